#pragma once
// People take their impulses from the cells of the grid.
//
// The weight of a cell is the mean of the cone over it; its mass is rho h A. q_x -= w J' h / S and q_z alike, so that rho A q summed up loses J'. Dry cells and obstacles have no part.

#include <vector>

#include "fluid_server/people/pushes.hpp"
#include "fluid_server/shallow_water/world.hpp"

namespace wade::fluid::shallow_water {

// Cells near one person, with their weights.
struct NearCells {
    std::vector<std::size_t> place;
    std::vector<double> weight;
};

// outside: a cell counts unless it lies in [begin, end) along x (mixed/).
void find_near(const ShallowWater& world, const Push& push, std::size_t begin, std::size_t end, NearCells& near);
void add_cells(const ShallowWater& world, const NearCells& near, NearWater& sum);

// Takes J' = `impulse` from them and other water of together the weight S; returns what they lost, N s.
GroundVector take_from(ShallowWater& world, const NearCells& near, const GroundVector& impulse, double weight);

// Every person takes its share of the frame; `primitive` is left as it was.
void push_cells(ShallowWater& world, PeopleInWater& people, double share);

}  // namespace wade::fluid::shallow_water
