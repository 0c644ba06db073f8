#include "crowd_client/water_snapshots.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

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

// Half a metre shows single particles of the paper's scenes; at most about a million cells a snapshot.
double cell_size(const Scene& scene) {
    const double area = scene.channel.x.length() * scene.channel.z.length();
    return std::max({0.5, scene.fluid.particle_spacing, std::sqrt(area / 1e6)});
}

std::uint32_t cells_along(double length, double cell) {
    return static_cast<std::uint32_t>(std::max(1.0, std::ceil(length / cell - 1e-9)));
}

}  // namespace

WaterSnapshots::WaterSnapshots(const std::filesystem::path& file, const Scene& scene)
    : file_(file),
      x0_(scene.channel.x.lo),
      z0_(scene.channel.z.lo),
      cell_(cell_size(scene)),
      columns_(cells_along(scene.channel.x.length(), cell_)),
      rows_(cells_along(scene.channel.z.length(), cell_)),
      rest_density_(scene.fluid.rest_density),
      mass_(static_cast<std::size_t>(columns_) * rows_) {
    std::string header = "WADEWAT1";
    put(header, columns_);
    put(header, rows_);
    put(header, cell_);
    put(header, x0_);
    put(header, z0_);
    put(header, max_depth);
    header.resize(header_bytes, '\0');
    file_.append(header);
}

void WaterSnapshots::write(std::uint64_t step, double time, const WaterView& water) {
    std::fill(mass_.begin(), mass_.end(), 0.0);
    for (std::size_t i = 0; i < water.size(); ++i) {
        const double c = std::floor((water.origin_x + water.scale_x * static_cast<double>(water.px[i]) - x0_) / cell_);
        const double r = std::floor((water.origin_z + water.scale_z * static_cast<double>(water.pz[i]) - z0_) / cell_);
        if (!(c >= 0 && c < columns_ && r >= 0 && r < rows_)) continue;
        mass_[static_cast<std::size_t>(r) * columns_ + static_cast<std::size_t>(c)] +=
            static_cast<double>(water.mass[i]);
    }
    record_.clear();
    put(record_, step);
    put(record_, time);
    for (const double mass : mass_) {
        const double depth = std::min(mass / (rest_density_ * cell_ * cell_), max_depth);
        put(record_, static_cast<std::uint16_t>(std::lround(depth * millimetres)));
    }
    file_.append(record_);
}

}  // namespace wade::crowd
