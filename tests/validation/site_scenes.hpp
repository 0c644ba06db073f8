#pragma once
// Small sites, turned by any angle, for the tests of shallow water.

#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/world.hpp"

namespace wade::validation {

// Axes a, b on the map that are turned about a point.
struct Turn {
    double x = 0, z = 0, cosine = 1, sine = 0;
    Turn(double about_x, double about_z, double degrees)
        : x(about_x),
          z(about_z),
          cosine(std::cos(degrees * std::numbers::pi / 180)),
          sine(std::sin(degrees * std::numbers::pi / 180)) {}

    [[nodiscard]] MapPoint operator()(double a, double b) const {
        return {x + cosine * a - sine * b, z + sine * a + cosine * b};
    }
    // a and b of a point of the map.
    [[nodiscard]] MapPoint back(double at_x, double at_z) const {
        return {cosine * (at_x - x) + sine * (at_z - z), -sine * (at_x - x) + cosine * (at_z - z)};
    }
    [[nodiscard]] MapPolygon box(double a_lo, double a_hi, double b_lo, double b_hi) const {
        const Turn& t = *this;
        return {{{t(a_lo, b_lo), t(a_hi, b_lo), t(a_hi, b_hi), t(a_lo, b_hi)}}};
    }
};

// Level ground with walls around it, without friction and water.
inline Scene empty_site(double length, double width, double cell) {
    Scene scene;
    scene.world->length = length, scene.world->width = width;
    scene.channel->x = {0, length}, scene.channel->z = {0, width};
    scene.channel->flow = Flow::closed;
    scene.fluid->model = ModelKind::shallow_water;
    scene.fluid->shallow_water.cell_size = cell;
    scene.fluid->cfl = 0.45;
    scene.site.emplace();
    scene.site->roughness.n = 0;
    return scene;
}

inline House house_of(MapPolygon polygon) {
    House result;
    result.polygon = std::move(polygon);
    return result;
}

// A raster of a function of its centres.
inline std::shared_ptr<const Raster> raster_of(double length, double width, double cell,
                                               const std::function<double(double x, double z)>& height) {
    Raster raster;
    raster.cell = cell;
    raster.columns = static_cast<std::size_t>(std::lround(length / cell));
    raster.rows = static_cast<std::size_t>(std::lround(width / cell));
    for (std::size_t row = 0; row < raster.rows; ++row) {
        for (std::size_t column = 0; column < raster.columns; ++column) {
            const auto at = [&](std::size_t n) { return (static_cast<double>(n) + 0.5) * cell; };
            raster.values.push_back(height(at(column), at(row)));
        }
    }
    return std::make_shared<const Raster>(std::move(raster));
}

// A street 30 m long and 5 m wide at an angle, with walls at its ends, and water 1 m deep in its first half.
inline Scene street(double degrees, double cell) {
    Scene scene = empty_site(40, 40, cell);
    const Turn turn(20, 20, degrees);
    scene.site->houses = {house_of(turn.box(-17, 17, 2.5, 6)), house_of(turn.box(-17, 17, -6, -2.5)),
                          house_of(turn.box(-17, -15, -3, 3)), house_of(turn.box(15, 17, -3, 3))};
    scene.site->water = {{turn.box(-16, 0, -3, 3), 1}};
    return scene;
}

// Houses on hills, at an angle.
inline Scene lake(double degrees, bool hills) {
    Scene scene = empty_site(40, 40, 0.5);
    const Turn turn(20, 20, degrees);
    scene.site->houses = {house_of(turn.box(-6, 3, -4, 5)), house_of(turn.box(5, 9, -9, -3.3)),
                          house_of(turn.box(3.2, 8, 1, 1.3))};
    scene.site->water = {{{}, 1}};
    if (!hills) return scene;
    scene.site->water = {{{}, 0.7}};
    scene.site->ground.raster =
        raster_of(40, 40, 1, [](double x, double z) { return 0.8 * std::sin(0.3 * x) * std::cos(0.2 * z) + 0.02 * x; });
    return scene;
}

}  // namespace wade::validation
