#!/usr/bin/python3
"""Makes the ground and the houses of this village: make_village.py [FOLDER]. Same files each time.

A valley falls by 1 % from east to west, a brook winds along its floor. Houses stand along two lanes on either side, each turned
with its lane; a dam closes the valley at its eastern end.
"""

import json
import math
import random
import sys
from pathlib import Path

LENGTH, WIDTH, CELL = 420.0, 260.0, 5.0  # m
DAM = 345.0  # x of the dam, m
HOUSES = 40


def brook(x):
    """z of the brook's middle, m."""
    return 130 + 16 * math.sin(x / 52) + 5 * math.sin(x / 23 + 1)


def ground(x, z):
    """Height of the ground, m: a flat floor, slopes that steepen, and a bed 1.2 m deep for the brook."""
    off = abs(z - brook(x))
    floor = 0.01 * x
    slope = 0.012 * min(off, 45) + 0.10 * max(0.0, off - 45) + 0.0016 * max(0.0, off - 60) ** 2
    bed = -1.2 * math.exp(-(off / 5.0) ** 2)
    return 100 + floor + slope + bed


def house_at(rng, x, lane):
    """Corners of a house beside a lane, turned with it, and its door on the side of the lane."""
    z = brook(x) + lane
    tangent = math.atan2(brook(x + 1) - brook(x - 1), 2) + rng.uniform(-0.12, 0.12)
    wide, deep = rng.uniform(9, 13), rng.uniform(7, 9)
    along, across = (math.cos(tangent), math.sin(tangent)), (-math.sin(tangent), math.cos(tangent))

    def place(a, b):
        return [round(x + a * along[0] + b * across[0], 2), round(z + a * along[1] + b * across[1], 2)]

    corners = [place(-wide / 2, -deep / 2), place(wide / 2, -deep / 2), place(wide / 2, deep / 2), place(-wide / 2, deep / 2)]
    if wide > 11.5:  # an L
        corners[2:3] = [place(wide / 2, 0), place(wide / 6, 0), place(wide / 6, deep / 2)]
    to_lane = -deep / 2 if abs(lane) in (16, 44) and lane > 0 else deep / 2
    return corners, place(-wide / 4, to_lane)


def houses():
    rng = random.Random(1953)
    features = []
    places = [(x, lane) for lane in (-44, -17, 17, 44) for x in range(70, 320, 24)]
    rng.shuffle(places)
    for x, lane in sorted(places[:HOUSES]):
        corners, door = house_at(rng, x + rng.uniform(-3, 3), lane + rng.uniform(-1.5, 1.5))
        features.append({
            "type": "Feature",
            "properties": {"name": f"house_{len(features) + 1:02d}", "height_m": round(rng.uniform(5, 8), 1),
                           "residents": 12 + len(features) % 2},
            "geometry": {"type": "Polygon", "coordinates": [[*corners, corners[0]]]}})
    return {"type": "FeatureCollection", "features": features}


def raster(folder):
    columns, rows = round(LENGTH / CELL), round(WIDTH / CELL)
    lines = [f"ncols {columns}", f"nrows {rows}", "xllcorner 0", "yllcorner 0", f"cellsize {CELL:g}", "NODATA_value -9999"]
    for row in reversed(range(rows)):
        lines.append(" ".join(f"{ground((c + 0.5) * CELL, (row + 0.5) * CELL):.2f}" for c in range(columns)))
    (folder / "ground.asc").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    raster(folder)
    (folder / "houses.geojson").write_text(json.dumps(houses(), indent=1) + "\n")
