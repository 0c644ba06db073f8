#include "fluid_server/steering/walls.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"

namespace wade::fluid::steering {

namespace {

// From the nearest point of a box to x; zero inside.
Vec3 way_from_box(const Box& box, const Vec3& x) {
    Vec3 way{};
    for (std::size_t k = 0; k < 3; ++k) {
        way[k] = x[k] - std::max(box.lo[k], std::min(box.hi[k], x[k]));
    }
    return way;
}

}  // namespace

Walls::Walls(const Solids& solids, const Channel& channel, const Settings& settings)
    : interior_(solids.interior()),
      quiet_(solids.interior()),
      obstacles_(solids.obstacles()),
      bed_(bed_facets(channel)),
      radius_(settings.wall_radius),
      push_(settings.wall_force ? settings.wall : 0),
      loss_(settings.wall_loss) {
    for (std::size_t k = 0; k < 3; ++k) {
        quiet_.lo[k] += radius_;
        quiet_.hi[k] -= radius_;
    }
    constexpr float for_rounding = 1.125F;
    std::vector<Box> near;
    for (const Box& box : obstacles_) near.push_back(grown(box, for_rounding * radius_));
    index_ = BoxIndex(near);
}

template <typename OnFace>
void Walls::for_each_face(const Vec3& x, OnFace&& on_face) const {
    for (std::size_t k = 0; k < 3; ++k) {
        Vec3 normal{};
        if (x[k] < quiet_.lo[k]) {
            normal[k] = 1;
            on_face(normal, x[k] - interior_.lo[k]);
        }
        if (x[k] > quiet_.hi[k]) {
            normal[k] = -1;
            on_face(normal, interior_.hi[k] - x[k]);
        }
    }
    if (!bed_.empty()) {
        const BedFacet& facet = facet_at(bed_, x[0]);
        const float distance = facet.distance(x[0], x[1]);
        if (distance < radius_) on_face(Vec3{facet.nx, facet.ny, 0}, distance);
    }
    for (const std::uint32_t o : index_.at(x[0], x[2])) {
        const Vec3 way = way_from_box(obstacles_[o], x);
        const float distance = std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
        if (distance > 0 && distance < radius_) {
            on_face(Vec3{way[0] / distance, way[1] / distance, way[2] / distance}, distance);
        }
    }
}

void Walls::add_near(const Vec3& x, const Vec3& v, Vec3& a) const {
    for_each_face(x, [&](const Vec3& normal, float distance) {
        const float pushed = push_ * push(radius_, distance);
        const float lost = loss_ * std::clamp(1 - distance / radius_, 0.0F, 1.0F);
        for (std::size_t k = 0; k < 3; ++k) a[k] += pushed * normal[k] - lost * v[k];
    });
}

double Walls::energy(const Vec3& x) const {
    double work = 0;
    for_each_face(x, [&](const Vec3&, float distance) {
        work += static_cast<double>(push_) * push_work(static_cast<double>(radius_), static_cast<double>(distance));
    });
    return work;
}

void keep_sphere_out(const Solids& solids, const std::vector<BedFacet>& bed, const std::array<double, 3>& centre,
                     double radius, double dt, std::array<double, 3>& velocity) {
    // Inelastic: of the velocity towards a face remains what reaches it within dt.
    const auto keep = [&](const std::array<double, 3>& normal, double gap) {
        double outward = 0;
        for (std::size_t k = 0; k < 3; ++k) outward += normal[k] * velocity[k];
        const double missing = -gap / dt - outward;
        for (std::size_t k = 0; k < 3 && missing > 0; ++k) velocity[k] += missing * normal[k];
    };
    const Vec3 x{static_cast<float>(centre[0]), static_cast<float>(centre[1]), static_cast<float>(centre[2])};
    for (const Box& box : solids.obstacles()) {
        const Vec3 way = way_from_box(box, x);
        const double distance = std::sqrt(static_cast<double>(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]));
        if (distance == 0) continue;
        keep({static_cast<double>(way[0]) / distance, static_cast<double>(way[1]) / distance,
              static_cast<double>(way[2]) / distance},
             distance - radius);
    }
    if (!bed.empty()) {
        const BedFacet& facet = facet_at(bed, x[0]);
        keep({static_cast<double>(facet.nx), static_cast<double>(facet.ny), 0},
             static_cast<double>(facet.distance(x[0], x[1])) - radius);
    }
    const Box& interior = solids.interior();
    for (std::size_t k = 0; k < 3; ++k) {
        std::array<double, 3> normal{};
        normal[k] = 1;
        if (std::isfinite(interior.lo[k])) keep(normal, centre[k] - static_cast<double>(interior.lo[k]) - radius);
        normal[k] = -1;
        if (std::isfinite(interior.hi[k])) keep(normal, static_cast<double>(interior.hi[k]) - centre[k] - radius);
    }
}

}  // namespace wade::fluid::steering
