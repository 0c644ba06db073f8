// Keys that name files.

#include <functional>
#include <nlohmann/json.hpp>

#include "configs/loading/scene_file.hpp"
#include "configs/numbers/fnv1a.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

using nlohmann::json;

// Each value of `document` whose key names a file. Values of a wrong type are left to who checks them.
void visit_paths(json& document, const KeyNode& node, const std::function<void(json&)>& visit) {
    if (node.key.is_path) {
        if (document.is_string() && !document.get_ref<const std::string&>().empty()) visit(document);
    } else if (document.is_array() && node.key.kind == KeyKind::list) {
        const KeyNode element{{"", KeyKind::object, ""}, {}, node.inside};
        for (json& one : document) visit_paths(one, element, visit);
    } else if (document.is_object()) {
        for (const KeyNode& inner : node.inside) {
            const auto found = document.find(std::string(inner.key.name));
            if (found != document.end()) visit_paths(*found, inner, visit);
        }
    }
}

constexpr std::size_t longest_file = std::size_t{2} << 30;

}  // namespace

void make_paths_absolute(json& document, const std::filesystem::path& folder) {
    visit_paths(document, scene_keys(), [&](json& path) {
        path = std::filesystem::absolute(folder / path.get<std::string>()).lexically_normal().string();
    });
}

void put_contents_for_paths(json& document) {
    visit_paths(document, scene_keys(), [&](json& path) {
        const auto file = path.get<std::string>();
        path = fnv1a(read_text_file(file, "the file " + file, longest_file));
    });
}

}  // namespace wade
