#pragma once
// The water of a case of open-channel flow, by any model that solves for it: what such a case sets and measures.

#include <array>
#include <functional>
#include <memory>

#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/particles/river_measures.hpp"
#include "profiles.hpp"
#include "run.hpp"

namespace wade::validation {

// A piece of water: a particle, or a cell of a grid.
struct Parcel {
    double x = 0, z = 0;  // m, of its middle
    double volume = 0;    // m^3
    double vx = 0;        // m/s
};

class Water {
 public:
    Water() = default;
    Water(const Water&) = delete;
    Water& operator=(const Water&) = delete;
    virtual ~Water() = default;

    [[nodiscard]] virtual const Scene& scene() const = 0;

    using VelocityField = std::function<std::array<double, 3>(const std::array<double, 3>& place)>;
    virtual void set_velocity(const VelocityField& field) = 0;

    // One frame of the scene.
    virtual void advance(Cost& cost) = 0;

    // Adds the water as it is to the columns.
    virtual void add_to(Columns& columns) const = 0;
    virtual void for_each_parcel(const std::function<void(const Parcel&)>& body) const = 0;
    [[nodiscard]] virtual fluid::RiverMeasures measures() const = 0;
    [[nodiscard]] double volume() const;  // m^3

    // Smallest x of the water, m; `none` if there is no water.
    [[nodiscard]] virtual double front(double none) const = 0;

    // Signs of trouble that only particles can have: those moved out of solids, layers that an empty stock did not send.
    [[nodiscard]] virtual double position_clamps() const { return 0; }
    [[nodiscard]] virtual double missed_layers() const { return 0; }

    // Integral of the driving acceleration of a recirculating channel, m/s.
    [[nodiscard]] double driving() const { return driving_; }

    // Writes cost, model and size into the result.
    virtual void note(const Cost& cost, Result& result) const = 0;

 protected:
    double driving_ = 0;
};

// The model that the scene names. Throws ConfigurationError for one that solves nothing.
[[nodiscard]] std::unique_ptr<Water> make_water(const Scene& scene);

}  // namespace wade::validation
