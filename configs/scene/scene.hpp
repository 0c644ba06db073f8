#pragma once
// The scene: all that describes a run, as typed plain data in SI units.
//
// x runs along the stream's axis, z across it, y is up; the bed is the plane y = 0. The stream flows towards -x.
// The value of a member in a new struct is the default of its key; names, units, ranges and meanings of the keys are in
// fields/. A Scene results from a file after merging with the files that it extends and after the checks.
//
// Each part has a header: world.hpp, channel.hpp, fluid.hpp, crowd.hpp, coupling.hpp. A source includes the headers of
// the parts that it uses, so that a new key of a part compiles only these sources.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "configs/scene/fields/site_keys.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/part.hpp"
#include "configs/scene/site.hpp"

namespace wade {

struct World;
struct Channel;
struct Fluid;
struct Crowd;
struct Coupling;

// Sets tau of one agent, of a group or, if neither is named, of all agents from a frame on.
struct TauEvent {
    std::uint64_t frame = 0;
    std::optional<int> agent;
    std::optional<std::string> group;
    double tau = 0;
};

struct Scene {
    // In one source, as they are long and most sources would have them.
    Scene();
    Scene(const Scene& other);
    Scene(Scene&& other) noexcept;
    Scene& operator=(const Scene& other);
    Scene& operator=(Scene&& other) noexcept;
    ~Scene();

    std::string name;
    std::string description;
    std::uint64_t seed = 1;
    double duration = 400;
    double frame_rate = 30;
    bool stop_when_no_agent_is_active = true;
    int lockstep_depth = 2;  // frames the fluid may be ahead of the crowd, 1 to 3
    Part<World> world;
    Part<Channel> channel;              // of a scene with a site: closed, of the world's size, and nothing else
    std::optional<SiteKeys> site_keys;  // as the file says it
    std::optional<Site> site;           // the same with what its files hold, instead of the channel
    std::vector<Obstacle> obstacles;
    Part<Fluid> fluid;
    Part<Crowd> crowd;
    Part<Coupling> coupling;
    std::vector<TauEvent> events;

    std::uint64_t hash = 0;  // of the resolved scene, the same on both sides of a run
};

}  // namespace wade
