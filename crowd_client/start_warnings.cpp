#include "crowd_client/start_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/numbers/portable.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/ways/place_ways.hpp"

namespace wade::crowd {
namespace {

// Markers in a cell for perception radii of 1 and 2 m.
struct Needed {
    double at_1_m, at_2_m;
};

Needed needed_markers(const Crowd& crowd) {
    const bool bodies = crowd.bodies != BodyRule::none;  // claim ahead of themselves
    if (crowd.markers == MarkerRule::fixed) return bodies ? Needed{16, 5} : Needed{45, 6};
    return bodies ? Needed{6, 4} : Needed{16, 4};
}

std::string warning_of_markers(const Crowd& crowd) {
    std::ostringstream text;
    text << "/crowd/markers_per_cell: with " << crowd.markers_per_cell
         << " markers in a cell of 2 x 2 m people walk at less "
         << "than nine tenths of their desired speed, or not at all; " << least_markers_per_cell(crowd)
         << " or more let them walk";
    return text.str();
}

// People of `measured` in a river of particles: what they sample depends on the layers of particles and on the time step
// (`tools/wade converge river_075`). Depths fluctuate by 5 % with 4 layers and 11 % with 2.
bool is_sampled_river(const Scene& scene) {
    return !scene.place && scene.fluid->model == ModelKind::dfsph && has_river(*scene.channel) &&
           scene.channel->depth > 0 && scene.crowd->response == ResponseKind::measured;
}

std::string warning_of_layers(const Scene& scene) {
    constexpr double least = 4;
    const double spacing = scene.fluid->particle_spacing, depth = scene.channel->depth;
    if (depth > 0.98 * least * spacing) return "";
    std::ostringstream text;
    text.precision(3);
    text << "/fluid/particle_spacing_m: " << depth / spacing << " layers of particles in " << depth
         << " m of water: below " << least
         << " layers the people lost and off their feet depend on their number. Remedy: /fluid/particle_spacing_m "
         << depth / least << " or less.";
    return text.str();
}

// The Courant number of the longest step: that of /fluid/cfl, or of a whole frame where frames are shorter.
std::string warning_of_time_step(const Scene& scene) {
    constexpr double most = 0.35;
    const double fastest = std::abs(scene.channel->velocity) + std::sqrt(scene.world->gravity * scene.channel->depth);
    const double of_frame = fastest / (scene.frame_rate * scene.fluid->particle_spacing);
    const double courant = std::min(scene.fluid->cfl, of_frame);
    if (courant < 1.03 * most) return "";
    std::ostringstream text;
    text.precision(2);
    text << "/fluid/cfl: time steps of a Courant number of " << courant << ", by /fluid/cfl " << scene.fluid->cfl
         << " at /frame_rate_hz " << scene.frame_rate << ": above " << most
         << " the people lost depend on the time step of particle water. Remedy: /fluid/cfl " << most << ".";
    return text.str();
}

// The shorter side of the rectangle with the area and the perimeter of a ground plan, m.
double width_of(const House& house) {
    const MapLine& ring = house.polygon.rings[0];
    double twice_area = 0, perimeter = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const MapPoint &a = ring[k], &b = ring[(k + 1) % ring.size()];
        twice_area += a.x * b.z - b.x * a.z;
        perimeter += length_of(b.x - a.x, b.z - a.z);
    }
    const double quarter = perimeter / 4;
    return quarter - std::sqrt(std::max(0.0, quarter * quarter - std::abs(twice_area) / 2));
}

// Cells across the houses of a site, and so across streets of that width: at least 3, the fewest that a flood model with parts
// of cells asks for across a flow path (TUFLOW HPC with sub-grid sampling 3 to 4, its manual of 2025, table 3.1).
// `tools/wade converge village street hamlet` tries it.
std::string warning_of_cells(const Scene& scene) {
    constexpr double least = 3;
    const bool has_cells = scene.fluid->model == ModelKind::shallow_water || scene.fluid->model == ModelKind::mixed;
    if (!scene.place || scene.place->houses.empty() || !has_cells) return "";
    std::vector<double> widths;
    for (const House& house : scene.place->houses) widths.push_back(width_of(house));
    const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    const double cell = scene.fluid->shallow_water.cell_size;
    if (*middle > 0.98 * least * cell) return "";
    std::ostringstream text;
    text.precision(2);
    text << "/fluid/shallow_water/cell_size_m: cells of " << cell << " m, " << *middle / cell
         << " of them across a house (median): below " << least
         << " the people off their feet depend on the cells. Remedy: /fluid/shallow_water/cell_size_m "
         << *middle / least << " or less.";
    return text.str();
}

}  // namespace

int least_markers_per_cell(const Crowd& crowd) {
    const Needed needed = needed_markers(crowd);
    const double radius = crowd.perception_radius;
    // Below 1 m as many within the radius as there, above it by a power of the radius.
    const double count = radius < 1 ? needed.at_1_m / (radius * radius)
                                    : needed.at_1_m * std::pow(needed.at_2_m / needed.at_1_m, std::log2(radius));
    return static_cast<int>(std::ceil(count - 1e-9));
}

std::vector<std::string> start_warnings(const Scene& scene, const Agents& agents, const Navigation& navigation) {
    std::vector<std::string> warnings = rate_warnings(scene);
    if (agents.size() > 0 && has_too_few_markers(scene.crowd)) warnings.push_back(warning_of_markers(scene.crowd));
    std::vector<std::string> of_water;
    if (agents.size() > 0) of_water.push_back(warning_of_cells(scene));
    if (is_sampled_river(scene))
        of_water.insert(of_water.end(), {warning_of_layers(scene), warning_of_time_step(scene)});
    for (std::string& warning : of_water) {
        if (!warning.empty()) warnings.push_back(std::move(warning));
    }
    const std::string no_way =
        scene.place ? people_cut_off(navigation, scene, agents) : people_without_way(navigation, scene, agents);
    if (no_way.empty()) return warnings;
    const bool may_stand = scene.crowd->navigation.rule == NavigationRule::straight;
    if (scene.crowd->bodies != BodyRule::none && !may_stand) throw ConfigurationError(no_way);
    warnings.push_back(no_way);
    return warnings;
}

}  // namespace wade::crowd
