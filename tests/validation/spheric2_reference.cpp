#include "spheric2_reference.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "configs/errors/exit_code.hpp"

namespace wade::validation {

namespace {

constexpr double end_time = 3;  // s, of what is compared

std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) {
        fields.push_back(field.substr(0, field.find('\r')));
    }
    return fields;
}

std::size_t place_of(const std::vector<std::string>& header, const std::string& name, const std::string& file) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) {
        throw ConfigurationError(file + ": the first line names no column " + name +
                                 "; needed: t_s, H1_m, H2_m, H3_m, H4_m, P1_Pa, P3_Pa.");
    }
    return static_cast<std::size_t>(found - header.begin());
}

double number(const std::vector<std::string>& row, std::size_t place, const std::string& where) {
    try {
        return std::stod(row.at(place));
    } catch (const std::exception&) {
        throw ConfigurationError(where + ": field " + std::to_string(place + 1) + " is no number.");
    }
}

}  // namespace

double arrival_time(const std::vector<double>& time, const std::vector<double>& height) {
    for (std::size_t i = 0; i < height.size(); ++i) {
        if (height[i] > spheric2_arrival_height) {
            if (i == 0) {
                return time[0];
            }
            const double share = (spheric2_arrival_height - height[i - 1]) / (height[i] - height[i - 1]);
            return time[i - 1] + share * (time[i] - time[i - 1]);
        }
    }
    return std::numeric_limits<double>::quiet_NaN();
}

Spheric2Reference spheric2_table() {
    Spheric2Reference table;
    for (int k = 0; k <= 12; ++k) {
        table.time.push_back(0.25 * k);
    }
    // Read off the published series at these times; before 1 mm the gauges show noise.
    table.height = {{
        {0, 0, 0, 0, 0.145, 0.268, 0.343, 0.323, 0.288, 0.296, 0.324, 0.252, 0.229},
        {0, 0, 0.099, 0.140, 0.179, 0.202, 0.238, 0.325, 0.286, 0.291, 0.281, 0.231, 0.203},
        {0, 0.049, 0.096, 0.130, 0.155, 0.157, 0.144, 0.131, 0.142, 0.295, 0.270, 0.235, 0.238},
        {0.550, 0.500, 0.427, 0.347, 0.279, 0.224, 0.182, 0.153, 0.130, 0.115, 0.104, 0.168, 0.202},
    }};
    table.pressure = {{
        {0, 0, 6564, 3762, 2847, 2914, 2825, 2945, 3095, 2814, 2530, 2160, 1827},
        {0, 0, 5245, 3764, 3117, 2444, 2056, 2144, 2228, 2171, 1856, 1428, 1122},
    }};
    table.arrival = {0.925, 0.377, 0.226};
    table.peak = {9658, 6310};
    table.peak_time = {0.42, 0.46};
    return table;
}

Spheric2Reference spheric2_series(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    if (!std::getline(in, line)) {
        throw ConfigurationError("cannot read " + file.string() + ".");
    }
    const std::vector<std::string> header = split(line);
    const auto place = [&](const std::string& name) { return place_of(header, name, file.string()); };
    const std::size_t time = place("t_s");
    const std::array<std::size_t, 4> heights{place("H1_m"), place("H2_m"), place("H3_m"), place("H4_m")};
    const std::array<std::size_t, 2> pressures{place("P1_Pa"), place("P3_Pa")};
    Spheric2Reference series;
    series.series = true;
    for (int n = 2; std::getline(in, line); ++n) {
        const std::vector<std::string> row = split(line);
        const std::string where = file.string() + ":" + std::to_string(n);
        const double t = number(row, time, where);
        if (t > end_time + 1e-9) {
            break;
        }
        series.time.push_back(t);
        for (std::size_t k = 0; k < heights.size(); ++k) {
            series.height[k].push_back(number(row, heights[k], where));
        }
        for (std::size_t k = 0; k < pressures.size(); ++k) {
            series.pressure[k].push_back(number(row, pressures[k], where));
        }
    }
    if (series.time.empty() || series.time.back() < end_time - 1e-9) {
        throw ConfigurationError(file.string() + ": the series ends before t_s = 3.");
    }
    for (std::size_t k = 0; k < series.arrival.size(); ++k) {
        series.arrival[k] = arrival_time(series.time, series.height[k]);
    }
    for (std::size_t k = 0; k < series.peak.size(); ++k) {
        const auto peak = std::max_element(series.pressure[k].begin(), series.pressure[k].end());
        series.peak[k] = *peak;
        series.peak_time[k] = series.time[static_cast<std::size_t>(peak - series.pressure[k].begin())];
    }
    return series;
}

Spheric2Reference spheric2_reference() {
    const char* folder = std::getenv("WADE_SPHERIC2_DATA");
    return folder == nullptr || *folder == '\0'
               ? spheric2_table()
               : spheric2_series(std::filesystem::path(folder) / "spheric_test2_50Hz_boxavg.csv");
}

}  // namespace wade::validation
