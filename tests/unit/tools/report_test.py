"""What tools/report concludes from its rows; nothing is run."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools"))

import numpy as np  # noqa: E402
from bplbm.page.report import report_page  # noqa: E402
from bplbm.project import CASES  # noqa: E402
from bplbm.report import arrays, command, details, judges, needs, seconds, speed, stability  # noqa: E402
from bplbm.report.cases import AT_REST, FREE, OURS, PAPERS  # noqa: E402


def row(scheme, seconds, error, spread=0.0, family=OURS, status="ok"):
    return {"scheme": scheme, "seconds": seconds, "error_percent": error, "spread_percent": spread, "family": family,
            "status": status, "reference_uncertainty_percent": 0.01}


class Recommended(unittest.TestCase):
    def test_is_the_default_where_times_are_alike(self):
        rows = [row("other", 1.0, 1.5), row("default", 1.1, 1.9), row("other", 1.05, 0.1)]
        self.assertEqual(command.recommended(rows, 2.0)["scheme"], "default")
        self.assertEqual(command.recommended(rows, 1.0)["error_percent"], 0.1)

    def test_is_the_cheapest_where_they_are_not(self):
        rows = [row("other", 1.0, 1.5), row("default", 1.3, 0.1)]
        self.assertEqual(command.recommended(rows, 2.0)["scheme"], "other")

    def test_counts_half_of_the_spread_and_nothing_that_failed_or_is_not_ours(self):
        rows = [row("default", 1.0, 1.5, spread=2.0), row("default", 1.0, 0.1, status="blown up"),
                row("default", 1.0, 0.1, family=PAPERS)]
        self.assertIsNone(command.recommended(rows, 2.0))
        self.assertIsNotNone(command.recommended(rows, 2.5))


    def test_is_told_once_for_all_that_it_serves(self):
        rows = [{**row("default", 1.0, 1.5), "choice": "a", "re_h": 3.0, "overlay": "[numerics]\ncell = 1\n"},
                {**row("default", 3.0, 0.5), "choice": "b", "re_h": 3.0, "overlay": "[numerics]\ncell = 2\n"}]
        text = command.text_of_recommended(rows)
        self.assertEqual([line for line in text if line.startswith("For")],
                         ["For 5 and 2 % at Re_h 3 take default, a: 1 s. Here that is",
                          "For 1 % at Re_h 3 take default, b: 3 s. Here that is"])
        self.assertIn("[numerics]\ncell = 2", text)


class Speed(unittest.TestCase):
    def test_bodies_fill_their_part_and_do_not_touch(self):
        for dimension, cells, fraction, _ in speed.CASES_OF_SPEED:
            centres = speed.centres(dimension, cells, fraction)
            volume = speed.FULL[dimension] * speed.CELLS_A_DIAMETER ** dimension * len(centres) / cells ** dimension
            one = speed.FULL[dimension] * speed.CELLS_A_DIAMETER ** dimension / cells ** dimension
            self.assertLess(abs(volume - fraction), 0.15 * fraction + 1.01 * one)  # whole bodies along each axis
            near = centres[:200]  # the layers begin at one side
            gaps = np.linalg.norm(near[:, None] - centres[None], axis=2)
            self.assertGreater(np.min(gaps[gaps > 0], initial=np.inf), speed.CELL * speed.CELLS_A_DIAMETER)
            self.assertGreater(centres.min(), 0.5 * speed.CELL * speed.CELLS_A_DIAMETER - 1e-12)
            self.assertLess(centres.max(), speed.CELL * (cells - 0.5 * speed.CELLS_A_DIAMETER) + 1e-12)

    def test_builds_run_in_turns_and_neighbours_are_compared(self):
        order = []

        def run(bins, folder, name):  # the machine gets slower from pair to pair
            order.append(name)
            seconds = (2.0 if name == "other" else 1.0) * (1 + (len(order) - 1) // 2)
            return {"wall_seconds": seconds, "physical_seconds": 0.5, "steps": 10, "cells": 1000}

        kept, speed.run, speed.OUT = (speed.run, speed.OUT), run, pathlib.Path(tempfile.mkdtemp())
        try:
            for program in ("lbm", "liggghts"):
                (speed.OUT / program).touch()
            speed.BIN = speed.OUT
            rows = speed.speed(speed.OUT, 3, [(2, 40, 0.1, 10)])
        finally:
            speed.run, speed.OUT = kept
        self.assertEqual(order, ["this", "other", "other", "this", "this", "other"])
        self.assertEqual(rows[0]["ratio"], [2.0, 2.0, 2.0])
        self.assertEqual(rows[0]["seconds"][1], 4.0)
        self.assertIn("times as fast", "\n".join(speed.text_of_speed(rows, 3)))


class Seconds(unittest.TestCase):
    def sizes(self, scheme, *points, tau="τ 1.5"):
        return [{**row(scheme, seconds, error), "choice": f"D/h {size}, {tau}"} for size, seconds, error in points]

    def test_lie_on_a_line_in_log_log(self):
        rows = self.sizes("default", (5, 1.0, -4.0), (10, 100.0, 0.25))
        self.assertAlmostEqual(seconds.best(rows, "default")[0], 10.0)

    def test_are_of_the_last_crossing_since_an_error_may_pass_through_zero(self):
        rows = self.sizes("default", (5, 1.0, -0.1), (10, 10.0, 2.0), (20, 100.0, 0.5))
        self.assertAlmostEqual(seconds.best(rows, "default")[0], 10.0 * 10.0**0.5)

    def test_are_bounds_where_no_size_run_is_beyond_the_limit(self):
        rows = self.sizes("default", (5, 1.0, -3.0), (10, 10.0, 2.0))
        self.assertIsNone(seconds.best(rows, "default"))
        rows = self.sizes("default", (5, 1.0, -0.3), (10, 10.0, 0.2))
        self.assertEqual(seconds.best(rows, "default")[:2], (1.0, None))

    def test_are_those_of_the_cheapest_step_and_told_of_the_default_and_the_one_before(self):
        rows = self.sizes(AT_REST[0], (5, 1.0, -4.0), (10, 100.0, 0.25)) \
            + self.sizes(AT_REST[0], (5, 0.1, -4.0), (10, 10.0, 0.25), tau="τ 2.5") \
            + self.sizes(AT_REST[1], (5, 4.0, -4.0), (10, 400.0, 0.25)) \
            + self.sizes(FREE[0], (5, 4.0, -4.0), (10, 400.0, 0.25))  # with nothing to compare with
        self.assertEqual(seconds.text_of_seconds(rows), [
            "Seconds to 1 %: default, bodies at rest: TRT, resistance, 1 s (between D/h 5 and D/h 10, τ 2.5, "
            "where its error changes sign); TRT, Holdych (former default), 40 s (between D/h 5 and D/h 10, τ 1.5, where its error "
            "changes sign): 40 times less.  "])

    def test_say_where_an_error_grows_again(self):
        rows = self.sizes("default", (5, 1.0, -3.0), (10, 10.0, 0.2), (20, 100.0, 1.1))
        self.assertEqual(seconds.said(rows, "default"), "not reached for good: less at D/h 10, more again at the finest run")


class Arrays(unittest.TestCase):
    def test_are_a_row_a_solid_fraction_and_a_column_a_size(self):
        row = {"body": "disc", "solid_term": "holdych", "fraction": 0.2, "tau": 1.0, "error_percent": -1.5, "spread_percent": 0.25}
        rows = [{**row, "cells": 20, "diameter": 10.09}, {**row, "cells": 8, "diameter": 4.04},
                {**row, "cells": 20, "diameter": 10.09}, {**row, "cells": 8, "diameter": 4.04, "tau": 2.0}]
        self.assertEqual([r["cells"] for r in arrays.at_one(rows, "disc", "holdych")[0.2]], [8, 20])
        self.assertEqual(arrays.cell(rows[0]), "-1.50 (0.25) D10.1")
        self.assertEqual(arrays.cell({**rows[0], "error_percent": None}), "no end")


class Text(unittest.TestCase):
    def test_is_wrapped_but_for_tables_and_keeps_its_breaks(self):
        lines = command.wrapped(["word " * 50 + " ", "| " + "a | " * 50, "short  "])
        self.assertLessEqual(max(map(len, lines[:-2])), command.WIDTH)
        self.assertTrue(lines[-3].endswith("word  "))
        self.assertEqual(lines[-2:], ["| " + "a | " * 50, "short  "])


class Page(unittest.TestCase):
    TEXT = """# Title

One `a|b <c>` **bold** line  
[next](#a-table) line
with more
```toml
[x]

y = 1
```
![own](own.png)
## A table
| a | b |
|---|---|
| -1.5 | <text> |
| 2e-3 | – |
- one
  goes on
- two
"""

    def test_holds_what_the_markdown_holds(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "own.png").write_bytes(b"png")
            text = report_page(self.TEXT, pathlib.Path(folder))
        for part in ("<title>Title</title>", "<code>a|b &lt;c&gt;</code> <b>bold</b> line<br>", '<a href="#a-table">next</a> line with more',
                     "<pre>[x]\n\ny = 1</pre>", 'src="data:image/png;base64,cG5n" alt="own"', '<h2 id="a-table">A table</h2>',
                     '<table class="sort"><thead><tr><th>a</th><th>b</th></tr></thead>', "<td class=n>-1.5</td><td>&lt;text&gt;</td>",
                     "<td class=n>2e-3</td>", "<ul><li>one goes on</li><li>two</li></ul>"):
            self.assertIn(part, text)

    def test_of_the_shipped_reports_loses_no_row(self):
        for path in (CASES / "report").rglob("README.md"):
            text, source = report_page(path.read_text(), path.parent), path.read_text()
            rows = [line for line in source.splitlines() if line.startswith("|")]
            self.assertEqual(text.count("<tr>"), len(rows) - text.count("<table"), path)
            self.assertEqual(text.count("<img"), source.count("!["), path)
            self.assertNotIn("```", text)


class Advantage(unittest.TestCase):
    def test_is_told_in_time_and_in_error(self):
        rows = [row("default", 1.0, 1.0), row("papers", 4.0, 2.0, family=PAPERS), row("papers", 0.5, 8.0, family=PAPERS)]
        cost, error = command.advantage(rows, PAPERS)
        self.assertEqual((cost, error), ([0.5, 4.0], [0.0, 2.0]))


class Details(unittest.TestCase):
    def run_of(self, log, obstacles):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        run = FakeRun([], scene="settling_disc")
        run.folder = pathlib.Path(folder.name)
        (run.folder / "lbm.log").write_text(log)
        (run.folder / "obstacles.csv").write_text("time,obstacle,fx,fy,torque\n" + "".join(
            f"{time},1,{load},0,0\n" for time, load in enumerate(obstacles)))
        return run

    def test_what_the_run_took_fills_what_the_overlay_leaves_open(self):
        run = self.run_of("collision    central_moment [auto: …]\nsolids       immersed_moving_boundary, holdych [auto: …]\n", [])
        auto = {"numerics": {"collision": "auto", "solid_term": "auto"}}
        self.assertEqual(details.made_with(run, auto, 2),
                         {"lattice": "D2Q9", "precision": "double", "scheme": "immersed_moving_boundary",
                          "collision": "central_moment", "solid_term": "holdych", "weight": "viscous"})
        run = self.run_of("collision    trt\nsolids       immersed_moving_boundary, layered_resistance [auto: …]\n", [])
        self.assertNotIn("weight", details.made_with(run, auto, 3))
        links = details.made_with(run, {"numerics": {"collision": "bgk", "scheme": "bounce_back"}}, 3)
        self.assertEqual(links, {"lattice": "D3Q19", "precision": "double", "scheme": "bounce_back", "collision": "bgk"})

    def test_noise_is_what_a_line_leaves_of_the_last_quarter(self):
        loads = [1e6] * 300 + [200.0 + 0.01 * i + (-1) ** i for i in range(100)]
        noise = details.load_noise("cylinder", self.run_of("", loads))
        self.assertAlmostEqual(noise["load_sigma_percent"], 0.5, 2)
        self.assertEqual(details.load_noise("cylinder", self.run_of("", loads[:12])), {})


class FakeRun:
    """What a judge asks of a run, without one: columns of a particle's probes and parameters."""

    def __init__(self, columns, **parameters):
        self.columns, self.parameters, self.summary = columns, parameters, parameters

    def probes(self, particle=1):
        return self.columns[particle - 1]


class HardCases(unittest.TestCase):
    def test_noise_is_the_change_a_step(self):
        time = np.arange(2000.0)
        disc = {"particle_density": 4.0 / np.pi, "diameter": 1.0, "depth": 1.0, "gravity_y": -1.0}  # weighs 1
        for height, met in ((0.02, True), (0.03, False)):
            force = 3.0 + 1e-6 * time + height * (-1.0) ** time
            run = FakeRun([{"time": time, "fy": force}], **disc)
            for judge in (judges.noise(0, 2000), judges.jump(0, 2000)):
                self.assertEqual(judge([run]), (met, f"{200 * height:.2g} %"))

    def test_a_way_is_the_same_half_a_period_on(self):
        one = {"x": np.array([0.7, 0.9, 1.0]), "y": np.array([0.5, 0.5, 0.5])}
        for error, met in ((0.0, True), (1e-9, False)):
            other = {"x": np.array([0.2, 0.4, 0.5 + error]), "y": one["y"]}
            runs = [FakeRun([columns], box_x=1.0, diameter=1.0) for columns in (one, other)]
            self.assertEqual(judges.same_way(0.5)(runs)[0], met)

    def test_numbers_of_discs_play_no_part(self):
        a, b = ({"x": np.array([x]), "y": np.array([2.0])} for x in (1.0, 3.0))
        first = FakeRun([a, b], diameter=1.0)
        self.assertTrue(judges.order([first, FakeRun([b, a], diameter=1.0)])[0])
        self.assertFalse(judges.order([first, FakeRun([a, b], diameter=1.0)])[0])

    def test_a_frame_that_moves_is_judged_by_the_order_of_the_equilibrium(self):
        for collision, drift, met in (("trt", [0.01, 0.015, 0.06], True), ("trt", [0.0, -0.016, 0.0], False),
                                      ("central_moment", [0.01, 0.01, 0.01], True), ("central_moment", [0.0, 0.0, -0.011], False)):
            self.assertEqual(judges.carried({"collision": collision, "drift": drift})[0], met)

    def test_steps_that_ran_away_are_blown_up_and_not_judged(self):
        case = stability.STEPS[1]  # shared, order
        for values, verdict, met in (({"shared": 1e-13, "order": 0.0}, "bounded", True),
                                     ({"shared": 1e-13, "order": 1e-11}, "bounded", False),
                                     ({"shared": 1e-13, "order": None}, "blown up", None),
                                     ({"shared": 1e-13, "order": 1e23}, "blown up", None)):
            became = stability.outcome_of_steps(case, values)
            self.assertEqual((became["verdict"], became["met"]), (verdict, met))

    def test_a_burst_keeps_momentum_and_energy(self):
        for lost, met in ((0.0, True), (0.03, False)):
            with tempfile.TemporaryDirectory() as folder:
                # two discs of 1 kg: the fluid brakes the first by 1 N for 1 s; the ledger holds 0.5 J, and loses some
                frames = "".join(f"ITEM: TIMESTEP\n{step}\n" + 7 * "head\n" + f"1 1.0 0.5 {x} 0 {v} 0 0 -1 0 0\n"
                                 "2 1.0 0.5 9 0 -1.0 0 0 0 0 0\n" for step, v, x in ((0, 2.0, 0.0), (1, 1.0, 1.5)))
                log = "".join(f"{step:8d} 1 {energy} 0 0 0 0 \n" for step, energy in ((0, 0.5), (20, 0.5 - 2.5 * lost)))
                pathlib.Path(folder, "discs.txt").write_text(frames)
                pathlib.Path(folder, "liggghts.log").write_text(log)
                run = FakeRun([], interval=1.0)
                run.folder = pathlib.Path(folder)
                self.assertEqual(judges.burst([run])[0], met)

    def test_each_row_of_the_table_has_the_default_apart(self):
        rows = [{"case": "c", "asked": "a", "operator": op, "solids": stability.RULE, "verdict": verdict, "met": met,
                 "value": value}
                for op, verdict, met, value in (("auto", "bounded", True, "3 %"), ("trt", "bounded", False, "9 %"),
                                                ("bgk", "blown up at step 7", None, ""))]
        self.assertIn("| c | a | met, 3 % | – | trt, by rule (9 %) | – | bgk, by rule (7) |",
                      stability.text_of_stability(rows))


class Needs(unittest.TestCase):
    def test_only_what_is_off_is_switched_on(self):
        self.assertEqual(needs.everything_on("taylor_green"),
                         {"numerics": {"smagorinsky": 1e-3}, "fluid": {"body_force": [1e-12, 0.0]}})
        self.assertEqual(needs.everything_on("suspension_migration"),
                         {"coupling": {"lubrication_range": 1e-9, "virtual_mass": 1e-9}})
        self.assertEqual(len(needs.everything_on("ten_cate_sphere")["fluid"]["body_force"]), 3)

    def test_solid_parts_are_of_the_last_run_and_without_the_wait(self):
        table = "Loop time of {0} on 1 procs\n" + "".join(
            f"{key} time (%) = {{{i}}} (1.0)\n" for i, key in enumerate(("Pair", "Neigh", "Comm", "Outpt", "Other"), 1))
        log = table.format(9, 9, 9, 9, 9, 9) + "fix lbm/couple: 4 intervals, 3.5 s of waiting for the fluid, " \
            "0.5 s of it before the first step\n" + table.format(6, 1, 0.5, 0.25, 0.25, 4)
        self.assertEqual(needs.solid_parts(log, 4), {"contacts": 250000.0, "neighbours": 125000.0, "ranks": 62500.0,
                                                            "output": 62500.0, "other": 250000.0, "waiting": 750000.0})


if __name__ == "__main__":
    unittest.main()
