#pragma once
// Flood maps: the largest values in each cell of a site since t = 0.
//
// Depth h and speed v count from 0.01 m of water on: thinner films are dry, because their speeds mean nothing to people
// [A]. Each map is the maximum of its own value over the ends of frames; it is not computed from the other maps:
//
//   max_depth_m h    max_speed_m_s v    max_dv_m2_s h v    arrival_s the first time with water
//   viseu 0 to 4, arr_h 0 to 6, defra the rating: see configs/numbers/hazard.hpp
//
// Walls and ground without height have no value; arrival_s has none where no water came. Gauges are read at the ends of
// frames, too, at any depth, in the cell with the nearest centre that is no wall.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "configs/scene/scene.hpp"

namespace wade::fluid {

struct MapGrid {
    double x = 0, z = 0;    // of the lower left corner from the scene's origin, m
    double dx = 1, dz = 1;  // m
    std::size_t columns = 0, rows = 0;
};

// A gauge, and what it read.
struct GaugeRecord {
    std::string name;
    std::size_t row = 0, column = 0;
    double ground = 0;                      // m, of its cell
    std::vector<double> time, depth, u, v;  // s, m, m/s along x and z
    std::vector<double> qx, qz;             // discharge per width along x and z, m^2/s
};

struct FloodMaps {
    explicit FloodMaps(const MapGrid& its_grid);

    MapGrid grid;
    std::vector<float> depth, speed, depth_speed, arrival, rating;  // by row from the south, then column
    std::vector<std::uint8_t> hazard;                               // H1 to H6
    std::vector<bool> wall;
    std::vector<GaugeRecord> gauges;
};

// Sets the gauges of a site up, once the walls are known; `ground`: its height, m, by cell as in the maps. Throws
// ConfigurationError if there are walls alone where a gauge is.
void place_gauges(FloodMaps& maps, const Site& site, const std::vector<double>& ground);

// Adds the water of a row at a time, s: depth, m, and velocity, m/s, of its cells. The discharge of gauges is their product; a
// model that knows the flux through faces writes that in its place.
void add_row(FloodMaps& maps, std::size_t row, double time, const double* h, const double* u, const double* v);

// Writes the maps into `folder`/maps, in the site's coordinate system, and `folder`/gauges.csv if there are gauges. Throws std::runtime_error.
void write_maps(const FloodMaps& maps, const Site& site, const std::filesystem::path& folder);

inline constexpr double wet_depth = 0.01;  // m

// Memory of a cell, bytes.
inline constexpr double bytes_of_map_cell = 5 * sizeof(float) + 2;

}  // namespace wade::fluid
