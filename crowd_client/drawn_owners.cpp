#include "crowd_client/drawn_owners.hpp"

#include <algorithm>
#include <cmath>

namespace wade::crowd {
namespace {

using L = Lanes<float>;

// The sum over the lanes, always in one order: halves are added until four lanes are left.
template <typename Number>
Number total(const Vector<Number>& v) {
    using Eight [[gnu::vector_size(8 * sizeof(Number))]] = Number;
    using Four [[gnu::vector_size(4 * sizeof(Number))]] = Number;
    static_assert(Vector<Number>::count == 16);
    Eight eights[2];
    std::memcpy(&eights, &v.part, sizeof eights);
    const Eight eight = eights[0] + eights[1];
    Four fours[2];
    std::memcpy(&fours, &eight, sizeof fours);
    const Four four = fours[0] + fours[1];
    return (four[0] + four[2]) + (four[1] + four[3]);
}

}  // namespace

void DrawnOwners::begin_row(const Claiming& claiming, const RowBand& band, int row) {
    if (!band.has(row)) return;
    const RowEntries entries = entries_of(claiming.cells, row);
    const std::size_t n = entries.last - entries.first;
    Row& here = row_of(claiming, row);
    here.first = entries.first;
    here.sums.assign(n, {});
    make_room(here.goal_x, n);
    make_room(here.goal_z, n);
    for (std::size_t i = 0; i < n; ++i) {
        const Vector2d& way = claiming.walkers.goal_offset[claiming.cells.walker[entries.first + i]];
        const auto x = static_cast<float>(way.x()), z = static_cast<float>(way.y());
        const float square = x * x + z * z;
        const float scale = square > 0 ? 1 / std::sqrt(square) : 0;
        here.goal_x[i] = x * scale;
        here.goal_z[i] = z * scale;
    }
    if (claiming.bodies == nullptr) return;
    make_room(here.discount, n);
    for (std::size_t i = 0; i < n; ++i) {
        here.discount[i] = static_cast<float>(claiming.walkers.discount[claiming.cells.walker[entries.first + i]]);
    }
}

void DrawnOwners::deal_cell(const Claiming& claiming, const RowBand& band, int column, int row) {
    draw_markers(markers_, claiming.markers.drawn, column, row);
    if (markers_.count == 0) return;
    find_candidates(candidates_, claiming.cells, claiming.bodies, markers_, column, row);
    claim(claims_, markers_, candidates_, claiming.cells, claiming.radius);
    const bool with_bodies = claiming.bodies != nullptr;
    if (with_bodies) find_contested(claims_, markers_, candidates_, claiming.walkers.contest_distance);
    pair_tests += markers_.count * (candidates_.count - 1);

    look_up_goals(claiming, band, column, row);
    weigh(with_bodies);
    if (with_bodies) {
        add_to_owners<true>(claiming, band, column, row);
    } else {
        add_to_owners<false>(claiming, band, column, row);
    }
}

// Rows of other bands belong to other threads: what is weighed for them here is added to nobody.
void DrawnOwners::look_up_goals(const Claiming& claiming, const RowBand& band, int column, int row) {
    for (std::vector<float>* table : {&goal_x_, &goal_z_, &discount_}) {
        make_table(*table, candidates_.count);
        (*table)[0] = 0;
    }
    for_each_row_of_candidates(claiming.cells, column, row,
                               [&](int r, std::uint32_t first, std::uint32_t last, std::size_t candidate) {
                                   if (!band.has(r)) return;
                                   const Row& here = row_of(claiming, r);
                                   const std::size_t from = first - here.first, n = last - first;
                                   std::copy_n(here.goal_x.data() + from, n, goal_x_.data() + candidate);
                                   std::copy_n(here.goal_z.data() + from, n, goal_z_.data() + candidate);
                                   if (claiming.bodies == nullptr) return;
                                   std::copy_n(here.discount.data() + from, n, discount_.data() + candidate);
                               });
}

void DrawnOwners::weigh(bool with_bodies) {
    const std::size_t places = L::padded(markers_.count), size = candidates_.count;
    for (std::vector<float>* v : {&weight_, &x_, &z_}) make_room(*v, places);
    for (std::size_t m = 0; m < places; m += L::count) {
        const L::Integers owner = L::load(claims_.owner.data() + m);
        const L::Reals x = L::load(markers_.x.data() + m) - look_up(candidates_.x, size, owner);
        const L::Reals z = L::load(markers_.z.data() + m) - look_up(candidates_.z, size, owner);
        const L::Reals along = look_up(goal_x_, size, owner) * x + look_up(goal_z_, size, owner) * z;
        const L::Reals square = x * x + z * z;
        const L::Reals distance = square_root(choose<float>(1e-20F < square, square, 1e-20F));
        const L::Reals ahead = distance + along;
        L::Reals f = choose<float>(0 < ahead, ahead, 0) / (distance + distance * distance);
        if (with_bodies) {
            f *= 1 - look_up(discount_, size, owner) * L::load(claims_.contested.data() + m);
        }
        L::store(weight_.data() + m, f);
        L::store(x_.data() + m, f * x);
        L::store(z_.data() + m, f * z);
    }
}

template <bool with_bodies>
void DrawnOwners::add_to_owners(const Claiming& claiming, const RowBand& band, int column, int row) {
    const std::size_t places = L::padded(markers_.count);
    const std::int32_t* const owners = claims_.owner.data();
    const float* const weight = weight_.data();
    const float* const x = x_.data();
    const float* const z = z_.data();
    const float* const contested = with_bodies ? claims_.contested.data() : nullptr;
    for_each_row_of_candidates(claiming.cells, column, row,
                               [&](int r, std::uint32_t first, std::uint32_t last, std::size_t candidate) {
                                   if (!band.has(r)) return;
                                   Row& here = row_of(claiming, r);
                                   Sums* const sums = here.sums.data() + (first - here.first);
                                   for (std::uint32_t k = 0; k < last - first; ++k) {
                                       Sums s = sums[k];
                                       const auto whose = static_cast<std::int32_t>(candidate + k);
                                       for (std::size_t m = 0; m < places; m += L::count) {
                                           const L::Integers own = L::load(owners + m) == whose;
                                           s.weight = choose(own, s.weight + L::load(weight + m), s.weight);
                                           s.x = choose(own, s.x + L::load(x + m), s.x);
                                           s.z = choose(own, s.z + L::load(z + m), s.z);
                                           s.owned += own;
                                           if constexpr (with_bodies)
                                               s.contested += own & (L::load(contested + m) != 0);
                                       }
                                       sums[k] = s;
                                   }
                               });
}

void DrawnOwners::finish(const Claiming& claiming, std::uint32_t entry, std::uint32_t image, int row) {
    const Row& here = row_of(claiming, row);
    Sums s = here.sums[entry - here.first];
    if (image != WalkerCells::none) {
        const Sums& other = here.sums[image - here.first];
        s.weight += other.weight, s.x += other.x, s.z += other.z;
        s.owned += other.owned, s.contested += other.contested;
    }
    const std::uint32_t k = claiming.cells.walker[entry];
    const float weight = total(s.weight);
    claiming.motion.vector[k] = Vector2d::Zero();
    if (weight > 0) {
        claiming.motion.vector[k] = {static_cast<double>(total(s.x) / weight),
                                     static_cast<double>(total(s.z) / weight)};
    }
    claiming.motion.owned[k] = static_cast<std::uint32_t>(-total(s.owned));
    if (claiming.bodies != nullptr) {
        claiming.motion.contested[k] = static_cast<std::uint32_t>(-total(s.contested));
    }
}

}  // namespace wade::crowd
