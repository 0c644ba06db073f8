#include "fluid_server/mixed/guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/particle_volume.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/parallel.hpp"

namespace wade::fluid::mixed {

namespace {

constexpr double golden = 0.6180339887498949;
constexpr double nowhere = -std::numeric_limits<double>::infinity();

// Where the stream is thinner than this share of a spacing it is no guide, nor is it for spray more than a spacing above
// it: what leaves the window there flies on by itself.
constexpr double thin = 0.25;

// Removes each particle i with drop(i), in stable order.
template <typename Drop>
void drop_particles(Particles& p, Drop&& drop) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        if (drop(i)) continue;
        if (kept != i) {
            for (const ParticleArray& array : particle_arrays) (p.*array.values)[kept] = (p.*array.values)[i];
            p.kind[kept] = p.kind[i];
        }
        ++kept;
    }
    p.count = kept;
}

}  // namespace

Guards::Guards(const shallow_water::ShallowWater& world, double length)
    : z_(world.grid.z),
      spacing_(world.scene.fluid->particle_spacing),
      length_(length),
      strips_(static_cast<std::size_t>(count_along(z_.length(), spacing_))),
      width_(z_.length() / static_cast<double>(strips_)),
      pitch_(spacing_),
      ends_(),
      outermost_(strips_) {
    for (std::size_t e = 0; e < 2; ++e) {
        End& end = ends_[e];
        end.side = e == 0 ? -1 : 1;
        end.last.assign(strips_, nowhere);
        // Strips add their odd particles in turn.
        for (std::size_t k = 0; k < strips_; ++k) {
            const double turn = golden * static_cast<double>(k + 1);
            end.rest.push_back(turn - std::floor(turn));
        }
    }
}

void Guards::move_to(const Window& window, const shallow_water::Grid& grid, bool walls) {
    const std::array<std::size_t, 2> faces{window.begin, window.end};
    const std::array<std::size_t, 2> borders{0, grid.nx};
    for (std::size_t e = 0; e < 2; ++e) {
        End& end = ends_[e];
        const double moved = end.side * (grid.face_x(faces[e]) - end.x);
        for (double& last : end.last) last -= moved;
        end.x = grid.face_x(faces[e]);
        end.open = !(walls && faces[e] == borders[e]);
    }
}

std::size_t Guards::strip_of(double z) const {
    const double strip = std::floor((z - z_.lo) / width_);
    return static_cast<std::size_t>(std::clamp(strip, 0.0, static_cast<double>(strips_ - 1)));
}

void Guards::fill(Particles& p, const shallow_water::ShallowWater& world) {
    const double length = ends_[1].x - ends_[0].x;
    // Between two walls whole columns; else the lattice starts half a spacing inside the outer edge or the wall.
    if (!ends_[0].open && !ends_[1].open) pitch_ = length / count_along(length, spacing_);
    const double from = ends_[0].open ? length_ : 0;
    ends_[1].last.assign(strips_, -(length + from) - 0.5 * pitch_);
    ends_[0].last.assign(strips_, from - 0.5 * pitch_);
    add_columns(ends_[1], p, world);
    pitch_ = spacing_;
}

void Guards::update(Particles& p, const shallow_water::ShallowWater& world, double dt,
                    const std::array<double, 2>& moved) {
    for (std::size_t i = 0; i < p.count; ++i) {
        const double x = static_cast<double>(p.x[i]);
        const bool outside =
            std::any_of(ends_.begin(), ends_.end(), [&](const End& end) { return end.open && end.s_of(x) > 0; });
        p.kind[i] = outside ? Kind::inflow : Kind::fluid;
    }
    drop_particles(p, [&](std::size_t i) {
        const double x = static_cast<double>(p.x[i]);
        return p.kind[i] == Kind::inflow && std::any_of(ends_.begin(), ends_.end(), [&](const End& end) {
                   return end.open && end.s_of(x) > length_;
               });
    });
    for (std::size_t e = 0; e < 2; ++e) {
        End& end = ends_[e];
        std::fill(outermost_.begin(), outermost_.end(), nowhere);
        for (std::size_t i = 0; i < p.count; ++i) {
            const double s = end.s_of(static_cast<double>(p.x[i]));
            if (s < -spacing_ - length_) continue;
            double& outermost = outermost_[strip_of(static_cast<double>(p.z[i]))];
            outermost = std::max(outermost, s);
        }
        double outwards = 0;
        for (std::size_t k = 0; k < strips_; ++k) {
            end.last[k] = std::max(end.last[k], outermost_[k]);
            if (!end.open) {
                outwards += 1;
                continue;
            }
            const double z = z_.lo + (static_cast<double>(k) + 0.5) * width_;
            const double u = stream_at(world, end.x + end.side * length_, z).u;
            outwards += end.side * u;
            end.last[k] = std::clamp(end.last[k] + end.side * u * dt, outermost_[k], length_);
        }
        // Where the stream leads in, the guard ends in a column, and the next ones follow it; else it ends anyhow.
        add_columns(end, p, world, outwards > 0 ? moved[e] - (end.open ? 0 : length_) : 0);
    }
    for_each_particle(p.count, [&](std::size_t i) {
        if (p.kind[i] == Kind::fluid) return;
        const Stream stream = stream_at(world, static_cast<double>(p.x[i]), static_cast<double>(p.z[i]));
        const double y = static_cast<double>(p.y[i]);
        if (stream.h < thin * spacing_ || y > stream.h + spacing_) {
            p.vy[i] = y > spacing_ ? p.vy[i] - static_cast<float>(world.constants.gravity * dt) : 0;
            p.pressure[i] = 0;
            return;
        }
        p.pressure[i] = static_cast<float>(world.constants.gravity * std::max(0.0, stream.h - y));
        p.vx[i] = static_cast<float>(stream.u);
        p.vy[i] = static_cast<float>(-y * stream.divergence);
        p.vz[i] = static_cast<float>(stream.v);
    });
}

// filled: length that the columns fill, m, if it is above 0.
void Guards::add_columns(End& end, Particles& p, const shallow_water::ShallowWater& world, double filled) {
    const double outer = end.open ? length_ : -0.4 * pitch_;
    double columns = 0;
    for (const double last : end.last) columns += std::max(0.0, std::floor((outer - last) / pitch_));
    const double wanted = filled * static_cast<double>(strips_) / pitch_;
    const double share = filled > 0 && columns > 0 ? std::clamp(wanted / columns, 0.5, 2.0) : 1.0;
    for (std::size_t k = 0; k < strips_; ++k) {
        while (end.last[k] + pitch_ <= outer) {
            end.last[k] += pitch_;
            add_column(end, k, end.last[k], share, p, world);
        }
    }
}

void Guards::add_column(End& end, std::size_t strip, double s, double share, Particles& p,
                        const shallow_water::ShallowWater& world) {
    const double x = end.x + end.side * s, z = z_.lo + (static_cast<double>(strip) + 0.5) * width_;
    const Stream stream = stream_at(world, x, z);
    const double ground = width_ * pitch_, volume = particle_volume(world.scene.fluid);
    const double wanted = share * stream.h * ground / volume + end.rest[strip];
    const double number = std::floor(wanted);
    end.rest[strip] = wanted - number;
    const double height = volume / (share * ground);  // of each particle in the column
    for (double j = 0; j < number; ++j) {
        const double y = (j + 0.5) * height;
        const Vec3 place{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
        if (!is_free(place, world.scene.obstacles, spacing_)) continue;
        if (p.count == p.capacity()) {
            throw RunError(
                ExitCode::numerical_failure,
                "no room for one more particle: raise /fluid/max_particles, which is " + std::to_string(p.capacity()));
        }
        const double pressure = world.constants.gravity * std::max(0.0, stream.h - y);
        p.add(place,
              {static_cast<float>(stream.u), static_cast<float>(-y * stream.divergence), static_cast<float>(stream.v)},
              s > 0 ? Kind::inflow : Kind::fluid, static_cast<float>(pressure));
    }
}

}  // namespace wade::fluid::mixed
