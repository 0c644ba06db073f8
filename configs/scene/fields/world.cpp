// Keys of the run as a whole, of the ground and of what stands on it.

#include "configs/scene/world.hpp"

#include "configs/scene/fields/lists.hpp"
#include "configs/scene/obstacle.hpp"

namespace wade {

void fields(World& world, Fields& f) {
    constexpr std::string_view of_raster = "with a site that of its ground's raster";
    f.number(
        "length_m", world.length, "m", above(0).to(1e5),
        "Extent along x. x = 0 is the fall, and people carried over it are dead, unless the flow of the channel is "
        "closed: then it is a wall.",
        preset_but(of_raster, [] { return KeyValue(); }));
    f.number("width_m", world.width, "m", above(0).to(1e5), "Extent along z.",
             preset_but(of_raster, [] { return KeyValue(); }));
    f.number("gravity_m_s2", world.gravity, "m/s2", from(0).to(100), "Gravity, along -y.");
    f.choice("ends", world.ends,
             "open: the world ends at x = 0 (the fall, or a wall if the channel is closed) and at length_m (a wall). "
             "periodic: it repeats along x, so that people who walk or are "
             "carried over one end come in at the other and none die there; length_m must be a multiple of the "
             "cells' 2 m and at least 6 m, and a channel that is not dry must be as long as the world and flow "
             "recirculating or periodic. For corridors without ends.");
}

void fields(Obstacle& obstacle, Fields& f) {
    box_fields(f, obstacle.x, obstacle.z);
    f.number("height_m", obstacle.height, "m", above(0).to(1000),
             "y of its top; water may flow over it, people do not walk over it.", required);
}

void fields(Scene& scene, Fields& f) {
    f.of_file("$schema", {}, "Path of this schema, for editors; ignored.");
    f.of_file("extends", {.shortest = 1},
              "A scene file, relative to this one, or a short name such as river/s05 (`wade scenes`); its values "
              "hold wherever "
              "this file sets none. Objects merge key "
              "by key, arrays are replaced; name and description are not taken over.");
    f.text("name", scene.name, short_name, "Short name for folders and titles: letters, digits, '_', '-' and '.'.",
           otherwise("the file's name without .json"));
    f.text("description", scene.description, {}, "What the scene shows, for its readers.");
    f.whole("seed", scene.seed, "", from(0).to(9007199254740991),
            "Start of all random numbers; the same seed gives the same run.");
    f.number("duration_s", scene.duration, "s", above(0).to(1e6), "Simulated time at which the run ends.");
    f.number("frame_rate_hz", scene.frame_rate, "1/s", from(0.01).to(1000),
             "Frames of the water in a second of simulated time.");
    f.flag("stop_when_no_agent_is_active", scene.stop_when_no_agent_is_active,
           "End the run once every agent has arrived or is dead. A scene without agents runs its full duration.");
    f.whole("lockstep_depth", scene.lockstep_depth, "frames", from(1).to(3),
            "Frames that the water may have ready before the crowd has read them; it changes the speed of the run, "
            "never its results.");
    f.object("world", scene.world, "The walkable ground, [0, length_m] x [0, width_m].");
    f.object_or_none(
        "site", scene.site_keys,
        "A real site instead of the channel: ground of any shape, houses, sources, outlets. x runs east, z "
        "north. Its water is that of the model shallow_water, the default there, or of dfsph.");
    f.object(
        "channel", scene.channel,
        "The channel that confines the water: bed y = 0, ends at x_min_m and x_max_m, banks at z_min_m and z_max_m.",
        required_unless("site"));
    f.list("obstacles", scene.obstacles, "Solid boxes that stand on the bed, for the water and for the crowd.");
    f.object("fluid", scene.fluid, "The water and how it is solved.");
    f.object(
        "crowd", [&] { fields(scene.crowd, f, scene.frame_rate); },
        "The agents (BioCrowds). A scene without groups has no agents.");
    f.object(
        "coupling", [&] { fields(scene.coupling, f, scene); }, "How the water moves the agents (Eq. 5 to 9).");
    f.list("events", scene.events,
           "Changes of tau in time, for one agent, for one group or, if neither is named, for all. Events of one frame "
           "act in the order of the list.",
           [&](TauEvent& event, Fields&) { fields(event, f, scene.frame_rate); });
}

}  // namespace wade
