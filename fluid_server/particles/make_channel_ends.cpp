#include "fluid_server/particles/make_channel_ends.hpp"

#include "configs/scene/channel.hpp"
#include "fluid_server/particles/body_force.hpp"
#include "fluid_server/particles/emitter.hpp"
#include "fluid_server/particles/inflow.hpp"
#include "fluid_server/particles/site/site_ends.hpp"

namespace wade::fluid {

namespace {

// One end is the other, and the water is kept at v_F.
class RecirculatingEnds final : public ChannelEnds {
 public:
    explicit RecirculatingEnds(const Scene& scene) : channel_(scene.channel) {}

    [[nodiscard]] std::optional<double> driving_acceleration(const Particles& particles, double end,
                                                             double dt) const override {
        return -fluid::driving_acceleration(particles, velocity_at(channel_, end), static_cast<float>(dt));
    }

 private:
    Channel channel_;
};

}  // namespace

std::unique_ptr<ChannelEnds> make_channel_ends(const Scene& scene, Particles& particles) {
    if (scene.site) return std::make_unique<SiteEnds>(scene);
    switch (scene.channel->flow) {
        case Flow::emitter: {
            auto emitter = std::make_unique<Emitter>(scene, particles.count);
            emitter->emit(particles, 0);
            return emitter;
        }
        case Flow::recirculating:
            return std::make_unique<RecirculatingEnds>(scene);
        case Flow::closed:
        case Flow::periodic:
            break;
    }
    return std::make_unique<ChannelEnds>();
}

}  // namespace wade::fluid
