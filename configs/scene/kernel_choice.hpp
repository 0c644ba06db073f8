#pragma once
// The kernel that a scene needs (/fluid/kernel "auto").
//
//   water fills its channel to a lid, or is periodic upwards        wendland_c2      flow strains the packing of both splines
//   a front is to run: onto a dry bed, over still water, out of     cubic_spline     the impulse on people at a front is 0.7 to 0.8
//   a block                                                                          times as wrong, and steps cost 1 / 1.38
//   else a river from the start, waves, water at rest               quartic_spline   a river of two layers stands half as wrong, a
//                                                                                    wave's period is 0.1 times as wrong
//
// The figures come from docs/models_of_water.md#kernels. If a kernel's support is too long for the walls or the period
// of the scene, the next shorter kernel is used. With support_in_spacings other than 2
// the choice is the cubic spline.

#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

[[nodiscard]] KernelKind kernel_needed(const Scene& scene);

// Replaces `automatic` by the kernel that the scene needs.
void choose_kernel(Scene& scene);

}  // namespace wade
