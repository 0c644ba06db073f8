#include "fluid_server/steering/flock_sweep.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/steering/flock_sweep.cpp"
#include <hwy/foreach_target.h>

#include "fluid_server/neighbours/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::HWY_NAMESPACE {

using steering::Settings;

// 1 / sqrt(a): root and quotient are rounded as IEEE 754 asks; processors' estimates differ.
HWY_INLINE V reciprocal_sqrt(V a) {
    return hn::Div(all(1), hn::Sqrt(a));
}

// The sums of one vector of particles.
struct FlockSums {
    Vec3V force, lost;  // m/s^2; sum of loss rate times velocity of the neighbour
    V loss;             // sum of loss rates, 1/s
    Vec3V seen_velocity;
    V seen;  // neighbours of the alignment
};

// Returns whether a neighbour, in the direction -way / r, is within an angle of the particle's velocity.
HWY_INLINE hn::Mask<Lanes> looks_at(V ahead, float cosine, hn::Mask<Lanes> stands) {
    return hn::Or(stands, hn::Ge(ahead, all(cosine)));
}

template <bool plain>
HWY_INLINE void sum_flock_of(std::size_t b, const Particles& p, const NeighbourLists& lists, const Settings& s,
                             const VectorArrays& out) {
    const NeighbourBlock& block = lists.blocks[b];
    const ConstVectorArrays velocity{p.vx.data(), p.vy.data(), p.vz.data()};
    const std::vector<float>& radius_factor = steering::radius_factors(p);
    const std::vector<float>& mass_factor = steering::mass_factors(p);
    const V tiny = all(1e-12F * s.separation_radius * s.separation_radius);
    const V radius2 = all(s.separation_radius * s.separation_radius);
    const V most = all(1 / (steering::nearest_fraction * steering::nearest_fraction));
    const V cohesion2 = all(s.cohesion_radius * s.cohesion_radius);
    const V pull_from2 = all(s.no_pull_within * s.no_pull_within);
    const V per_loss_radius = all(1 / s.loss_radius);
    for_each_vector(p.count, b, [&](std::size_t i, std::size_t cluster) {
        const Vec3V x = load(places(p), i);
        const Vec3V v = load(velocity, i);
        FlockSums sums{zero3(), zero3(), hn::Zero(lanes), zero3(), hn::Zero(lanes)};
        Vec3V forward = zero3();
        V factor_i = all(1);
        hn::Mask<Lanes> stands = hn::Eq(factor_i, factor_i);
        if constexpr (!plain) {
            const V v2 = dot(v, v);
            stands = hn::Eq(v2, hn::Zero(lanes));
            forward = times(hn::IfThenZeroElse(stands, reciprocal_sqrt(hn::Max(v2, all(1e-30F)))), v);
            factor_i = hn::LoadU(lanes, radius_factor.data() + i);
        }
        for_each_segment(block, cluster, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
            const Vec3V seen{hn::Add(x.x, all(view.map.shift[0])), hn::Add(x.y, all(view.map.shift[1])),
                             hn::Add(x.z, all(view.map.shift[2]))};
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t j = block.j[k];
                const Vec3V way = way_from(seen, p, j);
                const Vec3V vj{all(p.vx[j]), all(p.vy[j]), all(p.vz[j])};
                const V r2 = hn::Max(dot(way, way), tiny);
                const V inverse_r = reciprocal_sqrt(r2);
                const V r = hn::Mul(r2, inverse_r);
                V reach2 = radius2;
                V from2 = pull_from2;
                if constexpr (!plain) {
                    const V mean = hn::Mul(all(0.5F), hn::Add(factor_i, all(radius_factor[j])));
                    reach2 = hn::Mul(reach2, hn::Mul(mean, mean));
                    from2 = hn::Mul(from2, hn::Mul(mean, mean));
                }
                const V q2 = hn::Min(hn::Mul(reach2, hn::Mul(inverse_r, inverse_r)), most);
                V push = hn::Mul(all(s.separation), hn::Max(hn::Sub(q2, all(1)), hn::Zero(lanes)));
                const auto pulls = hn::And(hn::Lt(r2, cohesion2), hn::Ge(r2, from2));
                V pull = hn::IfThenElseZero(pulls, hn::MulAdd(all(s.pull_growth), r2, all(s.pull)));
                if constexpr (!plain) {
                    const V ahead = hn::Mul(hn::Sub(hn::Zero(lanes), dot(forward, way)), inverse_r);
                    push = hn::IfThenElseZero(looks_at(ahead, s.separation_cos, stands), push);
                    pull = hn::IfThenElseZero(looks_at(ahead, s.cohesion_cos, stands), pull);
                    const auto follows = hn::And(hn::And(hn::Lt(r, all(s.alignment_radius)), hn::Gt(r2, tiny)),
                                                 looks_at(ahead, s.alignment_cos, stands));
                    const V one = hn::IfThenElseZero(follows, all(1));
                    sums.seen = hn::Add(sums.seen, one);
                    sums.seen_velocity = add_product(one, vj, sums.seen_velocity);
                }
                sums.force = add_product(hn::Mul(hn::Sub(push, pull), inverse_r), way, sums.force);
                const V near = hn::Max(hn::NegMulAdd(r, per_loss_radius, all(1)), hn::Zero(lanes));
                sums.loss = hn::Add(sums.loss, near);
                sums.lost = add_product(near, vj, sums.lost);
            }
        });
        // A particle is in its own list: in the absolute form of the loss it is no neighbour of its own.
        const V relative = all(s.loss_relative);
        const V own = hn::Sub(sums.loss, hn::Sub(all(1), relative));
        const Vec3V loss{hn::MulSub(own, v.x, hn::Mul(relative, sums.lost.x)),
                         hn::MulSub(own, v.y, hn::Mul(relative, sums.lost.y)),
                         hn::MulSub(own, v.z, hn::Mul(relative, sums.lost.z))};
        Vec3V a = add_product(all(-s.loss), loss, sums.force);
        if constexpr (!plain) {
            const auto alone = hn::Eq(sums.seen, hn::Zero(lanes));
            const V share = hn::IfThenZeroElse(alone, hn::Div(all(s.alignment), hn::Max(sums.seen, all(1))));
            const V weight = hn::IfThenZeroElse(alone, all(-s.alignment));
            a = add_product(share, sums.seen_velocity, add_product(weight, v, a));
            // Beyond the last particle nothing has a mass.
            const V mass = hn::LoadU(lanes, mass_factor.data() + i);
            a = times(hn::Div(all(1), hn::IfThenElse(hn::Gt(mass, hn::Zero(lanes)), mass, all(1))), a);
        }
        store(a, out, i);
    });
}

void SumFlock(std::size_t b, const Particles& p, const NeighbourLists& lists, const Settings& s,
              const VectorArrays& out) {
    s.plain ? sum_flock_of<true>(b, p, lists, s, out) : sum_flock_of<false>(b, p, lists, s, out);
}

}  // namespace wade::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid {
HWY_EXPORT(SumFlock);

namespace steering {
void sum_flock(std::size_t block, const Particles& p, const NeighbourLists& lists, const Settings& settings,
               const VectorArrays& acceleration) {
    HWY_DYNAMIC_DISPATCH(SumFlock)(block, p, lists, settings, acceleration);
}
}  // namespace steering

}  // namespace wade::fluid
#endif
