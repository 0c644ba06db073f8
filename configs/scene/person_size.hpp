#pragma once
// Height and mass of people by age and sex, and the sizes that a scene may state.
//
// Below 20 years both follow the growth charts of the CDC (Kuczmarski et al. 2000, ages 2 to 20; public domain) by the LMS method
// (Cole and Green 1992): the value at the normal score z is M (1 + L S z)^(1/L), with L, M, S of the age and the sex. Scores stay
// within 2, as the charts end at the 3rd and the 97th per cent. The score of the mass is r z + sqrt(1 - r^2) z', r = 0.5 [A].
// From 20 years on the height is 1.7 m and the mass 65 kg.

#include <optional>
#include <string>

#include "configs/numbers/normal.hpp"
#include "configs/scene/fields/people.hpp"
#include "configs/scene/interval.hpp"

namespace wade {

inline constexpr double adult_age = 20;  // years

struct PersonSize {
    double height = 1.7;  // m
    double mass = 65;     // kg
};

// Random numbers of [0, 1) of a person, each for one purpose.
struct PersonDraws {
    double sex = 0, height = 0, age = 0, friction = 0, drowns = 0, mass = 0;
};

// Returns whether all people of these ages, years, are children.
[[nodiscard]] inline bool are_children(const Spread& age) {
    return age.hi < adult_age;
}

// Returns the size of a person of a group. Sizes of the row hold first. Sizes of the group hold for adults, or, in a group of children
// alone, for children. Else the size follows the age and the sex; a height or a mass alone sets the other one's score.
[[nodiscard]] PersonSize size_of_person(const AgentGroup& group, const PersonRow& row, double age, bool is_male,
                                        const PersonDraws& draws);

// A size that no person has.
struct SizeFault {
    bool is_mass = false;  // else the height
    std::string sentence;  // value and allowed range
};

// Returns what is wrong with a size at any of these ages, years, or at an unknown one; nothing if it is plausible. [A]: heights are 0.6 to 1.4 of the median of
// the age, of adults 1 to 2.5 m; masses of children 0.4 to 4 medians; mass over the square of the height 8 to 100 kg/m2.
[[nodiscard]] std::optional<SizeFault> fault_of_size(const std::optional<Interval>& age,
                                                     const std::optional<Spread>& height,
                                                     const std::optional<Spread>& mass);

}  // namespace wade
