// The hydraulic jump. On a level bed without friction a standing jump has no fixed position: it drifts whenever the
// momentum functions on its sides differ. So the case has a moving jump: a stream runs against a wall, and the jump
// that forms there travels upstream at a speed c. In its own frame it is a standing jump with u_1 + c instead of u_1.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "cases.hpp"
#include "channel_run.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "open_channel.hpp"
#include "slice.hpp"

namespace wade::validation {

namespace {

constexpr double depth_1 = 0.4;  // m, of the stream; the size does not matter, only how many layers it has
constexpr double wall_face = 1;  // m, x of the wall's face; the scene has the wall from 0 to there

// What the Froude number of the jump, relative to it, means in the frame of the channel: water at rest behind the jump.
struct Bore {
    double ratio = 0;     // h_2 / h_1
    double velocity = 0;  // u_1, m/s
    double speed = 0;     // c, m/s, upstream
    explicit Bore(double froude)
        : ratio(belanger_ratio(froude)),
          velocity(froude * std::sqrt(standard_gravity * depth_1) * (ratio - 1) / ratio),
          speed(velocity / (ratio - 1)) {}
    [[nodiscard]] double depth_2() const { return ratio * depth_1; }
};

// A jump is 4 to 6 h_2 long (Chow 1959, fig. 15-4), its middle depth somewhere within: the depth behind is read from 5 h_2
// behind the middle on, the stream over h_2 from half that length ahead of it on. It travels 10 h_2 in all; the last 3 h_2
// are averaged. Near the wall the first splash leaves vortices: nothing is read within h_2 of it.
constexpr double jump_length = 5;
constexpr double travel = 10;
constexpr double averaged_travel = 3;

// Returns the position of the jump: where the depth, from the wall upstream, first falls to the mean of both depths.
double jump_place(const Columns& columns, double depth_2) {
    const double middle = 0.5 * (depth_1 + depth_2);
    std::size_t last = 0;
    for (std::size_t k = 0; k < columns.count(); ++k) {
        last = columns.depth(k) > middle ? k : last;
    }
    if (last + 1 >= columns.count()) {
        return columns.centre(columns.count() - 1);
    }
    const double below = columns.depth(last) - middle;
    return columns.centre(last) + columns.length() * below / (below - (columns.depth(last + 1) - middle));
}

// Mean over the ground of the integral of vx^2 over the height, m^3/s^2: what velocities carry of momentum, fluctuations and all.
double carried_momentum(const Water& water, const Interval& x) {
    double sum = 0;
    water.for_each_parcel([&](const Parcel& parcel) {
        if (x.contains(parcel.x)) sum += parcel.volume * parcel.vx * parcel.vx;
    });
    return sum / (x.length() * water.scene().channel->z.length());
}

struct Line {
    double slope = 0;
    double at_zero = 0;
};

Line fit(const std::vector<double>& x, const std::vector<double>& y) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    const auto n = static_cast<double>(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        sx += x[i], sy += y[i], sxx += x[i] * x[i], sxy += x[i] * y[i];
    }
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    return {slope, (sy - slope * sx) / n};
}

// width: of the slice, m
Result run_jump(const Request& request, double froude, double width) {
    const Bore bore(froude);
    const double h2 = bore.depth_2();
    // Jumps run ahead of their calculated position and throw water ahead of them, fast jumps more. The extra length
    // keeps the measured stream away from the emitter.
    const double length = wall_face + (travel + 0.5 * jump_length + 1 + froude) * h2;
    std::vector<std::string> sizes = channel_slice(request);
    sizes.push_back(assign("/world/width_m", width));
    sizes.push_back(assign("/channel/z_max_m", width));
    sizes.push_back(assign("/channel/x_max_m", length));
    sizes.push_back(assign("/world/length_m", length));
    sizes.push_back(assign("/channel/velocity_m_s", bore.velocity));
    sizes.push_back(assign("/obstacles/0/z_max_m", width));
    // At the end the channel is full of deep water.
    const double room = width * length * 1.3 * h2;  // m^3
    sizes.push_back(assign("/fluid/max_particles", std::ceil(room / std::pow(request.spacing, 3))));
    const Scene scene = scene_for(request, "validation/jump.json", sizes);
    const double d = scene.fluid->particle_spacing;
    const std::unique_ptr<Water> water = make_water(scene);
    Cost cost;

    // All in the frame of the jump: sums of depth and discharge over the distance from the front.
    const double column = 2 * d;
    std::vector<double> time;
    std::vector<double> place;
    double sum_h1 = 0, sum_u1 = 0, sum_h2 = 0, sum_u2 = 0, sum_uu1 = 0, sum_uu2 = 0;
    Columns moving = make_columns({-travel * h2, 0.5 * jump_length * h2 + h2}, scene.channel->z.length(), column);
    std::vector<int> seen(moving.count(), 0);  // number of frames with the column in the channel
    const int frames = frames_in(scene, travel * h2 / bore.speed);
    const int averaged = frames_in(scene, averaged_travel * h2 / bore.speed);
    for (int frame = 1; frame <= frames; ++frame) {
        water->advance(cost);
        if (frame <= frames - averaged) {
            continue;
        }
        Columns now = make_columns(scene.channel->x, scene.channel->z.length(), column);
        water->add_to(now);
        const double front = jump_place(now, h2);
        time.push_back(frame / scene.frame_rate);
        place.push_back(front);
        const Interval ahead{front + 0.5 * jump_length * h2, front + (0.5 * jump_length + 1) * h2};
        const Interval behind{wall_face + h2, front - jump_length * h2};
        sum_h1 += mean_depth(now, ahead);
        sum_u1 += mean_discharge(now, ahead);
        sum_h2 += mean_depth(now, behind);
        sum_u2 += mean_discharge(now, behind);
        sum_uu1 += carried_momentum(*water, ahead);
        sum_uu2 += carried_momentum(*water, behind);
        moving.samples += 1;
        for (std::size_t k = 0; k < moving.count(); ++k) {
            const double x = (front + moving.centre(k) - now.x.lo) / now.length();
            if (x >= 0 && x < static_cast<double>(now.count()) && front + moving.centre(k) > wall_face) {
                moving.volume[k] += now.volume[static_cast<std::size_t>(x)];
                ++seen[k];
            }
        }
    }
    const auto n = static_cast<double>(averaged);
    const double h1 = sum_h1 / n;
    const double u1 = sum_u1 / n / h1;
    const double measured_h2 = sum_h2 / n;
    const double u2 = sum_u2 / n / measured_h2;
    // The jump speed that conserves mass between both depths. The front's speed differs while the jump grows longer.
    const double c = (u1 * h1 - u2 * measured_h2) / (measured_h2 - h1);
    const double relative = (u1 + c) / std::sqrt(standard_gravity * h1);
    // In the frame of the jump, over the density: velocities with their fluctuations, pressure as if hydrostatic.
    const double before = standard_gravity * h1 * h1 / 2 + sum_uu1 / n + (2 * u1 + c) * c * h1;
    const double after =
        standard_gravity * measured_h2 * measured_h2 / 2 + sum_uu2 / n + (2 * u2 + c) * c * measured_h2;
    const double fluctuations = sum_uu2 / n - u2 * u2 * measured_h2;

    Result result;
    water->note(cost, result);
    result.metrics = {{"depth_ratio", std::abs(measured_h2 / h1 / belanger_ratio(relative) - 1), "1"},
                      {"froude_measured", relative, "1"},
                      {"depth_ratio_measured", measured_h2 / h1, "1"},
                      {"stream_depth", std::abs(h1 / depth_1 - 1), "1"},
                      {"stream_velocity", std::abs(u1 / bore.velocity - 1), "1"},
                      {"jump_speed", std::abs(c / bore.speed - 1), "1"},
                      {"front_speed", std::abs(fit(time, place).slope / bore.speed - 1), "1"},
                      {"velocity_behind", std::abs(u2) / (u1 + c), "1"},
                      {"momentum_kept", std::abs(after / before - 1), "1"},
                      {"fluctuating_momentum", fluctuations / after, "1"},
                      {"max_density_error", cost.max_density_error, "1"}};
    Curve curve{"profile", {"x_m", "depth_m", "exact_depth_m"}, {}};
    for (std::size_t k = 0; k < moving.count(); ++k) {
        const double x = moving.centre(k);
        if (seen[k] < averaged) {
            continue;
        }
        curve.rows.push_back({x, moving.depth(k), x < 0 ? h1 * belanger_ratio(relative) : h1});
    }
    result.curves.push_back(curve);
    return result;
}

Case jump_case(const char* name, Result (*run_it)(const Request&), std::size_t starts = 1) {
    Case c;
    c.starts = starts;
    c.name = name;
    c.truth =
        "Belanger (1828), h_2/h_1 = (sqrt(1 + 8 Fr^2) - 1)/2, for the measured stream, relative to the jump, whose "
        "speed follows from the mass that both depths carry. It travels upstream from a wall: on a level bed without "
        "friction a standing jump has no place of its own. momentum_kept: how far the momentum function behind is from "
        "that before, with the squares of all velocities in the frame of the jump; fluctuating_momentum: what part of "
        "it fluctuations carry behind the jump, where Belanger has even flow. Layers of particles in the stream: 4, 6, "
        "8.";
    c.reference = "Belanger 1828";
    c.spacings = {depth_1 / 4, depth_1 / 6, depth_1 / 8};
    c.run = run_it;
    return c;
}

}  // namespace

Case jump_fr2_case() {
    return jump_case(
        "jump_fr2", [](const Request& request) { return run_jump(request, 2, slice_width(request)); }, 5);
}
Case jump_fr3_case() {
    return jump_case(
        "jump_fr3", [](const Request& request) { return run_jump(request, 3, slice_width(request)); }, 5);
}
Case jump_fr5_case() {
    return jump_case("jump_fr5", [](const Request& request) { return run_jump(request, 5, slice_width(request)); });
}
Case jump_fr5_wide_case() {
    Case c = jump_case("jump_fr5_wide", [](const Request& request) { return run_jump(request, 5, 6 * depth_1); });
    c.truth +=
        " A slice 2.4 m wide, nearly as wide as the water behind the jump is deep: in a thinner one vortices are as "
        "long as it is wide, feel no third dimension and live on.";
    c.long_from = 1;
    return c;
}

}  // namespace wade::validation
