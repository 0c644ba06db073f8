// Walking speed of people on the ground of a site: slopes and water.

#include <algorithm>
#include <cmath>

#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/site.hpp"
#include "crowd_client/navigation/site_routes.hpp"
#include "crowd_client/water/footprint.hpp"

namespace wade::crowd {
namespace {

constexpr double safe_demand = 0.8;   // largest D of water that a group enters
constexpr double shut_factor = 1000;  // of the slowness in water that it does not enter
constexpr double wet = 0.01;          // m; shallower water does not count

Vector2d gradient_of(const SiteRoutes& site, const Vector2d& p) {
    const double half = 0.5 * site.ground_step;
    const auto height = [&](double x, double z) { return ground_height(site.ground, {x, z}); };
    return Vector2d(height(p.x() + half, p.y()) - height(p.x() - half, p.y()),
                    height(p.x(), p.y() + half) - height(p.x(), p.y() - half)) /
           (2 * half);
}

// Returns r of the header, or 0 for a cell that the group does not enter.
double share_of_speed(const GroupRoutes& group, const SiteRoutes& site, std::size_t cell,
                      const WaterProperties& water) {
    const auto depth = static_cast<double>(site.depth[cell]), speed = static_cast<double>(site.speed[cell]);
    if (!(depth > 0)) return 1;
    if (site.enters_up_to && depth > *site.enters_up_to) return 0;
    const FeltStep felt{depth, Vector2d(speed, 0)};
    if (!(demand_at(group.person, 0, group.mass, Vector2d::Zero(), water, felt) < safe_demand)) return 0;
    return group.men * walking_speed_ratio(Sex::male, depth, speed, water.gravity) +
           (1 - group.men) * walking_speed_ratio(Sex::female, depth, speed, water.gravity);
}

}  // namespace

double tobler(double rise) {
    return std::exp(-3.5 * std::abs(rise + 0.05)) / std::exp(-0.175);
}

void find_dry_slowness(Navigation& navigation) {
    SiteRoutes& site = *navigation.site;
    if (site.slope == SlopeRule::level) return;
    const TravelGrid& grid = navigation.grid;
    site.dry.resize(grid.closed.size());
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            const double rise = gradient_of(site, grid.place(column, row)).norm();
            site.dry[grid.node(column, row)] = 2 / (tobler(rise) + tobler(-rise));
        }
    }
}

// Computes the fraction of each cell without houses, from 8 x 8 points in cells that a side may cut.
void find_free_ground(Navigation& navigation) {
    SiteRoutes& site = *navigation.site;
    const GroundCells& cells = site.cells;
    site.free.assign(cells.cells(), 1.0);
    constexpr int across = 8;
    for (std::size_t c = 0; c < cells.cells(); ++c) {
        const std::size_t cell_row = c / cells.columns;
        const double x = cells.x0 + static_cast<double>(c % cells.columns) * cells.step_x;
        const double z = cells.z0 + static_cast<double>(cell_row) * cells.step_z;
        if (!any_near(navigation.sight.houses.grounds, {x, x + cells.step_x}, {z, z + cells.step_z},
                      [](const Obstacle&) { return true; })) {
            continue;
        }
        int inside = 0;
        for (int i = 0; i < across * across; ++i) {
            const int along = i % across, line = i / across;
            const Vector2d p(x + (along + 0.5) / across * cells.step_x, z + (line + 0.5) / across * cells.step_z);
            if (is_in_a_house(navigation.sight.houses, p)) ++inside;
        }
        site.free[c] = 1 - static_cast<double>(inside) / (across * across);
    }
}

// Computes depth and speed by cell; returns whether there is any water.
bool find_water(SiteRoutes& site, const WaterBins& water, double rest_density) {
    const std::size_t cells = site.cells.cells();
    const double area = site.cells.step_x * site.cells.step_z;
    const double of_column = water.column.x() * water.column.y() / area;
    std::vector<Contact> sums(cells);
    std::vector<double> covered(cells);  // by columns, fraction of the cell
    Footprints footprints(site.cells, rest_density, water.column);
    for (std::size_t k = 0; k < water.x.size(); ++k) {
        const WaterParticle p = water.particle(k);
        const auto add = [&](std::size_t cell, double share) {
            sums[cell].mass += share * p.mass;
            sums[cell].momentum += share * p.mass * p.velocity;
            covered[cell] += share * of_column;
        };
        if (water.has_columns()) {
            footprints.deal(water.x[k], water.z[k], p.mass,
                            [&](std::size_t cell, double share, std::size_t) { add(cell, share); });
        } else if (const std::size_t c = site.cells.cell_of(water.x[k], water.z[k]); c != cells) {
            add(c, 1);
        }
    }
    constexpr double least_free = 0.0625;  // of a cell; water on less free ground counts as if it covered this
    bool any = false;
    site.depth.assign(cells, 0.0F);
    site.speed.assign(cells, 0.0F);
    for (std::size_t c = 0; c < cells; ++c) {
        // The column of a cut cell has its depth on its whole rectangle, also on the part in a house.
        const double open = std::max({site.free[c], covered[c], least_free});
        const double depth = sums[c].mass / (rest_density * area * open);
        if (!(depth > wet)) continue;
        any = true;
        site.depth[c] = static_cast<float>(depth);
        site.speed[c] = static_cast<float>(sums[c].momentum.norm() / sums[c].mass);
    }
    return any;
}

void find_wet_slowness(const Navigation& navigation, GroupRoutes& group, const WaterProperties& water) {
    const SiteRoutes& site = *navigation.site;
    const TravelGrid& grid = navigation.grid;
    std::vector<float> factor(site.cells.cells());
    group.shut.assign(site.cells.cells(), 0);
    for (std::size_t c = 0; c < factor.size(); ++c) {
        const double share = share_of_speed(group, site, c, water);
        group.shut[c] = share > 0 ? 0 : 1;
        factor[c] = static_cast<float>(share > 0 ? 1 / share : shut_factor);
    }
    group.slowness.resize(grid.closed.size());
    std::vector<std::size_t> columns(static_cast<std::size_t>(grid.columns));  // of the water's cells
    for (int column = 0; column < grid.columns; ++column) {
        columns[static_cast<std::size_t>(column)] = site.column_at(grid.place(column, 0).x());
    }
    for (int row = 0; row < grid.rows; ++row) {
        const float* const of_row = &factor[site.row_at(grid.place(0, row).y()) * site.cells.columns];
        const std::uint32_t first = grid.node(0, row);
        for (std::size_t column = 0; column < columns.size(); ++column) {
            const double dry = site.dry.empty() ? 1 : site.dry[first + column];
            group.slowness[first + column] = dry * static_cast<double>(of_row[columns[column]]);
        }
    }
}

double share_on_ground(const Navigation& navigation, std::uint32_t id, const Vector2d& p, const Vector2d& way) {
    if (!navigation.site) return 1;
    if (is_waiting(navigation, id)) return 0;
    if (navigation.site->slope == SlopeRule::level) return 1;
    return tobler(gradient_of(*navigation.site, p).dot(unit_or(way, Vector2d::Zero())));
}

}  // namespace wade::crowd
