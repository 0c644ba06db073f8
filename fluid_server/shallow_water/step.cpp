#include "fluid_server/shallow_water/step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/particles/inflow.hpp"
#include "fluid_server/shallow_water/people.hpp"
#include "fluid_server/shallow_water/row_update.hpp"

namespace wade::fluid::shallow_water {

namespace {

// A step of 1/1000 that still empties a cell too far is taken.
constexpr int most_halvings = 10;

// The largest (|u| + c) per_dx + (|v| + c) per_dz of a row, 1/s; NaN or infinite if a value is. cells: normal is u.
double fastest_of_row(const Cells& cells, std::size_t n, double gravity, double per_dx, double per_dz) {
    const double *const h = cells.h, *const u = cells.normal, *const v = cells.along;
    double fastest = 0, check = 0;
#pragma omp simd reduction(max : fastest) reduction(+ : check)
    for (std::size_t i = 0; i < n; ++i) {
        const double c = std::sqrt(gravity * h[i]);
        const double rate = (std::abs(u[i]) + c) * per_dx + (std::abs(v[i]) + c) * per_dz;
        fastest = rate > fastest ? rate : fastest;
        check += rate;  // a comparison would pass over NaN
    }
    return std::isfinite(check) ? fastest : check;
}

// Returns the sum of n values in an order that no vector width changes: eight partial sums, added at the end.
double sum_of_row(const double* values, std::size_t n) {
    constexpr std::size_t lanes = 8;
    std::array<double, lanes> partial{};
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes) {
        for (std::size_t k = 0; k < lanes; ++k) partial[k] += values[i + k];
    }
    for (std::size_t k = 0; i + k < n; ++k) partial[k] += values[i + k];
    return std::accumulate(partial.begin(), partial.end(), 0.0);
}

double sum(const std::vector<double>& values) {
    double total = 0;
    for (const double value : values) total += value;
    return total;
}

// Gives the members of a group the mean of what each would have alone. It is made of differences, so that nothing changes where
// all have the same.
void step_group(ShallowWater& world, const Group& group, double& least) {
    const Openings& openings = world.openings;
    Water& to = world.stage;
    Primitive& primitive = world.stage_primitive;
    const auto mean = [&](const RowMemory& values) {
        const double one = values[openings.members_of_groups[group.first]];
        double more = 0;
        for (std::size_t m = group.first + 1; m < group.last; ++m) {
            more += openings.weights[m] * (values[openings.members_of_groups[m]] - one);
        }
        return one + more;
    };
    double h = mean(to.h);
    least = std::min(least, h);
    h = std::max(h, 0.0);
    const bool wet = h > world.constants.dry;
    const double qx = wet ? mean(to.qx) : 0, qz = wet ? mean(to.qz) : 0;
    const double inverse = 1 / (wet ? h : 1.0);
    for (std::size_t m = group.first; m < group.last; ++m) {
        const std::size_t member = openings.members_of_groups[m];
        to.h[member] = h, to.qx[member] = qx, to.qz[member] = qz;
        primitive.h[member] = h;
        primitive.eta[member] = h + world.bed.height[member];
        primitive.u[member] = qx * inverse;
        primitive.v[member] = qz * inverse;
    }
}

double time_step(ShallowWater& world, double remaining) {
    const Grid& grid = world.grid;
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            double fastest = 0;
            world.lines.active.for_each_span(k, [&](std::size_t first, std::size_t n) {
                const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k)) + first;
                const double of_span = fastest_of_row(
                    {world.primitive.h.data() + c, nullptr, world.primitive.u.data() + c, world.primitive.v.data() + c},
                    n, world.constants.gravity, 1 / grid.dx, 1 / grid.dz);
                fastest = of_span <= fastest ? fastest : of_span;  // NaN, too
            });
            world.row_fastest[k] = fastest;
        }
    });
    double rate = 0;
    for (std::size_t k = world.band.begin; k < world.band.end; ++k) {
        const double fastest = world.row_fastest[k];
        rate = std::max(rate, fastest < 1e300 ? fastest : 1e300);  // NaN, too
    }
    rate = largest(world.band, rate);
    if (!(rate < 1e300)) {
        throw RunError(ExitCode::numerical_failure, "the shallow water is not finite; lower /fluid/cfl");
    }
    const Channel& channel = world.scene.channel;
    if (channel.flow == Flow::emitter) {
        const double v = largest_velocity(channel, world.time, world.time + remaining);
        rate = std::max(rate, (v + std::sqrt(world.constants.gravity * channel.depth)) / grid.dx);
    }
    double longest = rate > 0 ? world.scene.fluid->cfl / rate : remaining;
    if (world.site) {
        const double way = world.scene.fluid->cfl * std::min(world.grid.dx, world.grid.dz);
        longest =
            longest_with_inflow(*world.site, world.time, std::min(longest, remaining), world.constants.gravity, way);
    }
    return remaining / std::ceil(std::max(1.0, remaining / longest));
}

bool stayed_positive(const ShallowWater& world) {
    const double rounding = -1e-10 * world.constants.dry;
    const auto first = world.row_least.begin();
    return *std::min_element(first + static_cast<std::ptrdiff_t>(world.band.begin),
                             first + static_cast<std::ptrdiff_t>(world.band.end)) >= rounding;
}

// From `water` and `primitive` to `stage` and `stage_primitive` over dt. Whether all depths stayed positive.
bool try_step(ShallowWater& world, double dt) {
    const Channel& channel = world.scene.channel;
    const double discharge =
        channel.flow == Flow::emitter ? channel.depth * mean_velocity(channel, world.time, world.time + dt) : 0;
    for (GaugedCell& cell : world.gauged) cell.qx = cell.qz = 0;
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory& buffer) {
        update_band(world, dt, discharge, begin, end, buffer);
    });
    share_groups(world, world.stage.h, world.stage.qx, world.stage.qz);
    const auto groups = static_cast<std::ptrdiff_t>(world.openings.active_groups.size());
    double least = 0;
#pragma omp parallel for schedule(static) reduction(min : least) if (groups >= 512)
    for (std::ptrdiff_t number = 0; number < groups; ++number) {
        step_group(world, world.openings.groups[world.openings.active_groups[static_cast<std::size_t>(number)]], least);
    }
    world.row_least[world.band.begin] = std::min(world.row_least[world.band.begin], least);
    fill_borders(world, world.stage_primitive);
    return all_agree(world.band, stayed_positive(world));
}

// The longest step of report.dt after which all depths are positive, each one tried half of the one before.
void advance(ShallowWater& world, StepReport& report) {
    for (int halved = 0; !try_step(world, report.dt) && halved < most_halvings; ++halved) report.dt *= 0.5;
    std::swap(world.primitive, world.stage_primitive);
    std::swap(world.water, world.stage);
}

// What passed the ends of a channel and the watched faces in the step.
void book_flow(ShallowWater& world, StepReport& report) {
    if (world.site) return;
    const std::array<RowField, 2> flows{RowField{world.row_inflow.data(), 1, 1}, {world.row_outflow.data(), 1, 1}};
    gather_rows(world.band, flows, false);
    const double per_flux = report.dt * world.grid.dz;
    report.inflow = -per_flux * sum(world.row_inflow);
    report.outflow = -per_flux * sum(world.row_outflow);
    for (WatchedFace& watched : world.watched) {
        watched.volume += per_flux * sum(watched.row_mass);
        watched.momentum += per_flux * sum(watched.row_momentum);
    }
}

// The velocity along x that all water lacks to v_F; nothing without water.
std::optional<double> lack_of_velocity(ShallowWater& world, double time) {
    const Grid& grid = world.grid;
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k));
            world.row_volume[k] = sum_of_row(world.water.h.data() + c, grid.nx);
            world.row_momentum[k] = sum_of_row(world.water.qx.data() + c, grid.nx);
        }
    });
    const std::array<RowField, 2> sums{RowField{world.row_volume.data(), 1, 1}, {world.row_momentum.data(), 1, 1}};
    gather_rows(world.band, sums, true);
    const double volume = sum(world.row_volume);
    if (volume <= 0) return {};
    return -velocity_at(world.scene.channel, time) - sum(world.row_momentum) / volume;
}

void drive(ShallowWater& world, std::optional<double> driven_by, StepReport& report) {
    const Grid& grid = world.grid;
    const std::optional<double> found =
        driven_by ? -*driven_by * report.dt : lack_of_velocity(world, world.time + report.dt);
    if (!found) return update_primitive(world);
    const double lack = *found;
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k));
            for (std::size_t i = c; i < c + grid.nx; ++i) world.water.qx[i] += lack * world.water.h[i];
        }
    });
    report.driving_acceleration = -lack / report.dt;
    update_primitive(world);
}

// What came and went over the step, and where the water is now.
void change_site(ShallowWater& world, bool pushed, StepReport& report) {
    const Passed passed = exchange(world, report.dt);
    report.inflow += passed.inflow, report.outflow += passed.outflow;
    if (passed.rained) world.lines.active = Lines(world.grid, true);
    if (pushed || passed.rained) {
        update_active(world);
    } else {
        update_exchanged(world);
    }
    find_active(world);
}

}  // namespace

StepReport step(ShallowWater& world, double remaining, PeopleInWater* people, std::optional<double> driven_by) {
    StepReport report;
    StepStages stage(report.stages);
    if (world.site) {
        if (gates_open(*world.site, world.time)) {
            share_all(world);
            set_openings(world, world.time + gate_slack);
            update_primitive(world);
        }
        remaining = until_gate_opens(*world.site, world.time, remaining);
    }
    stage(Stage::time_step, [&] { report.dt = time_step(world, remaining); });
    stage(Stage::update, [&] { advance(world, report); });
    stage(Stage::flow, [&] { book_flow(world, report); });
    const bool driven = world.scene.channel->flow == Flow::recirculating;
    const bool pushed = people != nullptr && people->push();
    if (pushed) {
        stage(Stage::people, [&] {
            push_cells(world, *people, report.dt / people->frame_time);
            if (!driven && !world.site) update_active(world);
        });
    }
    if (world.site) stage(Stage::site, [&] { change_site(world, pushed, report); });
    if (driven) stage(Stage::drive, [&] { drive(world, driven_by, report); });
    world.time += report.dt;
    return report;
}

}  // namespace wade::fluid::shallow_water
