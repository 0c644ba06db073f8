// person_demands < LIST: the load of a stream of 1 m/s on standing people, by the equations of the response `measured`.
//
// A line of LIST is "height_m mass_kg depth_m skill"; each has a line of the answer, "S T R". As all grow with the square of the
// velocity, such people slip at 1 / sqrt(S) or 1 / sqrt(R) m/s and topple at 1 / sqrt(T) m/s. With "-" for a skill the friction and the arm over
// the height are 1, so that people of mu and lambda slip at sqrt(mu / S) and topple at sqrt(lambda / T).

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string>

#include "configs/scene/choices.hpp"
#include "crowd_client/people/people.hpp"

int main() {
    using namespace wade::crowd;
    const WaterProperties water;
    const Vector2d stream(1, 0), still = Vector2d::Zero();
    Body body;
    double depth = 0;
    for (std::string skill; std::cin >> body.height >> body.mass >> depth >> skill;) {
        const auto chosen = wade::choice_named<wade::Skill>(skill);
        if (!chosen && skill != "-") return 2;
        const Bracing bracing = chosen ? bracing_of(*chosen, body) : Bracing{1, 1};
        const double k = drag_upright(body.height, depth, water), weight = weight_on_feet(body, depth, water);
        std::printf("%.17g %.17g %.17g\n", slip_demand(k, stream, still, bracing.friction, weight),
                    topple_demand(k, stream, std::min(depth, body.height), weight, bracing.arm_share * body.height),
                    rush_demand(depth, stream));
    }
    return std::cin.eof() ? 0 : 2;
}
