#include "configs/scene/scene_json.hpp"

#include <utility>

#include "configs/scene/fields/lists.hpp"

namespace wade {

namespace {

// Of one list of a scene file [A].
constexpr std::size_t most_entries = 20'000;

class Reader : public Fields {
 public:
    Reader(const Json& document, const Reading& reading, const std::string& skipped)
        : Fields(skipped), here_(&document), reading_(reading) {}

 private:
    void visit(const Key& key, const Member& member) override {
        if (key.storage == Storage::file) return;
        const std::string name(key.name);
        if (here_->contains(name)) {
            take((*here_)[name], key, member);
        } else if (key.presence.rule == Presence::Rule::required) {
            note_missing_key({key, {}, {}}, pointer_, reading_);
        } else if (key.presence.derived) {
            derive(key, member);
        } else if (key.presence.rule == Presence::Rule::otherwise) {
            member.set({});
        }
    }

    void take(const Json& value, const Key& key, const Member& member) {
        const std::string pointer = pointer_to(pointer_, std::string(key.name));
        if (key.kind == KeyKind::spread && value.is_object()) {
            for (const std::string_view limit : {"min", "max"}) {
                const Key its{limit, KeyKind::number, "A limit of the values.", key.unit, key.range};
                if (!value.contains(std::string(limit))) note_missing_key({its, {}, {}}, pointer, reading_);
            }
            if (!value.contains("min") || !value.contains("max")) return;
            if (value["min"].get<double>() > value["max"].get<double>()) {
                reading_.problems.note(reading_.source + ": " + pointer + ": min " + value["min"].dump() +
                                       " is above max " + value["max"].dump() + "; allowed: min <= max.");
            }
            if (value.contains("mean") != value.contains("sd")) {
                reading_.problems.note(reading_.source + ": " + pointer +
                                       ": of mean and sd there is one; allowed: both, or none.");
            }
        }
        member.set(key_value(value, key));
    }

    void derive(const Key& key, const Member& member) {
        const KeyValue value = key.presence.derived();
        if (std::holds_alternative<std::monostate>(value)) {
            if (key.presence.rule == Presence::Rule::otherwise) member.set({});
            return;
        }
        if (!std::holds_alternative<Spread>(value)) {  // that of the crowd, which was checked where it stands
            check_keys(json_of(value), {key, {}, {}}, pointer_to(pointer_, std::string(key.name)), reading_);
        }
        member.set(value);
    }

    void visit_object(const Key& key, const std::function<void()>& inside) override {
        const std::string name(key.name);
        if (!here_->contains(name) && key.presence.rule == Presence::Rule::required) {
            if (!replaced(key)) note_missing_key({key, {}, {}}, pointer_, reading_);
            return;
        }
        static const Json nothing = Json::object();
        enter(here_->contains(name) ? (*here_)[name] : nothing, name, inside);
    }

    void visit_optional(const Key& key, const OptionalMember& member) override {
        const std::string name(key.name);
        if (!here_->contains(name)) return;
        member.make();
        enter((*here_)[name], name, member.visit);
    }

    // Whether another key of this object stands for it.
    [[nodiscard]] bool replaced(const Key& key) const {
        return !key.presence.unless.empty() && here_->contains(std::string(key.presence.unless));
    }

    void visit_list(const Key& key, const ListMember& member) override {
        const std::string name(key.name);
        if (!here_->contains(name)) return;
        const Json& list = (*here_)[name];
        if (list.size() > most_entries) {  // reading it would take more than 2 s and 200 MB
            reading_.problems.note(reading_.source + ": " + pointer_to(pointer_, name) + ": " +
                                   std::to_string(list.size()) + " entries; allowed: up to " +
                                   std::to_string(most_entries) + ", more of them in a file.");
            return;
        }
        member.resize(list.size());
        enter(list, name, [&] {
            for (std::size_t i = 0; i < list.size(); ++i) {
                enter(list[i], std::to_string(i), [&] { member.visit(i); });
            }
        });
    }

    void once_read(const std::function<std::optional<std::string>()>& resolve) override {
        if (const auto sentence = resolve()) {
            reading_.problems.note(reading_.source + ": " + pointer_ + ": " + *sentence);
        }
    }

    void enter(const Json& value, const std::string& name, const std::function<void()>& inside) {
        const Json* const outer = std::exchange(here_, &value);
        const std::string outer_pointer = std::exchange(pointer_, pointer_to(pointer_, name));
        inside();
        here_ = outer;
        pointer_ = outer_pointer;
    }

    const Json* here_;  // the object whose keys are visited, and its pointer
    std::string pointer_;
    const Reading& reading_;
};

class Writer : public Fields {
 public:
    Writer(Json& document, const std::string& skipped) : Fields(skipped), here_(&document) {}

 private:
    void visit(const Key& key, const Member& member) override {
        if (key.storage != Storage::member) return;
        Json value = json_of(member.get());
        if (!value.is_null()) (*here_)[std::string(key.name)] = std::move(value);
    }
    void visit_object(const Key& key, const std::function<void()>& inside) override {
        enter((*here_)[std::string(key.name)] = Json::object(), inside);
    }
    void visit_optional(const Key& key, const OptionalMember& member) override {
        if (member.has()) enter((*here_)[std::string(key.name)] = Json::object(), member.visit);
    }
    void visit_list(const Key& key, const ListMember& member) override {
        Json& list = (*here_)[std::string(key.name)] = Json::array();
        for (std::size_t i = 0; i < member.size(); ++i) {
            list.push_back(Json::object());
            enter(list.back(), [&] { member.visit(i); });
        }
    }
    void enter(Json& value, const std::function<void()>& inside) {
        Json* const outer = std::exchange(here_, &value);
        inside();
        here_ = outer;
    }

    Json* here_;
};

}  // namespace

void read_fields(const Json& document, const FieldList& list, const Reading& reading, const std::string& skipped) {
    Reader reader(document, reading, skipped);
    list(reader);
}

Json written_fields(const FieldList& list, const std::string& skipped) {
    Json document = Json::object();
    Writer writer(document, skipped);
    list(writer);
    return document;
}

void read_scene(const Json& document, Scene& scene, const Reading& reading, const std::string& skipped) {
    read_fields(
        document, [&](Fields& f) { fields(scene, f); }, reading, skipped);
}

Json written_scene(const Scene& scene, const std::string& skipped) {
    Scene copy = scene;  // the lists take members that can be set
    return written_fields([&](Fields& f) { fields(copy, f); }, skipped);
}

}  // namespace wade
