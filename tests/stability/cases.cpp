#include "cases.hpp"

namespace wade::stability {

const std::vector<Case>& all_cases() {
    static const std::vector<Case> cases = [] {
        std::vector<Case> all;
        for (const std::vector<Case>& family :
             {water_cases(), sloshing_cases(), inflow_cases(), particle_cases(), likeness_cases(), crowd_cases()}) {
            all.insert(all.end(), family.begin(), family.end());
        }
        return all;
    }();
    return cases;
}

}  // namespace wade::stability
