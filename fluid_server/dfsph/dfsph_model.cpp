#include "fluid_server/dfsph/dfsph_model.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/dfsph/time_step.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/inflow.hpp"
#include "fluid_server/particles/parallel.hpp"
#include "fluid_server/particles/river_measures.hpp"

namespace wade::fluid {

namespace {

// Whether better settings could go on from where this step began: compressed by no more than the 1 % that stable water
// may be, and no particle that pressure throws further than the time step allows.
bool is_sound(const StepReport& step, const Fluid& fluid) {
    return step.mean_density_error <= 0.01 && step.max_displacement <= 0.5 * fluid.particle_spacing;
}

// Up to this many layers the particle packing settles unnoticed under its weight (tests/stability, deep_column).
constexpr double quiet_layers = 20;

}  // namespace

// Measured: bytes a particle that there is room for, of arrays and of two states that are kept; bytes a pair, and pairs of
// the lists; seconds of CPU time a particle and step in a stream, which grow once water is deeper than `quiet_layers` or
// falls: blocks that collapse take some times the sweeps of a stream.
Estimate DfsphModel::estimate(const Scene& scene) {
    constexpr double bytes_of_room = 250, bytes_of_pair = 3.2, step_cost = 1 / 4.5e6, blocks_cost = 5;
    const double support = support_radius_of(scene.fluid), room = std::max(scene.fluid->max_particles, 1);
    Estimate estimate;
    estimate.particles = particles_expected(scene);
    const auto n = static_cast<double>(estimate.particles);
    estimate.memory = empty_server + bytes_of_room * room +
                      bytes_of_pair * neighbours_within(support, scene.fluid) * n +
                      memory_of_cells(scene, static_cast<float>(support), n) +
                      memory_of_frames(scene, static_cast<std::uint64_t>(room));
    const double depth = deepest_water(scene), wave = std::sqrt(scene.world->gravity * depth);
    const double speed = largest_velocity(scene.channel);
    const double layers = depth / scene.fluid->particle_spacing;
    const TimeStep step = longest_step(scene.fluid, {speed, wave, wave, layers}, 1 / scene.frame_rate);
    const double deep = std::max(1.0, depth / (quiet_layers * scene.fluid->particle_spacing));
    estimate.cpu_time =
        scene.duration / step.dt * n * step_cost * deep * (scene.channel->water_blocks.empty() ? 1 : blocks_cost);
    return estimate;
}

DfsphModel::DfsphModel(const Scene& scene)
    : world_(scene), bed_(bed_facets(scene.channel)), ground_(ground_of_bed(bed_)) {
    if (!world_.site()) return;
    ground_ = [&ground = world_.site()->ground()](const GroundVector& place) {
        const auto x = static_cast<float>(place[0]), z = static_cast<float>(place[1]);
        return ground.at(x, z).height(x, z);
    };
    columns_.emplace(scene);
    const double dx = columns_->x().length() / columns_->nx(), dz = columns_->z().length() / columns_->nz();
    maps_.emplace(MapGrid{columns_->x().lo, columns_->z().lo, dx, dz, columns_->nx(), columns_->nz()});
    std::vector<double> ground(columns_->count());
    for (std::size_t c = 0; c < columns_->count(); ++c) {
        maps_->wall[c] = columns_->is_solid(c);
        const std::size_t column = c % columns_->nx(), row = c / columns_->nx();
        ground[c] = ground_({columns_->x().lo + (static_cast<double>(column) + 0.5) * dx,
                             columns_->z().lo + (static_cast<double>(row) + 0.5) * dz});
    }
    place_gauges(*maps_, *scene.site, ground);
}

std::uint32_t DfsphModel::capacity() const {
    return static_cast<std::uint32_t>(std::max(world_.scene().fluid->max_particles, 1));
}

void DfsphModel::take_agents(const AgentsView& agents) {
    take_pushes(agents, people_);
    if (!people_.told) return;
    const double spacing = world_.scene().fluid->particle_spacing, mass = static_cast<double>(world_.particle_mass());
    world_.push_with([this, spacing, mass](const CellGrid& grid, Particles& particles, double duration, double gain) {
        push_particles(people_, duration / people_.frame_time, gain, grid, ground_, spacing, mass, particles);
    });
}

shm::Diagnostics DfsphModel::advance_frame(const FrameInterval& interval) {
    const auto start = std::chrono::steady_clock::now();
    const double frame_time = interval.duration();
    people_.frame_time = frame_time;
    shm::Diagnostics d;
    d.mean_density_error = 0;
    d.max_density_error = 0;
    double driving = 0;
    keep_state();
    double remaining = frame_time;
    // What is left after the last sub-step is rounding.
    while (remaining > 1e-9 * frame_time) {
        const StepReport step = this->step(remaining);
        if (d.sub_steps == 0) kept_is_sound_ = is_sound(step, world_.scene().fluid);
        remaining -= step.dt;
        ++d.sub_steps;
        d.last_dt_s = step.dt;
        d.density_iterations += static_cast<std::uint32_t>(step.density.iterations);
        d.divergence_iterations += static_cast<std::uint32_t>(step.divergence.iterations);
        d.mean_density_error += step.mean_density_error;
        d.max_density_error = std::max(d.max_density_error, step.max_density_error);
        driving += step.driving_acceleration * step.dt;
    }
    ++frame_;
    const auto elapsed = std::chrono::steady_clock::now() - start;
    const RiverMeasures river = measure();
    add_to_maps();
    d.mean_density_error /= d.sub_steps;
    d.solver_ns = static_cast<std::uint64_t>(std::chrono::nanoseconds(elapsed).count());
    d.mean_depth_m = river.mean_depth;
    d.mean_speed_m_s = river.mean_speed;
    d.kinetic_energy_j = river.kinetic_energy;
    d.potential_energy_j = river.potential_energy;
    if (world_.scene().channel->flow == Flow::recirculating) {
        d.driving_acceleration_m_s2 = driving / frame_time;
    }
    people_.pushes.clear();
    note_people(people_, d);
    d.position_clamps = world_.position_clamps();
    d.recycled_particles = world_.emitter().recycled;
    return d;
}

RiverMeasures DfsphModel::measure() const {
    const Particles& p = world_.particles();
    RiverMeasures river =
        measure_river(p, static_cast<double>(world_.particle_mass()), world_.scene().world->gravity, bed_);
    if (!world_.site() || p.count == 0) return river;
    double ground = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        ground += static_cast<double>(world_.site()->ground().at(p.x[i], p.z[i]).height(p.x[i], p.z[i]));
    }
    river.mean_depth -= 2 * ground / static_cast<double>(p.count);
    return river;
}

void DfsphModel::add_to_maps() {
    if (!maps_) return;
    columns_->sum(world_.particles());
    const std::size_t nx = columns_->nx();
    std::vector<double> h(nx), u(nx), v(nx);
    for (std::size_t k = 0; k < columns_->nz(); ++k) {
        for (std::size_t i = 0; i < nx; ++i) {
            const std::size_t c = k * nx + i;
            h[i] = columns_->depth(c);
            u[i] = columns_->is_wet(c) ? columns_->vx(c) : 0;
            v[i] = columns_->is_wet(c) ? columns_->vz(c) : 0;
        }
        add_row(*maps_, k, world_.time(), h.data(), u.data(), v.data());
    }
}

void DfsphModel::write_results(const std::filesystem::path& folder) const {
    if (maps_) write_maps(*maps_, *world_.scene().site, folder);
}

StepReport DfsphModel::step(double remaining) {
    try {
        return world_.step(remaining);
    } catch (const RunError& error) {
        failed_ = true;
        throw RunError(error.code(), "the water failed in frame " + std::to_string(frame_ + 1) +
                                         ", at t = " + short_number(world_.time()) + " s: " + error.what());
    }
}

void DfsphModel::keep_state() {
    if (kept_is_sound_) {
        std::swap(kept_, sound_);
        has_sound_ = true;
    }
    kept_is_sound_ = false;  // until its first step has shown it
    world_.capture(kept_);
    kept_.frame = frame_;
}

FailureStates DfsphModel::states_before_failure() const {
    if (!failed_) return {};
    return {&kept_, kept_is_sound_ ? &kept_ : has_sound_ ? &sound_ : nullptr};
}

const FluidState* DfsphModel::state() {
    world_.capture(kept_);
    kept_.frame = frame_;
    return &kept_;
}

void DfsphModel::restore(const FluidState& state, const std::string& source) {
    world_.restore(state, source);
    frame_ = state.frame;
}

std::uint32_t DfsphModel::write_frame(const shm::FrameFields& slot) const {
    const Particles& p = world_.particles();
    const float mass = world_.particle_mass();
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t) {
        std::fill(slot.mass.begin() + static_cast<std::ptrdiff_t>(begin),
                  slot.mass.begin() + static_cast<std::ptrdiff_t>(end), mass);
        const auto copy = [&](const std::vector<float>& from, std::span<float> to) {
            std::copy(from.begin() + static_cast<std::ptrdiff_t>(begin),
                      from.begin() + static_cast<std::ptrdiff_t>(end), to.begin() + static_cast<std::ptrdiff_t>(begin));
        };
        copy(p.vx, slot.vx);
        copy(p.vy, slot.vy);
        copy(p.vz, slot.vz);
        copy(p.x, slot.px);
        copy(p.y, slot.py);
        copy(p.z, slot.pz);
    });
    return static_cast<std::uint32_t>(p.count);
}

std::string DfsphModel::remarks() const {
    std::string text;
    if (world_.emitter().layers_missed > 0) {
        text = "warning: the stock was empty for " + std::to_string(world_.emitter().layers_missed) +
               " layers of the emitter, raise fluid.max_particles";
    }
    if (const std::string of_ends = world_.ends().remark(); !of_ends.empty())
        text += (text.empty() ? "" : "; ") + of_ends;
    const Scene& scene = world_.scene();
    const double layers = deepest_water(scene) / scene.fluid->particle_spacing;
    if (scene.fluid->kernel == KernelKind::cubic_spline && layers > quiet_layers) {
        text += (text.empty() ? "" : "; ") + std::string("note: water of ") + short_number(std::floor(layers)) +
                " layers of particles at rest shakes once when its packing settles; set /fluid/kernel to "
                "\"quartic_spline\" if that matters";
    }
    return text;
}

}  // namespace wade::fluid
