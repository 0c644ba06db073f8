#include "fluid_server/particles/site/site_ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/particle_volume.hpp"

namespace wade::fluid {

namespace {

struct Extent {
    MapPoint lo{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    MapPoint hi{-lo.x, -lo.z};

    void add(const MapLine& line) {
        for (const MapPoint& p : line) {
            lo = {std::min(lo.x, p.x), std::min(lo.z, p.z)};
            hi = {std::max(hi.x, p.x), std::max(hi.z, p.z)};
        }
    }
};

// Returns cells of `side` m over a line or a polygon and `margin` m more, clipped to the world and its margin.
PlanCells cells_over(const MapPolygon& polygon, const MapLine& line, const SiteShape& shape, double side,
                     double margin) {
    Extent extent;
    extent.add(line);
    for (const MapLine& ring : polygon.rings) extent.add(ring);
    const double x = std::max(extent.lo.x, shape.x.lo) - margin, z = std::max(extent.lo.z, shape.z.lo) - margin;
    const auto along = [&](double from, double to) {
        return static_cast<int>(std::max(0.0, std::ceil((to - from) / side)));
    };
    return {static_cast<float>(x), static_cast<float>(z), static_cast<float>(1 / side),
            along(x, std::min(extent.hi.x, shape.x.hi) + margin), along(z, std::min(extent.hi.z, shape.z.hi) + margin)};
}

// How far a point is from a line that may have one point only, m.
bool is_near(const MapLine& line, const MapPoint& p, double reach) {
    return is_at(Outlet{{}, {}, {}, line, {}, {}}, p, reach);
}

// In the world and in no house, with half a spacing to spare.
bool is_open_ground(const SiteShape& shape, const MapPoint& p, double half) {
    constexpr std::array<std::array<int, 2>, 5> round{{{0, 0}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};
    return std::all_of(round.begin(), round.end(), [&](const std::array<int, 2>& way) {
        const MapPoint q{p.x + way[0] * half, p.z + way[1] * half};
        return shape.x.lo <= q.x && q.x <= shape.x.hi && shape.z.lo <= q.z && q.z <= shape.z.hi && !in_house(shape, q);
    });
}

ParticleSource make_source(const Source& source, const SiteShape& shape, double spacing) {
    ParticleSource made;
    made.discharge = source.discharge;
    made.cells = cells_over(source.polygon, source.line, shape, spacing, 2 * spacing);
    for (int c = 0; c < static_cast<int>(made.cells.count()); ++c) {
        const MapPoint p = made.cells.middle(c);
        made.ground.push_back(static_cast<float>(shape.ground.height_at(p)));
        const bool of_source =
            source.line.empty() ? contains(source.polygon, p) : is_near(source.line, p, 0.75 * spacing);
        if (of_source && is_open_ground(shape, p, 0.45 * spacing)) made.sites.push_back(c);
    }
    if (made.sites.empty()) {
        throw ConfigurationError("the source \"" + source.name +
                                 "\" has no open ground as wide as a particle. Remedy: make it wider than two of "
                                 "/fluid/particle_spacing_m, or those smaller.");
    }
    return made;
}

ParticleOutlet make_outlet(const Outlet& outlet, const SiteShape& shape, double spacing) {
    ParticleOutlet made;
    made.cells = cells_over(outlet.polygon, outlet.line, shape, 0.5 * spacing, spacing);
    for (int c = 0; c < static_cast<int>(made.cells.count()); ++c)
        made.takes.push_back(is_at(outlet, made.cells.middle(c), spacing));
    return made;
}

}  // namespace

SiteEnds::SiteEnds(const Scene& scene)
    : spacing_(scene.fluid->particle_spacing), volume_(particle_volume(scene.fluid)), shape_(site_shape(scene)) {
    for (const Source& source : scene.site->sources) sources_.push_back(make_source(source, shape_, spacing_));
    for (const Outlet& outlet : scene.site->outlets) outlets_.push_back(make_outlet(outlet, shape_, spacing_));
}

void SiteEnds::begin_step(Particles& particles, double time, double dt) {
    take_leavers(particles);
    for (ParticleSource& source : sources_) {
        const auto made_by = [&](double t) {
            return static_cast<std::uint64_t>(integral_of(source.discharge, 0, t) / volume_);
        };
        if (const std::uint64_t before = made_by(time), now = made_by(time + dt); now > before)
            make(source, before, now, particles);
    }
}

void SiteEnds::take_leavers(Particles& p) {
    const auto& open = shape_.open;
    for (std::size_t i = 0; i < p.count; ++i) {
        const auto x = static_cast<double>(p.x[i]), z = static_cast<double>(p.z[i]);
        const bool beyond = (open[SiteShape::x_lo] && x < shape_.x.lo) || (open[SiteShape::x_hi] && x > shape_.x.hi) ||
                            (open[SiteShape::z_lo] && z < shape_.z.lo) || (open[SiteShape::z_hi] && z > shape_.z.hi);
        const bool leaves = beyond || std::any_of(outlets_.begin(), outlets_.end(), [&](const ParticleOutlet& outlet) {
                                const int cell = outlet.cells.at(p.x[i], p.z[i]);
                                return cell >= 0 && outlet.takes[static_cast<std::size_t>(cell)];
                            });
        if (!leaves) continue;
        p.x[i] = outflow_x();  // the grid drops it
        ++left_;
    }
}

namespace {

// Sorts the particles over a source by its cells.
void find_water(const Particles& p, ParticleSource& source) {
    source.water.resize(source.cells.count());
    for (auto& cell : source.water) cell.clear();
    for (std::size_t i = 0; i < p.count; ++i) {
        const int cell = source.cells.at(p.x[i], p.z[i]);
        if (cell >= 0) source.water[static_cast<std::size_t>(cell)].push_back({p.x[i], p.y[i], p.z[i]});
    }
}

// Returns the lowest height above the water of a site without a particle nearer than `apart`, among the particles of
// its cell and of the eight round it. None of the outermost cells is a site.
float free_height(const ParticleSource& source, int site, const MapPoint& place, float spacing) {
    const float apart = 0.95F * spacing;
    const auto c = static_cast<std::size_t>(site);
    float y = source.ground[c] + (static_cast<float>(source.water[c].size()) + 0.5F) * spacing;
    for (bool moved = true; moved;) {
        moved = false;
        for (const int row : {-source.cells.nx, 0, source.cells.nx}) {
            for (const int column : {-1, 0, 1}) {
                for (const Vec3& other : source.water[static_cast<std::size_t>(site + row + column)]) {
                    const float x = other[0] - static_cast<float>(place.x), z = other[2] - static_cast<float>(place.z);
                    const float square = apart * apart - x * x - z * z;
                    if (square <= 0 || std::abs(other[1] - y) >= 0.999F * std::sqrt(square)) continue;
                    y = other[1] + std::sqrt(square);
                    moved = true;
                }
            }
        }
    }
    return y;
}

}  // namespace

void SiteEnds::make(ParticleSource& source, std::uint64_t before, std::uint64_t now, Particles& p) {
    find_water(p, source);
    for (std::uint64_t n = before; n < now; ++n) {
        if (p.count == p.capacity()) {
            missed_ += now - n;
            return;
        }
        const std::uint64_t first = n * (1 + source.sites.size() / 3);  // where it looks first
        std::size_t fewest = std::numeric_limits<std::size_t>::max();
        int site = -1;
        for (std::size_t k = 0; k < source.sites.size(); ++k) {
            const int cell = source.sites[(k + first) % source.sites.size()];
            const std::size_t particles = source.water[static_cast<std::size_t>(cell)].size();
            if (particles < fewest) fewest = particles, site = cell;
        }
        const MapPoint middle = source.cells.middle(site);
        const Vec3 place{static_cast<float>(middle.x), free_height(source, site, middle, static_cast<float>(spacing_)),
                         static_cast<float>(middle.z)};
        p.add(place, {0, 0, 0}, Kind::fluid);
        source.water[static_cast<std::size_t>(site)].push_back(place);
        ++made_;
    }
}

std::string SiteEnds::remark() const {
    char text[200];
    std::snprintf(text, sizeof text, "%.9g m3 came in, %.9g m3 went out", static_cast<double>(made_) * volume_,
                  static_cast<double>(left_) * volume_);
    if (missed_ == 0) return text;
    return "warning: there was no room for " + std::to_string(missed_) +
           " particles of the sources, raise /fluid/max_particles; " + text;
}

}  // namespace wade::fluid
