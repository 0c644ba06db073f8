"""What the producers of this folder play: the known stream of ../README.md, its options, and the hash chain."""

import argparse
import signal
import sys

MASS_KG, HEIGHT_M, FRAME_RATE_HZ = 100, 0.23, 30
SPACING_M, ROWS, FIRST_X_M, FIRST_Z_M, LENGTH_M = 0.4642, 50, 60, 12, 100
PARTICLE_RADIUS_M = SPACING_M / 2


def bounded(kind, lowest, highest):
    def number(text):
        value = kind(text)
        if not lowest <= value <= highest:
            raise argparse.ArgumentTypeError(f"{text} is not allowed; allowed: {lowest:g} to {highest:g}")
        return value

    number.__name__ = "whole number" if kind is int else "number"
    return number


def scene_hash(text):
    value = int(text, 16)
    if not 0 <= value < 2**64:
        raise argparse.ArgumentTypeError(f"{text} is not allowed; allowed: 1 to 16 hexadecimal digits")
    return value


def read_options(program, people=False):
    parser = argparse.ArgumentParser(
        prog=program,
        allow_abbrev=False,
        description="Plays the known stream of tools/producers/README.md; the scene file is not read.",
    )
    parser.add_argument("scene", nargs="?", metavar="SCENE.json")
    parser.add_argument("--session", required=True)
    parser.add_argument("--frames", type=bounded(int, 1, 10**9), default=60)
    parser.add_argument("--particles", type=bounded(int, 1, 10**7), default=2000)
    parser.add_argument("--speed", type=bounded(float, -100, 100), default=1.5)
    parser.add_argument("--depth", type=bounded(int, 1, 63), default=1)
    parser.add_argument("--scene-hash", type=scene_hash, default=0)
    parser.add_argument("--attach-timeout-s", type=bounded(float, 0, 86400), default=10)
    parser.add_argument("--step-timeout-s", type=bounded(float, 0, 86400), default=60)
    if people:
        parser.add_argument("--take-people", action="store_true", help="takes the agents, and lets those who push the water push it")
    return parser.parse_args()


def run(program, produce, failure, options_of=read_options):
    """Runs a producer: reads its options, publishes its frames; on failure prints the text and exits with the code."""
    try:
        produce(options_of(program))
    except failure as error:
        print(f"{program}: {error}", file=sys.stderr)
        sys.exit(error.code)


def catch_signals():
    """Remembers SIGINT and SIGTERM; returns a function that gives the number of the one received, 0 before."""
    received = [0]

    def remember(number, _):
        received[0] = number

    signal.signal(signal.SIGINT, remember)
    signal.signal(signal.SIGTERM, remember)
    return lambda: received[0]


def mix(z):
    mask = 2**64 - 1
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & mask
    z = (z ^ z >> 27) * 0x94D049BB133111EB & mask
    return z ^ z >> 31


def chain(previous, frame, count, sums):
    """Hash chain over frames 1 .. frame, from that over the frames before and the sum of each field."""
    h = mix((previous + 0x9E3779B97F4A7C15) % 2**64)
    h = mix(h ^ frame)
    h = mix(h ^ count)
    for s in sums:
        h = mix(h ^ s % 2**64)
    return h or 1


def block(np, particles):
    """x of each particle at the start and its z, m; np: numpy."""
    k = np.arange(particles)
    return FIRST_X_M + k // ROWS * SPACING_M, FIRST_Z_M + k % ROWS * SPACING_M


def fill(np, fields, start_x, z, speed, frame):
    """The seven arrays of a frame: computed in double precision, rounded to float32 by the assignment."""
    mass, vx, vy, vz, px, py, pz = fields
    x = start_x - travelled(speed, frame)
    mass[:] = MASS_KG
    vx[:] = -speed
    vy[:] = vz[:] = 0
    px[:] = x - LENGTH_M * np.floor(x / LENGTH_M)
    py[:] = HEIGHT_M
    pz[:] = z


def travelled(speed, frame):
    """Returns the displacement of the block up to a frame, m."""
    return speed * frame / FRAME_RATE_HZ
