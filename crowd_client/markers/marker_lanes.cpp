#include "crowd_client/markers/marker_lanes.hpp"

#include "configs/scene/obstacle.hpp"
#include "crowd_client/markers/counter_random.hpp"

namespace wade::crowd {
namespace {

constexpr double out_of_reach = 1e15;  // m; its square is a float

template <typename Real>
void close_lanes(MarkerLanes<Real>& lanes) {
    for (std::size_t m = lanes.count; m < Lanes<Real>::padded(lanes.count); ++m) {
        lanes.x[m] = lanes.z[m] = static_cast<Real>(out_of_reach);
    }
}

void drop_those_inside(MarkerLanes<float>& lanes, const Vector2d& moved, const Obstacle& box) {
    const double origin_x = lanes.origin_x + moved.x(), origin_z = lanes.origin_z + moved.y();
    const auto count = static_cast<std::uint32_t>(lanes.count);
    float* const at_x = lanes.x.data();
    const float* const at_z = lanes.z.data();
#pragma omp simd
    for (std::uint32_t m = 0; m < count; ++m) {
        const double x = origin_x + static_cast<double>(at_x[m]), z = origin_z + static_cast<double>(at_z[m]);
        const bool inside = (box.x.lo <= x) & (x <= box.x.hi) & (box.z.lo <= z) & (z <= box.z.hi);
        at_x[m] = inside ? static_cast<float>(out_of_reach) : at_x[m];
    }
}

// Drops the markers in a plan by the even-odd rule, one side of the plan after the other.
void drop_those_in(MarkerLanes<float>& lanes, const Vector2d& moved, const MapPolygon& plan) {
    const double origin_x = lanes.origin_x + moved.x(), origin_z = lanes.origin_z + moved.y();
    const auto count = static_cast<std::uint32_t>(lanes.count);
    float* const at_x = lanes.x.data();
    const float* const at_z = lanes.z.data();
    std::vector<std::uint8_t>& crossed = lanes.crossed;
    crossed.assign(count, 0);
    for (const MapLine& ring : plan.rings) {
        for (std::size_t k = 0, last = ring.size() - 1; k < ring.size(); last = k++) {
            const MapPoint a = ring[last], b = ring[k];
            if (a.z == b.z) continue;
            const double slant = (b.x - a.x) / (b.z - a.z);
#pragma omp simd
            for (std::uint32_t m = 0; m < count; ++m) {
                const double x = origin_x + static_cast<double>(at_x[m]), z = origin_z + static_cast<double>(at_z[m]);
                const bool crosses = ((a.z > z) != (b.z > z)) & (x < a.x + slant * (z - a.z));
                crossed[m] ^= static_cast<std::uint8_t>(crosses);
            }
        }
    }
    for (std::uint32_t m = 0; m < count; ++m) {
        if (crossed[m] != 0) at_x[m] = static_cast<float>(out_of_reach);
    }
}

// Two numbers of 16 bits in one. "lowbias32" by C. Wellons (Hash function prospector, 2018).
inline std::uint32_t mix_32(std::uint32_t h) {
    h = (h ^ (h >> 16)) * 0x7feb352dU;
    h = (h ^ (h >> 15)) * 0x846ca68bU;
    return h ^ (h >> 16);
}

}  // namespace

void read_markers(MarkerLanes<double>& lanes, const Markers& markers, int column, int row) {
    const std::size_t cell = markers.grid.index(column, row);
    const std::size_t first = markers.cell_start[cell];
    lanes.count = markers.cell_start[cell + 1] - first;
    make_room(lanes.x, Lanes<double>::padded(lanes.count));
    make_room(lanes.z, Lanes<double>::padded(lanes.count));
    for (std::size_t m = 0; m < lanes.count; ++m) {
        lanes.x[m] = markers.x[first + m];
        lanes.z[m] = markers.z[first + m];
    }
    close_lanes(lanes);
}

void draw_markers(MarkerLanes<float>& lanes, const DrawnMarkers& drawn, int column, int row) {
    const bool beyond_joint = drawn.ring && (column == 0 || column > drawn.grid.columns - 3);
    lanes.count = beyond_joint ? 0 : drawn.first_x.size();
    lanes.origin_x = GroundGrid::line_start(column) + GroundGrid::cell_size / 2;
    lanes.origin_z = GroundGrid::line_start(row) + GroundGrid::cell_size / 2;
    make_room(lanes.x, Lanes<float>::padded(lanes.count));
    make_room(lanes.z, Lanes<float>::padded(lanes.count));

    const std::uint64_t cell = drawn.grid.index(column, row);
    const std::uint64_t key = mix_bits(mix_bits(drawn.seed + splitmix_step * (drawn.epoch + 1)) + splitmix_step * cell);
    const auto low = static_cast<std::uint32_t>(key), high = static_cast<std::uint32_t>(key >> 32);
    const float range = drawn.jitter * 0x1p-16F;
    const float* const first_x = drawn.first_x.data();
    const float* const first_z = drawn.first_z.data();
    float* const x = lanes.x.data();
    float* const z = lanes.z.data();
#pragma omp simd
    for (std::uint32_t i = 0; i < lanes.count; ++i) {
        const std::uint32_t h = mix_32(i * 0x9e3779b9U + low) ^ high;
        x[i] = first_x[i] + range * static_cast<float>(static_cast<std::int32_t>(h & 0xffffU));
        z[i] = first_z[i] + range * static_cast<float>(static_cast<std::int32_t>(h >> 16));
    }
    const double half = GroundGrid::cell_size / 2;
    const double middle_x = lanes.origin_x + drawn.moved.x(), middle_z = lanes.origin_z + drawn.moved.y();
    for_each_near(drawn.obstacles, {middle_x - half, middle_x + half}, {middle_z - half, middle_z + half},
                  [&](const Obstacle& box) { drop_those_inside(lanes, drawn.moved, box); });
    for_each_near(drawn.houses.grounds, {middle_x - half, middle_x + half}, {middle_z - half, middle_z + half},
                  [&](const Obstacle& ground) { drop_those_in(lanes, drawn.moved, drawn.houses.plan_on(ground)); });
    close_lanes(lanes);
}

}  // namespace wade::crowd
