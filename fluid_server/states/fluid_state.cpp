#include "fluid_server/states/fluid_state.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"

namespace wade::fluid {

namespace {

// The shortest text that tells the value from its neighbours; 0.1 stays 0.1.
std::string text_of(double value) {
    for (int digits = 6; digits < 17; ++digits) {
        std::ostringstream text;
        text.precision(digits);
        text << value;
        if (std::stod(text.str()) == value) return text.str();
    }
    return std::to_string(value);
}

template <typename Choice>
requires std::is_enum_v<Choice> std::string text_of(Choice choice) {
    return name_of(choice);
}

// Compares one value of the scene with that of the run that wrote the state; source names its file.
struct Comparison {
    const std::string& source;

    template <typename T>
    void same(const std::string& pointer, const T& here, const T& there) const {
        if (here == there) return;
        throw ConfigurationError(source + ": " + pointer + " is " + text_of(there) + " in this file and " +
                                 text_of(here) + " in the scene; allowed in the scene: " + text_of(there));
    }
    void same(const std::string& pointer, const Interval& here, const Interval& there) const {
        same(pointer + "_min_m", here.lo, there.lo);
        same(pointer + "_max_m", here.hi, there.hi);
    }
    void same_number(const std::string& pointer, std::size_t here, std::size_t there) const {
        if (here == there) return;
        throw ConfigurationError(source + ": " + pointer + " has " + std::to_string(there) +
                                 " entries in this file and " + std::to_string(here) +
                                 " in the scene; allowed in the scene: " + std::to_string(there));
    }
};

void check_channel(const Channel& here, const Channel& there, const Comparison& compare) {
    compare.same("/channel/flow", here.flow, there.flow);
    compare.same("/channel/x", here.x, there.x);
    compare.same("/channel/z", here.z, there.z);
    compare.same("/channel/sides", here.sides, there.sides);
    compare.same("/channel/top", here.top, there.top);
    if (here.top != Top::open) compare.same("/channel/height_m", here.height, there.height);
    if (here.flow == Flow::emitter) compare.same("/channel/depth_m", here.depth, there.depth);
    compare.same_number("/channel/bed_points", here.bed_points.size(), there.bed_points.size());
    for (std::size_t i = 0; i < here.bed_points.size(); ++i) {
        const std::string pointer = "/channel/bed_points/" + std::to_string(i);
        compare.same(pointer + "/x_m", here.bed_points[i].x, there.bed_points[i].x);
        compare.same(pointer + "/y_m", here.bed_points[i].y, there.bed_points[i].y);
    }
}

void check_obstacles(const std::vector<Obstacle>& here, const std::vector<Obstacle>& there, const Comparison& compare) {
    compare.same_number("/obstacles", here.size(), there.size());
    for (std::size_t i = 0; i < here.size(); ++i) {
        const std::string pointer = "/obstacles/" + std::to_string(i);
        compare.same(pointer + "/x", here[i].x, there[i].x);
        compare.same(pointer + "/z", here[i].z, there[i].z);
        compare.same(pointer + "/height_m", here[i].height, there[i].height);
    }
}

void check_lines(const std::string& pointer, const MapLine& here, const MapLine& there, const Comparison& compare) {
    compare.same_number(pointer, here.size(), there.size());
    for (std::size_t i = 0; i < here.size(); ++i) {
        const std::string point = pointer + "/" + std::to_string(i);
        compare.same(point + "/0", here[i].x, there[i].x);
        compare.same(point + "/1", here[i].z, there[i].z);
    }
}

void check_ground(const Ground& here, const Ground& there, const Comparison& compare) {
    compare.same("/site/ground/level_m", here.level, there.level);
    compare.same("/site/ground/slope_x", here.slope_x, there.slope_x);
    compare.same("/site/ground/slope_z", here.slope_z, there.slope_z);
    compare.same_number("/site/ground/points", here.points.size(), there.points.size());
    for (std::size_t i = 0; i < here.points.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            compare.same("/site/ground/points/" + std::to_string(i) + "/" + std::to_string(axis), here.points[i][axis],
                         there.points[i][axis]);
        }
    }
    const std::vector<double> none;
    const std::vector<double>& of_here = here.raster ? here.raster->values : none;
    const std::vector<double>& of_there = there.raster ? there.raster->values : none;
    compare.same_number("/site/ground/file", of_here.size(), of_there.size());
    for (std::size_t i = 0; i < of_here.size(); ++i) {
        if (!std::isnan(of_here[i]) || !std::isnan(of_there[i]))
            compare.same("/site/ground/file, value " + std::to_string(i), of_here[i], of_there[i]);
    }
}

// What confines the water; sources, outlets and friction may differ.
void check_site(const Site& here, const Site& there, const Comparison& compare) {
    check_ground(here.ground, there.ground, compare);
    compare.same_number("/site/houses", here.houses.size(), there.houses.size());
    for (std::size_t h = 0; h < here.houses.size(); ++h) {
        const std::string pointer = "/site/houses/" + std::to_string(h) + "/polygon";
        const std::vector<MapLine>&rings = here.houses[h].polygon.rings, &others = there.houses[h].polygon.rings;
        compare.same_number(pointer, rings.size(), others.size());
        for (std::size_t r = 0; r < rings.size(); ++r) check_lines(pointer, rings[r], others[r], compare);
    }
    compare.same_number("/site/gates", here.barriers.size(), there.barriers.size());
    for (std::size_t g = 0; g < here.barriers.size(); ++g) {
        const std::string pointer = "/site/gates/" + std::to_string(g);
        check_lines(pointer + "/line", here.barriers[g].line, there.barriers[g].line, compare);
        compare.same(pointer + "/opens_at_s", here.barriers[g].opens_at, there.barriers[g].opens_at);
    }
}

void check_room(const FluidState& state, const Scene& scene, const std::string& source) {
    const auto room = static_cast<std::uint64_t>(scene.fluid->max_particles);
    // Of the room of the state's run, what neither particles nor stock of an emitter used may go.
    const auto old_room = static_cast<std::uint64_t>(state.scene.fluid->max_particles);
    const std::uint64_t least = state.emitter ? old_room - state.emitter->stock : state.particles.count;
    const std::uint64_t needed = std::max<std::uint64_t>(least, state.particles.count);
    if (room >= needed) return;
    throw ConfigurationError(source + ": /fluid/max_particles is " + std::to_string(old_room) + " in this file and " +
                             std::to_string(room) + " in the scene; allowed in the scene: at least " +
                             std::to_string(needed) + ", which the water of the file needs");
}

}  // namespace

void copy_particles(const Particles& from, Particles& to) {
    if (from.count > to.capacity()) throw std::length_error("no room for the particles of a state");
    const auto n = static_cast<std::ptrdiff_t>(from.count);
    for (const auto& [name, values] : particle_arrays) std::copy_n((from.*values).begin(), n, (to.*values).begin());
    std::copy_n(from.kind.begin(), n, to.kind.begin());
    to.count = from.count;
}

void check_state_fits(const FluidState& state, const Scene& scene, const std::string& source) {
    const Comparison compare{source};
    compare.same("/fluid/model", scene.fluid->model, state.scene.fluid->model);
    compare.same("/fluid/particle_spacing_m", scene.fluid->particle_spacing, state.scene.fluid->particle_spacing);
    compare.same("/fluid/kernel", scene.fluid->kernel, state.scene.fluid->kernel);
    compare.same("/fluid/support_in_spacings", scene.fluid->support_in_spacings,
                 state.scene.fluid->support_in_spacings);
    compare.same("/fluid/rest_density_kg_m3", scene.fluid->rest_density, state.scene.fluid->rest_density);
    check_channel(scene.channel, state.scene.channel, compare);
    check_obstacles(scene.obstacles, state.scene.obstacles, compare);
    compare.same_number("/site", scene.site ? 1 : 0, state.scene.site ? 1 : 0);
    if (scene.site) check_site(*scene.site, *state.scene.site, compare);
    check_room(state, scene, source);
}

}  // namespace wade::fluid
