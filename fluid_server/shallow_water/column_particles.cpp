#include "fluid_server/shallow_water/column_particles.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "configs/numbers/splitmix.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/particle_volume.hpp"

namespace wade::fluid::shallow_water {

namespace {

// In cells: how far each particle of a row lies further across than the one before, and each row further along.
constexpr double next_across = 0.7548776662466927;
constexpr double next_row_along = 0.6180339887498949;

// The number a near n / golden ratio that has no divisor in common with n: the points (k, k a mod n) / n are spread evenly.
std::uint32_t generator_of(std::uint32_t n) {
    const auto wanted = static_cast<std::uint32_t>(std::lround(n * 0.6180339887498949));
    for (std::uint32_t off = 0; off < n; ++off) {
        if (wanted + off < n && std::gcd(wanted + off, n) == 1) return wanted + off;
        if (wanted > off && std::gcd(wanted - off, n) == 1) return wanted - off;
    }
    return 1;
}

constexpr double square = 10;  // m; agents sample only nearer water in the next frames

constexpr double widest_column = 2;  // m

// Parts of a cell along one axis.
std::uint32_t parts_of(double cell, double widest) {
    return static_cast<std::uint32_t>(std::max(1.0, std::ceil(cell / widest - 1e-9)));
}

// Half of the radius within which people sample particles of the mixed model, see crowd_client/water/felt_water.hpp.
double widest_beside_particles(const Fluid& fluid) {
    return 0.5 * std::max(0.5, 1.5 * fluid.particle_spacing);
}

std::size_t room_for(const ShallowWater& world, std::size_t of_cell) {
    std::size_t cells = world.grid.cells();
    if (world.scene.fluid->publish == Publish::near_agents) {
        double agents = 0;
        for (const AgentGroup& group : world.scene.crowd->groups) agents += group.count;
        const double near = (std::ceil(3 * square / world.grid.dx) + 1) * (std::ceil(3 * square / world.grid.dz) + 1);
        if (agents * near < static_cast<double>(cells))
            return std::max<std::size_t>(of_cell, 1) *
                   std::max<std::size_t>(1, static_cast<std::size_t>(agents * near));
    }
    const auto particles = static_cast<std::size_t>(std::max(world.scene.fluid->max_particles, 0));
    if (!world.site) return of_cell > 0 ? of_cell * cells : particles + cells;
    of_cell = std::max<std::size_t>(of_cell, 1);
    if (!world.openings.any()) return of_cell * cells;
    const auto closed = std::count(world.openings.share.begin(), world.openings.share.end(), 0.0);
    return of_cell * (cells - static_cast<std::size_t>(closed));
}

// The largest float below v, so that a place at the end of the channel is in it.
float inside(double v, const Interval& extent) {
    const auto place = static_cast<float>(v);
    if (static_cast<double>(place) >= extent.hi) return std::nextafter(static_cast<float>(extent.hi), 0.0F);
    return std::max(place, static_cast<float>(extent.lo));
}

}  // namespace

ColumnParticles::ColumnParticles(const ShallowWater& world)
    : rest_density_(world.scene.fluid->rest_density),
      particle_volume_(particle_volume(world.scene.fluid)),
      start_across_(unit_fraction(mix_bits(world.scene.seed + 2 * splitmix_step))),
      drift_x_(world.grid.cells(), 0),
      drift_z_(world.grid.cells(), 0),
      particles_(world.grid.cells(), 0),
      row_begin_(world.grid.nz + 1, 0) {
    const Scene& scene = world.scene;
    if (scene.crowd->response == ResponseKind::measured) {
        const bool mixed = scene.fluid->model == ModelKind::mixed;
        const double widest = mixed ? widest_beside_particles(scene.fluid) : widest_column;
        split_x_ = parts_of(world.grid.dx, widest);
        split_z_ = parts_of(world.grid.dz, widest);
        width_ = {world.grid.dx / split_x_, world.grid.dz / split_z_};
    }
    capacity_ = static_cast<std::uint32_t>(room_for(world, split_x_ * split_z_));
    all_ = scene.fluid->publish == Publish::all;
    if (!all_) {
        squares_x_ = static_cast<std::size_t>(std::ceil(world.grid.x.hi / square)) + 1;
        shown_.assign(squares_x_ * (static_cast<std::size_t>(std::ceil(world.grid.z.hi / square)) + 1), 0);
    }
    const double first = unit_fraction(mix_bits(world.scene.seed + splitmix_step));
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        const double start = first + static_cast<double>(k) * next_row_along;
        std::fill_n(drift_x_.begin() + static_cast<std::ptrdiff_t>(k * world.grid.nx), world.grid.nx,
                    start - std::floor(start));
    }
    count(world);
}

void ColumnParticles::drift(const ShallowWater& world, double dt) {
    if (split_x_ > 0) return;
    const Grid& grid = world.grid;
    for (std::size_t k = world.band.begin; k < world.band.end; ++k) {
        const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k)), first = k * grid.nx;
        world.lines.active.for_each_span(k, [&](std::size_t begin, std::size_t n) {
            for (std::size_t i = begin; i < begin + n; ++i) {
                drift_x_[first + i] += world.primitive.u[c + i] * (dt / grid.dx);
                drift_z_[first + i] += world.primitive.v[c + i] * (dt / grid.dz);
            }
        });
    }
}

void ColumnParticles::count_with(const ShallowWater& world, double volume) {
    const Grid& grid = world.grid;
    const double per_depth = grid.cell_area() / volume;
    double shown = 0, all = 0;
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const double* h = world.water.h.data() + grid.row(static_cast<std::ptrdiff_t>(k));
        std::uint64_t sum = 0;
        for (std::size_t i = 0; i < grid.nx; ++i) {
            if (i >= hidden_begin_ && i < hidden_end_) {
                particles_[k * grid.nx + i] = 0;
                continue;
            }
            const bool wet = h[i] > world.constants.dry;
            const auto n = wet ? static_cast<std::uint32_t>(std::ceil(h[i] * per_depth)) : 0U;
            particles_[k * grid.nx + i] = n;
            sum += n;
            shown += wet ? h[i] : 0.0;
            all += h[i];
        }
        row_begin_[k + 1] = row_begin_[k] + sum;
    }
    film_share_ = shown > 0 ? (all - shown) / shown : 0;
}

void ColumnParticles::show_near(const AgentsView& agents) {
    if (all_) return;
    std::fill(shown_.begin(), shown_.end(), 0);
    const std::size_t rows = shown_.size() / squares_x_;
    const auto line = [](double place, std::size_t count) {
        return static_cast<std::size_t>(std::clamp(place / square, 0.0, static_cast<double>(count - 1)));
    };
    for (std::size_t a = 0; a < agents.px.size(); ++a) {
        if (agents.state[a] != static_cast<float>(shm::agent_walking)) continue;
        const std::size_t x = line(static_cast<double>(agents.px[a]), squares_x_);
        const std::size_t z = line(static_cast<double>(agents.pz[a]), rows);
        for (std::size_t r = z - std::min<std::size_t>(z, 1); r <= std::min(z + 1, rows - 1); ++r) {
            for (std::size_t c = x - std::min<std::size_t>(x, 1); c <= std::min(x + 1, squares_x_ - 1); ++c) {
                shown_[r * squares_x_ + c] = 1;
            }
        }
    }
}

void ColumnParticles::count_wet(const ShallowWater& world) {
    const Grid& grid = world.grid;
    const double per_square = grid.dx / square;
    const std::uint32_t of_cell = std::max(1U, split_x_ * split_z_);
    std::fill(particles_.begin(), particles_.end(), 0);
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const double* const h = world.water.h.data() + grid.row(static_cast<std::ptrdiff_t>(k));
        std::uint64_t sum = 0;
        const std::size_t row = static_cast<std::size_t>(static_cast<double>(k) * grid.dz / square) * squares_x_;
        world.lines.active.for_each_span(k, [&](std::size_t begin, std::size_t n) {
            for (std::size_t i = begin; i < begin + n; ++i) {
                const bool seen =
                    all_ || shown_[row + static_cast<std::size_t>(static_cast<double>(i) * per_square)] != 0;
                const bool hidden = i >= hidden_begin_ && i < hidden_end_;
                particles_[k * grid.nx + i] = seen && !hidden && h[i] > world.constants.dry ? of_cell : 0;
                sum += particles_[k * grid.nx + i];
            }
        });
        row_begin_[k + 1] = row_begin_[k] + sum;
    }
}

void ColumnParticles::count(const ShallowWater& world) {
    if (world.site || split_x_ > 0) {
        count_wet(world);
        across_of_.resize(2, 1);
        return;
    }
    for (double volume = particle_volume_;; volume *= 1.25) {
        count_with(world, volume);
        if (row_begin_.back() <= capacity_) break;
    }
    const std::uint32_t most = *std::max_element(particles_.begin(), particles_.end());
    for (auto n = static_cast<std::uint32_t>(across_of_.size()); n <= most; ++n) across_of_.push_back(generator_of(n));
}

std::uint32_t ColumnParticles::write(const ShallowWater& world, const shm::FrameFields& slot) const {
    const auto rows = static_cast<std::ptrdiff_t>(world.grid.nz);
#pragma omp parallel for schedule(static) if (row_begin_.back() >= 4096)
    for (std::ptrdiff_t k = 0; k < rows; ++k) {
        const auto row = static_cast<std::size_t>(k);
        split_x_ > 0 ? write_columns(world, row, slot) : write_row(world, row, slot);
    }
    return static_cast<std::uint32_t>(row_begin_.back());
}

void ColumnParticles::write_columns(const ShallowWater& world, std::size_t k, const shm::FrameFields& slot) const {
    const Grid& grid = world.grid;
    const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k));
    const double z_lo = grid.z.lo + static_cast<double>(k) * grid.dz;
    const double mass_of_depth = rest_density_ * width_[0] * width_[1];
    std::uint64_t to = row_begin_[k];
    for (std::size_t i = 0; i < grid.nx; ++i) {
        if (particles_[k * grid.nx + i] == 0) continue;
        const double h = world.water.h[c + i], x_lo = grid.x.lo + static_cast<double>(i) * grid.dx;
        for (std::uint32_t part = 0; part < split_x_ * split_z_; ++part, ++to) {
            slot.mass[to] = static_cast<float>(mass_of_depth * h);
            slot.vx[to] = static_cast<float>(world.primitive.u[c + i]);
            slot.vy[to] = 0;
            slot.vz[to] = static_cast<float>(world.primitive.v[c + i]);
            slot.px[to] = static_cast<float>(x_lo + (part % split_x_ + 0.5) * width_[0]);
            slot.py[to] = static_cast<float>(world.bed.height[c + i] + 0.5 * h);
            slot.pz[to] = static_cast<float>(z_lo + (part / split_x_ + 0.5) * width_[1]);
        }
    }
}

void ColumnParticles::write_row(const ShallowWater& world, std::size_t k, const shm::FrameFields& slot) const {
    const Grid& grid = world.grid;
    const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k));
    const double z_lo = grid.z.lo + static_cast<double>(k) * grid.dz;
    std::uint64_t to = row_begin_[k];
    for (std::size_t i = 0; i < grid.nx; ++i) {
        const std::uint32_t n = particles_[k * grid.nx + i];
        if (n == 0) continue;
        const double h = world.water.h[c + i], bed = world.bed.height[c + i];
        const double share = 1.0 / n;
        // With the films' mass the momentum stays that of the grid.
        const double volume = grid.cell_area() * h * share * world.openings.share_of(c + i);
        const auto mass = static_cast<float>(rest_density_ * volume * (1 + film_share_));
        const auto vx = static_cast<float>(world.primitive.u[c + i] / (1 + film_share_));
        const auto vz = static_cast<float>(world.primitive.v[c + i] / (1 + film_share_));
        const double drift_x = drift_x_[k * grid.nx + i], drift_z = drift_z_[k * grid.nx + i];
        const double x_lo = grid.x.lo + static_cast<double>(i) * grid.dx;
        for (std::uint32_t p = 0; p < n; ++p, ++to) {
            const double along = (p + 0.5) * share + drift_x;
            const double laps = std::floor(along);
            // Counts on along the row, and moves from cell to cell with the particles.
            const double label = static_cast<double>(i) - laps;
            const std::uint64_t step = std::uint64_t{p} * across_of_[n];
            const double across =
                (static_cast<double>(step % n) + 0.5) * share + label * next_across + start_across_ + drift_z;
            slot.mass[to] = mass;
            slot.vx[to] = vx;
            slot.vy[to] = 0;
            slot.vz[to] = vz;
            slot.px[to] = inside(x_lo + (along - laps) * grid.dx, grid.x);
            slot.py[to] = static_cast<float>(bed + (p + 0.5) * share * h);
            slot.pz[to] = inside(z_lo + (across - std::floor(across)) * grid.dz, grid.z);
        }
    }
}

}  // namespace wade::fluid::shallow_water
