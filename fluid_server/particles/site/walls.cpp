#include "fluid_server/particles/site/walls.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "configs/numbers/portable.hpp"

// Each outline is cut where others cross or touch it. A piece is a wall if there is water on one side of it and none on the other;
// the two sides of a closed gate are a wall each. Walls that meet at a corner of the water know one another: going along a wall with
// the water on the left, the next wall is the first one to be met turning right from the way back.
//
//            water                    after
//     <--------------+ before  becomes  ^
//       after        |                  |   water       turn < pi: an inner corner, where images are seen of images
//                    |  a         ------+               turn > pi: an edge, past which sight is soft

namespace wade::fluid {

namespace {

constexpr double same_place = 1e-6;  // m
constexpr double beside = 1e-4;      // m, how far from a piece its sides are asked for
constexpr double straight = 1e-5;    // rad

struct Piece {
    MapPoint a, b;
    bool gate = false;
    std::int32_t house = -1;
};

double cross(const MapPoint& u, const MapPoint& v) {
    return u.x * v.z - u.z * v.x;
}
MapPoint minus(const MapPoint& a, const MapPoint& b) {
    return {a.x - b.x, a.z - b.z};
}

struct PlanBox {
    MapPoint lo, hi;
    explicit PlanBox(const Piece& piece)
        : lo{std::min(piece.a.x, piece.b.x) - same_place, std::min(piece.a.z, piece.b.z) - same_place},
          hi{std::max(piece.a.x, piece.b.x) + same_place, std::max(piece.a.z, piece.b.z) + same_place} {}
    [[nodiscard]] bool meets(const PlanBox& other) const {
        return lo.x <= other.hi.x && other.lo.x <= hi.x && lo.z <= other.hi.z && other.lo.z <= hi.z;
    }
};

std::vector<Piece> outlines(const SiteShape& shape, double time, double margin) {
    std::vector<Piece> pieces;
    for (std::size_t h = 0; h < shape.houses.size(); ++h) {
        for (const MapLine& ring : shape.houses[h].rings) {
            for (std::size_t k = 0; k < ring.size(); ++k)
                pieces.push_back({ring[k], ring[(k + 1) % ring.size()], false, static_cast<std::int32_t>(h)});
        }
    }
    for (const Barrier& gate : shape.gates) {
        for (std::size_t k = 1; gate.opens_at > time && k < gate.line.size(); ++k)
            pieces.push_back({gate.line[k - 1], gate.line[k], true});
    }
    const auto beyond = [&](SiteShape::Side side, double bound, double outwards) {
        return shape.open[side] ? bound + outwards * margin : bound;
    };
    const MapPoint lo{beyond(SiteShape::x_lo, shape.x.lo, -1), beyond(SiteShape::z_lo, shape.z.lo, -1)};
    const MapPoint hi{beyond(SiteShape::x_hi, shape.x.hi, 1), beyond(SiteShape::z_hi, shape.z.hi, 1)};
    if (!shape.open[SiteShape::x_lo]) pieces.push_back({lo, {lo.x, hi.z}});
    if (!shape.open[SiteShape::x_hi]) pieces.push_back({{hi.x, lo.z}, hi});
    if (!shape.open[SiteShape::z_lo]) pieces.push_back({lo, {hi.x, lo.z}});
    if (!shape.open[SiteShape::z_hi]) pieces.push_back({{lo.x, hi.z}, hi});
    return pieces;
}

// Where along a piece, 0 to 1, another one crosses it or ends on it.
void cuts_by(const Piece& piece, const Piece& other, std::vector<double>& cuts) {
    const MapPoint way = minus(piece.b, piece.a);
    const double length = length_of(way.x, way.z), slack = same_place / length;
    for (const MapPoint& p : {other.a, other.b}) {
        const MapPoint to = minus(p, piece.a);
        if (std::abs(cross(way, to)) > same_place * length) continue;
        cuts.push_back((way.x * to.x + way.z * to.z) / (length * length));
    }
    const MapPoint across = minus(other.b, other.a);
    const double turned = cross(way, across);
    if (std::abs(turned) < same_place * length * length_of(across.x, across.z)) return;
    const MapPoint to = minus(other.a, piece.a);
    const double t = cross(to, across) / turned, s = cross(to, way) / turned;
    if (s > -slack && s < 1 + slack) cuts.push_back(t);
}

std::vector<Piece> cut_up(const std::vector<Piece>& whole) {
    std::vector<Piece> pieces;
    std::vector<double> cuts;
    std::vector<PlanBox> boxes(whole.begin(), whole.end());
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const MapPoint way = minus(whole[i].b, whole[i].a);
        if (length_of(way.x, way.z) < same_place) continue;
        cuts.assign({0, 1});
        for (std::size_t k = 0; k < whole.size(); ++k) {
            if (k != i && boxes[i].meets(boxes[k])) cuts_by(whole[i], whole[k], cuts);
        }
        std::erase_if(cuts, [](double t) { return !(t >= 0 && t <= 1); });
        std::sort(cuts.begin(), cuts.end());
        const auto at = [&](double t) { return MapPoint{whole[i].a.x + t * way.x, whole[i].a.z + t * way.z}; };
        for (std::size_t c = 1; c < cuts.size(); ++c) {
            if ((cuts[c] - cuts[c - 1]) * length_of(way.x, way.z) > same_place)
                pieces.push_back({at(cuts[c - 1]), at(cuts[c]), whole[i].gate, whole[i].house});
        }
    }
    return pieces;
}

class WaterFinder {
 public:
    explicit WaterFinder(const SiteShape& shape) : shape_(shape) {
        for (const MapPolygon& house : shape.houses) {
            MapPoint lo{INFINITY, INFINITY}, hi{-INFINITY, -INFINITY};
            for (const MapLine& ring : house.rings) {
                for (const MapPoint& p : ring) {
                    lo = {std::min(lo.x, p.x), std::min(lo.z, p.z)};
                    hi = {std::max(hi.x, p.x), std::max(hi.z, p.z)};
                }
            }
            boxes_.emplace_back(Piece{lo, hi});
        }
    }

    [[nodiscard]] bool at(const MapPoint& p) const {
        const auto& open = shape_.open;
        if ((p.x < shape_.x.lo && !open[SiteShape::x_lo]) || (p.x > shape_.x.hi && !open[SiteShape::x_hi]) ||
            (p.z < shape_.z.lo && !open[SiteShape::z_lo]) || (p.z > shape_.z.hi && !open[SiteShape::z_hi]))
            return false;
        for (std::size_t h = 0; h < boxes_.size(); ++h) {
            if (boxes_[h].meets(PlanBox(Piece{p, p})) && contains(shape_.houses[h], p)) return false;
        }
        return true;
    }

 private:
    const SiteShape& shape_;
    std::vector<PlanBox> boxes_;
};

// A corner as a key: places that differ by rounding are the same.
using Corner = std::pair<std::int64_t, std::int64_t>;
Corner corner_at(const MapPoint& p) {
    return {std::llround(p.x / (10 * same_place)), std::llround(p.z / (10 * same_place))};
}

// Pieces from a to b with the water on their left.
std::vector<Piece> with_water_on_the_left(const SiteShape& shape, const std::vector<Piece>& pieces) {
    const WaterFinder water(shape);
    std::vector<Piece> walls;
    std::set<std::pair<Corner, Corner>> known;
    const auto add = [&](const Piece& wall) {
        if (known.emplace(corner_at(wall.a), corner_at(wall.b)).second) walls.push_back(wall);
    };
    for (const Piece& piece : pieces) {
        const MapPoint way = minus(piece.b, piece.a),
                       middle{0.5 * (piece.a.x + piece.b.x), 0.5 * (piece.a.z + piece.b.z)};
        const double step = beside / length_of(way.x, way.z);
        const bool left = water.at({middle.x - step * way.z, middle.z + step * way.x});
        const bool right = water.at({middle.x + step * way.z, middle.z - step * way.x});
        if (left == right && !piece.gate) continue;
        if (left) add(piece);
        if (right) add({piece.b, piece.a, piece.gate, piece.house});
    }
    return walls;
}

struct Joint {
    std::size_t after = Wall::none;
    double turn = 2 * std::numbers::pi;  // of the water, from the way back along a wall to the next one
};

std::vector<Joint> join(const std::vector<Piece>& walls) {
    std::map<Corner, std::vector<std::size_t>> begin_at;
    for (std::size_t w = 0; w < walls.size(); ++w) begin_at[corner_at(walls[w].a)].push_back(w);
    std::vector<Joint> joints(walls.size());
    for (std::size_t w = 0; w < walls.size(); ++w) {
        const MapPoint back = minus(walls[w].a, walls[w].b);
        for (const std::size_t next : begin_at[corner_at(walls[w].b)]) {
            const MapPoint on = minus(walls[next].b, walls[next].a);
            double turn = std::atan2(-cross(back, on), back.x * on.x + back.z * on.z);
            if (turn < straight) turn += 2 * std::numbers::pi;
            if (turn <= joints[w].turn) joints[w] = {next, turn};
        }
    }
    return joints;
}

}  // namespace

std::vector<Wall> walls_of(const SiteShape& shape, double time, double margin) {
    const std::vector<Piece> pieces = with_water_on_the_left(shape, cut_up(outlines(shape, time, margin)));
    const std::vector<Joint> joints = join(pieces);
    const auto goes_straight_on = [&](std::size_t w) {
        return joints[w].after != Wall::none && std::abs(joints[w].turn - std::numbers::pi) < straight;
    };
    std::vector<bool> is_continued(pieces.size(), false);
    for (std::size_t w = 0; w < pieces.size(); ++w) {
        if (goes_straight_on(w)) is_continued[joints[w].after] = true;
    }
    std::vector<Wall> walls;
    std::vector<std::size_t> last_piece;                              // of each wall
    std::vector<std::uint32_t> wall_from(pieces.size(), Wall::none);  // that begins with the piece
    for (std::size_t w = 0; w < pieces.size(); ++w) {
        if (is_continued[w]) continue;
        std::size_t last = w;
        while (goes_straight_on(last)) last = joints[last].after;
        const MapPoint a = pieces[w].a, way = minus(pieces[last].b, a);
        const double length = length_of(way.x, way.z);
        Wall wall;
        wall.a = {static_cast<float>(a.x), static_cast<float>(a.z)};
        wall.ux = static_cast<float>(way.x / length), wall.uz = static_cast<float>(way.z / length);
        wall.nx = -wall.uz, wall.nz = wall.ux;
        wall.length = static_cast<float>(length);
        wall.house = pieces[w].house;
        wall_from[w] = static_cast<std::uint32_t>(walls.size());
        last_piece.push_back(last);
        walls.push_back(wall);
    }
    for (std::size_t w = 0; w < walls.size(); ++w) {
        const Joint& joint = joints[last_piece[w]];
        if (joint.after == Wall::none) continue;
        Wall& next = walls[wall_from[joint.after]];
        walls[w].after = wall_from[joint.after];
        next.before = static_cast<std::uint32_t>(w);
        walls[w].edge_after = next.edge_before = joint.turn > std::numbers::pi;
    }
    return walls;
}

float distance_between(const Wall& a, const Wall& b) {
    const auto to = [](const Wall& wall, const PlanPoint& p) {
        const float s = std::clamp(wall.along(p.x, p.z), 0.0F, wall.length);
        const PlanPoint foot = wall.at(s);
        return length_of(p.x - foot.x, p.z - foot.z);
    };
    return std::min({to(a, b.a), to(a, b.end()), to(b, a.a), to(b, a.end())});
}

}  // namespace wade::fluid
