#pragma once
// A tank whose walls are those of a house with a courtyard, so that they have any angle.

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "configs/scene/scene_capacity.hpp"
#include "fluid_server/particles/place/place_solids.hpp"
#include "scenes.hpp"

namespace wade::fluid::test {

struct PlaceTank {
    double length = 1.2, width = 1.2;
    double turned = 0;   // degrees in plan
    double corner = 90;  // degrees between its sides
    double side = 4;     // of the world, m

    // A place of the tank, from its middle, on the map.
    [[nodiscard]] MapPoint at(double x, double z) const {
        const double a = turned * std::numbers::pi / 180, lean = z / std::tan(corner * std::numbers::pi / 180);
        return {side / 2 + std::cos(a) * (x + lean) - std::sin(a) * z,
                side / 2 + std::sin(a) * (x + lean) + std::cos(a) * z};
    }
    [[nodiscard]] MapLine box(double x0, double z0, double x1, double z1) const {
        return {at(x0, z0), at(x1, z0), at(x1, z1), at(x0, z1)};
    }
};

inline House house_of(std::vector<MapLine> rings) {
    House house;
    house.polygon.rings = std::move(rings);
    return house;
}

// The tank with water up to `level` over level ground at 0.
inline Scene place_scene(const PlaceTank& tank, double level, double spacing) {
    Scene scene;
    scene.world.length = scene.world.width = tank.side;
    scene.channel.x = scene.channel.z = {0, tank.side};
    scene.channel.flow = Flow::closed;
    scene.channel.initial_river = InitialRiver::dry;
    scene.fluid = fluid_of(spacing, 30000);
    Place place;
    const double l = tank.length / 2, w = tank.width / 2, far = tank.side + 1;
    place.houses = {house_of({{{-1, -1}, {far, -1}, {far, far}, {-1, far}}, tank.box(-l, -w, l, w)})};
    if (level > 0) place.water = {{{}, level}};
    scene.place = place;
    return scene;
}

inline PlaceSolids solids_of(const Scene& scene) {
    return {place_shape(scene), static_cast<float>(support_radius_of(scene.fluid)),
            static_cast<float>(scene.fluid.particle_spacing)};
}

}  // namespace wade::fluid::test
