#include "configs/scene/fields.hpp"

namespace wade {

namespace {

std::string below(const std::string& place, std::string_view name) {
    return place + "/" + std::string(name);
}

}  // namespace

void Fields::leaf(Key key, const Member& member) {
    if (below(place_, key.name) == skipped_) return;
    if (key.storage == Storage::member) key.storage = storage_;
    visit(key, member);
}

void Fields::branch(const Key& key, const std::function<void()>& inside) {
    const std::string here = place_;
    place_ = below(here, key.name);
    if (place_ != skipped_) visit_object(key, inside);
    place_ = here;
}

void Fields::branch(const Key& key, const OptionalMember& member) {
    const std::string here = place_;
    place_ = below(here, key.name);
    if (place_ != skipped_) visit_optional(key, member);
    place_ = here;
}

void Fields::items(const Key& key, const ListMember& member) {
    const std::string here = place_;
    const std::string list = below(here, key.name);
    place_ = list + "/*";
    if (list != skipped_) visit_list(key, member);
    place_ = here;
}

}  // namespace wade
