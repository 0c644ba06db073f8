// Outlets of a site: each of their cells belongs to one outlet and to no source.

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/map_cells.hpp"
#include "configs/scene/world.hpp"

namespace wade {

namespace {

// An outlet or a source with its cells.
struct WaterEnd {
    const MapPolygon* polygon = nullptr;  // without rings: along `line`
    const MapLine* line = nullptr;
    std::string words;  // label and name
    std::vector<CellSpan> spans;
};

std::size_t count_of(const std::vector<CellSpan>& spans) {
    std::size_t count = 0;
    for (const CellSpan& span : spans) count += span.last - span.first + 1;
    return count;
}

// Returns true if a line ends in the cell.
bool ends_in(const MapLine& line, const MapCells& grid, std::size_t cell) {
    constexpr double reach = 0.55;  // [A] of a cell, from its centre: ends drawn by hand overlap by less than 5 %
    const MapPoint centre = grid.centre_of(cell);
    const auto is_in = [&](const MapPoint& p) {
        return std::abs(p.x - centre.x) <= reach * grid.dx && std::abs(p.z - centre.z) <= reach * grid.dz;
    };
    return is_in(line.front()) || is_in(line.back());
}

// Returns true if two shapes only touch in the cells that they share: lines by their ends, a line by an end and a polygon.
bool only_touch(const WaterEnd& a, const WaterEnd& b, const MapCells& grid, const std::vector<CellSpan>& shared) {
    if (a.line->empty() && b.line->empty()) return false;
    const std::size_t count = count_of(shared);
    if (count == count_of(a.spans) || count == count_of(b.spans)) return false;
    return std::ranges::all_of(std::array{a.line, b.line}, [&](const MapLine* line) {
        return line->empty() || std::ranges::all_of(shared, [&](const CellSpan& span) {
                   for (std::size_t cell = span.first; cell <= span.last; ++cell) {
                       if (!ends_in(*line, grid, cell)) return false;
                   }
                   return true;
               });
    });
}

// Returns the rows and columns of cells that the edges of a shape cross.
template <typename End>
double work_of(const End& end, double cell) {
    double work = 0;
    const auto add = [&](const MapLine& points) {
        for (std::size_t n = 0; n < points.size(); ++n) {
            const MapPoint &a = points[n == 0 ? points.size() - 1 : n - 1], &b = points[n];
            work += 1 + (std::abs(a.x - b.x) + std::abs(a.z - b.z)) / cell;
        }
    };
    add(end.line);
    for (const MapLine& ring : end.polygon.rings) add(ring);
    return work;
}

class OutletCells {
 public:
    OutletCells(const Scene& scene, const std::string& source) : source_(source), ground_(scene.site->ground) {
        const double size = scene.fluid->model == ModelKind::dfsph ? scene.fluid->particle_spacing
                                                                   : scene.fluid->shallow_water.cell_size;
        grid_ = map_cells({0, scene.world->length}, {0, scene.world->width}, size);
    }

    void add(const Outlet& outlet) {
        const WaterEnd& end = outlets_.emplace_back(end_of(outlet));
        refuse_shared(end, "an outlet", "each cell has one water outside");
        if (outlet.kind == OutletKind::wave) check_rest(outlet, end);
        for (const CellSpan& span : end.spans) own(span, outlets_.size() - 1);
    }
    void check(const Source& made) {
        refuse_shared(end_of(made), "a source", "what comes in there would leave at once");
    }

 private:
    template <typename End>
    [[nodiscard]] WaterEnd end_of(const End& end) {
        constexpr double most_work = 1e7;  // [A] takes about 1 s
        work_ += work_of(end, std::min(grid_.dx, grid_.dz));
        if (work_ > most_work)
            refuse(source_, end.label,
                   "the edges of outlets and sources up to this one cross more cells than can be checked. Remedy: "
                   "ogr2ogr -simplify 0.1, or take out what is not needed.");
        WaterEnd made{&end.polygon, &end.line, end.label, {}};
        if (!end.name.empty() && end.label.find("(" + end.name + ")") == std::string::npos)
            made.words += " (" + end.name + ")";
        if (end.line.empty()) {
            made.spans = cells_in(grid_, end.polygon);
        } else {
            for (const std::size_t cell : cells_on(grid_, end.line)) made.spans.push_back({cell, cell});
        }
        return made;
    }

    // Calls body(owner, cells) for the parts of a span that outlets own, in ascending order.
    template <typename Body>
    void for_each_owned(const CellSpan& span, const Body& body) const {
        auto next = owned_.upper_bound(span.first);
        if (next != owned_.begin() && std::prev(next)->second.last >= span.first) --next;
        for (; next != owned_.end() && next->first <= span.last; ++next)
            body(next->second.owner,
                 CellSpan{std::max(span.first, next->first), std::min(span.last, next->second.last)});
    }

    void refuse_shared(const WaterEnd& end, const std::string& kind, const std::string& reason) const {
        std::map<std::size_t, std::vector<CellSpan>> shared;  // by owner
        for (const CellSpan& span : end.spans)
            for_each_owned(span, [&](std::size_t owner, const CellSpan& part) { shared[owner].push_back(part); });
        for (const auto& [owner, spans] : shared) {
            if (only_touch(end, outlets_[owner], grid_, spans)) continue;
            const MapPoint first = grid_.centre_of(spans.front().first);
            refuse(source_, end.words,
                   "it covers " + std::to_string(count_of(spans)) + " of the " +
                       std::to_string(count_of(outlets_[owner].spans)) + " cells of " + short_number(grid_.dx) +
                       " m of " + outlets_[owner].words + ", the first at x " + short_number(first.x) + " m, z " +
                       short_number(first.z) + " m; allowed: " + kind + " beside it, end to end, as " + reason +
                       ". Remedy: draw it elsewhere, or take one of the two out.");
        }
    }

    // A wave comes and leaves over water: at least one cell of the outlet is wet at rest.
    void check_rest(const Outlet& outlet, const WaterEnd& end) const {
        constexpr std::size_t most_points = 10'000'000;  // [A] cells times points: 0.1 s; beyond it cells are skipped
        const std::size_t step =
            1 + count_of(end.spans) * std::max<std::size_t>(1, ground_.points.size()) / most_points;
        const double rest = outlet.stage.front().value;
        double lowest = INFINITY;
        std::size_t n = 0;
        for (const CellSpan& span : end.spans) {
            for (std::size_t cell = span.first; cell <= span.last && lowest >= rest; ++cell) {
                if (n++ % step == 0) lowest = std::min(lowest, ground_height(ground_, grid_.centre_of(cell)));
            }
        }
        if (lowest < rest || end.spans.empty()) return;
        refuse(
            source_, end.words,
            "its level at rest, the first one, is " + short_number(rest) + " m, and the lowest bed of its cells is " +
                short_number(lowest) +
                " m; allowed with kind \"wave\": a level above it, as waves need water at rest. Remedy: draw it where "
                "there is water, or kind \"stage\".");
    }

    void own(const CellSpan& span, std::size_t owner) {
        std::vector<CellSpan> free;
        std::size_t from = span.first;
        for_each_owned(span, [&](std::size_t, const CellSpan& part) {
            if (from < part.first) free.push_back({from, part.first - 1});
            from = part.last + 1;
        });
        if (from <= span.last) free.push_back({from, span.last});
        for (const CellSpan& part : free) owned_[part.first] = {part.last, owner};
    }

    struct Owned {
        std::size_t last = 0, owner = 0;
    };
    const std::string& source_;
    const Ground& ground_;
    MapCells grid_;
    double work_ = 0;
    std::vector<WaterEnd> outlets_;
    std::map<std::size_t, Owned> owned_;  // spans of cells by their first one, apart from one another
};

}  // namespace

void check_outlets(const Scene& scene, const std::string& source, Problems& problems) {
    const Site& site = *scene.site;
    if (site.outlets.empty()) return;
    OutletCells cells(scene, source);
    for (const Outlet& outlet : site.outlets) problems.attempt([&] { cells.add(outlet); });
    for (const Source& made : site.sources) problems.attempt([&] { cells.check(made); });
}

}  // namespace wade
