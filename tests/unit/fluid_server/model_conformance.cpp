#include "model_conformance.hpp"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "fluid_server/server/run_clock.hpp"
#include "frame_arrays.hpp"

namespace wade::fluid::test {

namespace {

using Frame = std::array<std::vector<float>, 7>;  // mass, vx, vy, vz, px, py, pz

constexpr int frames = 6;

class Inspection {
 public:
    explicit Inspection(const Scene& scene) : scene_(scene) {}

    void look_at(const Frame& frame) {
        const Channel& channel = scene_.channel;
        const double d = scene_.fluid->particle_spacing;
        // Water that waits behind an opening reaches further upstream, what falls over the end is there for a step; what
        // splashes goes up to three times the depth.
        const double behind = channel.flow == Flow::emitter ? support_radius_of(scene_.fluid) + 3 * d : 0;
        const double fallen = channel.flow == Flow::emitter ? d : 0;
        const double top = 3 * deepest_water(scene_) + d, rounding = 1e-3 * d;
        const auto within = [&](float v, double lo, double hi) {
            return static_cast<double>(v) >= lo - rounding && static_cast<double>(v) <= hi + rounding;
        };
        for (std::size_t i = 0; i < frame[0].size(); ++i) {
            for (const std::vector<float>& field : frame) rule(std::isfinite(field[i]), "all numbers are finite");
            rule(frame[0][i] > 0, "masses are positive");
            rule(within(frame[4][i], channel.x.lo - fallen, channel.x.hi + behind) && within(frame[5][i], 0, top) &&
                     within(frame[6][i], channel.z.lo, channel.z.hi),
                 "particles are in the channel");
        }
    }

    void rule(bool kept, const std::string& what) {
        if (!kept && std::find(broken.begin(), broken.end(), what) == broken.end()) broken.push_back(what);
    }

    std::vector<std::string> broken;

 private:
    const Scene& scene_;
};

std::vector<Frame> frames_of_run(const ModelRow& row, const Scene& scene, int threads, Inspection& inspection) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    const std::unique_ptr<FluidModel> model = row.make(scene);
    inspection.rule(model->name() == name_of(row.kind), "its name is the word of scenes");
    inspection.rule(model->capacity() >= 1, "a frame has room for a particle");
    FrameArrays arrays(*model);
    const Ticks ticks = ticks_of(scene.frame_rate);
    // A person that stands in the middle of the channel.
    const std::array<float, 1> mass{65}, still{0}, radius{0.25F}, height{1.75F};
    const std::array<float, 1> x{static_cast<float>(0.5 * (scene.channel->x.lo + scene.channel->x.hi))};
    const std::array<float, 1> z{static_cast<float>(0.5 * (scene.channel->z.lo + scene.channel->z.hi))};
    std::vector<Frame> all;
    std::uint64_t most = 0;
    for (std::uint64_t f = 0; f < frames; ++f) {
        model->take_agents({f, f * ticks.per_frame, mass, still, still, still, x, still, z, radius, height, still});
        const FrameInterval interval{f * ticks.per_frame, (f + 1) * ticks.per_frame, ticks.per_second};
        const shm::Diagnostics d = model->advance_frame(interval);
        inspection.rule(d.sub_steps >= 1, "a frame is at least one step");
        inspection.rule(d.last_dt_s > 0 && d.last_dt_s <= (1 + 1e-9) * interval.duration(),
                        "a step is no longer than its frame");
        arrays.take(*model);
        if (arrays.count > model->capacity()) {
            inspection.rule(false, "frames fit the capacity");
            break;
        }
        all.push_back(arrays.particles());
        arrays.take(*model);
        inspection.rule(all.back() == arrays.particles(), "writing a frame changes nothing");
        inspection.look_at(all.back());
        most = std::max<std::uint64_t>(most, arrays.count);
    }
    inspection.rule(most <= row.estimate(scene).particles, "frames fit the estimate");
    omp_set_num_threads(before);
    return all;
}

}  // namespace

std::vector<std::string> broken_rules(const ModelRow& row, const Scene& scene) {
    Inspection inspection(scene);
    const std::vector<Frame> one = frames_of_run(row, scene, 1, inspection);
    const std::vector<Frame> two = frames_of_run(row, scene, 2, inspection);
    inspection.rule(one == two, "one thread and two give the same bits");
    inspection.rule(!one.empty() && !one.back()[0].empty(), "a scene with water has particles");
    const Estimate estimate = row.estimate(scene);
    inspection.rule(estimate.memory > 0 && estimate.cpu_time > 0, "memory and time are estimated");
    return inspection.broken;
}

}  // namespace wade::fluid::test
