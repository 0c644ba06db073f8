// Momentum that people take from the water: actuator disc, upper limit, free body; wake shielding between people.

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/people/push.hpp"
#include "crowd_client/pushing.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

constexpr double mass_of_cone = 1000 * 1.0 * 3.14159265358979 * 0.25 / 3;  // R = 0.5 m in 1 m of water, kg

// A file along x, the stream towards -x, C_D B = 0.30 m: the mean drag of one over that of one alone, and that of the last.
struct FileDrag {
    double mean = 0, last = 0;
};
FileDrag drag_of_file(std::size_t n, double pitch) {
    std::vector<Vector2d> positions, stream(n, Vector2d(-1, 0));
    for (std::size_t k = 0; k < n; ++k) positions.push_back({50 - pitch * static_cast<double>(k), 3});
    const std::vector<double> drag_width(n, 0.30), width(n, 0.30 / 1.1);
    BodyCells cells;
    std::vector<double> deficit;
    find_wakes({}, {positions, stream, drag_width, width}, cells, deficit);
    FileDrag drag;
    for (const double d : deficit) {
        drag.last = (1 - d) * (1 - d);
        drag.mean += drag.last / static_cast<double>(n);
    }
    return drag;
}

}  // namespace

TEST_CASE("A body that slows what it feels needs the larger coefficient of momentum theory") {
    // C_D B / W_e = 0.33 / 1.025: Newton's law for the disc, F = rho W_e h U^2 2 a (1 - a), gives the same factor.
    const double corrected = drag_on_slowed_stream(1.1, 0.3, 2.05 * 0.5);
    const double thrust = 0.33 / 1.025, a = (1 - std::sqrt(1 - thrust)) / 2;
    CHECK(corrected == Approx(1.1 / ((1 - a) * (1 - a))).epsilon(1e-12));
    CHECK(drag_on_slowed_stream(1.1, 0, 1) == Approx(1.1));
    CHECK(drag_on_slowed_stream(1.1, 5, 1) == drag_on_slowed_stream(1.1, 0.8 / 1.1, 1));  // C_T <= 0.8
}

TEST_CASE("Particles mix within the disc while they pass, the more the slower and deeper the water") {
    constexpr double g = 9.81;
    CHECK(disc_width_share(ModelKind::shallow_water, {0.1, 2, g}) == 1.5);
    for (const ModelKind model : {ModelKind::dfsph, ModelKind::mixed}) {
        CHECK(disc_width_share(model, {1, 1, g}) == Approx(1.6 + 0.011 * std::pow(9.81, 1.5)));
        CHECK(disc_width_share(model, {1, 4, g}) ==
              Approx(disc_width_share(model, {0.5, 1, g})));  // of one Froude number
        CHECK(disc_width_share(model, {50, 1, g}) == Approx(1.6).epsilon(1e-3));
        // A person that drifts with the water, or stands in still water, does not slow its sampled flow.
        CHECK(drag_on_slowed_stream(1.1, 0.3, disc_width_share(model, {0, 1, g})) == Approx(1.1));
        CHECK(drag_on_slowed_stream(1.1, 0.3, disc_width_share(model, {1e-200, 1, g})) == Approx(1.1));
    }
}

TEST_CASE("Who stands takes the drag of the step, but no more than half of the velocity that it feels") {
    const PushedWater water{{-1.2, 0.9}, mass_of_cone, 0.5};  // |u| = 1.5 m/s
    const double k = 165;
    const Vector2d short_step = push_of_walker(k, water, 1.0 / 30);
    CHECK(short_step.norm() == Approx(165 * 1.5 * 1.5 / 30));
    CHECK(short_step.x() / short_step.y() == Approx(-1.2 / 0.9));
    const Vector2d long_step = push_of_walker(k, water, 10);
    CHECK(long_step.norm() == Approx(0.5 * 1.5 * mass_of_cone / 0.5));
    CHECK(push_of_walker(k, {}, 1) == Vector2d::Zero());
    CHECK(push_of_walker(k, {Vector2d::Zero(), mass_of_cone, 0.5}, 1) == Vector2d::Zero());
}

TEST_CASE("A free body in water that does not end takes its velocity by the closed form, with steps of any length") {
    // v = U - U / (1 + k U t / m): half of U after m / (k U) = 0.56 s, 0.9 U after nine times that.
    const double k = 165, mass = 92;
    const PushedWater endless{Vector2d(1, 0), 1e12, 0.5};
    for (const double dt : {1.0 / 240, 1.0 / 30, 0.25}) {
        double velocity = 0, time = 0;
        while (time < 5 - 1e-9) {
            PushedWater water = endless;
            water.relative.x() = 1 - velocity;
            velocity += push_of_carried(k, mass, water, dt).x() / mass;
            time += dt;
        }
        CHECK(velocity == Approx(1 - 1 / (1 + k * time / mass)).epsilon(1e-9));
    }
}

TEST_CASE("Neither a light body nor little water is turned round by a long step, and momentum is kept") {
    for (const double mass : {1.0, 65.0}) {
        for (const double weight : {0.5, 262.0}) {
            const PushedWater water{Vector2d(2, 0), weight, 0.5};
            const double impulse = push_of_carried(165, mass, water, 100).x();
            const double body = impulse / mass, stream = 2 - 0.5 * impulse / weight;
            CHECK(stream >= body);
            CHECK(stream - body == Approx(2 / (1 + 165 * (0.5 / weight + 1 / mass) * 2 * 100)).epsilon(1e-6));
        }
    }
}

TEST_CASE("The wake of one fades as Blevins has it, ends at 20 m, and is nowhere upstream") {
    CHECK(wake_deficit(0.3, 0.27, 1, 0) == Approx(std::sqrt(0.3)));
    CHECK(wake_deficit(0.3, 0.27, 0.2, 0) == 1);
    CHECK(wake_deficit(0.3, 0.27, 4, 0.5) == Approx(std::sqrt(0.075) * std::exp(-4.5 * 0.25 / 1.2)));
    CHECK(wake_deficit(0.3, 0.27, 0.13, 0) == 0);
    CHECK(wake_deficit(0.3, 0.27, -1, 0) == 0);
    CHECK(wake_deficit(0.3, 0.27, 20.01, 0) == 0);
    CHECK(wake_deficit(0, 0.27, 1, 0) == 0);
}

TEST_CASE("A file of people leaves each the drag of the deepest wake before it") {
    struct Row {
        std::size_t people;
        double pitch, mean;
    };
    // Sums of (1 - sqrt(0.3 / x))^2, x the pitch: the nearest is the deepest. To the digits that are written.
    const std::vector<Row> rows{{5, 0.5, 0.24},   {10, 0.5, 0.146}, {20, 0.5, 0.10}, {5, 0.6, 0.27},
                                {10, 0.6, 0.177}, {20, 0.6, 0.13},  {5, 1, 0.36},    {10, 1, 0.284},
                                {20, 1, 0.24},    {5, 2, 0.50},     {10, 2, 0.438},  {20, 2, 0.41}};
    for (const Row& row : rows) {
        INFO(row.people << " people, " << row.pitch << " m");
        CHECK(drag_of_file(row.people, row.pitch).mean == Approx(row.mean).margin(0.006));
    }
    CHECK(drag_of_file(10, 0.5).last == Approx(0.05).margin(0.006));
    CHECK(drag_of_file(10, 0.6).last == Approx(0.09).margin(0.006));
    CHECK(drag_of_file(10, 1).last == Approx(0.20).margin(0.006));
    CHECK(drag_of_file(10, 2).last == Approx(0.375).margin(0.006));
}

TEST_CASE("Wakes are found by cells as by looking at everybody, round a periodic world as well") {
    constexpr std::size_t n = 300;
    std::vector<Vector2d> positions, stream;
    std::vector<double> drag_width, width(n, 0.27);
    for (std::size_t k = 0; k < n; ++k) {
        const double a = std::fmod(0.7548776662 * static_cast<double>(k), 1.0);
        const double b = std::fmod(0.5698402910 * static_cast<double>(k), 1.0);
        positions.push_back({60 * a, 20 * b});
        stream.push_back({std::cos(6 * b), std::sin(6 * b)});
        drag_width.push_back(k % 7 == 0 ? 0 : 0.3);
    }
    for (const double period : {0.0, 60.0}) {
        const World world{.length = 60, .width = 20, .ends = period > 0 ? Ends::periodic : Ends::open};
        BodyCells cells;
        std::vector<double> deficit;
        find_wakes(world, {positions, stream, drag_width, width}, cells, deficit);
        for (std::size_t k = 0; k < n; ++k) {
            double deepest = 0;
            for (const double shift : {0.0, -period, period}) {
                for (std::size_t i = 0; i < n; ++i) {
                    const Vector2d d = positions[k] + Vector2d(shift, 0) - positions[i];
                    const double along = d.dot(stream[k]);
                    const double across = d.y() * stream[k].x() - d.x() * stream[k].y();
                    deepest = std::max(deepest, wake_deficit(drag_width[i], width[i], along, across));
                }
            }
            // What lies beyond the margin of the search is less than 1e-3.
            CHECK((deepest < 1e-3 || std::abs(deficit[k] - deepest) < 1e-12));
        }
    }
}
