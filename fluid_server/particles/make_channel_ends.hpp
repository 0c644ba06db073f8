#pragma once
// Which ends a channel has.

#include <memory>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/channel_ends.hpp"

namespace wade::fluid {

// Those that the scene names, once its channel has been filled; an emitter adds what waits behind its opening.
[[nodiscard]] std::unique_ptr<ChannelEnds> make_channel_ends(const Scene& scene, Particles& particles);

}  // namespace wade::fluid
