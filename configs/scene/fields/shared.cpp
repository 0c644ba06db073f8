// Keys that several structs have.

#include "configs/scene/fields/lists.hpp"
#include "configs/scene/interval.hpp"

namespace wade {

void box_fields(Fields& f, Interval& x, Interval& z) {
    const Range range = from(0).to(1e5);
    f.number("x_min_m", x.lo, "m", range, "Smallest x.", required);
    f.number("x_max_m", x.hi, "m", range, "Largest x.", required);
    f.number("z_min_m", z.lo, "m", range, "Smallest z.", required);
    f.number("z_max_m", z.hi, "m", range, "Largest z.", required);
}

void velocity_fields(Fields& f, std::array<double, 3>& velocity, double fastest, std::string_view meaning_of_x) {
    const Range range = from(-fastest).to(fastest);
    f.number("velocity_x_m_s", velocity[0], "m/s", range, meaning_of_x);
    f.number("velocity_y_m_s", velocity[1], "m/s", range, "Along y.");
    f.number("velocity_z_m_s", velocity[2], "m/s", range, "Along z.");
}

}  // namespace wade
