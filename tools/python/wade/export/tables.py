"""Writers of particles and people, frame by frame: VTK for ParaView, PLY for Blender, CSV, and PedPy's text."""

import csv

import numpy as np

from wade.export.sources import STATES

STATE_WORDS = ", ".join(f"{code} {word}" for code, word in enumerate(STATES))
MEANING = {"id": "i4", "state": "i4"}  # types of what is not float32


def others(points):
    """Names of all but places and velocities, in the order in which they are written."""
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
    """A binary little-endian .ply a frame."""

    def __init__(self, folder, stream):
        self.folder, self.name = folder, stream.name

    def add(self, points):
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
        columns = [[STATES[code] for code in points[name]] if name == "state" else points[name].tolist()
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
