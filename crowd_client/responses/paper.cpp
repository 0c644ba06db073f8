#include "crowd_client/responses/paper.hpp"

#include "configs/scene/coupling.hpp"
#include "crowd_client/responses/sampled_coupling.hpp"

namespace wade::crowd {
namespace {

class PerFrame final : public Response {
 public:
    void respond(const FrozenCrowd& crowd, NextVelocities& next) const override {
        next.at_end.clear();
        next.mean.assign(crowd.walking.begin(), crowd.walking.end());
        if (crowd.water.x.empty()) return;
        for (std::size_t k = 0; k < crowd.active.size(); ++k) {
            const std::uint32_t id = crowd.active[k];
            next.mean[k] =
                coupled_velocity(crowd.agents.mass[id], crowd.walking[k], crowd.agents.tau[id], crowd.contacts[k]);
        }
    }
};

class Continuous final : public Response {
 public:
    explicit Continuous(const Sampling& sampling) : sampling_(sampling) {}

    void respond(const FrozenCrowd& crowd, NextVelocities& next) const override {
        next.mean.resize(crowd.active.size());
        next.at_end.resize(crowd.active.size());
        for (std::size_t k = 0; k < crowd.active.size(); ++k) {
            const RelaxedVelocity relaxed = relax(crowd, k);
            next.mean[k] = relaxed.mean;
            next.at_end[k] = relaxed.at_end;
        }
    }

 private:
    [[nodiscard]] RelaxedVelocity relax(const FrozenCrowd& crowd, std::size_t k) const {
        const std::uint32_t id = crowd.active[k];
        const Walker walker{crowd.positions[k], crowd.agents.momentary[id], crowd.walking[k], crowd.agents.mass[id],
                            crowd.agents.tau[id]};
        if (sampling_.samples > 1) return sampled_velocity(crowd.water, crowd.scene, sampling_, walker, crowd.dt);
        return relaxed_velocity(walker.mass, walker.velocity, walker.walking, walker.tau, crowd.contacts[k], crowd.dt);
    }

    Sampling sampling_;
};

}  // namespace

std::unique_ptr<Response> make_paper_response(const Scene& scene) {
    if (scene.coupling->rule == CouplingRule::continuous) return std::make_unique<Continuous>(sampling_of(scene));
    return std::make_unique<PerFrame>();
}

}  // namespace wade::crowd
