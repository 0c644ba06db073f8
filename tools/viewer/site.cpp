#include "configs/scene/site.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "configs/json/json.hpp"
#include "configs/scene/world.hpp"
#include "tools/viewer/sources.hpp"

namespace wade::view {
namespace {

constexpr double max_ground_points = 250000;  // of the ground
constexpr double parts_of_plane = 64;         // a plane needs no more

Json points_of(const MapLine& line) {
    Json list = Json::array();
    for (const MapPoint& p : line) list.push_back({p.x, p.z});
    return list;
}

// Its own outline, and those of the holes.
Json rings_of(const MapPolygon& polygon) {
    Json rings = Json::array();
    for (const MapLine& ring : polygon.rings) rings.push_back(points_of(ring));
    return rings;
}

template <typename List>
Json flows_of(const List& list) {
    Json flows = Json::array();
    for (const auto& one : list)
        flows.push_back({{"name", one.name}, {"rings", rings_of(one.polygon)}, {"line", points_of(one.line)}});
    return flows;
}

// As ground_height, but with NaN where the raster's own cell has no value.
float height_or_none(const Ground& ground, const MapPoint& p) {
    if (ground.raster) {
        const Raster& r = *ground.raster;
        const auto cell = [&](double v, double first, std::size_t cells) {
            return static_cast<std::size_t>(
                std::clamp(std::floor((v - first) / r.cell), 0.0, static_cast<double>(cells - 1)));
        };
        if (std::isnan(r.at(cell(p.x, r.x, r.columns), cell(p.z, r.z, r.rows))))
            return std::numeric_limits<float>::quiet_NaN();
    }
    return static_cast<float>(ground_height(ground, p));
}

}  // namespace

std::string site_json(const Site& site) {
    Json shown{{"houses", Json::array()}, {"shelters", Json::array()}, {"gates", Json::array()}};
    for (const House& house : site.houses)
        shown["houses"].push_back({{"name", house.name}, {"height", house.height}, {"rings", rings_of(house.polygon)}});
    for (const SiteShelter& shelter : site.shelters)
        shown["shelters"].push_back(
            {{"name", shelter.name}, {"exit", shelter.is_exit}, {"rings", rings_of(shelter.polygon)}});
    double level = std::numeric_limits<double>::lowest();
    for (const StandingWater& water : site.water) level = std::max(level, water.level);
    for (const Barrier& barrier : site.barriers) {
        const auto finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
        shown["gates"].push_back({{"name", barrier.name},
                                  {"crest", finite(barrier.crest)},
                                  {"opens_at", finite(barrier.opens_at)},
                                  {"line", points_of(barrier.line)}});
    }
    shown["sources"] = flows_of(site.sources);
    shown["outlets"] = flows_of(site.outlets);
    shown["highest_water"] = site.water.empty() ? Json() : Json(level);
    return shown.dump({.sorted = true, .lossy_text = true});
}

Message ground_of(const Scene& scene) {
    const Ground& ground = scene.site->ground;
    const double length = scene.world->length, width = scene.world->width;
    const double wanted = ground.raster ? ground.raster->cell : std::max(length, width) / parts_of_plane;
    const double step = std::max(wanted, std::sqrt(length * width / max_ground_points));
    const auto points = [&](double side) { return static_cast<std::uint32_t>(std::ceil(side / step - 1e-9)) + 1; };
    MessageHead head;
    head.kind = kind_ground;
    head.columns = points(length);
    head.count = head.columns * points(width);
    head.fields = 1;
    head.cell_m = static_cast<float>(step);
    Message message = new_message(head);
    const auto heights = array_of(message, head, 0);
    for (std::uint32_t k = 0; k < head.count; ++k) {
        const std::uint32_t column = k % head.columns, row = k / head.columns;
        const MapPoint p{std::min(length, step * column), std::min(width, step * row)};
        heights[k] = height_or_none(ground, p);
    }
    return message;
}

}  // namespace wade::view
