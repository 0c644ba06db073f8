#include "fluid_server/maps/flood_maps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/files/geotiff.hpp"
#include "configs/files/plain_file.hpp"
#include "configs/numbers/hazard.hpp"

namespace wade::fluid {

namespace {

constexpr float no_value_here = std::numeric_limits<float>::quiet_NaN();

class MapWriter {
 public:
    MapWriter(const FloodMaps& maps, const Site& site, const std::filesystem::path& folder)
        : maps_(maps), site_(site), folder_(folder / "maps"), values_(maps.depth.size()) {
        std::filesystem::create_directories(folder_);
    }

    // `value`: of the cell of a number.
    template <typename Value>
    void write(const char* name, const Value& value) {
        for (std::size_t k = 0; k < values_.size(); ++k) values_[k] = maps_.wall[k] ? no_value_here : value(k);
        const MapGrid& grid = maps_.grid;
        const MapImage image{
            grid.x + site_.origin_x, grid.z + site_.origin_z, grid.dx, grid.dz, grid.columns, grid.rows, values_};
        write_geotiff(folder_ / name, image, site_.epsg);
    }

 private:
    const FloodMaps& maps_;
    const Site& site_;
    std::filesystem::path folder_;
    std::vector<float> values_;
};

// A name in a table, quoted if it would be several fields.
std::string field_of(const std::string& name) {
    if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
    std::string quoted = "\"";
    for (const char letter : name) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
    return quoted + "\"";
}

void write_gauges(const FloodMaps& maps, const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "gauges.csv";
    clear_name(file);
    std::ofstream out(file);
    out.precision(9);
    out << "time_s,name,depth_m,level_m,velocity_x_m_s,velocity_z_m_s,discharge_x_m2_s,discharge_z_m2_s\n";
    for (std::size_t n = 0; n < maps.gauges.front().time.size(); ++n) {
        for (const GaugeRecord& g : maps.gauges) {
            char values[160];
            std::snprintf(values, sizeof values, ",%.7g,%.7g,%.7g,%.7g,%.7g,%.7g\n", g.depth[n], g.ground + g.depth[n],
                          g.u[n], g.v[n], g.qx[n], g.qz[n]);
            out << g.time[n] << ',' << field_of(g.name) << values;
        }
    }
    if (!out.flush()) throw std::runtime_error(file.string() + ": it could not be written");
}

void raise(float& largest, double value) {
    largest = std::max(largest, static_cast<float>(value));
}

}  // namespace

FloodMaps::FloodMaps(const MapGrid& its_grid)
    : grid(its_grid),
      depth(grid.columns * grid.rows),
      speed(depth.size()),
      depth_speed(depth.size()),
      arrival(depth.size(), no_value_here),
      rating(depth.size()),
      hazard(depth.size()),
      wall(depth.size()) {}

void add_row(FloodMaps& maps, std::size_t row, double time, const double* h, const double* u, const double* v) {
    const std::size_t first = row * maps.grid.columns;
    for (std::size_t i = 0; i < maps.grid.columns; ++i) {
        if (h[i] < wet_depth) continue;
        const std::size_t k = first + i;
        const double fast = std::sqrt(u[i] * u[i] + v[i] * v[i]);
        if (std::isnan(maps.arrival[k])) maps.arrival[k] = static_cast<float>(time);
        raise(maps.depth[k], h[i]);
        raise(maps.speed[k], fast);
        raise(maps.depth_speed[k], h[i] * fast);
        raise(maps.rating[k], hazard_rating(h[i], fast));
        maps.hazard[k] = std::max(maps.hazard[k], static_cast<std::uint8_t>(hazard_class(h[i], fast)));
    }
    for (GaugeRecord& gauge : maps.gauges) {
        if (gauge.row != row) continue;
        gauge.time.push_back(time);
        gauge.depth.push_back(h[gauge.column]);
        gauge.u.push_back(u[gauge.column]);
        gauge.v.push_back(v[gauge.column]);
        gauge.qx.push_back(gauge.depth.back() * gauge.u.back());
        gauge.qz.push_back(gauge.depth.back() * gauge.v.back());
    }
}

void place_gauges(FloodMaps& maps, const Site& site, const std::vector<double>& ground) {
    const MapGrid& grid = maps.grid;
    for (const Gauge& gauge : site.gauges) {
        constexpr double reach = 2;  // cells
        GaugeRecord record{gauge.name, 0, 0, 0, {}, {}, {}, {}, {}, {}};
        double nearest = reach * reach;
        for (std::size_t k = 0; k < maps.wall.size(); ++k) {
            if (maps.wall[k]) continue;
            const std::size_t row = k / grid.columns, column = k % grid.columns;
            const double x = (gauge.at.x - grid.x) / grid.dx - static_cast<double>(column) - 0.5;
            const double z = (gauge.at.z - grid.z) / grid.dz - static_cast<double>(row) - 0.5;
            if (!(x * x + z * z < nearest)) continue;
            nearest = x * x + z * z;
            record.row = row, record.column = column, record.ground = ground[k];
        }
        if (!(nearest < reach * reach))
            throw ConfigurationError("the gauge " + gauge.name + " has walls alone round it. Remedy: move it, or " +
                                     "smaller cells (/fluid/shallow_water/cell_size_m)");
        maps.gauges.push_back(std::move(record));
    }
}

void write_maps(const FloodMaps& maps, const Site& site, const std::filesystem::path& folder) {
    if (!maps.gauges.empty()) write_gauges(maps, folder);
    MapWriter writer(maps, site, folder);
    writer.write("max_depth_m.tif", [&](std::size_t k) { return maps.depth[k]; });
    writer.write("max_speed_m_s.tif", [&](std::size_t k) { return maps.speed[k]; });
    writer.write("max_dv_m2_s.tif", [&](std::size_t k) { return maps.depth_speed[k]; });
    writer.write("arrival_s.tif", [&](std::size_t k) { return maps.arrival[k]; });
    writer.write("viseu.tif", [&](std::size_t k) {
        const auto level = danger_level(double{maps.depth[k]}, double{maps.depth_speed[k]});
        return static_cast<float>(level);
    });
    writer.write("arr_h.tif", [&](std::size_t k) { return static_cast<float>(maps.hazard[k]); });
    writer.write("defra.tif", [&](std::size_t k) { return maps.rating[k]; });
}

}  // namespace wade::fluid
