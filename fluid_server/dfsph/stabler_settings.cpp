#include "fluid_server/dfsph/stabler_settings.hpp"

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/fluid.hpp"

namespace wade::fluid {

namespace {

class Changes {
 public:
    void at_most(const std::string& pointer, double value, double limit) {
        if (value > limit) add(pointer, value, limit);
    }
    void at_least(const std::string& pointer, double value, double limit) {
        if (value < limit) add(pointer, value, limit);
    }
    void add(const std::string& pointer, double from, double to) {
        list.push_back({pointer, short_number(from), short_number(to)});
    }
    std::vector<SettingChange> list;
};

void tighten(Changes& changes, const std::string& pointer, const PressureSolve& solve, const PressureSolve& usual) {
    changes.at_most(pointer + "/tolerance", solve.tolerance, usual.tolerance);
    changes.at_least(pointer + "/max_iterations", solve.max_iterations, usual.max_iterations);
}

}  // namespace

std::vector<SettingChange> stabler_settings(const Fluid& fluid) {
    const Fluid usual;  // the defaults
    Changes changes;
    changes.at_most("/fluid/cfl", fluid.cfl, usual.cfl);
    tighten(changes, "/fluid/density_solve", fluid.density_solve, usual.density_solve);
    const bool switched_off = fluid.divergence_solve.max_iterations == 0;
    if (!switched_off) tighten(changes, "/fluid/divergence_solve", fluid.divergence_solve, usual.divergence_solve);
    if (changes.list.empty()) changes.add("/fluid/cfl", fluid.cfl, fluid.cfl / 2);
    return changes.list;
}

std::string advice(const Fluid& fluid) {
    std::string text = "change ";
    const std::vector<SettingChange> changes = stabler_settings(fluid);
    for (std::size_t i = 0; i < changes.size(); ++i) {
        text += i == 0 ? "" : i + 1 == changes.size() ? " and " : ", ";
        text += changes[i].pointer + " from " + changes[i].from + " to " + changes[i].to;
    }
    return text;
}

std::string options_of_advice(const Fluid& fluid) {
    std::string text;
    for (const SettingChange& change : stabler_settings(fluid)) text += " --set " + change.pointer + "=" + change.to;
    return text;
}

}  // namespace wade::fluid
