#pragma once
// Finds positions that are nearer to one another than a millimetre, in about constant time each.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "configs/numbers/portable.hpp"

namespace wade {

// Two agents must start at least this far apart, m: at one point they have no direction of separation.
inline constexpr double smallest_start_distance = 0.001;

// Positions in cells of the smallest distance: two that are too near lie in one cell or in neighbours. Coordinates: m,
// |x|, |z| <= 1e5.
class NearPositions {
 public:
    void add(double x, double z, std::size_t id) { cells_[key(cell(x), cell(z))].push_back({x, z, id}); }

    // Returns the id of an added position that is nearer than the smallest distance.
    [[nodiscard]] std::optional<std::size_t> near(double x, double z) const {
        for (std::int64_t cx = cell(x) - 1; cx <= cell(x) + 1; ++cx) {
            for (std::int64_t cz = cell(z) - 1; cz <= cell(z) + 1; ++cz) {
                const auto found = cells_.find(key(cx, cz));
                if (found == cells_.end()) continue;
                for (const Position& place : found->second) {
                    if (length_of(x - place.x, z - place.z) < smallest_start_distance) return place.id;
                }
            }
        }
        return std::nullopt;
    }

 private:
    struct Position {
        double x, z;
        std::size_t id;
    };

    static std::int64_t cell(double v) { return static_cast<std::int64_t>(std::floor(v / smallest_start_distance)); }
    static std::int64_t key(std::int64_t cx, std::int64_t cz) {
        constexpr std::int64_t stride = std::int64_t{1} << 31;  // more than the cells along z
        return cx * stride + cz;
    }

    std::unordered_map<std::int64_t, std::vector<Position>> cells_;
};

}  // namespace wade
