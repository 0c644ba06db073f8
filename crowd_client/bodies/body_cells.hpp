#pragma once
// Neighbour search for people: a cell list, stored row by row. Cells are long across the rows, so that few runs of
// entries hold a neighbourhood.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "configs/scene/interval.hpp"
#include "crowd_client/equations.hpp"

namespace wade::crowd {

struct BodyCells {
    static constexpr double width = 1.0, length = 2.0;  // of a cell, along x and z, m
    static constexpr int border = 2;                    // cells round the world, for periodic images
    static constexpr std::size_t lanes = 16;            // entries that loops take at once

    int columns = 0, rows = 0;
    std::vector<std::uint32_t> start;  // people of cell c: [start[c], start[c + 1]), in the order of the list
    // Per entry, with lanes - 1 unused ones at the end:
    std::vector<std::uint32_t> person;  // index in the list
    std::vector<double> x, z;           // position of the person or its image, m

    std::vector<std::uint32_t> cell, listed;  // working memory
    std::vector<double> listed_x;

    [[nodiscard]] int column_of(double at_x) const {
        return std::clamp(static_cast<int>(std::floor(at_x / width)) + border, 0, columns - 1);
    }
    [[nodiscard]] int row_of(double at_z) const {
        return std::clamp(static_cast<int>(std::floor(at_z / length)) + border, 0, rows - 1);
    }

    // Calls visit(j, dx, dz) for each person j, or image, less than `reach` away along x and z, and for some farther
    // ones; d = its position - p, m.
    template <typename Visit>
    void visit_near(const Vector2d& p, double reach, Visit&& visit) const {
        visit_box(p, {-reach, reach}, {-reach, reach}, visit);
    }

    // The same for all people and images with d in a box, and for some others.
    template <typename Visit>
    void visit_box(const Vector2d& p, const Interval& along_x, const Interval& along_z, Visit&& visit) const {
        visit_runs(p, along_x, along_z, [&](std::uint32_t first, std::uint32_t end) {
            for (std::uint32_t i = first; i < end; ++i) visit(person[i], x[i] - p.x(), z[i] - p.y());
        });
    }

    // Calls visit(first, end) for one run of entries per row of cells. The runs hold all entries with d in a box, and
    // some others.
    template <typename Visit>
    void visit_runs(const Vector2d& p, const Interval& along_x, const Interval& along_z, Visit&& visit) const {
        const int first = column_of(p.x() + along_x.lo), last = column_of(p.x() + along_x.hi);
        const int last_row = row_of(p.y() + along_z.hi);
        for (int row = row_of(p.y() + along_z.lo); row <= last_row; ++row) {
            const auto line = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns);
            visit(start[line + static_cast<std::size_t>(first)], start[line + static_cast<std::size_t>(last) + 1]);
        }
    }
};

// Sorts people into the cells. In a periodic world (`period` > 0) people near the periodic boundary get images beyond
// it, within `reach` m.
void sort_people(BodyCells& cells, const World& world, std::span<const Vector2d> people, double reach);

}  // namespace wade::crowd
