#include "crowd_client/markers/drawn_owners.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace wade::crowd {
namespace {

using L = Lanes<float>;

// The sum of both and over their lanes, always in one order: halves are added until one is left.
MarkerShare total(const OwnerSums& a, const OwnerSums& b) {
    constexpr std::size_t lanes = L::count;
    std::array<MarkerShare, lanes / 2> sums;
    for (std::size_t k = 0; k < lanes / 2; ++k) sums[k] = (a[k] + b[k]) + (a[k + lanes / 2] + b[k + lanes / 2]);
    for (std::size_t half = lanes / 4; half > 0; half /= 2) {
        for (std::size_t k = 0; k < half; ++k) sums[k] += sums[k + half];
    }
    return sums[0];
}

constexpr OwnerSums nothing{};

MarkerShare load_four(const float* from) {
    MarkerShare v;
    std::memcpy(&v, from, sizeof v);
    return v;
}

}  // namespace

void DrawnOwners::begin_row(const Claiming& claiming, const RowBand& band, int row) {
    if (!band.has(row)) return;
    const RowEntries entries = entries_of(claiming.cells, row);
    const std::size_t n = entries.last - entries.first;
    Row& here = row_of(claiming, row);
    here.first = entries.first;
    here.sums.assign(n, {});
    make_room(here.goal_x, n + beyond_fours);
    make_room(here.goal_z, n + beyond_fours);
    for (std::size_t i = 0; i < n; ++i) {
        const Vector2d& way = claiming.walkers.goal_offset[claiming.cells.walker[entries.first + i]];
        const auto x = static_cast<float>(way.x()), z = static_cast<float>(way.y());
        const float square = x * x + z * z;
        const float scale = square >= std::numeric_limits<float>::min() ? 1 / std::sqrt(square) : 0;
        here.goal_x[i] = x * scale;
        here.goal_z[i] = z * scale;
    }
    if (claiming.bodies == nullptr) return;
    make_room(here.discount, n + beyond_fours);
    for (std::size_t i = 0; i < n; ++i) {
        here.discount[i] = static_cast<float>(claiming.walkers.discount[claiming.cells.walker[entries.first + i]]);
    }
}

void DrawnOwners::deal_cell(const Claiming& claiming, const RowBand& band, int column, int row) {
    draw_markers(markers_, claiming.markers.drawn, column, row);
    if (markers_.count == 0) return;
    find_candidates(candidates_, claiming.cells, claiming.bodies, markers_, column, row);
    look_up_owners(claiming, band, column, row);
    claim(claims_, markers_, candidates_, claiming.cells, column, row, claiming.radius);
    const bool with_bodies = claiming.bodies != nullptr;
    if (with_bodies) find_contested(claims_, markers_, candidates_, claiming.walkers.contest_distance);
    pair_tests += markers_.count * (candidates_.count - 1);

    weigh(with_bodies);
    if (with_bodies) {
        add_to_owners<true>();
    } else {
        add_to_owners<false>();
    }
}

// Rows of other bands belong to other threads: their weights are added to nobody_.
void DrawnOwners::look_up_owners(const Claiming& claiming, const RowBand& band, int column, int row) {
    const bool with_bodies = claiming.bodies != nullptr;
    for (std::vector<float>* table : {&goal_x_, &goal_z_, &discount_}) {
        make_table(*table, candidates_.count + beyond_fours);
        (*table)[0] = 0;
    }
    make_room(sums_of_, candidates_.count + beyond_fours);
    sums_of_[0] = &nobody_;
    for_each_run(claiming.cells, column, row, [&](int r, std::uint32_t first, std::uint32_t last, std::size_t before) {
        const std::size_t place = 1 + before, n = last - first;
        if (!band.has(r)) {
            std::fill_n(sums_of_.data() + place, n, &nobody_);
            return;
        }
        Row& here = row_of(claiming, r);
        const std::size_t from = first - here.first;
        for (std::size_t k = 0; k < n; k += 4) {
            copy_four(goal_x_.data() + place + k, here.goal_x.data() + from + k, 0.0F);
            copy_four(goal_z_.data() + place + k, here.goal_z.data() + from + k, 0.0F);
            if (with_bodies) copy_four(discount_.data() + place + k, here.discount.data() + from + k, 0.0F);
            std::iota(sums_of_.data() + place + k, sums_of_.data() + place + k + 4, here.sums.data() + from + k);
        }
    });
}

Way<float> DrawnOwners::way_of(std::size_t m, const L::Integers& owner, bool with_bodies) const {
    if (with_bodies) {
        return {L::load(claims_.way_x.data() + m), L::load(claims_.way_z.data() + m),
                L::load(claims_.distance.data() + m)};
    }
    const std::size_t size = candidates_.count;
    return way_to(L::load(markers_.x.data() + m), L::load(markers_.z.data() + m), look_up(candidates_.x(), size, owner),
                  look_up(candidates_.z(), size, owner));
}

void DrawnOwners::weigh(bool with_bodies) {
    const std::size_t places = L::padded(markers_.count), size = candidates_.count;
    for (std::vector<float>* v : {&weight_, &x_, &z_}) make_room(*v, places);
    for (std::size_t m = 0; m < places; m += L::count) {
        const L::Integers owner = L::load(claims_.owner.data() + m);
        const Way<float> way = way_of(m, owner, with_bodies);
        const L::Reals &x = way.x, &z = way.z, &distance = way.length;
        const L::Reals along = look_up(goal_x_, size, owner) * x + look_up(goal_z_, size, owner) * z;
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

// Adds each marker in the lane of its weight.
template <bool with_bodies>
void DrawnOwners::add_to_owners() {
    const std::int32_t* const owners = claims_.owner.data();
    OwnerSums* const* const sums_of = sums_of_.data();
    for (std::size_t m = 0; m < markers_.count; m += 4) {  // up to three beyond the last have no owner
        const auto weight = load_four(&weight_[m]), x = load_four(&x_[m]), z = load_four(&z_[m]);
        MarkerShare counted = {1, 1, 1, 1};
        if constexpr (with_bodies) counted += contested_unit * load_four(&claims_.contested[m]);
        const MarkerShare first_weight_x = __builtin_shufflevector(weight, x, 0, 4, 1, 5);
        const MarkerShare last_weight_x = __builtin_shufflevector(weight, x, 2, 6, 3, 7);
        const MarkerShare first_z_counted = __builtin_shufflevector(z, counted, 0, 4, 1, 5);
        const MarkerShare last_z_counted = __builtin_shufflevector(z, counted, 2, 6, 3, 7);
        const std::array<MarkerShare, 4> shares = {__builtin_shufflevector(first_weight_x, first_z_counted, 0, 1, 4, 5),
                                                   __builtin_shufflevector(first_weight_x, first_z_counted, 2, 3, 6, 7),
                                                   __builtin_shufflevector(last_weight_x, last_z_counted, 0, 1, 4, 5),
                                                   __builtin_shufflevector(last_weight_x, last_z_counted, 2, 3, 6, 7)};
        for (std::size_t k = 0; k < 4; ++k) {
            OwnerSums& sums = *sums_of[owners[m + k]];
            sums[(m + k) % L::count] += shares[k];
        }
    }
}

void DrawnOwners::finish(const Claiming& claiming, std::uint32_t entry, std::uint32_t image, int row) {
    const Row& here = row_of(claiming, row);
    const OwnerSums& own = here.sums[entry - here.first];
    const OwnerSums& other = image != WalkerCells::none ? here.sums[image - here.first] : nothing;
    const MarkerShare all = total(own, other);
    const float weight = all[0], x = all[1], z = all[2];
    const auto counted = static_cast<std::uint32_t>(all[3]);
    constexpr auto unit = static_cast<std::uint32_t>(contested_unit);
    const std::uint32_t k = claiming.cells.walker[entry];
    claiming.motion.vector[k] = Vector2d::Zero();
    if (weight > 0) claiming.motion.vector[k] = {static_cast<double>(x / weight), static_cast<double>(z / weight)};
    claiming.motion.owned[k] = counted % unit;
    if (claiming.bodies != nullptr) claiming.motion.contested[k] = counted / unit;
}

}  // namespace wade::crowd
