#include "fluid_server/shallow_water/wet_lines.hpp"

#include <algorithm>

namespace wade::fluid::shallow_water {

void mark_wet(const double* h, std::size_t k, double dry, const Lines& within, Lines& wet) {
    std::uint64_t* const bits = wet.row(static_cast<std::ptrdiff_t>(k));
    std::fill_n(bits, wet.words(), 0);
    within.for_each_span(k, [&](std::size_t first, std::size_t n) {
        for (std::size_t i = first; i < first + n; i += line_values) {
            const std::size_t m = std::min(line_values, first + n - i);
            unsigned wet_cells = 0;
            for (std::size_t j = 0; j < m; ++j) wet_cells |= static_cast<unsigned>(h[i + j] > dry) << j;
            if (wet_cells == 0) continue;
            wet.set(k, i);
            if ((wet_cells & 3U) != 0 && i > 0) wet.set(k, i - 1);
            if (wet_cells >> (line_values - 2) != 0 && i + line_values < within.cells()) wet.set(k, i + line_values);
        }
    });
}

void mark_active(std::ptrdiff_t k, WetLines& lines) {
    std::uint64_t* const to = lines.active.row(k);
    for (std::size_t w = 0; w < lines.wet.words(); ++w) {
        std::uint64_t bits = lines.always.row(k)[w];
        for (std::ptrdiff_t r = -Lines::beyond; r <= Lines::beyond; ++r) bits |= lines.wet.row(k + r)[w];
        to[w] = bits;
    }
}

}  // namespace wade::fluid::shallow_water
