// The fast copy of Eq. 1-3 beside the equations themselves.

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "configs/scene/world.hpp"
#include "crowd_client/markers/biocrowds.hpp"

using namespace wade;
using namespace wade::crowd;

namespace {

std::vector<Vector2d> scattered(int n, double length, double width) {
    std::vector<Vector2d> places;
    for (int i = 0; i < n; ++i) {  // a low-discrepancy set
        places.emplace_back(std::fmod(i * length * 0.6180339887, length), std::fmod(i * width * 0.7548776662, width));
    }
    return places;
}

// Displacements to the markers that walker k owns, in the order of the markers.
std::vector<Vector2d> own_markers(const Markers& markers, const std::vector<Vector2d>& walkers, std::size_t k,
                                  double radius) {
    std::vector<Vector2d> own;
    for (std::size_t m = 0; m < markers.size(); ++m) {
        const Vector2d place(markers.x[m], markers.z[m]);
        std::size_t owner = walkers.size();
        double best = radius * radius;
        for (std::size_t j = 0; j < walkers.size(); ++j) {
            const double distance = (place - walkers[j]).squaredNorm();
            if (distance < best) {
                best = distance;
                owner = j;
            }
        }
        if (owner == k) own.push_back(place - walkers[k]);
    }
    return own;
}

Vector2d motion_by_the_equations(const std::vector<Vector2d>& own, const Vector2d& goal_offset) {
    std::vector<double> weights;
    double sum = 0;
    for (const Vector2d& offset : own) {
        weights.push_back(marker_preference(goal_offset, offset));
        sum += weights.back();
    }
    for (double& w : weights) w = marker_weight(w, sum);
    return motion_vector(weights, own);
}

}  // namespace

TEST_CASE("The motion of a walker is Eq. 1-3 of its fixed markers, bit for bit", "[eq1][eq2][eq3]") {
    Scene scene;
    scene.world->length = 30;
    scene.world->width = 20;
    const double radius = GENERATE(0.4, 1.0, 1.7);
    const int threads = GENERATE(1, 3);
    const Markers markers = place_markers(scene);
    std::vector<Vector2d> walkers = scattered(120, 30, 20);
    walkers.emplace_back(markers.x[7], markers.z[7]);  // stands on a marker
    std::vector<Vector2d> goals = scattered(static_cast<int>(walkers.size()), 30, 20);
    for (std::size_t k = 0; k < goals.size(); ++k) goals[k] = goals[goals.size() - 1 - k] - walkers[k];
    goals[3] = Vector2d::Zero();  // has arrived

    Walkers w;
    w.position = walkers;
    w.goal_offset = goals;
    Motion motion;
    MarkerMemory memory;
    find_motion(motion, memory, markers, w, radius, 0, threads);
    std::size_t with_markers = 0;
    for (std::size_t k = 0; k < walkers.size(); ++k) {
        CAPTURE(k);
        const std::vector<Vector2d> own = own_markers(markers, walkers, k, radius);
        with_markers += own.size() > 1 ? 1U : 0U;
        REQUIRE(motion.vector[k] == motion_by_the_equations(own, goals[k]));
    }
    CHECK(with_markers > 100);
}
