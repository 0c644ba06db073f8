"""The picture of a run: what its title says and how paths are drawn in a world without ends."""

import contextlib
import io
import json
import resource
import sqlite3
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

from wade import UsageError
from wade.export import body, surfaces
from wade.export.sources import Points, Thinning
from wade.pictures import figure, film, render, run_files, texts, top_view
from wade.run.outcome import read_agents


def scene(velocity=1.5, history=(), ends="open", goals=((5.0, 9.0),), taus=(0.2,)):
    return {
        "name": "river_s05",
        "world": {"length_m": 20.0, "width_m": 10.0, "ends": ends},
        "channel": {
            "flow": "emitter",
            "velocity_m_s": velocity,
            "velocity_history": [{"time_s": t, "velocity_m_s": v} for t, v in history],
        },
        "crowd": {
            "goal_radius_m": 3.0,
            "groups": [{"tau": tau, "goal": {"x_m": x, "z_m": z}} for x, z in goals for tau in taus],
        },
    }


class Title(unittest.TestCase):
    def of(self, described):
        return texts.title_of(described, [], {}, [])

    def test_it_names_the_speed_of_the_river(self):
        self.assertEqual(self.of(scene()), "S5: $v_F$ 1.5 m/s")

    def test_a_history_is_named_by_its_range_and_not_by_the_speed_that_it_replaces(self):
        self.assertEqual(self.of(scene(1, [(0, 0), (2, 2.5), (3, 1)])), "S5: $v_F$ 0 to 2.5 m/s")
        self.assertEqual(self.of(scene(1, [(0, 2), (9, 2)])), "S5: $v_F$ 2 m/s")

    def test_a_drawn_tau_is_named_by_its_range(self):
        drawn = {"min": 0.4, "max": 0.8}
        for taus, text in (
            ((0.2,), "0.2"),
            ((0.8, 0.2, 0.8), "0.2/0.8"),
            ((drawn,), "0.4\u20130.8"),
            ((drawn, 0.5, drawn), "0.4\u20130.8/0.5"),
            (({"min": 0.3, "max": 0.3},), "0.3"),
        ):
            with self.subTest(taus=taus):
                title = texts.title_of(scene(taus=taus), ["one agent"], {"arrived": [], "dead": []}, [])
                self.assertEqual(title, f"S5: \u03c4 {text}, $v_F$ 1.5 m/s \u2013 0 of 1 arrived")


    def test_a_run_that_was_cut_off_claims_no_outcome(self):
        outcomes = (("unknown", "cut off, no outcome"), ("so far", "0 of 1 arrived, then cut off"), ("", "0 of 1 arrived"))
        for cut_off, text in outcomes:
            with self.subTest(text):
                title = texts.title_of(scene(), ["one agent"], {"arrived": [], "dead": []}, [], cut_off)
                self.assertEqual(title, f"S5: \u03c4 0.2, $v_F$ 1.5 m/s \u2013 {text}")

    def test_the_legend_of_a_run_that_was_cut_off_counts_whom_it_saw_last(self):
        ends = {"arrived": [], "dead": [], "active": [(1, 2)]}
        for cut_off, label in (("", "active (1)"), ("so far", "last seen (1)")):
            drawing, _ = figure.plt.subplots()
            self.addCleanup(figure.plt.close, drawing)
            figure.add_legend(drawing, ends, scene(), cut_off)
            self.assertIn(label, [text.get_text() for text in drawing.legends[0].get_texts()])


class Film(unittest.TestCase):
    """Two people walk in a site: 0 is sheltered at 0.5 s, between two frames, 1 drowns at 2 s; 2 stays indoors."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        described = {**scene(), "site": {"shelters": []}, "obstacles": [], "fluid": {"particle_spacing_m": 0.5}}
        described["channel"] |= {"x_min_m": 0.0, "x_max_m": 20.0, "z_min_m": 0.0, "z_max_m": 10.0, "depth_m": 1.0}
        described["crowd"]["groups"] = [{"count": 3, "name": "all", "goal": {"to": "shelters"}}]
        (self.folder / "manifest.json").write_text(json.dumps({"resolved_scene": described}))
        rows = [(0, "sheltered", "sheltered", 0.5), (1, "dead", "drowned", 2), (2, "indoors", "indoors", 3)]
        (self.folder / "agents.csv").write_text("id,outcome,state,time_s,height_m,x_m,z_m\n" + "".join(
            f"{who},{outcome},{state},{time},1.7,5,5\n" for who, outcome, state, time in rows))
        with contextlib.closing(sqlite3.connect(self.folder / "trajectories.sqlite")) as paths:
            paths.execute("CREATE TABLE trajectory_data (frame, id, pos_x, pos_y, ori_x, ori_y)")
            paths.execute("CREATE TABLE metadata (key, value)")
            paths.execute("INSERT INTO metadata VALUES ('fps', '1')")
            paths.executemany("INSERT INTO trajectory_data VALUES (?, ?, 5, 5, 1, 0)", [(0, 0), (0, 1), (1, 1), (2, 1), (3, 1)])
            paths.commit()

    def test_it_counts_as_agents_csv_at_each_time(self):
        drawn = film.Film(self.folder, None, Thinning(), 640)
        self.addCleanup(film.plt.close, drawn.figure)
        for time, expected in ((0, (2, 0, 0)), (0.6, (1, 1, 0)), (1.9, (1, 1, 0)), (3, (0, 1, 1))):
            drawn.advance(time)
            active, sheltered, dead = expected
            self.assertEqual(drawn.people_at(time), {"active": active, "arrived": 0, "sheltered": sheltered, "dead": dead,
                                                     "indoors": 1}, time)

    def test_it_begins_with_the_water_while_all_are_indoors(self):
        with contextlib.closing(sqlite3.connect(self.folder / "trajectories.sqlite")) as paths:
            paths.execute("UPDATE trajectory_data SET frame = frame + 2")
            paths.commit()
        water = None, np.array([(0.0,), (5.0,)], [("time", float)])
        with mock.patch.object(film, "water_snapshots", return_value=water):
            times, _ = film.times_of(self.folder, Thinning(), 1, 1)
        self.assertEqual(times.tolist(), [0, 1, 2, 3, 4, 5])
        drawn = film.Film(self.folder, None, Thinning(), 640)
        self.addCleanup(film.plt.close, drawn.figure)
        for time, lost, indoors in ((1, 0, 3), (2, 1, 1)):
            drawn.advance(time)
            found = drawn.people_at(time)
            self.assertEqual((found["dead"], found["indoors"]), (lost, indoors), time)

    def test_the_top_view_of_the_end_counts_the_same(self):
        rows = read_agents(self.folder / "agents.csv")
        ends, _ = top_view.people_at(rows, {}, 3, True)
        self.assertEqual({outcome: len(at) for outcome, at in ends.items()}, {"active": 0, "arrived": 0, "sheltered": 1, "dead": 1})


    def test_times_after_the_end_are_refused(self):
        for status, refused in (("completed", True), ("running", False)):
            (self.folder / "outcome.json").write_text(json.dumps({"sim_time_s": 3.0, "status": status}))
            run_files.check_time(self.folder, 3.0)
            with self.assertRaisesRegex(UsageError, "after the end of the run; allowed: 0 to 3 s") if refused \
                    else contextlib.nullcontext():
                run_files.check_time(self.folder, 3.1)


class File(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.drawing, _ = figure.plt.subplots()
        self.addCleanup(figure.plt.close, self.drawing)

    def test_each_ending_that_is_allowed_can_be_written(self):
        for ending in run_files.ENDINGS:
            output = self.folder / f"picture{ending}"
            run_files.save_picture(self.drawing, output)
            self.assertGreater(output.stat().st_size, 0)
        self.assertEqual(len(list(self.folder.iterdir())), len(run_files.ENDINGS))

    def test_full_disk_leaves_the_older_picture_and_no_part_of_the_new_one(self):
        output = self.folder / "figure.png"
        output.write_bytes(b"older")
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        self.addCleanup(resource.setrlimit, resource.RLIMIT_FSIZE, limits)
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, limits[1]))
        with self.assertRaises(OSError):
            run_files.save_picture(self.drawing, output)
        self.assertEqual([file.name for file in self.folder.iterdir()], ["figure.png"])
        self.assertEqual(output.read_bytes(), b"older")

    def test_other_endings_are_refused_with_those_that_are_allowed(self):
        for name in ("x.txt", "x", "x.svg"):
            said = io.StringIO()
            with self.subTest(name), contextlib.redirect_stderr(said):
                with self.assertRaises(SystemExit) as end:
                    figure.main([str(self.folder), "--output", name])
                self.assertEqual(end.exception.code, 2)
                self.assertIn(".png, .pdf, .eps, .ps", said.getvalue())


def water_scene(length=27.0, width=13.5, spacing=0.4642, depth=1.0, obstacles=(), blocks=(), flow="emitter"):
    channel = {"x_min_m": 0.0, "x_max_m": length, "z_min_m": 2.0, "z_max_m": 2.0 + width, "flow": flow, "depth_m": depth,
               "velocity_m_s": 1.5, "velocity_history": [], "water_blocks": [{"depth_m": block} for block in blocks]}
    return {"world": {"length_m": length, "width_m": width + 4, "ends": "open"}, "channel": channel,
            "fluid": {"particle_spacing_m": spacing}, "obstacles": list(obstacles)}


def parts_in_cells(places, width, start, cell, count):
    """Returns the fraction of each interval, `width` wide round a place, in each cell; fractions add up to 1."""
    low = np.maximum(places - width / 2 - start, 0) / cell
    high = np.minimum((places + width / 2 - start) / cell, count)
    cells = np.arange(count)
    overlap = np.minimum(high[:, None], cells + 1) - np.maximum(low[:, None], cells)
    return np.maximum(overlap, 0) / (high - low)[:, None]


def counted(x, z, described, cell=0.5):
    """Returns the result of read_water for water columns at these positions, each of spacing by spacing and 1 m."""
    channel, spacing = described["channel"], described["fluid"]["particle_spacing_m"]
    parts = []
    for axis, places in (("z", z), ("x", x)):
        low, high = channel[f"{axis}_min_m"], channel[f"{axis}_max_m"]
        parts.append(parts_in_cells(places, spacing, low, cell, int(np.ceil((high - low) / cell - 1e-9))))
    depth = parts[0].T @ parts[1] * spacing**2 / cell**2
    return 0.0, channel["x_min_m"], channel["z_min_m"], cell, depth


def lattice(described):
    """Returns positions of water columns that fill the channel evenly, as many as the spacing asks for."""
    channel, spacing = described["channel"], described["fluid"]["particle_spacing_m"]
    sides = []
    for axis in "xz":
        low, high = channel[f"{axis}_min_m"], channel[f"{axis}_max_m"]
        count = round((high - low) / spacing)
        sides.append(low + (np.arange(count) + 0.5) * (high - low) / count)
    x, z = np.meshgrid(*sides)
    return x.ravel(), z.ravel()


def volume(cells):
    x_edges, z_edges, depth = cells
    return float(np.sum(depth * np.outer(np.diff(z_edges), np.diff(x_edges))))


class Water(unittest.TestCase):
    def test_even_water_looks_even_and_none_of_it_is_lost(self):
        described = water_scene()
        x, z = lattice(described)
        # A lattice is even but for the spacing that the channel stretches; particles that are shaken by half a spacing show.
        for shaken, most in ((0.0, 0.02), (0.5, 0.1)):
            with self.subTest(shaken=shaken):
                shift = shaken * described["fluid"]["particle_spacing_m"] * (np.random.default_rng(1).random((2, len(x))) - 0.5)
                water = counted(np.clip(x + shift[0], 0, 26.99), np.clip(z + shift[1], 2, 15.49), described)
                cells = top_view.water_cells(water, described)
                self.assertAlmostEqual(volume(cells), float(water[4].sum()) * 0.25, places=9)
                self.assertGreater(cells[2].min(), 0.7, "no holes")
                self.assertLess(cells[2].std(), most)
                self.assertLess(cells[2].std(), 0.7 * water[4].std())

    def test_a_cell_that_the_particles_fill_evenly_is_left_as_it_is(self):
        described = water_scene(length=1.0, width=1.0, spacing=0.1)
        depth = np.array([[1.0, 0.0], [0.5, 0.25]])
        np.testing.assert_array_equal(top_view.water_cells((0.0, 0.0, 2.0, 0.5, depth), described)[2], depth)

    def test_cells_end_where_the_channel_ends_and_hold_the_whole_water(self):
        described = water_scene(length=1.2, width=0.28125, spacing=0.3)
        x_edges, z_edges, depth = top_view.water_cells((0.0, 0.0, 2.0, 0.5, np.array([[0.5625, 0.5625, 0.225]])), described)
        np.testing.assert_allclose(x_edges, [0, 0.5, 1, 1.2])
        np.testing.assert_allclose(z_edges, [2, 2.28125])
        np.testing.assert_allclose(depth, [[1, 1, 1]], rtol=1e-12)

    def test_water_is_not_spread_into_an_obstacle(self):
        box = {"x_min_m": 10.0, "x_max_m": 14.0, "z_min_m": 5.0, "z_max_m": 9.0}
        described = water_scene(obstacles=[box])
        depth = np.ones((27, 54))
        depth[6:14, 20:28] = 0
        np.testing.assert_array_equal(top_view.water_cells((0.0, 0.0, 2.0, 0.5, depth), described)[2], depth)

    def test_the_scale_is_that_of_the_scene_whatever_the_water(self):
        self.assertEqual(top_view.depth_scale(water_scene(depth=1.0)), 1.5)
        self.assertEqual(top_view.depth_scale(water_scene(depth=1.0, blocks=(2.0,))), 3)
        self.assertAlmostEqual(top_view.depth_scale(water_scene(depth=1.0, blocks=(0.05,), flow="closed")), 0.075)
        for named in (0.003, 0.1, 0.7, 4.0, 65.0):
            full = top_view.depth_scale(water_scene(depth=named))
            self.assertTrue(1.5 * named * (1 - 1e-9) <= full <= 2.6 * named, f"{full} of {named}")
        drawing, axes = figure.plt.subplots()
        self.addCleanup(figure.plt.close, drawing)
        for depth in (0.02, 1.0, 2.0):
            mesh = top_view.draw_water(axes, (np.array([0.0, 1]), np.array([0.0, 1]), np.array([[depth]])), water_scene())
            self.assertEqual(mesh.get_clim(), (0, 1.5))
        self.assertIsNone(top_view.draw_water(axes, (np.array([0.0, 1]), np.array([0.0, 1]), np.zeros((1, 1))), water_scene()))

    def test_arrows_of_the_stream_are_where_there_is_water(self):
        described = water_scene()
        depth = np.ones((27, 54))
        for dry, count in ((0, 12), (27, 6), (54, 0)):
            drawing, axes = figure.plt.subplots()
            self.addCleanup(figure.plt.close, drawing)
            depth[:, :dry] = 0
            cells = (np.arange(0, 27.1, 0.5), np.arange(2, 15.6, 0.5), depth)
            top_view.draw_flow(axes, described, cells)
            self.assertEqual(len(axes.texts), count)


class Groups(unittest.TestCase):
    def scene_of(self, goals, counts):
        described = scene(goals=goals)
        for group, count in zip(described["crowd"]["groups"], counts):
            group["count"] = count
        return described

    def test_one_group_and_more_than_there_are_colours_look_as_ever(self):
        self.assertEqual(top_view.path_colours(self.scene_of(((5.0, 9.0),), [3]), [0, 1]), [top_view.PATH] * 2)
        many = self.scene_of([(float(x), 9.0) for x in range(25)], [1] * 25)
        self.assertEqual(top_view.path_colours(many, [8]), [top_view.PATH])
        self.assertEqual(top_view.path_dashes(many, [8, 24]), ["solid"] * 2)
        self.assertEqual(top_view.goal_colour(many, (3.0, 9.0)), top_view.STAR)

    def test_24_groups_differ_in_colour_or_dashes(self):
        many = self.scene_of([(float(x), 9.0) for x in range(24)], [1] * 24)
        looks = zip(top_view.path_colours(many, range(24)), top_view.path_dashes(many, range(24)))
        self.assertEqual(len(set(looks)), 24)
        self.assertEqual(figure.rows_of_groups(many), 3)

    def test_outcomes_differ_in_shape_and_their_lightness_from_their_rim(self):
        """Shapes distinguish outcomes without colours; a rim makes a shape visible: a contrast of 3 (WCAG 1.4.11)."""
        styles = top_view.OUTCOMES.values()
        self.assertEqual(len({style["marker"] for style in styles}), len(styles))

        def luminance(colour):
            rgb = np.array(figure.top_view.plt.matplotlib.colors.to_rgb(colour))
            linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
            return linear @ [0.2126, 0.7152, 0.0722]

        for style in styles:
            dark, light = sorted((luminance(style["markerfacecolor"]), luminance(style["markeredgecolor"])))
            self.assertGreater((light + 0.05) / (dark + 0.05), 3)

    def test_paths_of_groups_are_seen_on_water_of_any_depth(self):
        described = self.scene_of(((5.0, 9.0), (7.0, 9.0)), [1, 1])
        drawing, axes = figure.plt.subplots()
        self.addCleanup(figure.plt.close, drawing)
        top_view.draw_paths(axes, {0: np.array([[5.0, 1.0], [5.0, 8.5]]), 1: np.array([[6.0, 1.0], [6.0, 8.5]])}, described)
        rim, paths = axes.collections
        self.assertEqual(rim.get_colors()[0][:3].tolist(), [1, 1, 1])
        self.assertGreater(rim.get_linewidths()[0], paths.get_linewidths()[0] + 1)

    def test_paths_have_the_colour_of_their_group_and_of_its_goal(self):
        described = self.scene_of(((5.0, 9.0), (7.0, 9.0), (7.0, 9.0)), [2, 1, 3])
        first, second, third = top_view.GROUPS[:3]
        self.assertEqual(top_view.path_colours(described, range(6)), [first, first, second, third, third, third])
        self.assertEqual(top_view.path_colours(described, [5, 1]), [third, first])
        self.assertEqual(top_view.goal_colour(described, (5.0, 9.0)), first)
        self.assertEqual(top_view.goal_colour(described, (7.0, 9.0)), top_view.STAR, "a goal of two groups")

    def test_people_lie_over_the_star_at_which_they_arrived(self):
        described = self.scene_of(((5.0, 9.0),), [1])
        drawing, axes = figure.plt.subplots()
        self.addCleanup(figure.plt.close, drawing)
        top_view.draw_goals(axes, described)
        star = axes.lines[0].get_zorder()
        ends = {"arrived": [np.array([5.0, 8.5])], "dead": [], "active": []}
        top_view.draw_people(axes, ends, {0: np.array([[5.0, 1.0], [5.0, 8.5]])}, described)
        self.assertGreater(axes.lines[-1].get_zorder(), star)


class Rendered(unittest.TestCase):
    """What Blender is given; Blender itself is run by system_render."""

    def edges(self, triangles):
        return [(int(a), int(b)) for triangle in triangles for a, b in zip(triangle, np.roll(triangle, -1))]

    def volume_within(self, points, triangles):
        """By the divergence theorem, m3; above 0 if the faces look outwards."""
        a, b, c = np.moveaxis(points[triangles], 1, 0)
        return float(np.sum(a * np.cross(b, c))) / 6

    def test_the_water_is_closed_and_as_much_as_in_the_cells(self):
        depth = np.zeros((4, 5))
        depth[1:3, 1:4], depth[0, 0] = 0.7, 0.7
        cells, still = (np.arange(6) * 0.5, np.arange(5) * 0.5), [0 * depth] * 3
        mesh = surfaces.over_cells(*cells, depth, 0 * depth, still)
        edges = self.edges(mesh.triangles)
        self.assertEqual({edges.count((a, b)) - edges.count((b, a)) for a, b in edges}, {0})
        self.assertAlmostEqual(self.volume_within(mesh.vertices, mesh.triangles), 7 * 0.7 * 0.25, 9)
        self.assertEqual(len(surfaces.over_cells(*cells, 0 * depth, 0 * depth, still).vertices), 0)

    def test_people_stand_where_they_are_and_their_parts_look_outwards(self):
        names = ("x", "y", "z", "heading", "lean_x", "lean_z")
        arrays = {name: np.zeros(2, "f4") for name in names}
        arrays |= {"x": np.float32([3, 8]), "z": np.float32([2, 5]), "height": np.float32([1.7, 1.2]),
                   "id": np.arange(2), "state": np.zeros(2, "i4"), "vx": np.zeros(2), "vy": np.zeros(2), "vz": np.zeros(2)}
        points, triangles, colours = render.figures(Points(0, 0.0, arrays), np.zeros(2))
        self.assertEqual(len(triangles), len(colours))
        edges = self.edges(triangles)
        self.assertEqual(sorted(edges), sorted((b, a) for a, b in edges))
        for n, who in enumerate(np.split(points, 2)):
            middle = (who.min(axis=0) + who.max(axis=0)) / 2
            np.testing.assert_allclose(middle[:2], [arrays["x"][n], arrays["z"][n]], atol=0.08)
            self.assertLess(abs(who[:, 2].max() - arrays["height"][n]), 0.05 * arrays["height"][n])
        for part in body.PARTS:
            corners, _, faces, _ = body.mesh(part)
            self.assertGreater(self.volume_within(corners.astype(float), faces), 0)


class Goals(unittest.TestCase):
    def test_the_circle_of_a_goal_at_the_edge_ends_at_the_edge(self):
        drawing, axes = figure.plt.subplots()
        self.addCleanup(figure.plt.close, drawing)
        top_view.draw_goals(axes, scene(goals=((5.0, 10.0), (19.0, 9.0))))
        self.assertEqual(len(axes.patches), 2)
        for circle in axes.patches:
            seen = circle.get_clip_box().transformed(axes.transData.inverted())
            np.testing.assert_allclose(seen.extents, [0, 0, 20, 10], atol=1e-9)


class Paths(unittest.TestCase):
    def parts(self, points, period=20.0):
        return [part.tolist() for part in top_view.laps_apart(np.array(points), period)]

    def test_a_world_with_ends_leaves_them_whole(self):
        self.assertEqual(self.parts([[1.0, 1], [19, 1]], 0), [[[1, 1], [19, 1]]])

    def test_a_path_that_goes_round_ends_at_one_end_and_goes_on_at_the_other(self):
        walked = self.parts([[18.0, 2], [19, 2], [1, 4], [2, 4]])
        self.assertEqual(walked, [[[18, 2], [19, 2], [20, 3]], [[0, 3], [1, 4], [2, 4]]])
        back = self.parts([[1.0, 4], [19, 2]])
        self.assertEqual(back, [[[1, 4], [0, 3]], [[20, 3], [19, 2]]])

    def test_each_lap_is_a_part_of_its_own(self):
        self.assertEqual(len(self.parts([[19.5, 1], [0.5, 1], [10, 1], [19.5, 1], [0.5, 1]])), 3)

    def test_a_goal_laps_away_is_a_direction(self):
        goals = ((5.0, 9.0), (100000.0, 8.0))
        self.assertEqual(top_view.far_goals(scene(ends="periodic", goals=goals)), [(100000.0, 8.0)])
        self.assertEqual(top_view.far_goals(scene(goals=goals)), [])


if __name__ == "__main__":
    unittest.main()
