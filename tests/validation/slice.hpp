#pragma once
// Thin slices: flows that are the same all across are computed between periodic sides as near as the kernel allows.

#include <algorithm>
#include <string>
#include <vector>

#include "configs/scene/fluid.hpp"
#include "validation_case.hpp"

namespace wade::validation {

// Three support radii, m, the least that the loader allows between periodic sides, in whole spacings: 6, 8 with the quartic
// spline, 9 with Wendland's kernel, 7 with a wider cubic spline. kernel: that of the scene's file; overrides of the request can ask for wider ones.
inline double slice_width(const Request& request, KernelKind kernel = KernelKind::cubic_spline) {
    double spacings = kernel == KernelKind::wendland_c2 ? 9 : 6;
    for (const std::string& text : request.overrides) {
        if (text.find("quartic") != std::string::npos) spacings = 8;
        if (text.find("wendland") != std::string::npos) spacings = 9;
        if (text.find("/fluid/support_in_spacings=2.") != std::string::npos) spacings = std::max(spacings, 7.0);
    }
    return spacings * request.spacing;
}

// Overrides that make world, channel and the first `blocks` blocks of water of a scene as wide as the slice.
inline std::vector<std::string> slice_sizes(const Request& request, std::size_t blocks) {
    const double width = slice_width(request);
    std::vector<std::string> sizes{assign("/world/width_m", width), assign("/channel/z_max_m", width)};
    for (std::size_t i = 0; i < blocks; ++i) {
        sizes.push_back(assign("/channel/water_blocks/" + std::to_string(i) + "/z_max_m", width));
    }
    return sizes;
}

}  // namespace wade::validation
