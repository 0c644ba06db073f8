#include "fluid_server/particles/box_index.hpp"

#include <algorithm>
#include <cmath>

namespace wade::fluid {

namespace {

constexpr double cells_per_box = 2;
constexpr double most_cells_along = 4096;

// From the lowest to the highest finite bound along an axis; lo = hi if there is none.
struct Span {
    float lo = Box::inf, hi = -Box::inf;
    [[nodiscard]] double length() const { return static_cast<double>(hi) - static_cast<double>(lo); }
};

Span span_of(std::span<const Box> boxes, std::size_t axis) {
    Span span;
    for (const Box& box : boxes) {
        for (const float bound : {box.lo[axis], box.hi[axis]}) {
            if (!std::isfinite(bound)) continue;
            span.lo = std::min(span.lo, bound), span.hi = std::max(span.hi, bound);
        }
    }
    return span.lo < span.hi ? span : Span{0, 0};
}

std::uint32_t cells_along(double length, double width) {
    return width > 0 ? static_cast<std::uint32_t>(std::clamp(std::floor(length / width), 1.0, most_cells_along)) : 1;
}

}  // namespace

BoxIndex::BoxIndex(std::span<const Box> boxes) {
    if (boxes.empty()) return;
    const Span x = span_of(boxes, 0), z = span_of(boxes, 2);
    const double wanted = cells_per_box * static_cast<double>(boxes.size());
    // Square cells; a row of boxes has a row of cells.
    const double width =
        std::max({std::sqrt(x.length() * z.length() / wanted), x.length() / wanted, z.length() / wanted});
    x_ = {x.lo, 0, cells_along(x.length(), width)};
    z_ = {z.lo, 0, cells_along(z.length(), width)};
    if (x.length() > 0) x_.per_m = static_cast<float>(x_.cells / x.length());
    if (z.length() > 0) z_.per_m = static_cast<float>(z_.cells / z.length());
    const auto for_each_cell = [&](const Box& box, auto&& visit) {
        for (std::uint32_t k = z_.cell(box.lo[2]); k <= z_.cell(box.hi[2]); ++k) {
            for (std::uint32_t i = x_.cell(box.lo[0]); i <= x_.cell(box.hi[0]); ++i) visit(k * x_.cells + i);
        }
    };
    start_.assign(std::size_t{x_.cells} * z_.cells + 1, 0);
    for (const Box& box : boxes) {
        first_cell_.push_back({x_.cell(box.lo[0]), z_.cell(box.lo[2])});
        for_each_cell(box, [&](std::uint32_t cell) { ++start_[cell]; });
    }
    std::uint32_t end = 0;
    for (std::uint32_t& cell : start_)
        cell = end += cell;  // filling from the back turns the end of each into its start
    boxes_.resize(end);
    for (std::size_t b = boxes.size(); b-- > 0;) {
        for_each_cell(boxes[b], [&](std::uint32_t cell) { boxes_[--start_[cell]] = static_cast<std::uint32_t>(b); });
    }
}

void BoxIndex::find(const Box& box, BoxNumbers& found) const {
    found.clear();
    const std::uint32_t i0 = x_.cell(box.lo[0]), i1 = x_.cell(box.hi[0]);
    const std::uint32_t k0 = z_.cell(box.lo[2]), k1 = z_.cell(box.hi[2]);
    for (std::uint32_t k = k0; k <= k1; ++k) {
        for (std::uint32_t i = i0; i <= i1; ++i) {
            for (const std::uint32_t b : in_cell(i, k)) {
                // A box of several cells is found in the first of them that the question spans.
                if (i == std::max(i0, first_cell_[b][0]) && k == std::max(k0, first_cell_[b][1])) found.push_back(b);
            }
        }
    }
    std::sort(found.begin(), found.end());
}

}  // namespace wade::fluid
