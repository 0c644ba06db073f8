#include "configs/checks/scene_checks.hpp"

#include <cstdio>

#include "configs/errors/exit_code.hpp"

namespace wade {

std::string short_number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

void refuse(const std::string& source, const std::string& pointer, const std::string& sentence) {
    throw ConfigurationError(source + ": " + pointer + ": " + sentence);
}

void check_times(const std::vector<double>& times, const std::string& source, const std::string& list) {
    for (std::size_t i = 1; i < times.size(); ++i) {
        if (times[i - 1] <= times[i]) continue;
        refuse(source, list + "/" + std::to_string(i) + "/time_s",
               short_number(times[i]) +
                   " s is earlier than that of the point before; allowed: >= " + short_number(times[i - 1]) + " s.");
    }
}

void check_scene(const Scene& scene, const std::string& source) {
    Problems problems;
    check_geometry(scene, source, problems);
    problems.throw_if_any();
    check_site(scene, source, problems);
    problems.throw_if_any();
    check_boundaries(scene, source, problems);
    check_water(scene, source, problems);
    check_crowd(scene, source, problems);
    problems.throw_if_any();
}

}  // namespace wade
