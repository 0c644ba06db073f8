#pragma once
// A mirror: what turns a particle into the image that its neighbours see behind the face of a solid.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace wade::fluid {

using Vec3 = std::array<float, 3>;

// A symmetric linear map that acts in the x-y plane and along z: (xx u_x + xy u_y, xy u_x + yy u_y, zz u_z).
struct PlaneMap {
    float xx = 1, xy = 0, yy = 1, zz = 1;

    bool operator==(const PlaneMap&) const = default;

    [[nodiscard]] Vec3 operator()(const Vec3& u) const {
        return {xx * u[0] + xy * u[1], xy * u[0] + yy * u[1], zz * u[2]};
    }
};

// The product a b of two maps that commute, so that it is symmetric as well.
inline PlaneMap product(const PlaneMap& a, const PlaneMap& b) {
    return {a.xx * b.xx + a.xy * b.xy, a.xx * b.xy + a.xy * b.yy, a.xy * b.xy + a.yy * b.yy, a.zz * b.zz};
}

// A rigid map of places, R x + shift.
struct RigidMap {
    PlaneMap rotation;
    Vec3 shift{};  // m

    bool operator==(const RigidMap&) const = default;

    [[nodiscard]] Vec3 operator()(const Vec3& x) const {
        const Vec3 r = rotation(x);
        return {r[0] + shift[0], r[1] + shift[1], r[2] + shift[2]};
    }
};

// A rotation, or one with a reflection, of any axis: Q u, and Q^T u back.
struct TurnMap {
    std::array<float, 9> q{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row by row

    bool operator==(const TurnMap&) const = default;

    [[nodiscard]] Vec3 operator()(const Vec3& u) const {
        return {q[0] * u[0] + q[1] * u[1] + q[2] * u[2], q[3] * u[0] + q[4] * u[1] + q[5] * u[2],
                q[6] * u[0] + q[7] * u[1] + q[8] * u[2]};
    }
    [[nodiscard]] Vec3 back(const Vec3& u) const {
        return {q[0] * u[0] + q[3] * u[1] + q[6] * u[2], q[1] * u[0] + q[4] * u[1] + q[7] * u[2],
                q[2] * u[0] + q[5] * u[1] + q[8] * u[2]};
    }
};

// What walls and ground at any angle make of places, Q x + shift.
struct TurnedMap {
    TurnMap turn;
    Vec3 shift{};  // m

    bool operator==(const TurnedMap&) const = default;

    [[nodiscard]] Vec3 operator()(const Vec3& x) const {
        const Vec3 r = turn(x);
        return {r[0] + shift[0], r[1] + shift[1], r[2] + shift[2]};
    }
};

// Across the plane n . x = c first, and then as `after` says.
inline TurnedMap reflected_first(const TurnedMap& after, const Vec3& n, float c) {
    const Vec3 qn = after.turn(n);
    TurnedMap map = after;
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) map.turn.q[3 * row + column] -= 2 * qn[row] * n[column];
        map.shift[row] += 2 * c * qn[row];
    }
    return map;
}

// Whether two maps differ by rounding only, as those of one image by other orders of walls do; at: near what is mapped; length: of it, m.
inline bool is_same(const TurnedMap& a, const TurnedMap& b, const Vec3& at, float length) {
    constexpr float same_map = 1e-4F, of_coordinates = 1e-6F;
    for (std::size_t k = 0; k < 9; ++k) {
        if (std::abs(a.turn.q[k] - b.turn.q[k]) > same_map) return false;
    }
    const Vec3 by_a = a(at), by_b = b(at);
    for (std::size_t k = 0; k < 3; ++k) {
        if (std::abs(by_a[k] - by_b[k]) > same_map * length + of_coordinates * std::abs(a.shift[k])) return false;
    }
    return true;
}

// The velocity of an image as viscosity sees it, M u + shift: mirrored at a face along which water slips, and such that
// the mean of particle and image is the velocity of the face where water sticks (Morris et al. 1997).
struct ImageVelocity {
    PlaneMap map;
    Vec3 shift{};
    bool sticks = false;  // one of the faces so far is one where water sticks

    bool operator==(const ImageVelocity&) const = default;
};

// A reflection across one, two or three faces. Those normal to the axes: x_k -> 2 plane_k - x_k. One of them may be a
// facet of the bed instead, a plane of normal (nx, ny, 0).
struct Mirror {
    std::array<bool, 3> axis{};
    Vec3 plane{};
    int obstacle = -1;  // obstacle with one of them as a face, or -1
    std::size_t obstacle_axis = 0;
    int facet = -1;         // of the bed, or -1
    bool inclined = false;  // the facet is not level: it stands for axis 1, and these hold
    float nx = 0, ny = 1;   // its unit normal, up
    float px = 0, py = 0;   // a point of it, m
    PlaneMap reflection;    // R, of vectors
    ImageVelocity viscous;

    [[nodiscard]] Vec3 reflect(const Vec3& x) const {
        Vec3 image = x;
        for (std::size_t k = 0; k < 3; ++k) {
            if (axis[k]) {
                image[k] = 2 * plane[k] - x[k];
            }
        }
        if (inclined) {
            const float distance = nx * (x[0] - px) + ny * (x[1] - py);
            image[0] -= 2 * distance * nx;
            image[1] -= 2 * distance * ny;
        }
        return image;
    }

    // The same as a map: its rotation is R, its shift the image of the origin.
    [[nodiscard]] RigidMap map() const { return {reflection, reflect({0, 0, 0})}; }
};

}  // namespace wade::fluid
