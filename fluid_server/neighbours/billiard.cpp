#include "fluid_server/neighbours/billiard.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "configs/numbers/portable.hpp"
#include "fluid_server/neighbours/cluster_positions.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/neighbours/billiard.cpp"
#include <hwy/foreach_target.h>

#include "fluid_server/neighbours/vectors-inl.hpp"

// As in sight-inl.hpp no product is fused with a sum: what is seen does not depend on the instruction set.
HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

using Seen = hn::Mask<Lanes>;

// Where a path meets a wall up to so many support radii beyond an inner corner, it still does: rounding.
constexpr float for_rounding_at_corners = 1e-5F;

// A point in plan, a lane each.
struct PlanV {
    V x, z;
};
HWY_INLINE PlanV minus(const PlanV& a, const PlanV& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.z, b.z)};
}
HWY_INLINE PlanV all_of(const PlanPoint& p) {
    return {all(p.x), all(p.z)};
}
HWY_INLINE V product_of(float ax, float az, const PlanV& b) {
    return hn::Add(hn::Mul(all(ax), b.x), hn::Mul(all(az), b.z));
}
HWY_INLINE V square_of(const PlanV& a) {
    return hn::Add(hn::Mul(a.x, a.x), hn::Mul(a.z, a.z));
}
HWY_INLINE V distance_of(const Wall& wall, const PlanV& p) {
    return product_of(wall.nx, wall.nz, minus(p, all_of(wall.a)));
}
HWY_INLINE V along(const Wall& wall, const PlanV& p) {
    return product_of(wall.ux, wall.uz, minus(p, all_of(wall.a)));
}
HWY_INLINE V share_past(V distance, float delta) {
    const V share = hn::Add(all(0.5F), hn::Mul(distance, all(0.5F / delta)));
    return hn::Min(hn::Max(share, hn::Zero(lanes)), all(1));
}

// A straight part of a path.
struct Leg {
    PlanV from, way;
    V square;  // of its length

    HWY_INLINE Leg(const PlanV& a, const PlanV& b) : from(a), way(minus(b, a)), square(square_of(way)) {}

    // How far a point is from the line; one of no length has none.
    [[nodiscard]] HWY_INLINE V distance(const PlanPoint& p) const {
        const PlanV to = minus(all_of(p), from);
        const V cross = hn::Abs(hn::Sub(hn::Mul(to.x, way.z), hn::Mul(to.z, way.x)));
        return hn::Div(cross, hn::Sqrt(hn::Max(square, all(1e-20F))));
    }
    // Whether the foot of a point on the line lies between the ends; walked: how far before the leg, m, it may lie.
    [[nodiscard]] HWY_INLINE Seen passes(const PlanPoint& p, V walked = hn::Zero(lanes)) const {
        const PlanV to = minus(all_of(p), from);
        const V on = hn::Add(hn::Mul(to.x, way.x), hn::Mul(to.z, way.z));
        return hn::And(hn::Gt(on, hn::Neg(hn::Mul(walked, hn::Sqrt(square)))), hn::Lt(on, square));
    }
};

HWY_INLINE Seen hits(const Wall& wall, const PlanV& a, const PlanV& b) {
    const V from = distance_of(wall, a), to = distance_of(wall, b), zero = hn::Zero(lanes);
    const Seen crosses = hn::Xor(hn::Lt(from, zero), hn::Lt(to, zero));
    if (hn::AllFalse(lanes, crosses)) return crosses;
    const V at_a = along(wall, a), at_b = along(wall, b);
    const V at = hn::Add(at_a, hn::Mul(hn::Div(from, hn::Sub(from, to)), hn::Sub(at_b, at_a)));
    return hn::And(crosses, hn::And(hn::Ge(at, zero), hn::Le(at, all(wall.length))));
}

// How much is seen along a leg past all that stands near. left_out: what the leg begins or ends at.
HWY_NOINLINE V past(const Obstruction& near, const PlanV& a, const PlanV& b, const Obstruction::Beside& left_out,
                    float delta) {
    const Leg leg(a, b);
    const V zero = hn::Zero(lanes);
    std::array<V, Obstruction::most> hit, share_of_hit;  // 1 or 0; and what is seen past the edge that is cut off
    std::uint64_t any = 0;
    for (std::size_t w = 0; w < near.walls.size(); ++w) {
        if ((left_out.walls >> w & 1U) != 0) continue;
        const Seen hits_wall = hits(near.walls[w], a, b);
        if (hn::AllFalse(lanes, hits_wall)) continue;
        any |= std::uint64_t{1} << w;
        hit[w] = hn::IfThenElseZero(hits_wall, all(1));
        share_of_hit[w] = zero;
    }
    V share = all(1);
    for (std::size_t e = 0; e < near.edges.size(); ++e) {
        if ((left_out.edges >> e & 1U) != 0) continue;
        const Obstruction::Edge& edge = near.edges[e];
        const V distance = leg.distance(edge.at);
        const Seen passes = hn::And(leg.passes(edge.at), hn::Lt(distance, all(delta)));
        if (hn::AllFalse(lanes, passes)) continue;
        V cut = zero;
        for (std::uint64_t w = edge.walls & any; w != 0; w &= w - 1)
            cut = hn::Max(cut, hit[static_cast<std::size_t>(std::countr_zero(w))]);
        const Seen is_cut = hn::Gt(cut, zero);
        share = hn::Min(share, hn::IfThenElse(hn::AndNot(is_cut, passes), share_past(distance, delta), all(1)));
        const V through = hn::IfThenElseZero(hn::And(is_cut, passes), share_past(hn::Neg(distance), delta));
        for (std::uint64_t w = edge.walls & any; w != 0; w &= w - 1) {
            V& of_wall = share_of_hit[static_cast<std::size_t>(std::countr_zero(w))];
            of_wall = hn::Max(of_wall, through);
        }
    }
    for (std::uint64_t w = any; w != 0; w &= w - 1) {
        const auto n = static_cast<std::size_t>(std::countr_zero(w));
        share = hn::Min(share, hn::IfThenElse(hn::Gt(hit[n], zero), share_of_hit[n], all(1)));
    }
    return share;
}

HWY_INLINE Obstruction::Beside both(const Obstruction::Beside& a, const Obstruction::Beside& b) {
    return {a.walls | b.walls, a.edges | b.edges};
}

HWY_INLINE PlanPoint reflected(const Wall& wall, const PlanPoint& p) {
    const float twice = 2 * wall.distance(p.x, p.z);
    return {p.x - twice * wall.nx, p.z - twice * wall.nz};
}

// How much of a path is within a wall where it meets it at s along the wall; leg: to what lies behind it; walked: how long the path is
// before the leg. An edge has a say where the unfolded path passes it, as it has in what is seen past it.
HWY_INLINE V share_within(const Wall& wall, V s, const Leg& leg, V walked, float delta, float slack) {
    const V rest = hn::Sub(all(wall.length), s);
    V share = all(1);
    const auto end = [&](V within, bool is_edge, const PlanPoint& at) HWY_ATTR {
        if (is_edge) {
            const V distance = hn::IfThenElse(leg.passes(at, walked), leg.distance(at), all(Box::inf));
            share = hn::Min(share, share_past(hn::CopySign(distance, within), delta));
        } else {
            share = hn::IfThenElseZero(hn::Ge(within, all(-slack)), share);
        }
    };
    end(s, wall.edge_before, wall.a);
    end(rest, wall.edge_after, wall.end());
    return share;
}

// The places that a path meets, and how much of it there is.
struct Path {
    std::array<PlanV, longest_path + 2> point;  // from the watcher on
    V share;
};

// From x to y. Nothing of it if y is on the wrong side.
HWY_INLINE Path path_to(const PathQuestion& question, const PlanV& x, const PlanPoint& y) {
    const WallPath& walls = question.path;
    const std::size_t n = walls.length;
    std::array<PlanPoint, longest_path + 1> target{};  // y as it is seen from before each wall
    target[n] = y;
    for (std::size_t m = n; m-- > 0;) target[m] = reflected(walls.wall[m], target[m + 1]);
    Path path;
    path.point[0] = x;
    path.share = all(1);
    V walked = hn::Zero(lanes);
    const float slack = for_rounding_at_corners * question.support_radius;
    for (std::size_t m = 0; m < n; ++m) {
        const Wall& wall = walls.wall[m];
        const PlanV& from = path.point[m];
        const PlanV to = all_of(target[m]);
        const float behind = wall.distance(target[m].x, target[m].z);
        const V before = distance_of(wall, from), apart = hn::Sub(before, all(behind));
        const Seen meets = hn::And(hn::Ge(before, all(-slack)), hn::Gt(apart, hn::Zero(lanes)));
        if (behind > slack || hn::AllFalse(lanes, meets)) {
            path.share = hn::Zero(lanes);
            return path;
        }
        const Leg leg(from, to);
        const V t = hn::Div(before, hn::Max(apart, all(1e-12F)));
        path.point[m + 1] = {hn::Add(from.x, hn::Mul(t, leg.way.x)), hn::Add(from.z, hn::Mul(t, leg.way.z))};
        path.share = hn::IfThenElseZero(meets, path.share);
        if (question.obstruction == nullptr) continue;
        path.share =
            hn::Min(path.share, share_within(wall, along(wall, path.point[m + 1]), leg, walked, question.delta, slack));
        walked = hn::Add(walked, hn::Mul(t, hn::Sqrt(leg.square)));
    }
    path.point[n + 1] = all_of(y);
    if (question.obstruction == nullptr || question.obstruction->walls.empty()) return path;
    for (std::size_t m = 0; m <= n; ++m) {
        if (hn::AllFalse(lanes, hn::Gt(path.share, hn::Zero(lanes)))) return path;
        const Obstruction::Beside before = m > 0 ? walls.beside[m - 1] : Obstruction::Beside{};
        const Obstruction::Beside after = m < n ? walls.beside[m] : Obstruction::Beside{};
        path.share = hn::Min(path.share, past(*question.obstruction, path.point[m], path.point[m + 1],
                                              both(before, after), question.delta));
    }
    return path;
}

// The keys of paths.
HWY_INLINE hn::Vec<Whole> key_of(const PathQuestion& question, const Path& path) {
    const Whole whole;
    const auto key_with = [&](std::size_t walls_before) HWY_ATTR {
        const bool between = walls_before > 0 && walls_before < question.path.length;
        const std::int32_t order = between ? question.order : question.like;
        return hn::Set(whole, order * SightKey::places_of_middle + static_cast<std::int32_t>(walls_before));
    };
    if (question.ground == nullptr) return key_with(0);
    const std::size_t n = question.path.length;
    V length = hn::Zero(lanes);
    std::array<V, longest_path + 1> of_leg;
    for (std::size_t m = 0; m <= n; ++m) {
        of_leg[m] = hn::Sqrt(square_of(minus(path.point[m + 1], path.point[m])));
        length = hn::Add(length, of_leg[m]);
    }
    V left = hn::Mul(all(0.5F), length);
    PlanV middle = path.point[0];
    auto key = hn::Zero(whole);
    Seen is_left = hn::FirstN(lanes, cluster_size);
    for (std::size_t m = 0; m <= n; ++m) {
        const Seen here = hn::And(is_left, m == n ? is_left : hn::Le(left, of_leg[m]));
        const V share = hn::Div(left, hn::Max(of_leg[m], all(1e-12F)));
        const PlanV way = minus(path.point[m + 1], path.point[m]);
        middle.x = hn::IfThenElse(here, hn::Add(path.point[m].x, hn::Mul(share, way.x)), middle.x);
        middle.z = hn::IfThenElse(here, hn::Add(path.point[m].z, hn::Mul(share, way.z)), middle.z);
        key = hn::IfThenElse(hn::RebindMask(whole, here), key_with(m), key);
        is_left = hn::AndNot(here, is_left);
        left = hn::Sub(left, of_leg[m]);
    }
    const GroundFacets& ground = *question.ground;
    if (ground.is_one_plane()) return key;
    const auto in_cells = [&](V at, float lo, int cells) HWY_ATTR {
        const V u = hn::Mul(hn::Sub(at, all(lo)), all(ground.per_m));
        return hn::Min(hn::Max(u, hn::Zero(lanes)), all(static_cast<float>(cells) - 0.5F));
    };
    const V u = in_cells(middle.x, ground.x, ground.nx), v = in_cells(middle.z, ground.z, ground.nz);
    const auto i = hn::ConvertTo(whole, u), k = hn::ConvertTo(whole, v);
    const Seen upper = hn::Gt(hn::Sub(v, hn::ConvertTo(lanes, k)), hn::Sub(u, hn::ConvertTo(lanes, i)));
    const auto cell = hn::Add(hn::Mul(k, hn::Set(whole, ground.nx)), i);
    const auto one = hn::IfThenElseZero(hn::RebindMask(whole, upper), hn::Set(whole, 1));
    const auto plane = hn::GatherIndex(whole, ground.plane_of.data(), hn::Add(hn::Add(cell, cell), one));
    return hn::Add(hn::Mul(plane, hn::Set(whole, question.orders * SightKey::places_of_middle)), key);
}

void FindPaths(const ClusterPositions& places, const NearParticlesOfCluster& near, const PathQuestion& question,
               PathsFound& found) {
    const Whole whole;
    const Vec3V x = load(ConstVectorArrays{places.x.data(), places.y.data(), places.z.data()}, 0);
    const Vec3V image = apply(question.path.map, x);
    const float reach = (1 + for_rounding) * question.support_radius;  // which are nearer is for append_seen() to say
    const V reach2 = all(reach * reach);
    for (std::size_t k = 0; k < near.size; ++k) {
        float* const shares = found.share.data() + k * cluster_size;
        std::int32_t* const keys = found.key.data() + k * cluster_size;
        const Vec3V way{hn::Sub(image.x, all(near.x[k])), hn::Sub(image.y, all(near.y[k])),
                        hn::Sub(image.z, all(near.z[k]))};
        const V r2 = hn::Add(hn::Add(hn::Mul(way.x, way.x), hn::Mul(way.y, way.y)), hn::Mul(way.z, way.z));
        const Seen is_near = hn::Lt(r2, reach2);
        if (question.order == 0) found.seen[k] = 0;
        if (hn::AllFalse(lanes, is_near)) continue;
        const Path path = path_to(question, {x.x, x.z}, {near.x[k], near.z[k]});
        V share =
            hn::ConvertTo(lanes, hn::NearestInt(hn::Mul(hn::IfThenElseZero(is_near, path.share), all(whole_share))));
        Seen counts = hn::Gt(share, hn::Zero(lanes));
        if (found.seen[k] != 0) {
            const V known = hn::LoadU(lanes, shares);
            counts = hn::Gt(share, known);
            share = hn::Max(share, known);
        }
        const unsigned new_lanes = bits_of(counts);
        if (new_lanes == 0) continue;
        hn::StoreU(share, lanes, shares);
        if (question.has_keys) {
            const auto key = key_of(question, path);
            const auto known = found.seen[k] == 0 ? key : hn::LoadU(whole, keys);
            hn::StoreU(hn::IfThenElse(hn::RebindMask(whole, counts), key, known), whole, keys);
        }
        found.seen[k] = static_cast<std::uint16_t>(found.seen[k] | new_lanes);
        const Seen some = hn::And(hn::Gt(share, hn::Zero(lanes)), hn::Lt(share, all(whole_share)));
        found.in_part = found.in_part || !hn::AllFalse(lanes, some);
    }
}

std::size_t FindByKey(const PathsFound& found, std::size_t near, std::vector<SeenByKey>& lists) {
    const Whole whole;
    std::size_t count = 0, last = 0;
    for (std::size_t k = 0; k < near; ++k) {
        const auto keys = hn::LoadU(whole, found.key.data() + k * cluster_size);
        for (unsigned left = found.seen[k]; left != 0;) {
            const std::int32_t key = found.key[k * cluster_size + static_cast<std::size_t>(std::countr_zero(left))];
            const unsigned same = bits_of(hn::RebindMask(lanes, hn::Eq(keys, hn::Set(whole, key)))) & left;
            if (last >= count || lists[last].key.value != key) {
                for (last = 0; last < count && lists[last].key.value != key;) ++last;
                if (last == count) {
                    if (++count > lists.size()) lists.emplace_back();
                    lists[last].key.value = key;
                    lists[last].seen.clear();
                }
            }
            lists[last].seen.push_back({static_cast<std::uint32_t>(k), static_cast<std::uint16_t>(same)});
            left &= ~same;
        }
    }
    return count;
}

std::size_t FindSeenNear(const ClusterPositions& places, const ClusterPositions& images, float support_radius,
                         const GroundPlane* plane, const NearParticlesOfCluster& near, std::span<const SeenNear> seen,
                         const PathsFound& found, std::size_t entries, NeighbourBlock& block, std::uint16_t** shares) {
    const Vec3V image = load(ConstVectorArrays{images.x.data(), images.y.data(), images.z.data()}, 0);
    const V h2 = all(support_radius * support_radius);
    LaneMask* const masks = lane_masks(block);
    V above = hn::Zero(lanes);
    if (plane != nullptr) {
        const Vec3V x = load(ConstVectorArrays{places.x.data(), places.y.data(), places.z.data()}, 0);
        above = hn::Add(hn::Add(hn::Mul(all(plane->n[0]), x.x), hn::Mul(all(plane->n[1]), x.y)),
                        hn::Sub(hn::Mul(all(plane->n[2]), x.z), all(plane->c)));
    }
    for (const SeenNear& one : seen) {
        const std::size_t k = one.k;
        const Vec3V way{hn::Sub(image.x, all(near.x[k])), hn::Sub(image.y, all(near.y[k])),
                        hn::Sub(image.z, all(near.z[k]))};
        const V r2 = hn::Add(hn::Add(hn::Mul(way.x, way.x), hn::Mul(way.y, way.y)), hn::Mul(way.z, way.z));
        Seen is_near = hn::Lt(r2, h2);
        if (plane != nullptr) {
            const float other = plane->distance({near.x[k], near.y[k], near.z[k]});
            is_near = hn::And(is_near, hn::Gt(hn::Add(above, all(other)), hn::Zero(lanes)));
        }
        const unsigned mask = bits_of(is_near) & one.lanes;
        if (mask == 0) continue;
        block.j[entries] = near.j[k];
        masks[entries] = static_cast<LaneMask>(mask);
        ++entries;
        if (shares == nullptr) continue;
        put_together(hn::NearestInt(hn::LoadU(lanes, found.share.data() + k * cluster_size)), mask, *shares);
        *shares += std::popcount(mask);
    }
    return entries;
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid {

HWY_EXPORT(FindPaths);
HWY_EXPORT(FindByKey);
HWY_EXPORT(FindSeenNear);

void find_paths(const ClusterPositions& places, const NearParticlesOfCluster& near, const PathQuestion& question,
                PathsFound& found) {
    HWY_DYNAMIC_DISPATCH(FindPaths)(places, near, question, found);
}

std::size_t sort_by_key(const PathsFound& found, std::size_t near, std::vector<SeenByKey>& lists) {
    return HWY_DYNAMIC_DISPATCH(FindByKey)(found, near, lists);
}

std::size_t append_seen(const ClusterPositions& places, const ClusterPositions& image, float support_radius,
                        const GroundPlane* plane, const NearParticlesOfCluster& near, std::span<const SeenNear> seen,
                        const PathsFound& found, std::size_t entries, NeighbourBlock& block, std::uint16_t** shares) {
    return HWY_DYNAMIC_DISPATCH(FindSeenNear)(places, image, support_radius, plane, near, seen, found, entries, block,
                                              shares);
}

Obstruction::Beside Obstruction::beside(std::uint32_t wall, const Wall& at) const {
    Beside bits;
    const PlanPoint end = at.end();
    for (std::size_t w = 0; w < numbers.size(); ++w) {
        const bool goes_on = (at.edge_before && numbers[w] == at.before) || (at.edge_after && numbers[w] == at.after);
        if (numbers[w] == wall || goes_on) bits.walls |= std::uint64_t{1} << w;
    }
    const auto is_at = [](const PlanPoint& a, const PlanPoint& b) { return length_of(a.x - b.x, a.z - b.z) < 1e-4F; };
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (is_at(edges[e].at, at.a) || is_at(edges[e].at, end)) bits.edges |= std::uint64_t{1} << e;
    }
    return bits;
}

void PathsFound::make_room(std::size_t near, std::size_t lanes) {
    in_part = false;
    if (seen.size() >= near && share.size() >= near * lanes) return;
    seen.resize(near + near / 4);
    share.resize(seen.size() * lanes);
    key.resize(seen.size() * lanes);
}

}  // namespace wade::fluid
#endif
