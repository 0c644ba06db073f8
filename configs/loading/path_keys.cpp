// Keys that name files.

#include <functional>

#include "configs/loading/scene_file.hpp"
#include "configs/numbers/fnv1a.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

// Visits each value of `document` with a key that names a file. Skips values of a wrong type; check_keys() reports
// them.
void visit_paths(Json& document, const KeyNode& node, const std::function<void(Json&)>& visit) {
    if (node.key.is_path) {
        if (document.is_string() && !document.get<std::string>().empty()) visit(document);
    } else if (document.is_array() && node.key.kind == KeyKind::list) {
        const KeyNode element = element_of(node);
        for (Json& one : document) visit_paths(one, element, visit);
    } else if (document.is_object()) {
        for (const KeyNode& inner : node.inside) {
            if (Json* const found = document.find(inner.key.name)) visit_paths(*found, inner, visit);
        }
    }
}

constexpr std::size_t longest_file = std::size_t{2} << 30;

}  // namespace

void make_paths_absolute(Json& document, const std::filesystem::path& folder) {
    visit_paths(document, scene_keys(), [&](Json& path) {
        path = std::filesystem::absolute(folder / path.get<std::string>()).lexically_normal().string();
    });
}

void put_contents_for_paths(Json& document) {
    visit_paths(document, scene_keys(), [&](Json& path) {
        const auto file = path.get<std::string>();
        path = fnv1a(read_file(file, "the file " + file, longest_file));
    });
}

}  // namespace wade
