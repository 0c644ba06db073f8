#include "water_run.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <ctime>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/numbers/fnv1a.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "energy_budget.hpp"

namespace wade::stability {

using fluid::FluidWorld;
using fluid::Particles;
using fluid::StepReport;

namespace {

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Steps after which a run has run away: what the CFL condition asks for at ten times the speed sqrt(2 g H) of water that
// falls from the height H of its world, with v_F and the velocities of the start on top.
std::size_t step_limit(const Scene& scene) {
    double height = scene.channel->depth;
    double speed = scene.channel->velocity;
    for (const VelocityPoint& point : scene.channel->velocity_history) speed = std::max(speed, point.velocity);
    for (const WaterBlock& block : scene.channel->water_blocks) {
        height = std::max(height, block.y_min + block.depth);
        speed = std::max(speed, std::hypot(block.velocity[0], block.velocity[1], block.velocity[2]));
    }
    const double fall = std::sqrt(2 * scene.world->gravity * height);
    const double d = scene.fluid->particle_spacing;
    const double steps = scene.duration * 10 * (speed + 2 * fall) / (std::min(scene.fluid->cfl, 0.5) * d);
    const double viscous = scene.duration * 8 * scene.fluid->kinematic_viscosity / (d * d);
    return static_cast<std::size_t>(std::max(steps, viscous) + 10 * scene.duration * scene.frame_rate + 1000);
}

// Returns whether water can be at a position; `slack` covers the rounding of float positions.
bool is_inside(const Scene& scene, double x, double y, double z, double slack) {
    const Channel& channel = scene.channel;
    if (channel.top != Top::periodic && y < bed_height(channel, x) - slack) return false;
    if (channel.top != Top::open && y > channel.height + slack) return false;
    if (channel.sides == Sides::walls && (z < channel.z.lo - slack || z > channel.z.hi + slack)) return false;
    if (channel.flow == Flow::closed && (x < channel.x.lo - slack || x > channel.x.hi + slack)) return false;
    return std::none_of(scene.obstacles.begin(), scene.obstacles.end(), [&](const Obstacle& o) {
        return x > o.x.lo + slack && x < o.x.hi - slack && z > o.z.lo + slack && z < o.z.hi - slack &&
               y < o.height - slack;
    });
}

class Watch {
 public:
    Watch(const FluidWorld& world, const Hooks& hooks)
        : hooks_(hooks),
          energy_(world),
          // Every particle in the channel or in the stock of the emitter.
          complete_(world.particles().count + world.emitter().stock) {
        energy_.add(hooks.extra_energy);
    }

    void add_energy(double energy) { energy_.add(energy); }

    void note_step(const FluidWorld& world, const StepReport& step, Result& result) {
        ++result.steps;
        result.simulated_time += step.dt;
        const Particles& p = world.particles();
        result.particles = std::max(result.particles, p.count);
        look_at_each(world, result);
        // Of the report, not |v| dt: the density solve moves positions without changing velocities.
        result.max_displacement =
            std::max(result.max_displacement, step.max_displacement / world.scene().fluid->particle_spacing);
        const std::uint64_t present = p.count + world.emitter().stock;
        const std::uint64_t missing = present > complete_ ? present - complete_ : complete_ - present;
        result.lost_particles = std::max(result.lost_particles, missing + outside_ + world.position_clamps());
        energy_.note_step(world, step);
        result.energy_ratio = std::max(result.energy_ratio, energy_.ratio());
        result.kinetic_ratio = std::max(result.kinetic_ratio, energy_.kinetic_ratio());
        // The errors in the report are those at the begin of the step.
        if (result.simulated_time - step.dt >= hooks_.settling) {
            result.mean_density_error = std::max(result.mean_density_error, step.mean_density_error);
            result.max_density_error = std::max(result.max_density_error, step.max_density_error);
        }
    }

 private:
    void look_at_each(const FluidWorld& world, Result& result) {
        const Particles& p = world.particles();
        const Scene& scene = world.scene();
        const double slack = 1e-6 * (scene.channel->x.hi + scene.channel->z.hi);
        std::uint64_t bad = 0;
        for (std::size_t i = 0; i < p.count; ++i) {
            const float v2 = p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i];
            if (!std::isfinite(v2) || !std::isfinite(p.x[i] + p.y[i] + p.z[i])) {
                ++bad;
                continue;
            }
            if (!is_inside(scene, static_cast<double>(p.x[i]), static_cast<double>(p.y[i]), static_cast<double>(p.z[i]),
                           slack)) {
                ++outside_;
            }
        }
        result.nonfinite = std::max(result.nonfinite, bad);
    }

    const Hooks& hooks_;
    EnergyBudget energy_;
    std::uint64_t complete_;
    std::uint64_t outside_ = 0;  // summed over steps
};

void run_frames(FluidWorld& world, Watch& watch, const Hooks& hooks, Result& result) {
    const Scene& scene = world.scene();
    const double frame = 1 / scene.frame_rate;
    const std::size_t limit = hooks.steps > 0 ? hooks.steps : step_limit(scene);
    const auto frames = static_cast<std::size_t>(std::llround(scene.duration * scene.frame_rate));
    for (std::size_t f = 1; f <= frames; ++f) {
        if (hooks.before_frame) watch.add_energy(hooks.before_frame(world, static_cast<double>(f - 1) * frame));
        double remaining = frame;
        while (remaining > 1e-9 * frame) {
            const StepReport step = world.step(remaining);
            remaining -= step.dt;
            watch.note_step(world, step, result);
            if (hooks.after_step) hooks.after_step(world, step, result);
            if (result.steps >= limit) {
                if (hooks.steps == 0) {
                    result.failure = "the time step collapsed: " + std::to_string(limit) +
                                     " steps at t = " + std::to_string(result.simulated_time) + " s";
                }
                return;
            }
        }
        result.state_hash = hash_state(world.particles(), result.state_hash);
        if (hooks.after_frame) hooks.after_frame(world, static_cast<double>(f) * frame, result);
    }
}

}  // namespace

std::uint64_t hash_state(const Particles& p, std::uint64_t seed) {
    std::uint64_t hash = seed ^ fnv1a_basis;
    for (const std::vector<float>* field : {&p.x, &p.y, &p.z, &p.vx, &p.vy, &p.vz}) {
        for (std::size_t i = 0; i < p.count; ++i) {
            hash = fnv1a_next(hash, std::bit_cast<std::uint32_t>((*field)[i]));
        }
    }
    return hash;
}

Result run_water(const Scene& scene, const Hooks& hooks) {
    Result result;
    const double begin = cpu_seconds();
    try {
        FluidWorld world(scene);
        if (hooks.start) hooks.start(world);
        Watch watch(world, hooks);
        result.particles = world.particles().count;
        run_frames(world, watch, hooks, result);
    } catch (const RunError& error) {
        result.failure = error.what();
        if (result.failure.find("not finite") != std::string::npos) {
            result.nonfinite = std::max<std::uint64_t>(1, result.nonfinite);
        }
    }
    result.cpu_time = cpu_seconds() - begin;
    return result;
}

}  // namespace wade::stability
