#!/usr/bin/python3
"""Plays the known stream of ../README.md; standard library only."""

import math
from array import array
from operator import mul

import known_stream
from shared_memory_stream import SharedMemoryStream, StreamError


def hash_weights(count):
    """What the hash chain adds to, and mixes into, each value of an array."""
    return [[factor * n & 0xFFFFFFFF for n in range(1, count + 1)] for factor in (0x9E3779B1, 0x85EBCA77)]


def field_sum(field, weights):
    """Sum of the hash chain over one array of float32."""
    words = field.cast("B").cast("I")
    x = [w + a & 0xFFFFFFFF for w, a in zip(words, weights[0])]
    y = [(w << 16 & 0xFFFFFFFF | w >> 16) ^ b for w, b in zip(words, weights[1])]
    return sum(map(mul, x, y))


def still_arrays(options):
    """Returns the arrays that are the same in every frame, by their index in a slot, and the x at the start."""
    s, places = known_stream, range(options.particles)
    arrays = {
        0: array("f", [s.MASS_KG]) * options.particles,
        1: array("f", [-options.speed]) * options.particles,
        2: array("f", [0]) * options.particles,
        3: array("f", [0]) * options.particles,
        5: array("f", [s.HEIGHT_M]) * options.particles,
        6: array("f", [s.FIRST_Z_M + k % s.ROWS * s.SPACING_M for k in places]),
    }
    return arrays, [s.FIRST_X_M + k // s.ROWS * s.SPACING_M for k in places]


def positions(start, travelled):
    """px of a frame: computed in double precision, rounded to float32 by the array."""
    length, floor = known_stream.LENGTH_M, math.floor
    moved = (x - travelled for x in start)
    return array("f", [x - length * floor(x / length) for x in moved])


def produce(options):
    still, start = still_arrays(options)
    weights = hash_weights(options.particles)
    with SharedMemoryStream(options.session, options.particles, "producer_plain", options.depth, options.scene_hash,
                            options.attach_timeout_s, options.step_timeout_s, known_stream.catch_signals(),
                            particle_radius=known_stream.PARTICLE_RADIUS_M) as stream:
        stream.wait_for_consumers()
        for frame in range(1, options.frames + 1):
            fields = stream.begin_frame()
            if fields is None:
                break
            for place, values in still.items():
                fields[place][:] = memoryview(values)
            fields[4][:] = memoryview(positions(start, known_stream.travelled(options.speed, frame)))
            sums = [field_sum(field, weights) for field in fields]
            chain = known_stream.chain(stream.hash, frame, options.particles, sums)
            stream.end_frame(options.particles, chain, final=frame == options.frames)
        stream.close()


if __name__ == "__main__":
    known_stream.run("producer_plain", produce, StreamError)
