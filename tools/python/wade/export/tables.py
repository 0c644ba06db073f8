"""Writers of particles and people, frame by frame: VTK for ParaView, PLY for Blender, GeoTIFF, CSV, and PedPy's text."""

import csv
import zlib

import numpy as np

from wade import UsageError, plain_file
from wade.export.meshes import write_ply
from wade.reports.files import write_whole
from wade.states import CODES, UNKNOWN

STATE_WORDS = ", ".join([f"{UNKNOWN} unknown", *(f"{code} {word}" for word, code in CODES.items())])
WORDS = (*CODES, "")  # the last is that of UNKNOWN
MEANING = {"id": "i4", "state": "i4"}  # types of what is not float32


def others(points):
    """Returns the names of all fields but positions and velocities, in the order of writing."""
    order = ("id", "state", "height", "heading", "lean_x", "lean_y", "lean_z", "mass")
    return [name for name in order if name in points.arrays]


class Vtk:
    """A .vtp a frame, raw appended Float32, and a .pvd that tells the times; of VTK's XML file formats, version 1.0."""

    def __init__(self, folder, stream):
        self.folder, self.name, self.rows = folder, stream.name, []

    def add(self, points):
        points, count = points.z_up(), len(points)
        file = self.folder / f"{self.name}_{points.number:06d}.vtp"
        blocks, offset = [], 0

        def array(name, values, components=1):
            nonlocal offset
            kind = "Float32" if values.dtype == np.float32 else "Int32"
            parts = f' NumberOfComponents="{components}"' if components > 1 else ""
            text = f'<DataArray type="{kind}" Name="{name}"{parts} format="appended" offset="{offset}"/>'
            data = np.ascontiguousarray(values).tobytes()
            blocks.append(np.uint64(len(data)).tobytes() + data)
            offset += 8 + len(data)
            return text

        index = np.arange(count, dtype="i4")
        xml = [
            '<?xml version="1.0"?>',
            '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64"><PolyData>',
            '<FieldData><DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">'
            f"{points.time_s:.9g}</DataArray></FieldData>",
            f'<Piece NumberOfPoints="{count}" NumberOfVerts="{count}">',
            f'<Points>{array("Points", points.stacked("x", "y", "z"), 3)}</Points>',
            f'<Verts>{array("connectivity", index)}{array("offsets", index + 1)}</Verts>',
            f'<PointData Vectors="velocity">{array("velocity", points.stacked("vx", "vy", "vz"), 3)}',
            *(array(name, points[name]) for name in others(points)),
            '</PointData></Piece></PolyData><AppendedData encoding="raw">',
        ]
        with open(file, "wb") as out:
            out.write(("\n".join(xml) + "\n_").encode())
            out.writelines(blocks)
            out.write(b"\n</AppendedData></VTKFile>\n")
        self.rows.append(f'<DataSet timestep="{points.time_s:.9g}" part="0" file="{file.name}"/>')

    def finish(self):
        write_collection(self.folder / f"{self.name}.pvd", self.rows)


def write_collection(file, rows):
    """A .pvd: rows name the file of each time."""
    text = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="1.0" byte_order="LittleEndian"><Collection>', *rows,
            "</Collection></VTKFile>"]
    file.write_text("\n".join(text) + "\n", encoding="utf-8")


class Depths:
    """depth.pvd and a .vti for each snapshot of a run's water.bin: the depth in its cells, m; x along x, z along y."""

    def __init__(self, folder, grid, records):
        self.folder, (self.x0, self.z0, self.cell), self.records = folder, grid, records

    def write(self, thinning):
        """Writes the snapshots that are wanted; returns how many."""
        rows = []
        for snapshot in thinning.chosen(Snapshot(record) for record in self.records):
            file = self.folder / f"depth_{snapshot.number:06d}.vti"
            high, wide = snapshot.depth.shape
            extent, time_s = f"0 {wide} 0 {high} 0 0", f"{snapshot.time_s:.9g}"
            data = np.ascontiguousarray(snapshot.depth, "<f4").tobytes()
            with open(file, "wb") as out:
                out.write(f"""<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<ImageData WholeExtent="{extent}" Origin="{self.x0:.9g} {self.z0:.9g} 0" Spacing="{self.cell:.9g} {self.cell:.9g} 1">
<FieldData><DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time_s}</DataArray></FieldData>
<Piece Extent="{extent}"><CellData Scalars="depth">
<DataArray type="Float32" Name="depth" format="appended" offset="0"/></CellData></Piece></ImageData>
<AppendedData encoding="raw">
_""".encode())
                out.write(np.uint64(len(data)).tobytes() + data + b"\n</AppendedData></VTKFile>\n")
            rows.append(f'<DataSet timestep="{time_s}" part="0" file="{file.name}"/>')
        write_collection(self.folder / "depth.pvd", rows)
        return len(rows)


class Snapshot:
    """A record of water.bin."""

    def __init__(self, record):
        self.number, self.time_s, self.depth = int(record["frame"]), float(record["time"]), record["depth"] / 1000.0


class Ply:
    """A binary little-endian .ply a frame; of water also the mesh of its surface, surface_NNNNNN.ply."""

    def __init__(self, folder, stream):
        self.folder, self.name, self.surface = folder, stream.name, stream.surface

    def add(self, points):
        if self.surface:
            write_ply(self.folder / f"surface_{points.number:06d}.ply", points.time_s, self.surface(points))
        points = points.z_up()
        names = ["x", "y", "z", "vx", "vy", "vz", *others(points)]
        kind = np.dtype([(name, MEANING.get(name, "<f4")) for name in names])
        rows = np.empty(len(points), kind)
        for name in names:
            rows[name] = points[name]
        types = ("int" if name in MEANING else "float" for name in names)
        comment = f"comment state: {STATE_WORDS}\n" if "state" in names else ""
        head = "".join(f"property {kind} {name}\n" for kind, name in zip(types, names))
        with open(self.folder / f"{self.name}_{points.number:06d}.ply", "wb") as out:
            out.write(f"ply\nformat binary_little_endian 1.0\ncomment time_s {points.time_s:.9g}\n"
                      f"comment m, m/s; x upstream, y across, z up, right-handed\n{comment}"
                      f"element vertex {len(rows)}\n{head}end_header\n".encode())
            out.write(rows.tobytes())

    def finish(self):
        pass


# Upper bounds of H1 to H5 of Australian Rainfall and Runoff (2019, book 6, table 6.7.4): depth times speed, depth, speed.
HAZARD_CLASSES = ((0.3, 0.3, 2), (0.6, 0.5, 2), (0.6, 1.2, 2), (1, 2, 2), (4, 4, 4))
WET_M = 0.01  # less is dry, as for the maps of a site
BANDS = ("depth_m", "speed_m_s", "dv_m2_s", "arr_h")


def hazard_class(depth, speed):
    """1 to 6 for H1 to H6, 0 where it is dry."""
    found = np.where(depth > 0, 1 + len(HAZARD_CLASSES), 0)
    for number, (most_dv, most_depth, most_speed) in reversed(list(enumerate(HAZARD_CLASSES, 1))):
        found[(depth > 0) & (depth * speed <= most_dv) & (depth <= most_depth) & (speed <= most_speed)] = number
    return found.astype("f4")


def write_geotiff(path, bands, corner, cell, epsg, time_s):
    """TIFF 6.0 with the tags of GeoTIFF 1.1: {name: rows of values, the southern one first}; NaN is "no data".

    corner: easting and northing of the lower left one, m; cell: its size along both; epsg: 0 if there is no number.
    """
    names, count = list(bands), len(bands)
    rows, columns = bands[names[0]].shape
    strips = [zlib.compress(np.ascontiguousarray(bands[name][::-1], "<f4").tobytes()) for name in names]
    keys = [1, 1, 0, 2, 1024, 0, 1, 1 if epsg else 32767, 1025, 0, 1, 1]  # model: projected; a cell is an area
    if epsg:
        keys = [1, 1, 0, 4, *keys[4:], 3072, 0, 1, epsg, 3076, 0, 1, 9001]
    told = "".join(f'<Item name="DESCRIPTION" sample="{k}" role="description">{name}</Item>' for k, name in enumerate(names))
    short, long, double, text = "<u2", "<u4", "<f8", "S"
    tags = {256: (long, [columns]), 257: (long, [rows]), 258: (short, [32] * count), 259: (short, [8]), 262: (short, [1]),
            273: (long, [0] * count), 277: (short, [count]), 278: (long, [rows]), 279: (long, [len(s) for s in strips]),
            284: (short, [2]), 338: (short, [0] * (count - 1)), 339: (short, [3] * count),
            33550: (double, [cell[0], cell[1], 0]), 33922: (double, [0, 0, 0, corner[0], corner[1] + rows * cell[1], 0]),
            34735: (short, keys), 42113: (text, b"nan\0"),
            42112: (text, f'<GDALMetadata><Item name="time_s">{time_s:.9g}</Item>{told}</GDALMetadata>\0'.encode())}
    tags = {tag: value for tag, value in sorted(tags.items()) if len(value[1])}
    after = 8 + 2 + 12 * len(tags) + 4  # where values lie that are too long for their entry
    sizes = {tag: len(value) if kind == text else np.dtype(kind).itemsize * len(value) for tag, (kind, value) in tags.items()}
    first = after + sum(size + size % 2 for size in sizes.values() if size > 4)
    tags[273] = (long, [first + sum(map(len, strips[:k])) for k in range(count)])
    entries, values = b"", b""
    for tag, (kind, value) in tags.items():
        data = value if kind == text else np.array(value, kind).tobytes()
        number = {short: 3, long: 4, double: 12, text: 2}[kind]
        entries += np.array([tag, number], "<u2").tobytes() + np.uint32(len(value)).tobytes()
        entries += data.ljust(4, b"\0") if len(data) <= 4 else np.uint32(after + len(values)).tobytes()
        values += (data + bytes(len(data) % 2)) if len(data) > 4 else b""
    with open(path, "wb") as out:
        out.write(b"II*\0" + np.uint32(8).tobytes() + np.uint16(len(tags)).tobytes() + entries + bytes(4) + values)
        out.writelines(strips)


class GeoTiff:
    """water_NNNNNN.tif a frame: depth, speed, depth times speed and hazard class in the cells of the water, and the maps of a
    site; in its coordinate system, if it has one, else in the scene's own metres.

    What particles or columns a cell holds gives its depth and, by their momentum, its speed.
    """

    def __init__(self, folder, scene, maps, region):
        self.folder, channel, fluid = folder, scene["channel"], scene["fluid"]
        site = scene.get("site", {})
        self.density, self.epsg = fluid["rest_density_kg_m3"], int(site.get("epsg", 0))
        columns = site and fluid["model"] == "shallow_water"
        size = fluid["shallow_water"]["cell_size_m"] if columns else max(0.5, fluid["particle_spacing_m"])
        self.edges = []  # of cells, along z and x
        for axis in "zx":
            low, high = channel[f"{axis}_min_m"], channel[f"{axis}_max_m"]
            self.edges.append(np.linspace(low, high, max(1, round((high - low) / size)) + 1))
        self.origin = np.array([site.get("origin_easting_m", 0), site.get("origin_northing_m", 0)], float)
        self.walls = None
        if maps:
            from wade.pictures.run_files import read_map

            largest, _, _ = read_map(maps / "max_depth_m.tif")
            self.edges = [np.linspace(edges[0], edges[-1], n + 1) for edges, n in zip(self.edges, largest.shape)]
            self.walls = np.isnan(largest)
        self.kept = [slice(0, len(edges) - 1) for edges in self.edges]
        if region:
            for axis, (low, high) in enumerate((region[2:], region[:2])):
                edges = self.edges[axis]
                inside = np.flatnonzero((edges[:-1] < high) & (edges[1:] > low))
                if not len(inside):
                    raise UsageError(f"--region: no cell of the water, {self.edges[1][0]:g},{self.edges[1][-1]:g},"
                                     f"{self.edges[0][0]:g},{self.edges[0][-1]:g} m, lies in it")
                self.kept[axis] = slice(inside[0], inside[-1] + 1)

    def write(self, number, time_s, bands):
        dz, dx = (edges[1] - edges[0] for edges in self.edges)
        corner = self.origin + [self.edges[1][self.kept[1].start], self.edges[0][self.kept[0].start]]
        shown = {name: (band if self.walls is None else np.where(self.walls, np.nan, band))[tuple(self.kept)]
                 for name, band in bands.items()}
        write_geotiff(self.folder / f"water_{number:06d}.tif", shown, corner, (dx, dz), self.epsg, time_s)

    def add(self, points):
        def summed(values):
            return np.histogram2d(points["z"], points["x"], self.edges, weights=values)[0]

        mass = summed(points["mass"])
        area = (self.edges[0][1] - self.edges[0][0]) * (self.edges[1][1] - self.edges[1][0])
        depth = mass / (self.density * area)
        depth[depth < WET_M] = 0
        per_mass = np.divide(1, mass, out=np.zeros_like(mass), where=depth > 0)
        speed = per_mass * np.hypot(summed(points["mass"] * points["vx"]), summed(points["mass"] * points["vz"]))
        self.write(points.number, points.time_s, dict(zip(BANDS, (depth, speed, depth * speed, hazard_class(depth, speed)))))

    def add_snapshot(self, snapshot, grid):
        """Of water.bin, which knows depths only: what of each of its cells lies in a cell of the water."""
        x0, z0, cell = grid
        depth = snapshot.depth
        for axis, low in ((0, z0), (1, x0)):
            own = low + cell * np.arange(depth.shape[axis] + 1)
            edges = self.edges[axis]
            shared = np.minimum(own[1:], edges[1:, None]) - np.maximum(own[:-1], edges[:-1, None])
            depth = np.moveaxis(np.tensordot(np.maximum(0, shared) / (edges[1] - edges[0]), depth, (1, axis)), 0, axis)
        self.write(snapshot.number, snapshot.time_s, {"depth_m": np.where(depth < WET_M, 0, depth)})

    def finish(self):
        pass


def copy_maps(maps, folder):
    """The maps of a site, which are GeoTIFF already; their names."""
    from wade.pictures.run_files import read_map

    files = sorted(maps.glob("*.tif"))
    for file in files:
        read_map(file)  # a damaged one is refused
        write_whole(folder / file.name, plain_file.read_bytes(file, plain_file.TABLE_MIB))
    return [file.stem for file in files]


class Csv:
    """One .csv of all frames, a row a particle or person."""

    def __init__(self, folder, stream):
        self.file = open(folder / f"{stream.name}.csv", "w", newline="", encoding="utf-8")
        self.rows, self.begun = csv.writer(self.file, lineterminator="\n"), False

    def add(self, points):
        names = ["x", "y", "z", "vx", "vy", "vz", *others(points)]
        units = {"mass": "mass_kg", "height": "height_m", "heading": "heading_rad", "lean_x": "lean_x_rad",
                 "lean_z": "lean_z_rad", **{n: f"{n}_m" for n in "xyz"}, **{f"v{n}": f"v{n}_m_s" for n in "xyz"}}
        if not self.begun:
            self.rows.writerow(["frame", "time_s", *(units.get(name, name) for name in names)])
            self.begun = True
        columns = [[WORDS[code] for code in points[name]] if name == "state" else points[name].tolist()
                   if name in MEANING else [f"{value:.7g}" for value in points[name].tolist()] for name in names]
        time_s = f"{points.time_s:.9g}"
        self.rows.writerows([points.number, time_s, *row] for row in zip(*columns))

    def finish(self):
        self.file.close()


class PedPy:
    """people.txt, as load_trajectory_from_txt of PedPy and JuPedSim's text format have it; their y is our z."""

    def __init__(self, folder, stream):
        self.stream, self.first, self.step = stream, None, 0
        self.file = open(folder / "people.txt", "w", encoding="utf-8")
        self.held = None  # the first frame, until the second one tells the rate

    def add(self, points):
        if self.first is None:
            self.first, self.held = points.number, points
            return
        if not self.step:
            self.step = points.number - self.first
            self.begin()
        self.write(points)

    def begin(self):
        self.file.write(f"# framerate: {self.stream.rate_hz / (self.step or 1):.9g} fps\n# ID FR x/m y/m z/m\n")
        if self.held:
            self.write(self.held)
            self.held = None

    def write(self, points):
        here = points.only(points["present"] > 0) if "present" in points.arrays else points
        frame = round((points.number - self.first) / self.step) if self.step else 0
        for who, x, z, height in zip(here["id"], here["x"], here["z"], here["height"]):
            self.file.write(f"{who}\t{frame}\t{x:.4f}\t{z:.4f}\t{height:.2f}\n")

    def finish(self):
        if not self.step:
            self.begin()
        self.file.close()
