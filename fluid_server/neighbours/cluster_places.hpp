#pragma once
// What the searches for neighbours have in common: places of clusters, boxes round them, room that grows little.

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fluid_server/neighbours/neighbour_lists.hpp"

namespace wade::fluid {

inline ClusterPlaces places_of(const Particles& p, std::size_t begin, std::size_t end, std::size_t size) {
    ClusterPlaces places;
    places.size = size;
    for (std::size_t l = 0; l < size; ++l) {
        const std::size_t i = std::min(begin + l, end - 1);
        places.x[l] = p.x[i], places.y[l] = p.y[i], places.z[l] = p.z[i];
    }
    return places;
}

template <typename Map>
ClusterPlaces mapped(const ClusterPlaces& places, const Map& map) {
    ClusterPlaces image;
    image.size = places.size;
    for (std::size_t l = 0; l < places.size; ++l) {
        const Vec3 x = map({places.x[l], places.y[l], places.z[l]});
        image.x[l] = x[0], image.y[l] = x[1], image.z[l] = x[2];
    }
    return image;
}

inline Box box_round(const ClusterPlaces& places) {
    Box box{{Box::inf, Box::inf, Box::inf}, {-Box::inf, -Box::inf, -Box::inf}};
    const auto grow = [&](std::size_t axis, const std::array<float, largest_cluster>& x) {
        for (std::size_t l = 0; l < places.size; ++l) {
            box.lo[axis] = std::min(box.lo[axis], x[l]);
            box.hi[axis] = std::max(box.hi[axis], x[l]);
        }
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
