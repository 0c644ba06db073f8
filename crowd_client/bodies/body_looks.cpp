#include "crowd_client/bodies/body_looks.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/interval.hpp"

namespace wade::crowd {
namespace {

constexpr std::uint32_t lanes = BodyCells::lanes;

// Sums use integers, so that they do not depend on the storage order of people. Each addend is less than 2^21: a sum
// holds a thousand people, more than fit within reach.
constexpr float per_unit = 0x1p20F;

// Calls add(first, end) for each block of `lanes` entries of the runs that hold a box round p; the run ends at `end`.
// A caller skips entries of the last block beyond it. The compiler turns a block into one loop without branches.
template <typename Add>
inline void add_box(const BodyCells& cells, const Vector2d& p, const Interval& along_x, const Interval& along_z,
                    Add&& add) {
    cells.visit_runs(p, along_x, along_z, [&](std::uint32_t first, std::uint32_t end) {
        for (std::uint32_t block = first; block < end; block += lanes) add(block, end);
    });
}

void fill(std::vector<float>& x, std::vector<float>& z, const BodyCells& cells,
          const std::vector<Vector2d>& of_person) {
    const std::size_t n = cells.start.back();
    x.resize(n + lanes - 1);
    z.resize(n + lanes - 1);
    for (std::size_t i = 0; i < n; ++i) {
        x[i] = static_cast<float>(of_person[cells.person[i]].x());
        z[i] = static_cast<float>(of_person[cells.person[i]].y());
    }
}

}  // namespace

void sort_headings(Looks& looks, const BodyCells& cells, const std::vector<Vector2d>& heading) {
    fill(looks.heading_x, looks.heading_z, cells, heading);
}

void sort_routes(Looks& looks, const BodyCells& cells, const std::vector<Vector2d>& way,
                 const std::vector<Vector2d>& bearing) {
    fill(looks.way_x, looks.way_z, cells, way);
    fill(looks.bearing_x, looks.bearing_z, cells, bearing);
}

double share_followed(const Looks& looks, const BodyCells& cells, const Vector2d& p, const Vector2d& heading) {
    constexpr float reach = 1.5F, faces = -0.85F;
    const auto own_x = static_cast<float>(heading.x()), own_z = static_cast<float>(heading.y());
    std::int32_t sum = 0, all = 0;
    add_box(cells, p, {-reach, reach}, {-reach, reach}, [&](std::uint32_t first, std::uint32_t end) {
        const double *const xs = &cells.x[first], *const zs = &cells.z[first];
        const float *const hx = &looks.heading_x[first], *const hz = &looks.heading_z[first];
        const auto count = static_cast<std::int32_t>(end - first);
#pragma omp simd reduction(+ : sum, all)
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(lanes); ++i) {
            const auto dx = static_cast<float>(xs[i] - p.x()), dz = static_cast<float>(zs[i] - p.y());
            const float square = dx * dx + dz * dz;  // 0: the agent itself
            const float cosine = own_x * hx[i] + own_z * hz[i];
            const bool counts = (i < count) & (square > 0) & (square < reach * reach) & (cosine >= faces);
            sum += counts ? static_cast<std::int32_t>(cosine * per_unit) : 0;
            all += counts ? 1 : 0;
        }
    });
    return sum > 0 ? static_cast<double>(sum) / static_cast<double>(per_unit) / static_cast<double>(all) : 0.0;
}

double share_opposed(const Looks& looks, const BodyCells& cells, const Vector2d& p, const Vector2d& way,
                     const Vector2d& bearing) {
    constexpr double reach = 2.5, half = 1.0, spread = 0.25;
    // The bounding box of the strip, cut at furthest_look, the reach of periodic images.
    constexpr double wide = half + spread * reach;
    const auto side = [&](double along, double across) -> Interval {
        return {std::max(-furthest_look, std::min(0.0, reach * along) - wide * std::abs(across)),
                std::min(furthest_look, std::max(0.0, reach * along) + wide * std::abs(across))};
    };
    const auto ex = static_cast<float>(way.x()), ez = static_cast<float>(way.y());
    const auto bx = static_cast<float>(bearing.x()), bz = static_cast<float>(bearing.y());
    std::int32_t opposed = 0, all = 0;
    add_box(cells, p, side(way.x(), way.y()), side(way.y(), way.x()), [&](std::uint32_t first, std::uint32_t end) {
        const double *const xs = &cells.x[first], *const zs = &cells.z[first];
        const float *const way_x = &looks.way_x[first], *const way_z = &looks.way_z[first];
        const float *const bearing_x = &looks.bearing_x[first], *const bearing_z = &looks.bearing_z[first];
        const auto count = static_cast<std::int32_t>(end - first);
#pragma omp simd reduction(+ : opposed, all)
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(lanes); ++i) {
            const auto dx = static_cast<float>(xs[i] - p.x()), dz = static_cast<float>(zs[i] - p.y());
            const float ahead = dx * ex + dz * ez;  // 0: the agent itself
            const float across = dx * ez - dz * ex;
            const float broad = static_cast<float>(half) + static_cast<float>(spread) * ahead;
            const bool counts = (i < count) & (ahead > 0) & (ahead <= static_cast<float>(reach)) & (across <= broad) &
                                (-across <= broad);
            const float weight = per_unit / (0.5F + (counts ? ahead : 0.0F));
            const float along = ex * way_x[i] + ez * way_z[i], goals = bx * bearing_x[i] + bz * bearing_z[i];
            const float cosine = along > goals ? along : goals;
            all += counts ? static_cast<std::int32_t>(weight) : 0;
            opposed += counts & (cosine < 0) ? static_cast<std::int32_t>(-weight * cosine) : 0;
        }
    });
    return opposed > 0 ? static_cast<double>(opposed) / static_cast<double>(all) : 0.0;
}

}  // namespace wade::crowd
