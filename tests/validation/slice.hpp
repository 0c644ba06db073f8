#pragma once
// Thin slices: flows that are the same all across are computed between periodic sides as near as the kernel allows.

#include <string>
#include <vector>

#include "validation_case.hpp"

namespace wade::validation {

// Three support radii, m, the least that the loader allows between periodic sides: 6 spacings, or 9 with the wider
// kernel. kernel: that of the scene's file; an override of the request can ask for the wider one.
inline double slice_width(const Request& request, KernelKind kernel = KernelKind::cubic_spline) {
    bool wide = kernel == KernelKind::wendland_c2;
    for (const std::string& text : request.overrides) {
        wide = wide || text.find("wendland") != std::string::npos;
    }
    return (wide ? 9 : 6) * request.spacing;
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
