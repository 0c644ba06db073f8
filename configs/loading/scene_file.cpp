#include "configs/loading/scene_file.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <system_error>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

using nlohmann::json;

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

// The parser's message without its own number and position.
std::string reason_of(const json::exception& error) {
    const std::string text = error.what();
    const std::size_t column = text.find("column ");
    const std::size_t start = column == std::string::npos ? text.find("] ") : text.find(": ", column);
    return start == std::string::npos ? text : text.substr(start + 2);
}

// Finds what the parser itself lets pass: keys that stand twice in one object, and nesting deeper than any scene needs
// (which would exhaust the stack of all that walks through a document).
class Watch {
 public:
    bool operator()(int depth, json::parse_event_t event, const json& value) {
        if (depth > deepest_allowed) {
            too_deep_ = true;
            return false;
        }
        if (event == json::parse_event_t::object_start) {
            open_.emplace_back();
        } else if (event == json::parse_event_t::object_end) {
            open_.pop_back();
        } else if (event == json::parse_event_t::key) {
            const auto key = value.get<std::string>();
            if (!open_.back().insert(key).second && !first_) first_ = key;
        }
        return true;
    }
    [[nodiscard]] const std::optional<std::string>& duplicate() const { return first_; }
    [[nodiscard]] bool too_deep() const { return too_deep_; }

    static constexpr int deepest_allowed = 50;

 private:
    bool too_deep_ = false;
    std::vector<std::set<std::string>> open_;
    std::optional<std::string> first_;
};

// The same file under whatever name, to recognise a cycle.
std::filesystem::path identity(const std::filesystem::path& file) {
    std::error_code ignored;  // a file that cannot be resolved cannot be read either, and that error is reported
    const std::filesystem::path resolved = std::filesystem::weakly_canonical(file, ignored);
    return ignored ? file : resolved;
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

json parse_scene_text(std::string_view text, const std::string& source) {
    Watch watch;
    json document;
    try {
        document = json::parse(
            text.begin(), text.end(),
            [&watch](int depth, json::parse_event_t event, json& value) { return watch(depth, event, value); },
            /*allow_exceptions=*/true, /*ignore_comments=*/true);
    } catch (const json::parse_error& error) {
        throw ConfigurationError(source + ": not valid JSON at " + line_and_column(text, error.byte) + ": " +
                                 reason_of(error) + ".");
    } catch (const json::exception& error) {
        throw ConfigurationError(source + ": not valid JSON: " + reason_of(error) + ".");
    }
    if (watch.too_deep()) {
        throw ConfigurationError(source + ": objects and arrays are nested more than " +
                                 std::to_string(Watch::deepest_allowed) + " deep.");
    }
    if (watch.duplicate()) {
        throw ConfigurationError(source + ": the key \"" + *watch.duplicate() + "\" stands twice in one object.");
    }
    return document;
}

void merge_over(json& lower, const json& upper) {
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

std::vector<json> scene_layers(std::string_view text, const std::filesystem::path& file) {
    Problems problems;
    Chain chain;
    std::vector<json> layers;
    problems.attempt([&] {
        chain.add(file, file.string());
        std::string current(text);
        std::filesystem::path current_file = file;
        while (true) {
            const std::string source = current_file.string();
            json document = parse_scene_text(current, source);
            check_keys(document, scene_keys(), "", {source, problems});
            take_people(document, current_file, problems);
            make_paths_absolute(document, current_file.parent_path());
            const json extends = document.is_object() ? document.value("extends", json()) : json();
            layers.push_back(std::move(document));
            if (!extends.is_string() || extends.get_ref<const std::string&>().empty()) break;
            const std::filesystem::path parent =
                (current_file.parent_path() / extends.get<std::string>()).lexically_normal();
            chain.add(parent, source);
            current = read_text_file(parent, source + ": /extends: the file " + parent.string() + " that it extends");
            current_file = parent;
        }
    });
    problems.throw_if_any();
    std::reverse(layers.begin(), layers.end());
    return layers;
}

json merge_layers(const std::vector<json>& layers) {
    json merged = json::object();
    for (const json& layer : layers) {
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
