#!/usr/bin/python3
"""Publishes a uniform stream, 0.8 m deep and 1.2 m/s towards -x, from cells of any size: a model for depth-averaged codes.

Replace `water` by the depth and velocity of your code. With --points each column is a particle without width instead, which
shows why the width has to be stated: docs/people_in_water.md, "How densely water is sampled".
"""

import argparse

import known_stream
import numpy as np
from columns import Grid
from known_stream import bounded
from shared_memory_stream import SharedMemoryStream, StreamError

LENGTH_M, WIDTH_M, FIRST_Z_M = 100, 27, 11.5  # the channel of configs/paper


def read_options(program):
    parser = argparse.ArgumentParser(prog=program, allow_abbrev=False, description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", nargs="?", metavar="SCENE.json", help="accepted and not read")
    parser.add_argument("--session", required=True)
    parser.add_argument("--cell-m", type=bounded(float, 0.05, 20), default=1, help="width of the cells [1]")
    parser.add_argument("--points", action="store_true", help="publish points in place of columns")
    parser.add_argument("--frames", type=bounded(int, 1, 10**9), default=60)
    parser.add_argument("--depth", type=bounded(int, 1, 63), default=1)
    parser.add_argument("--scene-hash", type=known_stream.scene_hash, default=0)
    parser.add_argument("--attach-timeout-s", type=bounded(float, 0, 86400), default=10)
    parser.add_argument("--step-timeout-s", type=bounded(float, 0, 86400), default=60)
    return parser.parse_args()


def water(shape):
    """Depth, m, and velocity along x and z, m/s, of each cell."""
    return np.full(shape, 0.8), np.full(shape, -1.2), np.zeros(shape)


def produce(options):
    cell = options.cell_m
    grid = Grid(0, FIRST_Z_M, cell, cell, round(LENGTH_M / cell), round(WIDTH_M / cell))
    width = (0, 0) if options.points else grid.column_width
    with SharedMemoryStream(options.session, grid.capacity, "producer_columns", options.depth, options.scene_hash,
                            options.attach_timeout_s, options.step_timeout_s, known_stream.catch_signals(),
                            column_width=width) as stream:
        stream.wait_for_consumers()
        for frame in range(1, options.frames + 1):
            arrays = stream.begin_frame()
            if arrays is None:
                break
            stream.end_frame(grid.fill(arrays, *water(grid.shape)), final=frame == options.frames)
        stream.close()


if __name__ == "__main__":
    known_stream.run("producer_columns", produce, StreamError, read_options)
