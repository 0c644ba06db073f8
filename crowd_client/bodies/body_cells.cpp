#include "crowd_client/bodies/body_cells.hpp"

#include "configs/scene/world.hpp"

namespace wade::crowd {

void sort_people(BodyCells& cells, const World& world, std::span<const Vector2d> people, double reach) {
    cells.columns = static_cast<int>(std::floor(world.length / BodyCells::width)) + 1 + 2 * BodyCells::border;
    cells.rows = static_cast<int>(std::floor(world.width / BodyCells::length)) + 1 + 2 * BodyCells::border;
    const auto count = static_cast<std::size_t>(cells.columns) * static_cast<std::size_t>(cells.rows);

    cells.listed.clear();
    cells.listed_x.clear();
    if (const double period = world.period(); period > 0) {
        for (std::size_t k = 0; k < people.size(); ++k) {
            const double x = people[k].x();
            for (const double shift : {period, -period}) {
                if (x + shift <= -reach || x + shift >= period + reach) continue;
                cells.listed.push_back(static_cast<std::uint32_t>(k));
                cells.listed_x.push_back(x + shift);
            }
        }
    }
    const std::size_t n = people.size(), entries = n + cells.listed.size();
    const auto person_of = [&](std::size_t i) { return i < n ? static_cast<std::uint32_t>(i) : cells.listed[i - n]; };
    const auto x_of = [&](std::size_t i) { return i < n ? people[i].x() : cells.listed_x[i - n]; };

    cells.cell.resize(entries);
    cells.start.assign(count + 1, 0);
    for (std::size_t i = 0; i < entries; ++i) {
        const int row = cells.row_of(people[person_of(i)].y());
        const std::size_t cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(cells.columns) +
                                 static_cast<std::size_t>(cells.column_of(x_of(i)));
        cells.cell[i] = static_cast<std::uint32_t>(cell);
        ++cells.start[cell + 1];
    }
    // start[c + 1] is the next free entry of cell c while people are sorted in, and the end of the cell afterwards.
    std::uint32_t before = 0;
    for (std::size_t c = 0; c < count; ++c) {
        const std::uint32_t in_cell = cells.start[c + 1];
        cells.start[c + 1] = before;
        before += in_cell;
    }
    cells.person.resize(entries + BodyCells::lanes - 1);
    cells.x.resize(entries + BodyCells::lanes - 1);
    cells.z.resize(entries + BodyCells::lanes - 1);
    for (std::size_t i = 0; i < entries; ++i) {
        const std::uint32_t to = cells.start[cells.cell[i] + std::size_t{1}]++;
        cells.person[to] = person_of(i);
        cells.x[to] = x_of(i);
        cells.z[to] = people[person_of(i)].y();
    }
}

}  // namespace wade::crowd
