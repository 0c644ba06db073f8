#include "fluid_server/dfsph.hpp"

#include <algorithm>
#include <cmath>

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

// a_i(p); particles inside the emitter keep their velocity.
void pressure_acceleration(const std::vector<float>& pressure, const Particles& p, const NeighbourLists& lists,
                           ParticleFields& f) {
    const float* const pr = pressure.data();
    for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        LaneSum x;
        LaneSum y;
        LaneSum z;
        for_each_segment(block, place, [&](const NeighbourBlock::Segment& mirror, std::size_t first, std::size_t last) {
            const PlaneMap r = mirror.reflection;
            const std::uint32_t* j = block.j.data();
            const float* gx = block.gx.data();
            const float* gy = block.gy.data();
            const float* gz = block.gz.data();
            for (std::size_t k = first; k < last; k += lanes) {
#pragma omp simd
                for (std::size_t l = 0; l < lanes; ++l) {
                    const float pj = pr[j[k + l]];
                    x.lane[l] += pj * (r.xx * gx[k + l] + r.xy * gy[k + l]);
                    y.lane[l] += pj * (r.xy * gx[k + l] + r.yy * gy[k + l]);
                    z.lane[l] += pj * (r.zz * gz[k + l]);
                }
            }
        });
        const float moves = p.kind[i] == Kind::inflow ? 0.0F : 1.0F;
        f.ax[i] = -moves * (pr[i] * f.gx[i] + x.total());
        f.ay[i] = -moves * (pr[i] * f.gy[i] + y.total());
        f.az[i] = -moves * (pr[i] * f.gz[i] + z.total());
    });
}

// D_i(u) for the particle i at a place of its block.
float density_rate(const std::vector<float>& ux, const std::vector<float>& uy, const std::vector<float>& uz,
                   std::size_t i, const NeighbourBlock& block, std::size_t place, const ParticleFields& f) {
    const auto [first, last] = all_pairs(block, place);
    const std::uint32_t* j = block.j.data();
    const float* gx = block.gx.data();
    const float* gy = block.gy.data();
    const float* gz = block.gz.data();
    const float* x = ux.data();
    const float* y = uy.data();
    const float* z = uz.data();
    LaneSum sum;
    for (std::size_t k = first; k < last; k += lanes) {
#pragma omp simd
        for (std::size_t l = 0; l < lanes; ++l) {
            const std::uint32_t jl = j[k + l];
            sum.lane[l] += x[jl] * gx[k + l] + y[jl] * gy[k + l] + z[jl] * gz[k + l];
        }
    }
    return ux[i] * f.gx[i] + uy[i] * f.gy[i] + uz[i] * f.gz[i] - sum.total();
}

}  // namespace

ParticleFields::ParticleFields(std::size_t capacity)
    : density(capacity),
      gx(capacity),
      gy(capacity),
      gz(capacity),
      inverse_diagonal(capacity),
      source(capacity),
      ax(capacity),
      ay(capacity),
      az(capacity) {}

void compute_density_and_diagonal(const Particles& p, const NeighbourLists& lists, ParticleFields& f) {
    for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        LaneSum x;
        LaneSum y;
        LaneSum z;
        LaneSum squares;
        for_each_segment(block, place, [&](const NeighbourBlock::Segment& mirror, std::size_t first, std::size_t last) {
            const PlaneMap r = mirror.reflection;
            const float* gx = block.gx.data();
            const float* gy = block.gy.data();
            const float* gz = block.gz.data();
            for (std::size_t k = first; k < last; k += lanes) {
#pragma omp simd
                for (std::size_t l = 0; l < lanes; ++l) {
                    x.lane[l] += r.xx * gx[k + l] + r.xy * gy[k + l];
                    y.lane[l] += r.xy * gx[k + l] + r.yy * gy[k + l];
                    z.lane[l] += r.zz * gz[k + l];
                    squares.lane[l] += gx[k + l] * gx[k + l] + gy[k + l] * gy[k + l] + gz[k + l] * gz[k + l];
                }
            }
        });
        const float sx = x.total();
        const float sy = y.total();
        const float sz = z.total();
        const float sum_of_squares = squares.total();
        const float diagonal = sx * sx + sy * sy + sz * sz + sum_of_squares;
        f.density[i] = lists.density[i];
        f.gx[i] = sx;
        f.gy[i] = sy;
        f.gz[i] = sz;
        f.inverse_diagonal[i] = sum_of_squares > 0 ? 1 / diagonal : 0;  // a particle alone has no pressure
    });
}

double bed_pressure_force(const Particles& p, const NeighbourLists& lists, double particle_mass) {
    BlockSums<double> forces;
    forces.begin(p.count);
    for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        const float pi = p.pressure[i];
        for_each_segment(block, place, [&](const NeighbourBlock::Segment& mirror, std::size_t first, std::size_t last) {
            const PlaneMap r = mirror.reflection;
            if (r.yy > 0 || p.kind[i] == Kind::inflow) {
                return;
            }
            double push = 0;
            for (std::size_t k = first; k < last; ++k) {
                const std::uint32_t j = block.j[k];
                const float gy = r.xy * block.gx[k] + r.yy * block.gy[k];
                push -= static_cast<double>((pi + p.pressure[j]) * gy);
            }
            forces[i / block_size] += push * particle_mass;
        });
    });
    return forces.total([](double& sum, double force) { sum += force; });
}

std::array<double, 3> obstacle_force(const Particles& p, const NeighbourLists& lists, double particle_mass,
                                     double viscosity, int obstacle) {
    BlockSums<std::array<double, 3>> forces;
    forces.begin(p.count);
    for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        const float pi = p.pressure[i];
        const Vec3 vi{p.vx[i], p.vy[i], p.vz[i]};
        for_each_segment(block, place, [&](const NeighbourBlock::Segment& mirror, std::size_t first, std::size_t last) {
            if (mirror.obstacle != obstacle || p.kind[i] == Kind::inflow) {
                return;
            }
            // The face pushes along its normal; along itself it holds only water that sticks to it.
            const auto normal = static_cast<std::size_t>(mirror.obstacle_axis);
            std::array<double, 3> push{};
            for (std::size_t k = first; k < last; ++k) {
                const std::uint32_t j = block.j[k];
                const Vec3 g = mirror.reflection({block.gx[k], block.gy[k], block.gz[k]});
                push[normal] += static_cast<double>((pi + p.pressure[j]) * g[normal]);
                const Vec3 image = mirror.viscous.map({p.vx[j], p.vy[j], p.vz[j]});
                for (std::size_t a = 0; a < 3; ++a) {
                    const float slip = vi[a] - (image[a] + mirror.viscous.shift[a]);
                    push[a] -= 2 * viscosity * static_cast<double>(slip * block.gradient_factor[k]);
                }
            }
            for (std::size_t a = 0; a < 3; ++a) {
                forces[i / block_size][a] += push[a] * particle_mass;
            }
        });
    });
    return forces.total([](std::array<double, 3>& sum, const std::array<double, 3>& force) {
        for (std::size_t a = 0; a < 3; ++a) {
            sum[a] += force[a];
        }
    });
}

SolveResult PressureSolver::iterate(std::vector<float>& pressure, float warm_start, Particles& p,
                                    const NeighbourLists& lists, ParticleFields& f, float dt,
                                    const PressureSolve& settings) {
    SolveResult result;
    const float dt2 = dt * dt;
    for_each_particle(p.count, [&](std::size_t i) { pressure[i] *= warm_start; });
    pressure_acceleration(pressure, p, lists, f);
    while (result.iterations < settings.max_iterations) {
        errors_.begin(p.count);
        for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
            // Compression that is left after the step.
            const float error = f.source[i] + dt2 * density_rate(f.ax, f.ay, f.az, i, block, place, f);
            errors_[i / block_size] += static_cast<double>(std::max(error, 0.0F));
            pressure[i] = std::max(0.0F, pressure[i] + relaxation_ * error * f.inverse_diagonal[i] / dt2);
        });
        pressure_acceleration(pressure, p, lists, f);
        ++result.iterations;
        const double total = errors_.total([](double& sum, double e) { sum += e; });
        result.error = p.count == 0 ? 0 : total / static_cast<double>(p.count);
        if (result.iterations >= settings.min_iterations && result.error <= settings.tolerance) {
            break;
        }
    }
    return result;
}

void PressureSolver::subtract_mean(std::vector<float>& source, std::size_t n) {
    errors_.begin(n);
    for_each_particle(n, [&](std::size_t i) { errors_[i / block_size] += static_cast<double>(source[i]); });
    const double total = errors_.total([](double& sum, double e) { sum += e; });
    const auto mean = static_cast<float>(n == 0 ? 0 : total / static_cast<double>(n));
    for_each_particle(n, [&](std::size_t i) { source[i] -= mean; });
}

void apply_acceleration(Particles& p, const ParticleFields& f, float dt) {
    for_each_particle(p.count, [&](std::size_t i) {
        p.vx[i] += dt * f.ax[i];
        p.vy[i] += dt * f.ay[i];
        p.vz[i] += dt * f.az[i];
    });
}

SolveResult PressureSolver::solve_divergence(Particles& p, const NeighbourLists& lists, ParticleFields& f, float dt,
                                             float step_share, const PressureSolve& settings) {
    const float closing = confined_ ? 0 : gap_closing * step_share;
    for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        const float rate = density_rate(p.vx, p.vy, p.vz, i, block, place, f);
        // With a source of -1 the pressure of a particle with an open side stays at zero.
        const float gap = std::min(0.0F, f.density[i] - 1);
        f.source[i] = f.density[i] < open_surface_density_ ? -1 : dt * rate + closing * gap;
    });
    if (confined_) {
        subtract_mean(f.source, p.count);
    }
    PressureSolve of_this_step = settings;
    of_this_step.tolerance *= static_cast<double>(step_share) * std::min(1.0, std::pow(usual_layers / layers_, 2));
    const double forgotten = confined_ ? forgotten_confined : std::min(forgotten_at_most, forgotten_per_layer * layers_);
    const SolveResult result = iterate(p.pressure, static_cast<float>(1 - forgotten), p, lists, f, dt, of_this_step);
    apply_acceleration(p, f, dt);
    return result;
}

SolveResult PressureSolver::solve_density(std::vector<float>& pressure, Particles& p, const NeighbourLists& lists,
                                          ParticleFields& f, float dt, const PressureSolve& settings) {
    for_each_list(p.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        f.source[i] = f.density[i] - 1 + dt * density_rate(p.vx, p.vy, p.vz, i, block, place, f);
    });
    if (confined_) {
        subtract_mean(f.source, p.count);
    }
    return iterate(pressure, warm_start_density, p, lists, f, dt, settings);
}

}  // namespace wade::fluid
