#include "tools/splishsplash/scene_settings.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#include "configs/json/json.hpp"

namespace wade::splishsplash {

namespace {

[[noreturn]] void refuse(const std::string& key, const Json& value, const std::string& allowed) {
    throw std::invalid_argument("/Wade/" + key + " is " + value.dump({.sorted = true}) + ", allowed is " + allowed);
}

double number(const std::string& key, const Json& value, double lo, double hi) {
    if (value.is_number() && value.get<double>() >= lo && value.get<double>() <= hi) return value.get<double>();
    std::ostringstream allowed;
    allowed << "a number from " << lo << " to " << hi;
    refuse(key, value, allowed.str());
}

template <typename Number>
std::array<Number, 3> triple(const std::string& key, const Json& value) {
    constexpr bool whole = std::is_integral_v<Number>;
    const auto fits = [](const Json& item) { return whole ? item.is_number_integer() : item.is_number(); };
    if (!value.is_array() || value.size() != 3 || !std::all_of(value.begin(), value.end(), fits))
        refuse(key, value, whole ? "three integers" : "three numbers");
    using Stored = std::conditional_t<whole, std::int64_t, double>;
    const auto item = [&](std::size_t i) { return static_cast<Number>(value[i].get<Stored>()); };
    return {item(0), item(1), item(2)};
}

void read_key(SceneSettings& settings, const std::string& key, const Json& value) {
    if (key == "session") {
        if (!value.is_string()) refuse(key, value, "a session name");
        settings.session = value.get<std::string>();
    } else if (key == "metres_per_unit") {
        settings.units.metres_per_unit = number(key, value, 1e-6, 1e6);
    } else if (key == "time_scale") {
        settings.units.time_scale = number(key, value, 1e-6, 1e6);
    } else if (key == "origin_m") {
        settings.units.origin = triple<double>(key, value);
    } else if (key == "axes") {
        settings.units.axes = triple<std::int32_t>(key, value);
    } else if (key == "depth") {
        const double depth = number(key, value, 1, 63);
        if (!value.is_number_integer()) refuse(key, value, "an integer from 1 to 63");
        settings.depth = static_cast<std::uint32_t>(depth);
    } else if (key == "attach_timeout_s") {
        settings.attach_timeout_s = number(key, value, 1e-3, 1e6);
    } else if (key == "step_timeout_s") {
        settings.step_timeout_s = number(key, value, 0, 1e6);
    } else {
        throw std::invalid_argument(
            "/Wade/" + key +
            " is no key of this block, which knows session, metres_per_unit, time_scale, origin_m, "
            "axes, depth, attach_timeout_s and step_timeout_s");
    }
}

}  // namespace

SceneSettings read_settings(std::string_view block) {
    SceneSettings settings;
    const std::optional<Json> object = block.empty() ? Json() : Json::try_parse(block);
    if (object && object->is_null()) return settings;
    if (!object || !object->is_object()) throw std::invalid_argument("/Wade must be an object");
    for (const JsonMember* const member : object->sorted_items()) read_key(settings, member->first, member->second);
    check(settings.units);
    return settings;
}

}  // namespace wade::splishsplash
