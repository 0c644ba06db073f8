#include "configs/loading/scene_file.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/short_names.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

// "line L, column C" of the byte with the given number, counted from 1.
std::string line_and_column(std::string_view text, std::size_t byte) {
    std::size_t line = 1, column = 1;
    for (std::size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
        if (text[i] == '\n') {
            ++line;
            column = 1;
        } else {
            ++column;
        }
    }
    return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

// The same file under whatever name, to recognise a cycle.
std::filesystem::path identity(const std::filesystem::path& file) {
    std::error_code ignored;  // a file that cannot be resolved cannot be read either, and that error is reported
    const std::filesystem::path resolved = std::filesystem::weakly_canonical(file, ignored);
    return ignored ? file : resolved;
}

// Returns the file that `name` stands for in /extends of `file`: relative to its folder, or else a short name. Throws
// ConfigurationError if there is neither.
std::filesystem::path extended_file(const std::filesystem::path& file, const std::string& name) {
    const std::filesystem::path relative = (file.parent_path() / name).lexically_normal();
    std::error_code ignored;  // a file that cannot be read is reported with its reason
    if (std::filesystem::status(relative, ignored).type() != std::filesystem::file_type::not_found) return relative;
    const std::optional<std::filesystem::path> folder = scenes_folder();
    const std::optional<std::filesystem::path> known = folder ? scene_of_short_name(name, *folder) : std::nullopt;
    if (known) return *known;
    throw ConfigurationError(file.string() + ": /extends: there is no file " + relative.string() +
                             " and no scene of this short name; `wade scenes` lists those.");
}

// Renames /place, the name of /site until version 1.0.
void rename_place(Json& document, const std::string& source) {
    if (!document.is_object() || !document.contains("place")) return;
    if (document.contains("site")) {
        throw ConfigurationError(source + ": /place is the former name of /site, which is there, too; allowed: /site.");
    }
    Json site = std::move(document["place"]);
    document.erase("place");
    document["site"] = std::move(site);  // a new member may move the others in memory
}

// The files that extend one another, the first being the one that was asked for.
class Chain {
 public:
    static constexpr std::size_t most_files = 32;

    // Throws if `file`, which `named_by` extends, is in the chain already or makes it too long.
    void add(const std::filesystem::path& file, const std::string& named_by) {
        const bool is_new = known_.insert(identity(file)).second;
        names_.push_back(file.string());
        if (!is_new) {
            throw ConfigurationError(named_by + ": /extends: the files extend one another: " + way() + ".");
        }
        if (names_.size() > most_files) {
            throw ConfigurationError(named_by + ": /extends: more than " + std::to_string(most_files) +
                                     " files extend one another in a row, from " + names_.front() +
                                     " on; allowed: <= " + std::to_string(most_files) + ".");
        }
    }

 private:
    [[nodiscard]] std::string way() const {
        std::string text;
        for (const std::string& name : names_) text += (text.empty() ? "" : " -> ") + name;
        return text;
    }

    std::set<std::filesystem::path> known_;
    std::vector<std::string> names_;
};

}  // namespace

Json parse_scene_text(std::string_view text, const std::string& source) {
    try {
        return Json::parse(text, {.comments = true, .unique_keys = true});
    } catch (const JsonError& error) {
        const std::string place = error.fault == JsonError::Fault::syntax
                                      ? "not valid JSON at " + line_and_column(text, error.byte) + ": "
                                  : error.fault == JsonError::Fault::number ? "not valid JSON: "
                                                                            : "";
        throw ConfigurationError(source + ": " + place + error.what() + ".");
    }
}

void merge_over(Json& lower, const Json& upper) {
    if (!lower.is_object() || !upper.is_object()) {
        lower = upper;
        return;
    }
    for (const auto& [key, value] : upper.items()) {
        if (lower.contains(key)) {
            merge_over(lower[key], value);
        } else {
            lower[key] = value;
        }
    }
}

std::vector<Json> scene_layers(std::string_view text, const std::filesystem::path& file) {
    Problems problems;
    Chain chain;
    std::vector<Json> layers;
    problems.attempt([&] {
        chain.add(file, file.string());
        std::string current(text);
        std::filesystem::path current_file = file;
        while (true) {
            const std::string source = current_file.string();
            Json document = parse_scene_text(current, source);
            rename_place(document, source);
            check_keys(document, scene_keys(), "", {source, problems});
            take_people(document, current_file, problems);
            make_paths_absolute(document, current_file.parent_path());
            const Json extends = std::as_const(document)["extends"];
            layers.push_back(std::move(document));
            if (!extends.is_string() || extends.get<std::string>().empty()) break;
            const std::filesystem::path parent = extended_file(current_file, extends.get<std::string>());
            chain.add(parent, source);
            current = read_text_file(parent, source + ": /extends: the file " + parent.string() + " that it extends");
            current_file = parent;
        }
    });
    problems.throw_if_any();
    std::reverse(layers.begin(), layers.end());
    return layers;
}

Json merge_layers(const std::vector<Json>& layers) {
    Json merged = Json::object();
    for (const Json& layer : layers) {
        // A scene that took over its parent's name would write its results under that name.
        merged.erase("name");
        merged.erase("description");
        merge_over(merged, layer);
    }
    merged.erase("extends");
    merged.erase("$schema");
    return merged;
}

}  // namespace wade
