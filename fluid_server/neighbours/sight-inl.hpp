// What is seen past boxes and in their faces, for the files that Highway compiles for several instruction sets.

#include <array>
#include <cstddef>
#include <span>

#include "fluid_server/neighbours/vectors-inl.hpp"

// Once for each instruction set.
#if defined(WADE_SIGHT_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef WADE_SIGHT_INL_HPP
#undef WADE_SIGHT_INL_HPP
#else
#define WADE_SIGHT_INL_HPP
#endif

// No product is fused with a sum here, so that visibility across a face does not depend on the instruction set.
//
// Soft visibility. If visibility ended sharply at an edge of a box, a particle that moves past it would appear and
// vanish as a whole, itself and its image. The pressure would jump, and water round a house never came to rest. So a
// line that passes an edge at a distance below delta counts in part. Let e be its distance from the box, negative if it
// passes through the box. Then
//
//         share = clamp(1/2 + e / (2 delta), 0, 1)      of a particle at the end of the line,
//         share = clamp(1/2 - e / (2 delta), 0, 1)      of an image there, seen in the face that the line enters.
//
// Both test the same line against the same edge, so that the two add up to one: every position round a particle is
// still filled once. The exception is under one in a hundred, near the upper corners of a box, where three edges
// matter. Both are the same from either end. e is the distance of a corner c from the line through x and y in the plane
// across the edge, (c - x) x (c - y) / |x - y|; for images it is measured from the point where line and face meet.
// Either changes only its sign if x and y are swapped, so that forces stay opposite. The divergence leaves out how a
// fraction changes as particles move: it is constant within a step.
//
// In three dimensions e is the largest gap between line and box along six directions: the three axes and, for the
// edges, the three directions normal to the line and to an axis (separating axes, Gottschalk et al. 1996, SIGGRAPH,
// 171). Contact (solids.hpp) keeps all centres 0.4 spacings away from every face and delta is 0.3 spacings, so that no
// particle counts in part at a flat face.
HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

using Seen = hn::Mask<Lanes>;

HWY_INLINE Vec3V load(const ClusterPositions& places) {
    return load(ConstVectorArrays{places.x.data(), places.y.data(), places.z.data()}, 0);
}
HWY_INLINE V along(const Vec3V& x, std::size_t axis) {
    return axis == 0 ? x.x : axis == 1 ? x.y : x.z;
}

// How much is seen past an edge at a distance, m; delta: see above.
HWY_INLINE V share_past(V distance, float delta) {
    const V share = hn::Add(all(0.5F), hn::Mul(distance, all(0.5F / delta)));
    return hn::Min(hn::Max(share, hn::Zero(lanes)), all(1));
}

// Along an axis the ways from both ends of a line to both faces of a box, and that from end to end: reckoned by itself, so that it
// does not depend on where a face far away was cut off.
struct ToFaces {
    V x_lo, x_hi, y_lo, y_hi, x_y;
};

// How far the four edges along an axis keep a line from their box, m; m and n: from its ends x and y along the other two axes.
HWY_INLINE V past_edges(const ToFaces& m, const ToFaces& n) {
    const auto side = [](V xm, V ym, V xn, V yn) HWY_ATTR { return hn::Sub(hn::Mul(xm, yn), hn::Mul(xn, ym)); };
    const V a = side(m.x_lo, m.y_lo, n.x_lo, n.y_lo), b = side(m.x_lo, m.y_lo, n.x_hi, n.y_hi);
    const V c = side(m.x_hi, m.y_hi, n.x_lo, n.y_lo), d = side(m.x_hi, m.y_hi, n.x_hi, n.y_hi);
    const V least = hn::Min(hn::Min(a, b), hn::Min(c, d)), most = hn::Max(hn::Max(a, b), hn::Max(c, d));
    const V length2 = hn::Add(hn::Mul(m.x_y, m.x_y), hn::Mul(n.x_y, n.x_y));
    const V distance = hn::Div(hn::Max(least, hn::Neg(most)), hn::Sqrt(length2));
    // A line along the axis has no side here.
    return hn::IfThenElse(hn::Gt(length2, hn::Zero(lanes)), distance, all(-Box::inf));
}

// How much of y is seen past an obstacle; box: round the places x. An axis along which a line ends on one side of it, delta away,
// decides alone, and one along which a line stays more than delta away from both faces has no say: each line for itself, so that what
// one sees does not depend on the others, though what goes for all is found out at once. near: the lanes that count.
HWY_INLINE V seen_past(const Box& obstacle, const Box& box, const Vec3V& x, const Vec3& y, Seen near, float delta) {
    const float far = 8 * delta;  // a face farther away from both ends than that has no say, be it at infinity
    std::array<bool, 3> between{};
    for (std::size_t k = 0; k < 3; ++k) {
        const float least = std::min(box.lo[k], y[k]), most = std::max(box.hi[k], y[k]);
        if (obstacle.lo[k] - most >= delta || least - obstacle.hi[k] >= delta) return all(1);
        between[k] = least - obstacle.lo[k] > delta && obstacle.hi[k] - most > delta;
    }
    std::array<Seen, 3> has_say;
    const auto faces = [&](std::size_t k) HWY_ATTR {
        const V from = along(x, k), to = all(y[k]);
        const V least = hn::Min(from, to), most = hn::Max(from, to), lo = all(obstacle.lo[k]), hi = all(obstacle.hi[k]);
        has_say[k] = hn::Or(hn::Le(hn::Sub(least, lo), all(delta)), hn::Le(hn::Sub(hi, most), all(delta)));
        const V cut_lo = hn::Max(lo, hn::Sub(least, all(far))), cut_hi = hn::Min(hi, hn::Add(most, all(far)));
        return ToFaces{hn::Sub(cut_lo, from), hn::Sub(cut_hi, from), hn::Sub(cut_lo, to), hn::Sub(cut_hi, to),
                       hn::Sub(to, from)};
    };
    const std::array<ToFaces, 3> to{faces(0), faces(1), faces(2)};
    V distance = all(-Box::inf);
    for (std::size_t k = 0; k < 3; ++k) {
        if (between[k]) continue;
        const V below = hn::Min(to[k].x_lo, to[k].y_lo), above = hn::Neg(hn::Max(to[k].x_hi, to[k].y_hi));
        distance = hn::IfThenElse(has_say[k], hn::Max(distance, hn::Max(below, above)), distance);
    }
    // Most lines of a cluster at a corner end on one side, each of its own.
    if (hn::AllFalse(lanes, hn::And(near, hn::Lt(distance, all(delta))))) return all(1);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t m = (k + 1) % 3, n = (k + 2) % 3;
        if (between[m] || between[n]) continue;
        const Seen both = hn::And(has_say[m], has_say[n]);
        distance = hn::IfThenElse(both, hn::Max(distance, past_edges(to[m], to[n])), distance);
    }
    return share_past(distance, delta);
}

// The same past all of them.
static HWY_NOINLINE V seen_past_all(std::span<const Box> obstacles, const Box& box, const Vec3V& x, const Vec3& y,
                                    Seen near, float delta) {
    V share = all(1);
    for (const Box& obstacle : obstacles) share = hn::Min(share, seen_past(obstacle, box, x, y, near, delta));
    return share;
}

// The face of an obstacle as a mirror: how much of a particle at y is seen in it.
class Face {
 public:
    HWY_INLINE Face(const Box& box, const Mirror& mirror, const Vec3V& x, float delta)
        : box_(box),
          mirror_(mirror),
          delta_(delta),
          k_(mirror.obstacle_axis),
          m_((k_ + 1) % 3),
          n_((k_ + 2) % 3),
          side_(mirror.plane[k_] == box.hi[k_] ? 1.0F : -1.0F),
          from_(hn::Mul(all(side_), hn::Sub(along(x, k_), all(mirror.plane[k_])))),
          xm_(along(x, m_)),
          xn_(along(x, n_)) {}

    [[nodiscard]] HWY_INLINE float side() const { return side_; }  // 1 or -1 along its axis
    // The lanes on its side, a bit each.
    [[nodiscard]] HWY_INLINE unsigned lanes_in_front() const { return bits_of(hn::Ge(from_, hn::Zero(lanes))); }
    // How near the nearest lane on its side is, m.
    [[nodiscard]] HWY_INLINE float nearest() const {
        const V from = hn::IfThenElse(hn::Ge(from_, hn::Zero(lanes)), from_, all(Box::inf));
        return hn::GetLane(hn::MinOfLanes(lanes, from));
    }
    // How far y is from the face, m; not on its side if negative.
    [[nodiscard]] HWY_INLINE float distance(const Vec3& y) const { return side_ * (y[k_] - mirror_.plane[k_]); }

    // in_plan: its upper edge has no say.
    [[nodiscard]] HWY_INLINE V share_of(const Vec3& y, bool in_plan = false) const {
        const V to = all(distance(y));
        const V way = hn::Add(from_, to);
        const Seen on_side = hn::And(hn::Ge(from_, hn::Zero(lanes)), hn::Gt(way, hn::Zero(lanes)));
        const V within = hn::Min(in_plan && m_ == 1 ? all(Box::inf) : within_edges(m_, xm_, y, to, way),
                                 in_plan && n_ == 1 ? all(Box::inf) : within_edges(n_, xn_, y, to, way));
        return hn::IfThenElseZero(on_side, share_past(within, delta_));
    }

 private:
    // How far the line to the image passes within both edges of the face, m, seen along these; negative if outside. A line that
    // ends before it reaches beyond an edge stays outside by as much.
    [[nodiscard]] HWY_INLINE V within_edges(std::size_t m, V x, const Vec3& particle, V to, V way) const {
        const float lo = box_.lo[m], hi = box_.hi[m];
        if (lo == -Box::inf && hi == Box::inf) return all(Box::inf);
        const V y = all(mirror_.axis[m] ? 2 * mirror_.plane[m] - particle[m] : particle[m]);
        const V crossing = hn::Div(hn::Add(hn::Mul(x, to), hn::Mul(y, from_)), way);
        const V beside = hn::Sub(y, x);
        const V cosine = hn::Div(way, hn::Sqrt(hn::Add(hn::Mul(way, way), hn::Mul(beside, beside))));
        const V line = hn::Mul(hn::Min(hn::Sub(crossing, all(lo)), hn::Sub(all(hi), crossing)), cosine);
        const V ends = hn::Min(hn::Sub(hn::Max(x, y), all(lo)), hn::Sub(all(hi), hn::Min(x, y)));
        return hn::Min(line, ends);
    }

    const Box& box_;
    const Mirror& mirror_;
    float delta_;
    std::size_t k_, m_, n_;
    float side_;
    V from_, xm_, xn_;
};

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
