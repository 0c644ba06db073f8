#include "fluid_server/shallow_water/site/openings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "configs/numbers/portable.hpp"
#include "fluid_server/shallow_water/site/map_cover.hpp"

namespace wade::fluid::shallow_water {

namespace {

constexpr double least_opening = 1e-6;   // a face that is open less is closed
constexpr double least_by_lines = 0.02;  // open shares below this are better told by the faces than by scan lines

// A cell is stepped alone if its faces are no larger for its area than those of a whole cell, or a little: the time step
// has that much room.
constexpr double most_face_for_area = 1.1;

enum Side : std::size_t { x_lower, x_upper, z_lower, z_upper };
using Sides4 = std::array<double, 4>;

// Cells and faces by k * nx + i, without the grid's memory around them.
struct OpenGrid {
    std::size_t nx, nz;
    std::vector<double> share;
    std::vector<double> face_x, face_z;                // k * (nx + 1) + i, k * nx + i
    std::map<std::size_t, WeirFace> weirs_x, weirs_z;  // by face

    [[nodiscard]] Sides4 faces(std::size_t cell) const {
        const std::size_t i = cell % nx, k = cell / nx;
        return {face_x[k * (nx + 1) + i], face_x[k * (nx + 1) + i + 1], face_z[cell], face_z[cell + nx]};
    }
    double& face(std::size_t cell, Side side) {
        const std::size_t i = cell % nx, k = cell / nx;
        if (side == x_lower || side == x_upper) return face_x[k * (nx + 1) + i + (side == x_upper ? 1 : 0)];
        return face_z[cell + (side == z_upper ? nx : 0)];
    }
    // The cell beyond a face; of the site's edge the cell itself.
    [[nodiscard]] std::size_t beyond(std::size_t cell, std::size_t side) const {
        const std::size_t i = cell % nx, k = cell / nx;
        if (side == x_lower) return i == 0 ? cell : cell - 1;
        if (side == x_upper) return i + 1 == nx ? cell : cell + 1;
        if (side == z_lower) return k == 0 ? cell : cell - nx;
        return k + 1 == nz ? cell : cell + nx;
    }
};

int count_bits(const CoverMask& mask) {
    int n = 0;
    for (const std::uint16_t line : mask) n += __builtin_popcount(line);
    return n;
}

// The points of `open` that are joined to one of them.
CoverMask joined_to_first(const CoverMask& open) {
    CoverMask part{};
    for (std::size_t s = 0; s < cover_lines; ++s) {
        if (open[s] == 0) continue;
        part[s] = static_cast<std::uint16_t>(open[s] & -open[s]);
        break;
    }
    for (bool grew = true; grew;) {
        grew = false;
        for (std::size_t s = 0; s < cover_lines; ++s) {
            unsigned wider = part[s] | (part[s] << 1U) | (unsigned{part[s]} >> 1U);
            if (s > 0) wider |= part[s - 1];
            if (s + 1 < cover_lines) wider |= part[s + 1];
            const auto next = static_cast<std::uint16_t>(wider & open[s]);
            grew = grew || next != part[s];
            part[s] = next;
        }
    }
    return part;
}

// Points on a side of the cell, a bit each.
unsigned points_on(const CoverMask& mask, std::size_t side) {
    if (side == z_lower) return mask.front();
    if (side == z_upper) return mask.back();
    unsigned bits = 0;
    for (std::size_t s = 0; s < cover_lines; ++s) {
        const unsigned bit = side == x_lower ? mask[s] & 1U : unsigned{mask[s]} >> (cover_lines - 1);
        bits |= bit << s;
    }
    return bits;
}

CoverMask largest_part(const CoverMask& open) {
    CoverMask rest = open, largest{};
    for (int left = count_bits(open); left > count_bits(largest); left = count_bits(rest)) {
        const CoverMask part = joined_to_first(rest);
        if (count_bits(part) > count_bits(largest)) largest = part;
        for (std::size_t s = 0; s < cover_lines; ++s) rest[s] = static_cast<std::uint16_t>(rest[s] & ~part[s]);
    }
    return largest;
}

// Of cells that walls split only the largest part stays open, and of their faces what is open to the parts on both sides, so
// that no water passes from one side of a thin wall to the other.
void keep_largest_parts(OpenGrid& grid, const Cover& cover) {
    std::vector<CoverMask> open(cover.mask.size()), kept(cover.mask.size());
    for (std::size_t n = 0; n < open.size(); ++n) {
        for (std::size_t s = 0; s < cover_lines; ++s) open[n][s] = static_cast<std::uint16_t>(~cover.mask[n][s]);
        kept[n] = largest_part(open[n]);
        const int all = count_bits(open[n]);
        if (all > 0) grid.share[cover.partly[n]] *= static_cast<double>(count_bits(kept[n])) / all;
    }
    for (std::size_t n = 0; n < open.size(); ++n) {
        for (std::size_t side = 0; side < 4; ++side) {
            const std::size_t cell = cover.partly[n], other = grid.beyond(cell, side), opposite = side ^ 1U;
            const auto found = std::lower_bound(cover.partly.begin(), cover.partly.end(), other);
            const bool partly = other != cell && found != cover.partly.end() && *found == other;
            if (partly && other > cell) continue;  // the other one's turn
            unsigned had = points_on(open[n], side), has = points_on(kept[n], side);
            if (partly) {
                const auto m = static_cast<std::size_t>(found - cover.partly.begin());
                had &= points_on(open[m], opposite), has &= points_on(kept[m], opposite);
            }
            if (had != has) {
                grid.face(cell, static_cast<Side>(side)) *=
                    static_cast<double>(__builtin_popcount(has)) / __builtin_popcount(had);
            }
        }
    }
}

// Lengthens a gate beyond the centre of its end cell if a wall fills a part of that cell; otherwise the face beside the
// wall would stay open.
MapLine up_to_walls(const OpenGrid& open, const Grid& grid, MapLine line) {
    const auto lengthen = [&](MapPoint& end, const MapPoint& from) {
        const double column = (end.x - grid.x.lo) / grid.dx, row = (end.z - grid.z.lo) / grid.dz;
        if (!(column >= 0 && row >= 0 && column < double(open.nx) && row < double(open.nz))) return;
        if (open.share[static_cast<std::size_t>(row) * open.nx + static_cast<std::size_t>(column)] >= 1) return;
        const double x = end.x - from.x, z = end.z - from.z, reach = 0.5 * length_of(grid.dx, grid.dz);
        end.x += reach * x / length_of(x, z), end.z += reach * z / length_of(x, z);
    };
    lengthen(line.front(), line[1]);
    lengthen(line.back(), line[line.size() - 2]);
    return line;
}

// Closes the faces between centres of cells that a line parts. In a row of such faces a line of direction (x, z) has the length
// 1 / (|x| + |z|) of theirs.
void close_faces(OpenGrid& open, const Grid& grid, const MapLine& line, double crest) {
    double length = 0;
    const auto parts = [&](std::size_t cell, std::size_t other) {
        const auto centre = [&](std::size_t c) {
            const std::size_t column = c % open.nx, row = c / open.nx;
            return MapPoint{grid.x.lo + (static_cast<double>(column) + 0.5) * grid.dx,
                            grid.z.lo + (static_cast<double>(row) + 0.5) * grid.dz};
        };
        const MapPoint p = centre(cell), q = centre(other);
        for (std::size_t n = 1; n < line.size(); ++n) {
            const MapPoint &a = line[n - 1], &b = line[n];
            const double tx = b.x - a.x, tz = b.z - a.z;
            const double at_p = tx * (p.z - a.z) - tz * (p.x - a.x), at_q = tx * (q.z - a.z) - tz * (q.x - a.x);
            if ((at_p > 0) == (at_q > 0)) continue;
            const double f = at_p / (at_p - at_q), x = p.x + f * (q.x - p.x), z = p.z + f * (q.z - p.z);
            const double t = ((x - a.x) * tx + (z - a.z) * tz) / (tx * tx + tz * tz);
            length = length_of(tx, tz) / (std::abs(tx) + std::abs(tz));
            if (t >= 0 && t <= 1) return true;
        }
        return false;
    };
    for (const std::size_t cell : cells_on(grid, line)) {
        for (std::size_t side = 0; side < 4; ++side) {
            const std::size_t other = open.beyond(cell, side);
            if (other == cell || !parts(cell, other)) continue;
            double& share = open.face(cell, static_cast<Side>(side));
            const bool along_x = side == x_lower || side == x_upper;
            auto& weirs = along_x ? open.weirs_x : open.weirs_z;
            const double* const first = along_x ? open.face_x.data() : open.face_z.data();
            const std::size_t number = static_cast<std::size_t>(&share - first),
                              width = along_x ? open.nx + 1 : open.nx;
            if (const auto known = weirs.find(number); known != weirs.end()) {  // the higher wall holds the water
                known->second.crest = std::max(known->second.crest, crest);
            } else if (share > 0) {
                weirs[number] = {static_cast<std::uint32_t>(number % width), crest, length, share};
            }
            share = 0;
        }
    }
}

OpenGrid open_grid(const Grid& grid, const std::vector<House>& houses, const RowMemory& ground,
                   const std::vector<Barrier>& barriers) {
    std::vector<const MapPolygon*> polygons;
    polygons.reserve(houses.size());
    for (const House& house : houses) polygons.push_back(&house.polygon);
    const Cover cover = cover_of(grid, polygons);
    OpenGrid open{grid.nx, grid.nz, cover.cell, cover.face_x, cover.face_z, {}, {}};
    for (std::vector<double>* shares : {&open.share, &open.face_x, &open.face_z}) {
        for (double& s : *shares) s = 1 - s;
    }
    keep_largest_parts(open, cover);
    for (const Barrier& barrier : barriers) {
        close_faces(open, grid, up_to_walls(open, grid, barrier.line), barrier.crest);
    }
    for (std::vector<double>* shares : {&open.face_x, &open.face_z}) {
        for (double& s : *shares) s = s < least_opening ? 0 : s;
    }
    for (std::size_t cell = 0; cell < open.share.size(); ++cell) {
        const Sides4 faces = open.faces(cell);
        // A corner of a cell that a wall cuts off is a triangle.
        const double corner = 0.5 * std::max(faces[x_lower], faces[x_upper]) * std::max(faces[z_lower], faces[z_upper]);
        if (open.share[cell] < least_by_lines) open.share[cell] = std::max(open.share[cell], corner);
        const double b = ground[grid.row(static_cast<std::ptrdiff_t>(cell / open.nx)) + cell % open.nx];
        const bool reached = std::any_of(faces.begin(), faces.end(), [](double a) { return a > 0; });
        if (!reached || std::isnan(b)) open.share[cell] = 0;
    }
    for (std::size_t cell = 0; cell < open.share.size(); ++cell) {
        if (open.share[cell] > 0) continue;
        for (std::size_t side = 0; side < 4; ++side) open.face(cell, static_cast<Side>(side)) = 0;
    }
    const auto holds = [&](std::size_t lower, std::size_t upper, const WeirFace& weir) {
        return std::isfinite(weir.crest) && weir.open >= least_opening && open.share[lower] > 0 &&
               open.share[upper] > 0;
    };
    std::erase_if(open.weirs_x, [&](const auto& weir) {
        const std::size_t cell = weir.first / (open.nx + 1) * open.nx + weir.second.column;
        return !holds(cell - 1, cell, weir.second);
    });
    std::erase_if(open.weirs_z,
                  [&](const auto& weir) { return !holds(weir.first - open.nx, weir.first, weir.second); });
    return open;
}

// Small cells with a neighbour each, until the faces are not too large for the area.
class Groups {
 public:
    explicit Groups(const OpenGrid& open) : open_(open), of_(open.share.size(), none) {
        for (std::size_t cell = 0; cell < of_.size(); ++cell) {
            if (open.share[cell] <= 0 || open.share[cell] >= 1 || !too_small({cell})) continue;
            if (of_[cell] == none) add({cell});
            while (too_small(cells_[of_[cell]]) && grow(of_[cell])) {
            }
        }
    }
    // Groups of several cells, each in ascending order.
    [[nodiscard]] std::vector<std::vector<std::size_t>> result() const {
        std::vector<std::vector<std::size_t>> groups;
        for (std::vector<std::size_t> cells : cells_) {
            if (cells.size() < 2) continue;
            std::sort(cells.begin(), cells.end());
            groups.push_back(std::move(cells));
        }
        return groups;
    }

 private:
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max(), most_members = 8;

    [[nodiscard]] bool too_small(const std::vector<std::size_t>& cells) const {
        double along_x = 0, along_z = 0, share = 0;
        for (const std::size_t cell : cells) {
            share += open_.share[cell];
            const Sides4 faces = open_.faces(cell);
            for (std::size_t side = 0; side < 4; ++side) {
                const std::size_t other = open_.beyond(cell, side);
                if (other != cell && std::find(cells.begin(), cells.end(), other) != cells.end()) continue;
                (side == x_lower || side == x_upper ? along_x : along_z) += faces[side];
            }
        }
        return std::max(along_x, along_z) > 2 * most_face_for_area * share;
    }
    void add(std::vector<std::size_t> cells) {
        for (const std::size_t cell : cells) of_[cell] = cells_.size();
        cells_.push_back(std::move(cells));
    }
    // Takes in what lies beyond its widest face; false if there is nothing.
    bool grow(std::size_t group) {
        std::size_t best = none;
        double widest = 0;
        for (const std::size_t cell : cells_[group]) {
            const Sides4 faces = open_.faces(cell);
            for (std::size_t side = 0; side < 4; ++side) {
                const std::size_t other = open_.beyond(cell, side);
                if (other == cell || of_[other] == group || faces[side] <= 0) continue;
                const double worth = faces[side] + 0.5 * open_.share[other];
                if (worth <= widest) continue;
                widest = worth, best = other;
            }
        }
        if (best == none) return false;
        if (of_[best] == none) add({best});
        std::vector<std::size_t>& others = cells_[of_[best]];
        if (cells_[group].size() + others.size() > most_members) return false;
        cells_[group].insert(cells_[group].end(), others.begin(), others.end());
        others.clear();
        for (const std::size_t cell : cells_[group]) of_[cell] = group;
        return true;
    }

    const OpenGrid& open_;
    std::vector<std::size_t> of_;
    std::vector<std::vector<std::size_t>> cells_;
};

// body(row, entries) adds the entries of a row.
template <typename Entry, typename Body>
EntriesByRow<Entry> by_row(std::size_t rows, Body&& body) {
    EntriesByRow<Entry> result;
    result.begin.assign(rows + 1, 0);
    for (std::size_t k = 0; k < rows; ++k) {
        body(k, result.entries);
        result.begin[k + 1] = result.entries.size();
    }
    return result;
}

// What flood walls push is part of the flux over them.
OpenGrid without_weirs(OpenGrid open) {
    for (const auto& [face, weir] : open.weirs_x) open.face_x[face] = weir.open;
    for (const auto& [face, weir] : open.weirs_z) open.face_z[face] = weir.open;
    return open;
}

EntriesByRow<WeirFace> weir_faces(const std::map<std::size_t, WeirFace>& weirs, std::size_t rows, std::size_t width) {
    if (weirs.empty()) return {};
    return by_row<WeirFace>(rows, [&](std::size_t k, std::vector<WeirFace>& entries) {
        const auto end = weirs.lower_bound((k + 1) * width);
        for (auto weir = weirs.lower_bound(k * width); weir != end; ++weir) entries.push_back(weir->second);
    });
}

EntriesByRow<WallCell> wall_cells(const OpenGrid& open) {
    return by_row<WallCell>(open.nz, [&](std::size_t k, std::vector<WallCell>& entries) {
        for (std::size_t i = 0; i < open.nx; ++i) {
            if (open.share[k * open.nx + i] <= 0) continue;
            const Sides4 a = open.faces(k * open.nx + i);
            const double x = a[x_lower] - a[x_upper], z = a[z_lower] - a[z_upper];
            if (x != 0 || z != 0) entries.push_back({static_cast<std::uint32_t>(i), x, z, length_of(x, z)});
        }
    });
}

EntriesByRow<OneSided> one_sided(const OpenGrid& open, Side lower, Side upper) {
    return by_row<OneSided>(open.nz, [&](std::size_t k, std::vector<OneSided>& entries) {
        for (std::size_t i = 0; i < open.nx; ++i) {
            const std::size_t cell = k * open.nx + i;
            if (open.share[cell] <= 0) continue;
            const Sides4 a = open.faces(cell);
            const bool below = a[lower] <= 0 && open.beyond(cell, lower) != cell;
            const bool above = a[upper] <= 0 && open.beyond(cell, upper) != cell;
            if (!below && !above) continue;
            const int away = below && above ? 0 : below ? 1 : -1;
            entries.push_back({static_cast<std::uint32_t>(i), static_cast<std::int8_t>(away)});
        }
    });
}

}  // namespace

Openings find_openings(const Grid& grid, const std::vector<House>& houses, const RowMemory& ground,
                       const std::vector<Barrier>& barriers) {
    Openings result;
    const OpenGrid open = open_grid(grid, houses, ground, barriers);
    const auto whole = [](const std::vector<double>& v) {
        return std::all_of(v.begin(), v.end(), [](double s) { return s >= 1; });
    };
    if (whole(open.share) && whole(open.face_x) && whole(open.face_z)) return result;
    result.share.assign(grid.stored(), 1);
    result.per_share.assign(grid.stored(), 1);
    result.face_x.assign(grid.stored(), 1);
    result.face_z.assign(grid.stored(), 1);
    result.narrowed_x.rows.assign(grid.stored() / grid.stride, 0);
    result.narrowed_z.rows.assign(grid.stored() / grid.stride, 0);
    for (std::size_t k = 0; k <= open.nz; ++k) {
        const std::size_t row = grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = 0; i <= open.nx; ++i) {
            const std::size_t c = row + i;
            if (i < open.nx) result.face_z[c] = open.face_z[k * open.nx + i];
            if (k < open.nz) result.face_x[c] = open.face_x[k * (open.nx + 1) + i];
            if (result.face_z[c] < 1) result.narrowed_z.rows[c / grid.stride] = 1;
            if (result.face_x[c] < 1) result.narrowed_x.rows[c / grid.stride] = 1;
            if (i == open.nx || k == open.nz) continue;
            const double s = open.share[k * open.nx + i];
            result.share[c] = s;
            result.per_share[c] = s > 0 ? 1 / s : 0;
        }
    }
    result.walls = wall_cells(without_weirs(open));
    result.weirs_x = weir_faces(open.weirs_x, open.nz, open.nx + 1);
    result.weirs_z = weir_faces(open.weirs_z, open.nz, open.nx);
    result.slopes_x = one_sided(open, x_lower, x_upper);
    result.slopes_z = one_sided(open, z_lower, z_upper);
    const Lines lines(grid, false);
    for (const std::vector<std::size_t>& cells : Groups(open).result()) {
        Group& group = result.groups.emplace_back();
        group.first = result.members_of_groups.size();
        for (const std::size_t cell : cells) {
            const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(cell / open.nx)) + cell % open.nx;
            result.members_of_groups.push_back(c);
            result.places_of_members.push_back(
                {static_cast<std::uint32_t>(cell / open.nx), static_cast<std::uint32_t>(cell % open.nx)});
            result.per_share[c] = -1 / open.share[cell];
            group.share += open.share[cell];
        }
        group.last = result.members_of_groups.size();
        for (const std::size_t cell : cells) result.weights.push_back(open.share[cell] / group.share);
        group.first_line = result.lines_of_groups.size();
        for (std::size_t m = group.first; m < group.last; ++m) {
            const MemberPlace& member = result.places_of_members[m];
            const Lines::Position line = lines.position(member.row, member.column);
            const auto begin = result.lines_of_groups.begin() + static_cast<std::ptrdiff_t>(group.first_line);
            if (std::find(begin, result.lines_of_groups.end(), line) == result.lines_of_groups.end()) {
                result.lines_of_groups.push_back(line);
            }
        }
        group.last_line = result.lines_of_groups.size();
    }
    return result;
}

double mean_of(const Openings& openings, const Group& group, const RowMemory& values) {
    double sum = 0;
    for (std::size_t m = group.first; m < group.last; ++m) {
        const std::size_t c = openings.members_of_groups[m];
        sum += openings.share[c] * values[c];
    }
    return sum / group.share;
}

void level_group(const Openings& openings, const Group& group, RowMemory& values) {
    bool alike = true;  // then rounding must not change them
    for (std::size_t m = group.first + 1; m < group.last; ++m) {
        alike = alike && values[openings.members_of_groups[m]] == values[openings.members_of_groups[group.first]];
    }
    if (alike) return;
    const double mean = mean_of(openings, group, values);
    for (std::size_t m = group.first; m < group.last; ++m) values[openings.members_of_groups[m]] = mean;
}

void level_groups(const Openings& openings, RowMemory& values) {
    for (const Group& group : openings.groups) level_group(openings, group, values);
}

void level_active_groups(const Openings& openings, RowMemory& values) {
    for (const std::size_t g : openings.active_groups) level_group(openings, openings.groups[g], values);
}

}  // namespace wade::fluid::shallow_water
