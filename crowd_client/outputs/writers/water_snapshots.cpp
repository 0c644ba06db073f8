#include "crowd_client/outputs/writers/water_snapshots.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "crowd_client/water/footprint.hpp"

namespace wade::crowd {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian and written as it lies in memory");

constexpr std::size_t header_bytes = 64;
constexpr double millimetres = 1000;
constexpr double max_depth = 65.535;  // m, the largest u16 in millimetres

template <typename T>
void put(std::string& bytes, T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
}

bool has_columns(const Scene& scene) {
    return scene.site && scene.fluid->model == ModelKind::shallow_water;
}

// Half a metre shows single particles of the paper's scenes, in a site the water's own cells show its columns; at most about a
// million cells a snapshot.
double cell_size(const Scene& scene) {
    const double area = scene.channel->x.length() * scene.channel->z.length();
    const double of_water =
        has_columns(scene) ? scene.fluid->shallow_water.cell_size : std::max(0.5, scene.fluid->particle_spacing);
    return std::max(of_water, std::sqrt(area / 1e6));
}

GroundCells grid_over(const Scene& scene) {
    const Interval &x = scene.channel->x, &z = scene.channel->z;
    const double cell = cell_size(scene);
    const auto along = [&](double length) {
        return static_cast<std::size_t>(std::max(1.0, std::ceil(length / cell - 1e-9)));
    };
    return {x.lo, z.lo, cell, cell, along(x.length()), along(z.length())};
}

}  // namespace

WaterSnapshots::WaterSnapshots(const std::filesystem::path& file, const Scene& scene)
    : file_(file),
      grid_(grid_over(scene)),
      rest_density_(scene.fluid->rest_density),
      has_columns_(has_columns(scene)),
      mass_(grid_.cells()) {
    std::string header = "WADEWAT1";
    put(header, static_cast<std::uint32_t>(grid_.columns));
    put(header, static_cast<std::uint32_t>(grid_.rows));
    put(header, grid_.step_x);
    put(header, grid_.x0);
    put(header, grid_.z0);
    put(header, max_depth);
    header.resize(header_bytes, '\0');
    file_.append(header);
}

void WaterSnapshots::write(std::uint64_t step, double time, const WaterView& water) {
    std::fill(mass_.begin(), mass_.end(), 0.0);
    Footprints footprints(grid_, rest_density_, water.column);
    const bool of_one_cell = has_columns_ && !(water.column.x() > 0);
    for (std::size_t i = 0; i < water.size(); ++i) {
        const double mass = static_cast<double>(water.mass[i]);
        // A column of a site without a width is as wide as its cell, whatever its volume.
        footprints.deal(water.origin_x + water.scale_x * static_cast<double>(water.px[i]),
                        water.origin_z + water.scale_z * static_cast<double>(water.pz[i]), mass,
                        [&](std::size_t cell, double share, std::size_t own) {
                            if (!of_one_cell)
                                mass_[cell] += share * mass;
                            else if (cell == own)
                                mass_[cell] += mass;
                        });
    }
    record_.clear();
    put(record_, step);
    put(record_, time);
    const double mass_of_depth = rest_density_ * grid_.step_x * grid_.step_z;
    for (const double mass : mass_) {
        const double depth = std::min(mass / mass_of_depth, max_depth);
        put(record_, static_cast<std::uint16_t>(std::lround(depth * millimetres)));
    }
    file_.append(record_);
}

}  // namespace wade::crowd
