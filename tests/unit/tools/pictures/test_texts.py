"""Titles and legends of pictures fit into the picture, whatever the scene and its people are."""

import unittest

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

from wade.pictures import texts


def scene(name, taus, events=0):
    groups = [{"name": f"group_{i}"} | ({} if tau is None else {"tau": tau}) for i, tau in enumerate(taus)]
    return {"name": name, "channel": {"flow": "emitter", "velocity_m_s": 1.5, "velocity_history": []},
            "crowd": {"groups": groups}, "events": [{"tau": 0.01 * i} for i in range(events)]}


SCENES = {
    "thirty values": scene("base", [i / 30 for i in range(30)]),
    "two thousand groups": scene("base", [i / 2000 for i in range(2000)]),
    "ranges": scene("base", [{"min": i / 123456, "max": i / 3333} for i in range(1000)]),
    "events": scene("base", [0.5], events=500),
    "a name without end": scene("W" * 500, [0.123456, 0.234567, 0.345678, 0.456789], events=4),
    "brackets and letters": scene("Größe [neu] (2) 水位 {x}_y^z\\frac", [0.2]),
    "formulas": scene("$a$ $$ \\$ $\\frac{", [0.2]),
    "control characters": scene("a\nb\x1b[31m\x9b", [0.2]),
}


class Fits(unittest.TestCase):
    def picture(self):
        figure = plt.figure(figsize=(11.6, 5), dpi=80)
        self.addCleanup(plt.close, figure)
        return figure

    def assert_inside(self, drawn, figure):
        box = drawn.get_window_extent(figure.canvas.get_renderer())
        self.assertGreater(box.width, 0)
        self.assertTrue(box.x0 >= 0 and box.x1 <= figure.bbox.width, f"{box} in {figure.bbox}")

    def test_titles(self):
        for kind, described in SCENES.items():
            with self.subTest(kind):
                figure = self.picture()
                people = {"arrived": [0] * 123456, "dead": [0] * 654321}
                title = texts.title_of(described, [0] * 1000000, people, [98765.4], "so far")
                outcome = {"scene": described["name"], "seed": 2**63, "fluid": {"model": "shallow_water"},
                           "contact_rule": "difference", "status": "numerical_failure"}
                texts.draw_title(figure, title, texts.subtitle_of(outcome, 99999.9, (99999.9,), True), "words " * 60)
                self.assertEqual(len(figure.texts), 3)
                for drawn in figure.texts:
                    self.assert_inside(drawn, figure)
                self.assertGreater(figure.texts[0].get_fontsize(), 6)

    def test_legends(self):
        for count, length in ((1, 300), (2, 64), (8, 64), (8, 1)):
            with self.subTest(count=count, length=length):
                figure = self.picture()
                names = texts.group_names([{"name": "_" + "W" * length}] * count)
                texts.draw_legend(figure, [Line2D([], [], label=name) for name in names], 0.1)
                self.assertEqual(len(figure.legends[0].get_texts()), count, "no label is left out")
                self.assert_inside(figure.legends[0], figure)

    def test_few_values_are_told_one_by_one_and_many_by_their_range(self):
        self.assertEqual(texts.tau_text(scene("s05", [0.2, 0.4, 0.2])), "0.2/0.4")
        self.assertEqual(texts.tau_text(scene("s05", [0.2, 0.3, 0.4, 0.5, {"min": 0.1, "max": 0.9}])), "0.1–0.9 (5 values)")
        self.assertEqual(texts.tau_text(scene("measured", [None, 0.2, None])), "0.2/by body")
        self.assertEqual(texts.tau_text(scene("measured", [None], events=1)), "by body→0")
        self.assertEqual(texts.tau_text(scene("s05", [0.2], events=2)), "0.2→0→0.01")
        self.assertEqual(texts.tau_text(scene("s05", [0.2], events=9)), "0.2→… (9 switches)→0.08")


if __name__ == "__main__":
    unittest.main()
