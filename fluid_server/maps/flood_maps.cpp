#include "fluid_server/maps/flood_maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "configs/files/geotiff.hpp"
#include "configs/numbers/hazard.hpp"

namespace wade::fluid {

namespace {

constexpr float no_value_here = std::numeric_limits<float>::quiet_NaN();

class MapWriter {
 public:
    MapWriter(const FloodMaps& maps, const Place& place, const std::filesystem::path& folder)
        : maps_(maps), place_(place), folder_(folder / "maps"), values_(maps.depth.size()) {
        std::filesystem::create_directories(folder_);
    }

    // `value`: of the cell of a number.
    template <typename Value>
    void write(const char* name, const Value& value) {
        for (std::size_t k = 0; k < values_.size(); ++k) values_[k] = maps_.wall[k] ? no_value_here : value(k);
        const MapGrid& grid = maps_.grid;
        const MapImage image{
            grid.x + place_.origin_x, grid.z + place_.origin_z, grid.dx, grid.dz, grid.columns, grid.rows, values_};
        write_geotiff(folder_ / name, image, place_.epsg);
    }

 private:
    const FloodMaps& maps_;
    const Place& place_;
    std::filesystem::path folder_;
    std::vector<float> values_;
};

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
}

void write_maps(const FloodMaps& maps, const Place& place, const std::filesystem::path& folder) {
    MapWriter writer(maps, place, folder);
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
