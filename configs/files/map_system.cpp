#include "configs/files/map_system.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <iterator>

namespace wade {

namespace {

struct NumberRun {
    int first, count;
};
constexpr NumberRun metre_systems[] = {
#include "configs/files/metre_systems.inc"
};

bool is_in_metres(int epsg) {
    const auto after = std::upper_bound(std::begin(metre_systems), std::end(metre_systems), epsg,
                                        [](int number, const NumberRun& run) { return number < run.first; });
    return after != std::begin(metre_systems) && epsg < std::prev(after)->first + std::prev(after)->count;
}

}  // namespace

std::string import_words() {
    return "Remedy: tools/wade site import FILE --out DIR writes it as the programs read it.";
}

std::string reproject_words() {
    return "allowed: a projected system with axes east and north in metres. Remedy: tools/wade site import FILE "
           "--epsg "
           "N --out DIR reprojects, N for example that of the site's UTM zone.";
}

std::string fault_of_system(int epsg) {
    if (epsg == 0 || is_in_metres(epsg)) return "";
    const std::string number = "EPSG:" + std::to_string(epsg);
    constexpr std::array mercator{3857, 900913, 3785, 3395};
    if (std::find(mercator.begin(), mercator.end(), epsg) != mercator.end())
        return number + " is a Mercator map of the world; its lengths grow with latitude; " + reproject_words();
    constexpr std::array degrees{4326, 4258, 4267, 4269, 4171, 4283, 4312, 4612, 4674, 4979, 7844};
    if (std::find(degrees.begin(), degrees.end(), epsg) != degrees.end())
        return number + " counts in degrees; " + reproject_words();
    return number +
           " is no projected system in metres: its axes are in feet, degrees, south or west, or EPSG does not know "
           "it; " +
           reproject_words();
}

std::optional<int> epsg_of_name(std::string_view name) {
    std::string text(name);
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    constexpr std::array<std::string_view, 5> starts{
        "URN:OGC:DEF:CRS:EPSG:", "URN:X-OGC:DEF:CRS:EPSG:", "HTTP://WWW.OPENGIS.NET/DEF/CRS/EPSG/",
        "HTTPS://WWW.OPENGIS.NET/DEF/CRS/EPSG/", "EPSG:"};
    for (const std::string_view start : starts) {
        if (!text.starts_with(start)) continue;
        std::string_view rest = std::string_view(text).substr(start.size());
        // A version of the register may stand before the number.
        const std::size_t slash = start == "EPSG:" ? std::string_view::npos : rest.find_last_of(":/");
        if (slash != std::string_view::npos) rest.remove_prefix(slash + 1);
        int number = 0;
        const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
        if (error == std::errc() && end == rest.data() + rest.size() && number > 0) return number;
        return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace wade
