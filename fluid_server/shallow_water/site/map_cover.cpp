#include "fluid_server/shallow_water/site/map_cover.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wade::fluid::shallow_water {

namespace {

// A face is scanned on both of its sides, this share of a cell away, as a polygon may end on it.
constexpr double beside = 1e-9;

// A place on the grid, in cells.
struct Node {
    double along, across;
};
using Ring = std::vector<Node>;
struct Shape {
    std::vector<Ring> rings;
    double first = 0, last = 0;  // across
};
using Spans = std::vector<std::pair<double, double>>;

// Polygons in cells of the grid, with x along the scan lines, or z.
std::vector<Shape> shapes_of(const Grid& grid, const std::vector<const MapPolygon*>& polygons, bool lines_along_x) {
    std::vector<Shape> shapes;
    for (const MapPolygon* polygon : polygons) {
        Shape shape;
        shape.first = 1e300, shape.last = -1e300;
        for (const MapLine& line : polygon->rings) {
            Ring& ring = shape.rings.emplace_back();
            for (const MapPoint& p : line) {
                const double x = (p.x - grid.x.lo) / grid.dx, z = (p.z - grid.z.lo) / grid.dz;
                ring.push_back(lines_along_x ? Node{x, z} : Node{z, x});
                shape.first = std::min(shape.first, ring.back().across);
                shape.last = std::max(shape.last, ring.back().across);
            }
        }
        if (shape.last > shape.first) shapes.push_back(std::move(shape));
    }
    return shapes;
}

// Where the polygons cover the line, in ascending order and apart from each other, within [0, cells].
void cut(const std::vector<const Shape*>& shapes, double line, double cells, Spans& spans) {
    spans.clear();
    std::vector<double> cuts;
    for (const Shape* shape : shapes) {
        cuts.clear();
        for (const Ring& ring : shape->rings) {
            for (std::size_t k = 0, last = ring.size() - 1; k < ring.size(); last = k++) {
                const Node &a = ring[last], &b = ring[k];
                if ((a.across > line) == (b.across > line)) continue;
                cuts.push_back(a.along + (b.along - a.along) * (line - a.across) / (b.across - a.across));
            }
        }
        std::sort(cuts.begin(), cuts.end());
        for (std::size_t k = 0; k + 1 < cuts.size(); k += 2) {
            const double lo = std::max(0.0, cuts[k]), hi = std::min(cells, cuts[k + 1]);
            if (lo < hi) spans.emplace_back(lo, hi);
        }
    }
    std::sort(spans.begin(), spans.end());
    std::size_t kept = 0;
    for (std::size_t k = 1; k < spans.size(); ++k) {
        if (spans[k].first <= spans[kept].second) {
            spans[kept].second = std::max(spans[kept].second, spans[k].second);
        } else {
            spans[++kept] = spans[k];
        }
    }
    if (!spans.empty()) spans.resize(kept + 1);
}

// Calls body(cell, covered share of it) for the cells that the spans touch.
template <typename Body>
void for_each_covered(const Spans& spans, std::size_t cells, Body&& body) {
    for (const auto& [lo, hi] : spans) {
        for (auto i = static_cast<std::size_t>(lo); i < cells && static_cast<double>(i) < hi; ++i) {
            const auto at = static_cast<double>(i);
            body(i, std::min(hi, at + 1) - std::max(lo, at));
        }
    }
}

// Polygons by row of cells, so that a line asks only those near it.
class ByRow {
 public:
    ByRow(std::vector<Shape> shapes, std::size_t rows) : shapes_(std::move(shapes)), rows_(rows) {
        for (const Shape& shape : shapes_) {
            const auto last = static_cast<double>(rows) - 1;
            const double lo = std::floor(shape.first - 2 * beside), hi = std::floor(shape.last + 2 * beside);
            for (double k = std::max(0.0, lo); k <= std::min(last, hi); ++k) {
                rows_[static_cast<std::size_t>(k)].push_back(&shape);
            }
        }
    }
    // line: across, in cells.
    const std::vector<const Shape*>& at(double line) const {
        const double k = std::floor(line);
        return rows_[static_cast<std::size_t>(std::clamp(k, 0.0, static_cast<double>(rows_.size()) - 1))];
    }

 private:
    std::vector<Shape> shapes_;
    std::vector<std::vector<const Shape*>> rows_;
};

// Covered shares of the faces on the lines 0 to `lines` - 1 across: put(line, cell, share) with the larger of both sides.
template <typename Put>
void scan_faces(const ByRow& shapes, std::size_t lines, std::size_t cells, Put&& put) {
    Spans spans;
    std::vector<double> covered(cells, 0);
    for (std::size_t k = 0; k < lines; ++k) {
        for (const double side : {-beside, beside}) {
            const double line = static_cast<double>(k) + side;
            cut(shapes.at(line), line, static_cast<double>(cells), spans);
            for_each_covered(spans, cells, [&](std::size_t i, double share) { covered[i] += share; });
            for_each_covered(spans, cells, [&](std::size_t i, double) { put(k, i, std::exchange(covered[i], 0.0)); });
        }
    }
}

// Calls body(row, spans of its 16 lines).
template <typename Body>
void scan_cells(const ByRow& shapes, const Grid& grid, Body&& body) {
    std::array<Spans, cover_lines> spans;
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const auto& near = shapes.at(static_cast<double>(k));
        if (near.empty()) continue;
        for (std::size_t s = 0; s < cover_lines; ++s) {
            const double line = static_cast<double>(k) + (static_cast<double>(s) + 0.5) / cover_lines;
            cut(near, line, static_cast<double>(grid.nx), spans[s]);
        }
        body(k, spans);
    }
}

void add_row(const std::array<Spans, cover_lines>& spans, std::size_t k, const Grid& grid, std::vector<double>& cell) {
    for (const Spans& line : spans) {
        for_each_covered(line, grid.nx, [&](std::size_t i, double share) { cell[k * grid.nx + i] += share; });
    }
    for (std::size_t i = k * grid.nx; i < (k + 1) * grid.nx; ++i) cell[i] = std::min(1.0, cell[i] / cover_lines);
}

// Points of the cell that the spans of its lines cover.
CoverMask mask_of(const std::array<Spans, cover_lines>& spans, std::size_t i) {
    CoverMask mask{};
    for (std::size_t s = 0; s < cover_lines; ++s) {
        for (const auto& [lo, hi] : spans[s]) {
            const double from = (lo - static_cast<double>(i)) * cover_lines - 0.5,
                         to = (hi - static_cast<double>(i)) * cover_lines - 0.5;
            for (double p = std::max(0.0, std::ceil(from)); p < cover_lines && p < to; ++p) {
                mask[s] = static_cast<std::uint16_t>(mask[s] | (1U << static_cast<unsigned>(p)));
            }
        }
    }
    return mask;
}

}  // namespace

std::vector<double> cover_of_cells(const Grid& grid, const std::vector<const MapPolygon*>& polygons) {
    std::vector<double> cell(grid.cells(), 0);
    const ByRow shapes(shapes_of(grid, polygons, true), grid.nz);
    scan_cells(shapes, grid, [&](std::size_t k, const auto& spans) { add_row(spans, k, grid, cell); });
    return cell;
}

Cover cover_of(const Grid& grid, const std::vector<const MapPolygon*>& polygons) {
    Cover cover;
    const std::size_t nx = grid.nx, nz = grid.nz;
    cover.cell.assign(nx * nz, 0);
    cover.face_x.assign((nx + 1) * nz, 0);
    cover.face_z.assign(nx * (nz + 1), 0);
    const ByRow rows(shapes_of(grid, polygons, true), nz), columns(shapes_of(grid, polygons, false), nx);
    scan_cells(rows, grid, [&](std::size_t k, const auto& spans) {
        add_row(spans, k, grid, cover.cell);
        for (std::size_t i = 0; i < nx; ++i) {
            const double share = cover.cell[k * nx + i];
            if (share <= 0 || share >= 1) continue;
            cover.partly.push_back(k * nx + i);
            cover.mask.push_back(mask_of(spans, i));
        }
    });
    scan_faces(rows, nz + 1, nx, [&](std::size_t line, std::size_t i, double share) {
        double& face = cover.face_z[line * nx + i];
        face = std::max(face, share);
    });
    scan_faces(columns, nx + 1, nz, [&](std::size_t line, std::size_t k, double share) {
        double& face = cover.face_x[k * (nx + 1) + line];
        face = std::max(face, share);
    });
    return cover;
}

}  // namespace wade::fluid::shallow_water
