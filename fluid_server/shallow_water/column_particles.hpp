#pragma once
// Converts the columns of the grid to particles, the input of the crowd.
//
// A wet cell of volume V is n particles, V / d^3 rounded up, d the scene's particle spacing. Each has the n-th part of the
// cell's mass and the cell's velocity, so that mass and momentum of all particles are those of the grid; the mass of films
// too thin to have a velocity is shared by all.
//
//    +-----------+   n points spread evenly over the cell (at k/n along, k a/n across, modulo 1, a/n near the golden
//    |  .      . |   ratio; one in each of n layers over the depth) drift with the velocity of the cell. A point that
//    |      .    |   leaves the cell at one side comes in at the other; there it is the next particle along the stream,
//    |  .      . |   which lies 0.755 of a cell further across, the rows 0.618 of a cell further along than their
//    +-----------+   neighbours: multiples of both fill the cell evenly (Roberts 2018, the R sequences). Where the
//                    stream is uniform the next cell does the same, so that particles drift on from cell to cell.
//
// On a site each wet cell is one particle, whatever the spacing, and films are not shown.
//
// People with the response `measured` integrate their sampling kernel over columns (shm::StreamInfo::column_width). For them each wet
// cell is divided into equal columns at fixed positions, which are at most 2 m wide, in the mixed model half a sampling radius.
//
// For the response `paper` the mass in contact with an agent is that of the water column in the mean over time, wherever the agent stands: the
// stream brings particles past it at all distances.

#include <array>
#include <cstdint>
#include <vector>

#include "fluid_server/fluid_model.hpp"
#include "fluid_server/shallow_water/step.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::fluid::shallow_water {

class ColumnParticles {
 public:
    explicit ColumnParticles(const ShallowWater& world);

    // Room that a frame needs at most: max_particles of the scene and one more a cell; of a site one a cell that is open; the
    // columns of all cells for the response `measured`.
    [[nodiscard]] std::uint32_t capacity() const { return capacity_; }

    // Width of the columns along x and z, m; 0 of particles that drift.
    [[nodiscard]] std::array<double, 2> width() const { return width_; }

    // Moves the places on by dt, s, at the velocities that the water has.
    void drift(const ShallowWater& world, double dt);

    // The places, for ranks to hand over.
    [[nodiscard]] std::array<RowField, 2> places(const Grid& grid) {
        return {RowField{drift_x_.data(), grid.nx, grid.nx}, {drift_z_.data(), grid.nx, grid.nx}};
    }

    // Counts the particles of each cell; where they would be more than the capacity, larger and fewer ones are made.
    void count(const ShallowWater& world);

    // With /fluid/publish near_agents: shows from the next count on only the columns of 10 m squares with an agent
    // outdoors, and of the eight squares round each.
    void show_near(const AgentsView& agents);

    // Leaves out the cells of these numbers along x, [begin, end), from the next count on.
    void leave_out(std::size_t begin, std::size_t end) {
        hidden_begin_ = begin;
        hidden_end_ = end;
    }

    // Writes the particles of the water that was counted last; returns their number.
    std::uint32_t write(const ShallowWater& world, const shm::FrameFields& slot) const;

 private:
    void count_with(const ShallowWater& world, double volume);
    void count_wet(const ShallowWater& world);
    void write_columns(const ShallowWater& world, std::size_t k, const shm::FrameFields& slot) const;
    void write_row(const ShallowWater& world, std::size_t k, const shm::FrameFields& slot) const;

    double rest_density_;
    double particle_volume_;  // d^3, m^3
    double start_across_;     // in cells, by the seed
    std::uint32_t capacity_;
    std::array<double, 2> width_{};            // m
    std::uint32_t split_x_ = 0, split_z_ = 0;  // columns of a cell along x and z
    std::vector<double> drift_x_, drift_z_;    // by cell, in cells since t = 0
    std::vector<std::uint32_t> particles_;     // by cell
    std::vector<std::uint64_t> row_begin_;     // of its particles in the frame, and their number behind the last
    std::vector<std::uint32_t> across_of_;     // a, by n
    std::size_t hidden_begin_ = 0, hidden_end_ = 0;
    bool all_ = true;                  // columns are shown
    std::size_t squares_x_ = 0;        // along x
    std::vector<std::uint8_t> shown_;  // squares
    double film_share_ = 0;            // mass of all water over that of the cells with particles, less 1
};

}  // namespace wade::fluid::shallow_water
