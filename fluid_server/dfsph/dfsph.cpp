#include "fluid_server/dfsph/dfsph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "configs/scene/fluid.hpp"
#include "fluid_server/neighbours/sweeps.hpp"

// W2 to W10: the equations of docs/step_of_the_water.md.

namespace wade::fluid {

namespace {

// Share of the last step's pressure that a solve starts from.
// The divergence solve answers to rates, so that it can keep nearly all of its pressure. What it forgets in a step keeps
// deep water, where a wrong pressure takes many iterations to find, from being lifted by what it was a moment ago.
constexpr double forgotten_per_layer = 2e-4;
constexpr double forgotten_at_most = 0.01;
// Without a free surface the constant part of its pressure would live for ever.
constexpr double forgotten_confined = 0.05;
// The density solve corrects what is left of each step; what it needed last time is a good guess and no more.
constexpr float warm_start_density = 0.95F;

// Layers of particles in the water that the tolerance of the divergence solve is meant for.
constexpr double usual_layers = 10;

// Share of the gap to rest density that a particle may close in a step of CFL 0.5: the divergence solve lets it be compressed
// by so much. Without it water that has once been loosened could not fall back; with all of it the fall has no
// resistance and water at rest trembles.
constexpr float gap_closing = 0.1F;

// A Jacobi iteration finds the short waves of the pressure at once and the long ones of deep water last. From this
// iteration on a solve adds momentum (Nesterov 1983, in the form of Beck and Teboulle 2009 for non-negative unknowns).
// From the pressure q of an iteration it goes to
//   q' = max(0, y + omega error / (dt^2 A)),   y' = q' + beta (q' - q),
// where beta grows from 0 towards 1. The momentum restarts once it leads back (O'Donoghue and Candes 2015) or the error
// grows, as it would without end in crushed water.
constexpr int first_with_momentum = 4;
constexpr int first_with_momentum_deep = 1;  // with two levels: 0.5 sweeps a step fewer at 80 layers

// A solve ends by its mean error, and the mean of no whole block of particles, which lie close together, may be more than so
// many times the tolerance. A mean over all water alone lets a part of it stay crushed, the larger the more water there is: where a stream
// of 39,000 particles was stopped by a block some dozens were compressed by a third in steps of CFL 1, until they flew
// apart. With 7 times the tolerance they still did, with 5 and 3 not.
constexpr double most_in_a_block = 5;

// From how many layers on the divergence solve has two levels: with fewer, 24 in trials, the coarse grid costs more than the
// iterations that it spares.
constexpr double one_level_up_to = 32;

// With two levels the divergence solve has two tolerances. The tolerance of the means round a node of the coarse grid
// shrinks with the square of the number of layers, because these means add up over the depth. The tolerance of the mean
// over single particles shrinks with this power, because most of that error has no sign.
constexpr double power_of_particles = 1.25;

// What it is at most with two levels. With 0.005 the lattice of 200 layers still broke when it buckled, and that of 50 with 0.01.
constexpr double largest_tolerance = 2e-3;

// Share of the coarse correction that is taken: the Jacobi iteration beside it finds some of the same waves. 0.4 to 1 made no
// difference in trials.
constexpr float coarse_share = 0.7F;

class Momentum {
 public:
    float next_beta() {
        const float next = (1 + std::sqrt(1 + 4 * t_ * t_)) / 2;
        return (std::exchange(t_, next) - 1) / next;
    }
    void begin_anew() { t_ = 1; }

 private:
    float t_ = 1;
};

// What the sweeps of a solve work on. correction: of the gradients of confined water, or null.
struct Operator {
    const Particles& p;
    const NeighbourLists& lists;
    const GradientCorrection* correction;
    ParticleFields& f;
    bool moves_inflow = false;  // or particles inside the emitter keep their velocity
};

// One number for each particle of a block.
using BlockOf = std::array<float, block_size>;

// W7: from sum_j p_j g_ij to a_i(p).
void finish_acceleration(const std::vector<float>& pressure, const Operator& o, std::size_t begin, std::size_t end) {
    ParticleFields& f = o.f;
    for (std::size_t i = begin; i < end; ++i) {
        const float moves = o.p.kind[i] == Kind::inflow && !o.moves_inflow ? 0.0F : 1.0F;
        f.ax[i] = -moves * (pressure[i] * f.gx[i] + f.ax[i]);
        f.ay[i] = -moves * (pressure[i] * f.gy[i] + f.ay[i]);
        f.az[i] = -moves * (pressure[i] * f.gz[i] + f.az[i]);
    }
}

// W7: D_i(u) of the particles of a block in the place of sum_j u_j . (R g_ij).
void finish_density_rates(const ConstVectorArrays& u, const Operator& o, std::size_t begin, std::size_t end,
                          BlockOf& rates) {
    const ParticleFields& f = o.f;
    for (std::size_t i = begin; i < end; ++i) {
        rates[i - begin] = u.x[i] * f.gx[i] + u.y[i] * f.gy[i] + u.z[i] * f.gz[i] - rates[i - begin];
    }
}

VectorArrays accelerations(ParticleFields& f) {
    return {f.ax.data(), f.ay.data(), f.az.data()};
}

// a_i(p).
void pressure_acceleration(const std::vector<float>& pressure, const Operator& o) {
    for_each_block(o.p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        if (o.correction != nullptr) {
            sum_corrected_gradients(b, o.p, o.lists, o.correction->arrays(), pressure.data(), accelerations(o.f));
        } else {
            sum_gradients(b, o.p, o.lists, pressure.data(), accelerations(o.f));
        }
        finish_acceleration(pressure, o, begin, end);
    });
}

// Calls body(begin, end, block, D_i(u) of its particles) for each block.
template <typename Body>
void with_density_rates(const ConstVectorArrays& u, const Operator& o, Body&& body) {
    for_each_block(o.p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        BlockOf rates;
        if (o.correction != nullptr) {
            sum_corrected_divergence(b, o.p, o.lists, o.correction->arrays(), u, rates.data());
        } else {
            sum_divergence(b, o.p, o.lists, u, rates.data());
        }
        finish_density_rates(u, o, begin, end, rates);
        body(begin, end, b, rates);
    });
}

// Both at the start of a solve, where one sweep does for the two: finds a_i(p) and calls body as with_density_rates() does.
template <typename Body>
void start_solve(const std::vector<float>& pressure, const ConstVectorArrays& u, const Operator& o, Body&& body) {
    if (o.correction != nullptr) {
        with_density_rates(u, o, body);
        pressure_acceleration(pressure, o);
        return;
    }
    for_each_block(o.p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        BlockOf rates;
        sum_gradients_and_divergence(b, o.p, o.lists, pressure.data(), accelerations(o.f), u, rates.data());
        finish_acceleration(pressure, o, begin, end);
        finish_density_rates(u, o, begin, end, rates);
        body(begin, end, b, rates);
    });
}

// The sum of what is not negative among the first n.
double sum_of_positive(const BlockOf& values, std::size_t n) {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += static_cast<double>(std::max(values[k], 0.0F));
    return sum;
}

// Goes on from q = `found` to y' (see first_with_momentum), of n particles from `pressure` and `earlier` on. Returns by how
// much that leads back.
double carry_on(const BlockOf& found, std::size_t n, float beta, float* pressure, float* earlier) {
    double back = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const float moved = found[k] - earlier[k];
        back += static_cast<double>((pressure[k] - found[k]) * moved);
        pressure[k] = found[k] + beta * moved;
        earlier[k] = found[k];
    }
    return back;
}

double total_of(const BlockSums<double>& sums) {
    return sums.total([](double& sum, double of_block) { sum += of_block; });
}

// Returns the largest mean over a block. The last block may have few particles, but its sum is divided by a full block.
double worst_mean_of(const BlockSums<double>& sums) {
    return sums.total([](double& worst, double of_block) { worst = std::max(worst, of_block); }) /
           static_cast<double>(block_size);
}

ConstVectorArrays velocities(const Particles& p) {
    return {p.vx.data(), p.vy.data(), p.vz.data()};
}

}  // namespace

// W2 and W3.
void compute_density_and_diagonal(const Particles& p, const Kernel& kernel, float volume, bool viscous,
                                  NeighbourLists& lists, ParticleFields& f) {
    lists.factor_unit =
        volume * std::visit([](const auto& k) { return k.gradient_factor(0); }, kernel) / largest_factor_units;
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        float* const squares = f.inverse_diagonal.data();
        sum_kernel(b, p, kernel, volume, lists,
                   {f.density.data(),
                    {f.gx.data(), f.gy.data(), f.gz.data()},
                    squares,
                    viscous ? accelerations(f) : VectorArrays{}});
        for (std::size_t i = begin; i < end; ++i) {
            f.inverse_diagonal[i] = inverse_of_diagonal(f.gx[i], f.gy[i], f.gz[i], squares[i]);
        }
    });
}

// W8.
template <typename Source>
SolveResult PressureSolver::solve(const PressureSystem& system, const Task& task, Source&& source) {
    const Particles& p = system.particles;
    ParticleFields& f = system.fields;
    std::vector<float>& pressure = task.pressure;
    const PressureSolve& settings = task.settings;
    const Operator o{p, system.lists, system.correction, f, task.inflow == Inflow::free};
    const bool inflow_is_given = task.inflow == Inflow::given;
    const auto is_given = [&](std::size_t i) { return inflow_is_given && p.kind[i] == Kind::inflow; };
    const auto given = inflow_is_given ? std::count(p.kind.data(), p.kind.data() + p.count, Kind::inflow) : 0;
    const double free = static_cast<double>(p.count) - static_cast<double>(given);
    const float warm_start = task.warm_start;
    for_each_particle(p.count, [&](std::size_t i) { pressure[i] *= is_given(i) ? 1 : warm_start; });
    start_solve(pressure, velocities(p), o, [&](std::size_t begin, std::size_t end, std::size_t, const BlockOf& rates) {
        for (std::size_t i = begin; i < end; ++i) f.source[i] = source(i, rates[i - begin]);
    });
    if (confined_) {
        subtract_mean(f.source, p.count);
    }
    SolveResult result;
    const float dt2 = task.dt * task.dt;
    Momentum momentum;
    bool long_waves = task.two_levels;
    const int momentum_from = long_waves ? first_with_momentum_deep : first_with_momentum;
    for (bool last = settings.max_iterations == 0; !last;) {
        const bool first = result.iterations == 0, carries = result.iterations >= momentum_from;
        if (result.iterations == momentum_from) {
            earlier_ = pressure;
        }
        const float beta = carries ? momentum.next_beta() : 0;
        errors_.begin(p.count);
        turns_.begin(p.count);
        const auto go_on = [&](std::size_t begin, std::size_t end, std::size_t b, const BlockOf& found) {
            float* const from = pressure.data() + begin;
            if (carries) {
                turns_[b] = carry_on(found, end - begin, beta, from, earlier_.data() + begin);
            } else {
                std::copy_n(found.begin(), end - begin, from);
            }
        };
        with_density_rates(accelerations(f), o,
                           [&](std::size_t begin, std::size_t end, std::size_t b, const BlockOf& rates) {
                               BlockOf errors;  // compression that is left after the step
                               for (std::size_t i = begin; i < end; ++i)
                                   errors[i - begin] = f.source[i] + dt2 * rates[i - begin];
                               for (std::size_t i = begin; inflow_is_given && i < end; ++i) {
                                   if (is_given(i)) errors[i - begin] = 0;
                               }
                               errors_[b] = sum_of_positive(errors, end - begin);
                               const float* const from = pressure.data() + begin;
                               BlockOf found;
                               for (std::size_t k = 0; k < end - begin; ++k) {
                                   const float change = relaxation_ * errors[k] * f.inverse_diagonal[begin + k] / dt2;
                                   found[k] = std::max(0.0F, from[k] + change);
                               }
                               if (long_waves) {
                                   note_for_long_waves(p, begin, end, first, errors, found);
                               } else {
                                   go_on(begin, end, b, found);
                               }
                           });
        ++result.iterations;
        const double error = free == 0 ? 0 : total_of(errors_) / free;
        const bool grows = error > std::exchange(result.error, error);
        double error_of_long_waves = 0;
        if (long_waves) {
            if (first) build_long_waves(system);
            long_waves = first || !grows;  // where they have made it worse the rest of the solve does without
            if (long_waves && free > 0) error_of_long_waves = find_long_waves(p, dt2) / free;
            for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
                BlockOf found;
                std::copy_n(found_.data() + begin, end - begin, found.data());
                go_on(begin, end, b, found);
            });
        }
        const bool solved = result.iterations >= settings.min_iterations && result.error <= settings.tolerance &&
                            worst_mean_of(errors_) <= most_in_a_block * settings.tolerance &&
                            error_of_long_waves <= task.tolerance_of_long_waves;
        last = solved || result.iterations == settings.max_iterations;
        if (carries && (last || grows || total_of(turns_) > 0)) {
            std::copy_n(earlier_.begin(), p.count, pressure.begin());
            momentum.begin_anew();
        }
        pressure_acceleration(pressure, o);
    }
    result.sweeps = (system.correction != nullptr ? 2 : 1) + 2 * result.iterations + (task.two_levels ? 1 : 0);
    return result;
}

// W13.
bool PressureSolver::place_long_waves(const Particles& p, const PressureSolve& settings) {
    const bool is_deep = !confined_ && layers_ > one_level_up_to && long_waves_.fits() && settings.max_iterations > 0;
    if (!is_deep || !long_waves_.place(p)) return false;
    for (std::vector<float>* const v : {&may_change_, &residual_, &found_}) v->resize(p.x.size());
    return true;
}

// Stores c_i in the arrays of the accelerations, which the iteration has already turned into density rates.
void PressureSolver::build_long_waves(const PressureSystem& system) {
    ParticleFields& f = system.fields;
    const VectorArrays open = accelerations(f);
    for_each_block(system.particles.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        sum_gradients(b, system.particles, system.lists, may_change_.data(), open);
        for (std::size_t i = begin; i < end; ++i) {
            open.x[i] += may_change_[i] * f.gx[i];
            open.y[i] += may_change_[i] * f.gy[i];
            open.z[i] += may_change_[i] * f.gz[i];
        }
    });
    long_waves_.build(system.particles, may_change_, open);
}

// From the errors of a block and the pressures that its particles have found for themselves.
void PressureSolver::note_for_long_waves(const Particles& p, std::size_t begin, std::size_t end, bool first,
                                         const BlockOf& errors, const BlockOf& found) {
    for (std::size_t i = begin; i < end; ++i) {
        found_[i] = found[i - begin];
        const bool is_given = inflow_is_carried_ && p.kind[i] == Kind::inflow;
        if (first) may_change_[i] = found_[i] > 0 && !is_given ? 1 : 0;
        residual_[i] = found_[i] > 0 ? may_change_[i] * errors[i - begin] : 0;
    }
}

double PressureSolver::find_long_waves(const Particles& p, float dt2) {
    const double error = long_waves_.solve(residual_);
    for_each_particle(p.count, [&](std::size_t i) {
        if (may_change_[i] > 0) found_[i] = std::max(0.0F, found_[i] + coarse_share / dt2 * residual_[i]);
    });
    return error;
}

void PressureSolver::subtract_mean(std::vector<float>& source, std::size_t n) {
    errors_.begin(n);
    for_each_particle(n, [&](std::size_t i) { errors_[i / block_size] += static_cast<double>(source[i]); });
    const auto mean = static_cast<float>(n == 0 ? 0 : total_of(errors_) / static_cast<double>(n));
    for_each_particle(n, [&](std::size_t i) { source[i] -= mean; });
}

// W9.
SolveResult PressureSolver::solve_divergence(const PressureSystem& system, float dt, float step_share,
                                             const PressureSolve& settings) {
    const ParticleFields& f = system.fields;
    const float closing = confined_ ? 0 : gap_closing * step_share;
    const auto source = [&](std::size_t i, float rate) {
        // With a source of -1 the pressure of a particle with an open side stays at zero.
        const float gap = std::min(0.0F, f.density[i] - 1);
        return f.density[i] < open_surface_density_ ? -1 : dt * rate + closing * gap;
    };
    const bool two_levels = place_long_waves(system.particles, settings);
    const double shallow = std::min(1.0, usual_layers / layers_);
    const double tolerance = two_levels ? std::min(settings.tolerance, largest_tolerance) : settings.tolerance;
    const auto tolerance_by = [&](double layers) { return tolerance * (static_cast<double>(step_share) * layers); };
    PressureSolve of_this_step = settings;
    of_this_step.tolerance = tolerance_by(two_levels ? std::pow(shallow, power_of_particles) : shallow * shallow);
    const double forgotten =
        confined_ ? forgotten_confined : std::min(forgotten_at_most, forgotten_per_layer * layers_);
    const Inflow inflow = inflow_is_carried_ ? Inflow::given : Inflow::rigid;
    const Task task{system.particles.pressure,
                    static_cast<float>(1 - forgotten),
                    dt,
                    inflow,
                    of_this_step,
                    two_levels,
                    two_levels ? tolerance_by(shallow * shallow) : 0};
    const SolveResult result = solve(system, task, source);
    apply_acceleration(system.particles, f, dt);
    return result;
}

// W10.
SolveResult PressureSolver::solve_density(const PressureSystem& system, DensitySolve what, float dt,
                                          const PressureSolve& settings) {
    Particles& p = system.particles;
    const ParticleFields& f = system.fields;
    const bool shifts = what == DensitySolve::positions;
    const auto is_held = [&](std::size_t i) { return !inflow_is_carried_ && p.kind[i] == Kind::inflow; };
    const auto source = [&](std::size_t i, float rate) {
        const float excess = f.density[i] - 1;
        return (is_held(i) ? std::min(excess, 0.0F) : excess) + dt * rate;
    };
    // On one level: which particles have pressure here changes from one to the next, and a coarse correction of that let water
    // of 200 layers collapse in trials.
    const Inflow carried = shifts ? Inflow::free : Inflow::given;
    const Task task{shifts ? p.shift_pressure : p.pressure, warm_start_density, dt,
                    inflow_is_carried_ ? carried : Inflow::rigid, settings};
    return solve(system, task, source);
}

}  // namespace wade::fluid
