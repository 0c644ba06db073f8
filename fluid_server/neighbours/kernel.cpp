#include "fluid_server/neighbours/kernel.hpp"

#include "configs/scene/scene_capacity.hpp"

namespace wade::fluid {

Kernel make_kernel(const Fluid& fluid) {
    const auto h = static_cast<float>(support_radius_of(fluid));
    switch (fluid.kernel) {
        case KernelKind::quartic_spline:
            return QuarticSpline(h, support_in_spacings_of(fluid));
        case KernelKind::wendland_c2:
            return WendlandC2(h);
        case KernelKind::cubic_spline:
            break;
    }
    return CubicSpline(h, support_in_spacings_of(fluid));
}

}  // namespace wade::fluid
