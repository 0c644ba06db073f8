#pragma once
// What the searches for neighbours have in common: places of clusters, boxes round them, room that grows little.

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fluid_server/neighbours/neighbour_lists.hpp"

namespace wade::fluid {

// All lanes have a place, so that loops over them are vectors.
inline ClusterPositions places_of(const Particles& p, std::size_t begin, std::size_t end, std::size_t size) {
    ClusterPositions places;
    places.size = size;
    const auto take = [&](const std::vector<float>& from, std::array<float, largest_cluster>& to) {
        if (end - begin == largest_cluster) {
            std::copy_n(from.data() + begin, largest_cluster, to.data());
            return;
        }
        for (std::size_t l = 0; l < largest_cluster; ++l) to[l] = from[std::min(begin + l, end - 1)];
    };
    take(p.x, places.x), take(p.y, places.y), take(p.z, places.z);
    return places;
}

template <typename Map>
ClusterPositions mapped(const ClusterPositions& places, const Map& map) {
    ClusterPositions image;
    image.size = places.size;
    for (std::size_t l = 0; l < largest_cluster; ++l) {
        const Vec3 x = map({places.x[l], places.y[l], places.z[l]});
        image.x[l] = x[0], image.y[l] = x[1], image.z[l] = x[2];
    }
    return image;
}

inline Box box_round(const ClusterPositions& places) {
    Box box;
    const auto grow = [&](std::size_t axis, const std::array<float, largest_cluster>& x) {
        float lo = Box::inf, hi = -Box::inf;
#pragma omp simd reduction(min : lo) reduction(max : hi)
        for (std::size_t l = 0; l < largest_cluster; ++l) lo = std::min(lo, x[l]), hi = std::max(hi, x[l]);
        box.lo[axis] = lo, box.hi[axis] = hi;
    };
    grow(0, places.x), grow(1, places.y), grow(2, places.z);
    return box;
}

// More than what rounding moves, as a fraction of the support radius.
inline constexpr float for_rounding = 0.001F;

// As vector::resize to at least `size`, with less room to spare.
template <typename T>
void make_room(std::vector<T>& list, std::size_t size) {
    if (list.size() >= size) return;
    if (list.capacity() < size) list.reserve(size + size / 16);
    list.resize(list.capacity());
}

// As vector::push_back, with less room to spare.
template <typename T>
void add(std::vector<T>& list, const T& one_more) {
    if (list.size() == list.capacity()) list.reserve(list.size() + list.size() / 16 + 4);
    list.push_back(one_more);
}

}  // namespace wade::fluid
