"""Depth-averaged water on a regular grid as the columns of a stream, with numpy; as wade_columns() of the C library.

    grid = Grid(x_min, z_min, cell_x, cell_z, nx, nz)
    with SharedMemoryStream(session, grid.capacity, "my code", column_width=grid.column_width) as stream:
        ...
        stream.end_frame(grid.fill(stream.begin_frame(), depth, u, v, bed))
"""

import math

import numpy as np
from shared_memory_segment import USAGE, StreamError

WIDEST_COLUMN_M, WIDEST_CELL_M = 2, 1e6
ROUNDING = 1 + 1e-9  # of a cell size that was computed, as 100.0 / 50
DRY_UP_TO_M, DENSITY = 0.001, 1000
# Fill values of file formats, as 9.97e36, are outside of these.
DEEPEST_M, FASTEST_M_S, HIGHEST_M = 12000, 1000, 12000


def demand(good, name, value, allowed):
    if not good:
        raise StreamError(USAGE, f"{name} = {value:g} is not allowed; allowed: {allowed}.")


class Grid:
    """Cell (i, j) has its lower corner at (x_min + i cell_x, z_min + j cell_z), world metres.

    Cells wider than 2 m are divided into equal columns. Errors: StreamError.
    """

    def __init__(self, x_min, z_min, cell_x, cell_z, nx, nz):
        for axis, corner, cell, number in ("x", x_min, cell_x, nx), ("z", z_min, cell_z, nz):
            demand(math.isfinite(corner), f"{axis}_min", corner, "finite")
            demand(0 < cell <= WIDEST_CELL_M, f"cell_{axis}", cell, f"above 0 and at most {WIDEST_CELL_M:g} m")
            demand(number >= 1, f"n{axis}", number, "1 or more")
        self.shape = nz, nx
        self.parts = [max(1, math.ceil(cell / (WIDEST_COLUMN_M * ROUNDING))) for cell in (cell_x, cell_z)]
        self.column_width = tuple(min(WIDEST_COLUMN_M, cell / parts) for cell, parts in zip((cell_x, cell_z), self.parts))
        self.capacity = nx * nz * self.parts[0] * self.parts[1]
        self.x = self.middles(x_min, cell_x, nx, self.parts[0])
        self.z = self.middles(z_min, cell_z, nz, self.parts[1])

    @staticmethod
    def middles(start, cell, cells, parts):
        """Middles of the columns, m, one row a cell."""
        return start + cell * (np.arange(cells)[:, None] + (np.arange(parts) + 0.5) / parts)

    def wet_values(self, name, values, wet, limit):
        """Values of the wet cells, which have to be numbers within +-limit."""
        values = np.asarray(values, float).reshape(self.shape)[wet]
        bad = np.flatnonzero(~(np.abs(values) <= limit))
        if bad.size:
            j, i = np.argwhere(wet)[bad[0]]
            demand(False, f"{name} of cell ({i}, {j})", values[bad[0]], f"-{limit} to {limit} where there is water")
        return values

    def fill(self, arrays, depth, u, v, bed=None):
        """Writes the columns of the wet cells into the arrays of a frame; returns their number.

        depth, m, u, v, m/s along x and z, bed, height in m: one value a cell, row-major, x fastest. Depths that are NaN or
        at most 1 mm are dry; the other values are read where there is water.
        """
        depth = np.asarray(depth, float).reshape(self.shape)
        bad = np.argwhere((depth < 0) | (depth > DEEPEST_M))
        if bad.size:
            j, i = bad[0]
            demand(False, f"depth of cell ({i}, {j})", depth[j, i], f"0 to {DEEPEST_M} m, or NaN where it is dry")
        wet = depth > DRY_UP_TO_M
        rows, columns = np.nonzero(wet)
        water = depth[wet]
        ground = 0 if bed is None else self.wet_values("bed", bed, wet, HIGHEST_M)
        # By cell, within it by z and x.
        shape = len(water), self.parts[1], self.parts[0]
        values = {
            "mass": DENSITY * self.column_width[0] * self.column_width[1] * water,
            "vx": self.wet_values("u", u, wet, FASTEST_M_S), "vy": np.zeros_like(water),
            "vz": self.wet_values("v", v, wet, FASTEST_M_S), "py": ground + 0.5 * water,
        }
        values = {name: value[:, None, None] for name, value in values.items()}
        values["px"] = self.x[columns][:, None, :]
        values["pz"] = self.z[rows][:, :, None]
        count = math.prod(shape)
        for name, array in zip(("mass", "vx", "vy", "vz", "px", "py", "pz"), arrays):
            np.frombuffer(array, np.float32)[:count] = np.broadcast_to(values[name], shape).ravel()
        return count
