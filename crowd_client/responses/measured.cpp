#include "crowd_client/responses/measured.hpp"

#include <algorithm>

#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/people/push.hpp"
#include "crowd_client/responses/paper.hpp"

namespace wade::crowd {
namespace {

class Measured final : public Response {
 public:
    explicit Measured(const Scene& scene)
        : by_tau_(make_paper_response(scene)),
          water_{scene.fluid->rest_density, scene.world->gravity},
          pushes_(scene.coupling->two_way) {}

    void respond(const FrozenCrowd& crowd, NextVelocities& next) const override {
        const Agents& agents = crowd.agents;
        const auto is_by_tau = [&](std::uint32_t id) { return agents.people.by_body[id] == 0; };
        if (std::any_of(crowd.active.begin(), crowd.active.end(), is_by_tau)) {
            by_tau_->respond(crowd, next);
            if (next.at_end.empty()) next.at_end = next.mean;
        }
        next.mean.resize(crowd.active.size());
        next.at_end.resize(crowd.active.size());
        next.push.resize(crowd.active.size());
        for (std::size_t k = 0; k < crowd.active.size(); ++k) {
            const std::uint32_t id = crowd.active[k];
            if (is_by_tau(id)) continue;
            FeltStep felt{crowd.felt[k].depth, crowd.felt[k].velocity, crowd.dt};
            const Vector2d& before = agents.momentary[id];
            if (pushes_) {
                felt.most_impulse = largest_push({felt.stream - before, crowd.felt[k].weight, crowd.felt[k].theta});
            }
            const PersonInWater person =
                person_in_water(agents.people, id, agents.mass[id], crowd.walking[k], water_, felt);
            const PersonStep step = step_in_water(person, before, Vector2d::Zero(), crowd.dt);
            const Vector2d& after = step.velocity;
            next.push[k] = step.drag;
            next.at_end[k] = after;
            // Bodies without ground gain speed for seconds: the mean of both ends gives the displacement of short
            // steps.
            next.mean[k] = person.has_ground ? after : Vector2d(0.5 * (before + after));
        }
    }

 private:
    std::unique_ptr<Response> by_tau_;
    WaterProperties water_;
    bool pushes_;  // the water
};

}  // namespace

std::unique_ptr<Response> make_measured_response(const Scene& scene) {
    return std::make_unique<Measured>(scene);
}

}  // namespace wade::crowd
