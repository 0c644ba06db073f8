#pragma once
// The ground of a site and the water on it at t = 0, by cell of a grid.

#include <cstddef>

#include "configs/scene/site.hpp"
#include "fluid_server/particles/site/site_shape.hpp"
#include "fluid_server/shallow_water/grid.hpp"

namespace wade::fluid::shallow_water {

// Height of the ground by cell, m: of a raster the mean over its cells that lie in the cell, or, where these are not smaller,
// straight between their centres; NaN where it says nothing. Of a plane, or of points, that at the centre of the cell.
RowMemory ground_heights(const Ground& ground, const Grid& grid);

// Square of Manning's n by cell, s^2/m^(2/3); of a raster or of zones. Empty: n is the same everywhere.
RowMemory squares_of_manning(const Roughness& roughness, const Grid& grid);

// Height where the ground says something, else 0, and friction.
Bed site_bed(const Site& site, const Grid& grid);

// Sets the depths at t = 0, m: up to the highest level with a polygon over the cell, less where it covers only a part,
// or the depth of the raster, if it is more. open: fraction of each cell that is no house; empty: all is open.
void fill_site(const Site& site, const Grid& grid, const RowMemory& ground, const RowMemory& open, RowMemory& depth);

}  // namespace wade::fluid::shallow_water
