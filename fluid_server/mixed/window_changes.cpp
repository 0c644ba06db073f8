// The window opens, closes and moves: cells become particles and particles cells.

#include <algorithm>
#include <cmath>
#include <vector>

#include "configs/scene/particle_volume.hpp"
#include "fluid_server/mixed/mixed_world.hpp"

namespace wade::fluid::mixed {

void MixedWorld::change_window(const Window& to) {
    if (to == window_) return;
    const bool apart = to.begin >= window_.end || to.end <= window_.begin;
    if (!window_.empty() && (to.empty() || apart)) sleep();
    if (!to.empty()) {
        if (window_.empty()) {
            wake(to);
        } else {
            move(to);
        }
        std::vector<std::size_t> faces;
        if (ends()[0].open) faces.push_back(window_.begin);
        if (ends()[1].open) faces.push_back(window_.end);
        shallow_water::watch_faces(shallow_, faces);
    }
    columns_.leave_out(window_.begin, window_.end);
}

void MixedWorld::wake(const Window& window) {
    momentum_.expected = momentum_of_cells(shallow_, 0, shallow_.grid.nx);
    guards_.move_to(window, shallow_.grid, rule_.ends_are_walls());
    fluid_.change_particles([&](Particles& p) { guards_.fill(p, shallow_); });
    window_ = window;
    const double filled = volume_in_window(fluid_.particles(), ends(), spacing_);
    const std::size_t e = ends()[1].open ? 1 : 0;  // an open end, to pay it from
    accounts_[e].owed += volume_of_cells(shallow_, window.begin, window.end) - filled;
}

void MixedWorld::sleep() {
    const double volume = volume_in_window(fluid_.particles(), ends(), spacing_);
    // All that is owed is settled as well, if the cells can bear it.
    const double wanted = volume + accounts_[0].owed + accounts_[1].owed;
    const double before = volume_of_cells(shallow_, window_.begin, window_.end);
    const double added = add_to_cells(shallow_, window_.begin, window_.end, wanted - before);
    accounts_[0].owed = 0;
    accounts_[1].owed = wanted - before - added;
    shallow_water::update_primitive(shallow_);
    shallow_water::watch_faces(shallow_, {});
    fluid_.change_particles([](Particles& p) { p.count = 0; });
    window_ = {};
}

void MixedWorld::move(const Window& to) {
    const Window from = window_;
    const shallow_water::Grid& grid = shallow_.grid;
    const double middle = 0.5 * (grid.face_x(std::max(from.begin, to.begin)) + grid.face_x(std::min(from.end, to.end)));
    // Of the particles on either side of the middle of what both windows hold.
    const auto volumes = [&] {
        std::array<double, 2> sum{};
        const Particles& p = fluid_.particles();
        for (std::size_t i = 0; i < p.count; ++i) {
            const double x = static_cast<double>(p.x[i]);
            sum[x < middle ? 0 : 1] += share_in_window(x, ends(), spacing_) * particle_volume(spacing_);
        }
        return sum;
    };
    const std::array<double, 2> before = volumes();
    const std::array<double, 2> moved{ends()[0].x - grid.face_x(to.begin), grid.face_x(to.end) - ends()[1].x};
    guards_.move_to(to, grid, rule_.ends_are_walls());
    fluid_.change_particles([&](Particles& p) { guards_.update(p, shallow_, 0, moved); });
    window_ = to;
    const std::array<double, 2> after = volumes();
    const std::array<std::array<std::size_t, 2>, 2> cells{
        {{std::min(from.begin, to.begin), std::max(from.begin, to.begin)},
         {std::min(from.end, to.end), std::max(from.end, to.end)}}};
    for (std::size_t e = 0; e < 2; ++e) {
        const auto [begin, end] = cells[e];
        if (begin == end) continue;
        const double of_cells = volume_of_cells(shallow_, begin, end);
        const double lost = before[e] - after[e];
        const bool woke = e == 0 ? to.begin < from.begin : to.end > from.end;
        // Cells that fall asleep take over the volume of their particles.
        if (woke) {
            accounts_[e].owed += of_cells + lost;
        } else {
            accounts_[e].owed += lost - of_cells - add_to_cells(shallow_, begin, end, lost - of_cells);
        }
    }
    shallow_water::update_primitive(shallow_);
}

}  // namespace wade::fluid::mixed
