#!/usr/bin/python3
"""Plays the known stream of ../README.md; with numpy, straight into the shared memory."""


import known_stream
import numpy as np
from shared_memory_stream import SharedMemoryStream, StreamError


def field_sums(fields):
    """Sums of the hash chain, one for each array of float32."""
    n = np.arange(1, len(fields[0]) + 1, dtype=np.uint32)
    for field in fields:
        w = field.view(np.uint32)
        x = w + n * np.uint32(0x9E3779B1)
        y = (w << np.uint32(16) | w >> np.uint32(16)) ^ (n * np.uint32(0x85EBCA77))
        yield int(np.sum(x.astype(np.uint64) * y, dtype=np.uint64))


def produce(options):
    start_x, z = known_stream.block(np, options.particles)
    with SharedMemoryStream(options.session, options.particles, "producer_numpy", options.depth, options.scene_hash,
                            options.attach_timeout_s, options.step_timeout_s, known_stream.catch_signals(),
                            particle_radius=known_stream.PARTICLE_RADIUS_M) as stream:
        stream.wait_for_consumers()
        for frame in range(1, options.frames + 1):
            arrays = stream.begin_frame()
            if arrays is None:
                break
            fields = [np.frombuffer(values, np.float32) for values in arrays]
            known_stream.fill(np, fields, start_x, z, options.speed, frame)
            chain = known_stream.chain(stream.hash, frame, options.particles, field_sums(fields))
            stream.end_frame(options.particles, chain, final=frame == options.frames)
        stream.close()


if __name__ == "__main__":
    known_stream.run("producer_numpy", produce, StreamError)
