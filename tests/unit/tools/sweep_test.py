"""What tools/sweep plans, keeps and writes; the runs are pretended."""

import contextlib
import csv
import io
import json
import pathlib
import re
import sys
import tempfile
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

import numpy as np  # noqa: E402
from bplbm import sweep  # noqa: E402
from bplbm.page import chart  # noqa: E402
from bplbm.page.sweep import charts, curves, status  # noqa: E402
from bplbm.sweep_values import Mistake, Sweep, axis, evaluate, Names  # noqa: E402
from bplbm.toml_text import laid_over, toml  # noqa: E402

SCENE = {"fluid": {"density": 1000.0, "gravity": [0.0, -9.81]}, "boundary": [{"side": "left", "pressure": 5.0}, {"side": "right"}],
         "particles": {"density": [2000.0, 2500.0], "variables": {"seed": 1, "friction": 0.4}}}


def planned(sets, lets=()):
    varied = Sweep(SCENE, tuple(map(axis, sets)), tuple(map(sweep.let, lets)))
    return [(varied.label(chosen), varied.overlay(chosen)) for chosen in varied.combinations()]


class Values(unittest.TestCase):
    def test_lists_ranges_texts_and_vectors(self):
        self.assertEqual(axis("a.b=1..3,7").values, (1, 2, 3, 7))
        self.assertEqual(axis("a.b=3..1").values, (3, 2, 1))
        self.assertEqual(axis("a.b=1e-5,trt,true,[0.1,2]").values, (1e-5, "trt", True, [0.1, 2]))

    def test_all_combinations_the_last_key_fastest(self):
        runs = planned(["friction=0.1,0.2", "fluid.density=1,2"])
        self.assertEqual([name for name, _ in runs], ["friction-0.1_density-1", "friction-0.1_density-2", "friction-0.2_density-1",
                                                      "friction-0.2_density-2"])
        self.assertEqual(runs[1][1], {"particles": {"variables": {"friction": 0.1}}, "fluid": {"density": 2}})

    def test_keys_of_one_name_are_told_apart(self):
        self.assertEqual(planned(["fluid.density=1", "particles.density=2"])[0][0], "fluid.density-1_particles.density-2")
        self.assertEqual(planned(["fluid.gravity[1]=-1", "boundary[0].pressure=7"])[0][0], "gravity_1--1_pressure-7")

    def test_an_entry_of_a_list_keeps_the_others(self):
        overlay = planned(["boundary[0].pressure=7"])[0][1]
        self.assertEqual(overlay, {"boundary": [{"side": "left", "pressure": 7}, {"side": "right"}]})
        self.assertEqual(SCENE["boundary"][0]["pressure"], 5.0)
        self.assertEqual(planned(["fluid.gravity[1]=-1"])[0][1], {"fluid": {"gravity": [0.0, -1]}})

    def test_expressions_follow_from_other_keys(self):
        (_, overlay), = planned(["phi=0.1"], ["fluid.body_force=[0, phi*(particles.density[1]/fluid.density-1)*9.81]"])
        self.assertEqual(list(overlay), ["fluid"])
        np.testing.assert_allclose(overlay["fluid"]["body_force"], [0, 0.1 * 1.5 * 9.81])
        (_, overlay), = planned(["fluid.density=500"], ["numerics.cell=1/fluid.density", "run.end_time=2*numerics.cell*sqrt(friction*10)"])
        self.assertAlmostEqual(overlay["run"]["end_time"], 2 / 500 * 2)

    def test_mistakes_are_named(self):
        for words, said in ((["nothing=1"], "no expression uses it"), (["particles.variables.sede=1"], "it has seed, friction"),
                            (["a.b="], "KEY=VALUE"), (["a.b=1,,2"], "is missing"), (["a.b=0.1..0.3"], "whole numbers only"),
                            (["a.b=1,1"], "there twice"), (["a b=1"], "is no key"), (["boundary[5].pressure=1"], "no entry number 5"),
                            (["fluid.density=1", "fluid.density=2"], "given twice"), (["a.b=1..20000"], "more than 10000")):
            with self.assertRaises(Mistake, msg=words) as caught:
                planned(words)
            self.assertIn(said, str(caught.exception))

    def test_an_expression_can_do_arithmetic_and_nothing_else(self):
        names = Names(SCENE, {"x": 2})
        self.assertEqual(evaluate("x^3 + max(1, -x)", names), 9)
        for text, said in (("__import__('os')", "cannot be used"), ("x.real", "nothing is called 'x.real'"), ("1/0", "has no value"),
                           ("x +", "is no expression"), ("(-8)**0.5", "no finite value"), ("y", "nothing is called 'y'")):
            with self.assertRaises(Mistake, msg=text) as caught:
                evaluate(text, names)
            self.assertIn(said, str(caught.exception))


class Toml(unittest.TestCase):
    def test_what_is_written_is_read_again(self):
        import tomllib
        tables = {"a": {"b": 1, "c": {"d": [1.5, "ä"]}}, "list": [{"x": True}, {"x": False}]}
        self.assertEqual(tomllib.loads(toml(tables)), tables)

    def test_an_overlay_replaces_keys_one_by_one_and_lists_whole(self):
        self.assertEqual(laid_over({"a": {"b": 1, "c": {"d": 1, "e": 2}}, "l": [1, 2]}, {"a": {"c": {"d": 9}}, "l": [3]}),
                         {"a": {"b": 1, "c": {"d": 9, "e": 2}}, "l": [3]})


STAND_IN = """import json, pathlib, sys
words = sys.argv[1:]
out = pathlib.Path(words[words.index("--out") + 1])
overlay = pathlib.Path(words[words.index("--overlay") + 1]).read_text()
out.mkdir(exist_ok=True)
(out / ".bplbm").write_text("")
density = float((overlay + "density = 1").split("density = ")[1].split()[0])
open("started", "a").write(f"{density:g} ")
if density == 13:
    sys.exit("lbm | error | unlucky <number>")
missed = density == 15
result = {"name": "speed", "value": 2 * density, "unit": "m/s", "reference": 1, "source": "x", "error": 0.5 * missed, "tolerance": 0.02, "pass": not missed}
(out / "summary.json").write_text(json.dumps({"results": [result], "quantities": [], "physical_seconds": 1.0, "ma_max": 0.1,
                                              "mass_drift": 0.0, "wall_seconds": 0.1, "parameters": {}}))
sys.exit(4 * missed)
"""


class Command(unittest.TestCase):
    """tools/sweep with a stand-in for tools/launch.py."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "launch.py").write_text(STAND_IN.replace('open("started"', f'open({str(self.folder / "started")!r}'))
        (self.folder / "sand").mkdir()
        (self.folder / "sand" / "scene.toml").write_text("[fluid]\ndensity = 1.0\n")
        self.out = self.folder / "out"

    def main(self, *words):
        words = ["sweep", str(self.folder / "sand"), "--out", str(self.out), *words]
        with mock.patch.object(sweep, "TOOLS", self.folder), mock.patch.object(sys, "argv", words), \
                contextlib.redirect_stdout(io.StringIO()) as said, contextlib.redirect_stderr(said):
            try:
                return sweep.main()
            except SystemExit as end:
                return end.code
            finally:
                self.said = said.getvalue()

    def started(self):
        path = self.folder / "started"
        words = sorted(path.read_text().split()) if path.exists() else []
        path.unlink(missing_ok=True)
        return words

    def rows(self):
        with open(self.out / "sweep.csv") as file:
            return list(csv.DictReader(file))

    def test_what_is_done_is_not_done_again(self):
        self.assertEqual(self.main("--set", "fluid.density=1,2", "--jobs", "2"), 0)
        self.assertEqual(self.started(), ["1", "2"])
        self.assertEqual(self.main("--set", "fluid.density=1,2,3"), 0)
        self.assertEqual(self.started(), ["3"])
        self.assertEqual([row["speed [m/s]"] for row in self.rows()], ["2.0", "4.0", "6.0"])

    def kept(self, number=1):
        """Values of the results in the table of an earlier sweep."""
        with open(self.out.with_name(f"out.{number}") / "sweep.csv") as file:
            return [row["speed [m/s]"] for row in csv.DictReader(file)]

    def test_an_earlier_sweep_is_kept_where_the_scene_or_an_option_is_another(self):
        self.main("--set", "fluid.density=1,2")
        self.started()
        (self.folder / "sand" / "scene.toml").write_text("[fluid]\ndensity = 1.5\n")
        self.main("--set", "fluid.density=1")
        self.assertEqual((self.started(), self.kept()), (["1"], ["2.0", "4.0"]))
        self.assertEqual(len(self.rows()), 1)
        self.assertIn(f"sweep | kept | the earlier sweep in {self.out} is now {self.out}.1", self.said)
        self.main("--set", "fluid.density=1", "--until", "0.5")
        self.assertEqual((self.started(), self.kept(2)), (["1"], ["2.0"]))
        (self.folder / "sand" / "scene.toml").write_text('[fluid]\ndensity = 1.5\n[grains]\nfile = "grains.csv"\n')
        for text in ("1", "2", "2"):  # a file that the scene names is part of it
            (self.folder / "sand" / "grains.csv").write_text(text)
            self.main("--set", "fluid.density=1", "--until", "0.5")
        self.assertEqual((self.started(), self.kept(4)), (["1", "1"], ["2.0"]))
        self.main("--set", "fluid.density=13", "--until", "0.5")  # one that fails, and then nothing is lost by another scene
        self.main("--set", "fluid.density=1", "--until", "0.5")
        self.assertFalse(self.out.with_name("out.5").exists())

    def test_an_expression_that_is_another_is_another_run(self):
        self.main("--set", "particles.hydraulic_ratio=1", "--let", "fluid.density=2*particles.hydraulic_ratio")
        self.main("--set", "particles.hydraulic_ratio=1", "--let", "fluid.density=3*particles.hydraulic_ratio")
        self.assertEqual((self.started(), self.kept()), (["2", "3"], ["4.0"]))

    def test_rows_of_other_values_and_keys_stay_in_the_table(self):
        self.main("--set", "fluid.density=1,2,3")
        self.main("--set", "fluid.density=2")
        self.assertEqual(self.started(), ["1", "2", "3"])
        self.assertEqual([row["fluid.density [kg/m³]"] for row in self.rows()], ["2", "1", "3"])
        self.assertIn("2 earlier runs of other values or keys stay in the table", self.said)
        self.main("--set", "particles.hydraulic_ratio=7")
        self.assertEqual([(row["particles.hydraulic_ratio"], row["fluid.density [kg/m³]"]) for row in self.rows()],
                         [("7", "1.0"), ("", "1"), ("", "2"), ("", "3")])  # 1.0 is the scene's

    def test_values_of_expressions_are_columns(self):
        self.main("--set", "a=1,2", "--let", "fluid.density=10*a")
        self.assertEqual([(row["a"], row["fluid.density [kg/m³]"]) for row in self.rows()], [("1", "10"), ("2", "20")])
        self.assertIn("fluid.density [kg/m³]", (self.out / "index.html").read_text())

    def test_a_key_that_no_scene_has_is_refused_at_once(self):
        for words in (["--set", "fluid.densty=1,2"], ["--set", "fluid.density=1", "--let", "fluid.densty=2"]):
            self.assertEqual(self.main(*words, "--list"), 2)
            self.assertIn("no scene has a key 'fluid.densty'; is it fluid.density?", self.said)
        self.assertEqual(self.main("--set", "boundary[0].presure=1", "--list"), 2)
        self.assertEqual(self.main("--set", "fluid.gravity=[0,-1]", "--list"), 0)

    def test_a_failed_run_keeps_its_reason_and_the_others_go_on(self):
        self.assertEqual(self.main("--set", "fluid.density=12,13,14"), 1)
        rows = self.rows()
        self.assertEqual([row["status"] for row in rows], ["ok", "failed", "ok"])
        self.assertEqual(rows[1]["reason"], "unlucky <number>")
        page = (self.out / "index.html").read_text()
        self.assertIn("unlucky &lt;number&gt;", page)
        self.assertIn("<svg", page)
        self.started()
        self.main("--set", "fluid.density=12,13,14")
        self.assertEqual(self.started(), [])
        self.main("--set", "fluid.density=12,13,14", "--retry")
        self.assertEqual(self.started(), ["13"])

    def test_a_result_out_of_tolerance_is_named(self):
        self.assertEqual(self.main("--set", "fluid.density=14,15"), 0)
        self.assertEqual([(row["status"], row["reason"]) for row in self.rows()],
                         [("ok", ""), ("out of tolerance", "speed is +50.0 % off, tolerance 2 %")])
        page = (self.out / "index.html").read_text()
        self.assertNotIn("speed is", page[:page.index("<h2>Reasons</h2>")])  # not in a column that is seen by scrolling only
        self.assertIn("speed is +50.0 % off", page)
        self.assertIn('<a href="logs/density-15.log" class=note>out of tolerance</a>', page)
        self.assertIn("references of the scene", page)
        self.assertNotIn("<h2>Reasons</h2>", self.page_of("fluid.density=14,16", "other"))

    def test_a_run_cut_short_is_called_so_and_vectors_have_brackets(self):
        self.main("--set", "fluid.gravity=[0,-1],[0,-2]", "--until", "0.5")
        self.assertEqual([(row["status"], row["fluid.gravity [m/s²]"]) for row in self.rows()], [("ok", "0 -1"), ("ok", "0 -2")])
        self.assertIn("<td>(0, -2)</td>", (self.out / "index.html").read_text())
        self.assertEqual(status({"code": 0, "reason": "not judged: ended at 1 of 2 s"}), ("not judged", "note"))

    def page_of(self, values, folder):
        self.main("--set", values, "--out", str(self.folder / folder))
        return (self.folder / folder / "index.html").read_text()

    def test_a_folder_of_somebody_else_is_refused(self):
        self.out.mkdir()
        (self.out / "thesis.txt").write_text("x")
        self.assertEqual(self.main("--set", "fluid.density=1"), 2)
        self.assertEqual(self.started(), [])
        self.assertEqual([p.name for p in self.out.iterdir()], ["thesis.txt"])

    def test_what_belongs_to_a_single_run_is_refused(self):
        for words in (["--restart"], ["--record", "x.h5"], ["--force"]):
            self.assertEqual(self.main("--set", "fluid.density=1", *words), 2, words)
        self.assertEqual(self.started(), [])

    def test_a_parameter_set_is_laid_under_the_values(self):
        (self.folder / "sand" / "fine.toml").write_text("[numerics]\ncell = 1\n")
        self.assertEqual(self.main("--set", "fluid.density=1", "--parameter-set", "fine"), 0)
        self.assertEqual(self.main("--set", "fluid.density=1", "--parameter-set", "coarse"), 2)
        self.assertEqual(self.started(), ["1"])

    def test_the_page_needs_nothing_else(self):
        self.main("--set", "fluid.density=1,2")
        page = (self.out / "index.html").read_text()
        self.assertIsNone(re.search(r"""(src|href)=["']?(https?:|//)""", page))
        self.assertEqual(json.loads((self.out / "sweep.json").read_text())["runs"]["density-1"]["code"], 0)


class Curves(unittest.TestCase):
    def test_are_a_line_for_each_of_the_other_values_and_a_mean_where_they_are_many(self):
        def rows(seeds):
            return {f"{x}{s}": {"all": {"x": x, "seed": s}, "results": {"y": x + s}} for x in (1, 2) for s in range(seeds)}
        varied = {"x": "x [m]", "seed": "particles.variables.seed [s]"}
        lines = curves(["x", "seed"], varied, rows(2), "y", "x")
        self.assertEqual([(line.name, list(line.y)) for line in lines], [("seed 0 s", [1, 2]), ("seed 1 s", [2, 3])])
        line, = curves(["x", "seed"], varied, rows(9), "y", "x")
        self.assertEqual((line.name, list(line.y)), ("mean of 9 series", [5, 6]))

    def test_a_result_of_one_value_alone_has_no_curve(self):
        rows = {str(x): {"all": {"x": x}, "results": {"y": x, **({"z": x} if x == 3 else {})}} for x in (1, 2, 3)}
        drawn = charts(["x"], {"x": "x [m]"}, rows)
        self.assertEqual(re.findall('aria-label="([^"]*)"', drawn), ["y against x [m]"])

    def test_a_long_label_has_two_lines(self):
        self.assertEqual(chart.label_lines("largest speed of a particle [m/s]", 220), ["largest speed of a particle [m/s]"])
        self.assertEqual(chart.label_lines("mean velocity along x, solids included [m/s]", 180), ["mean velocity along x,", "solids included [m/s]"])
        self.assertEqual(chart.label_lines("x" * 99, 180), ["x" * 99])

    def test_ticks_are_round_and_no_peak_is_lost(self):
        self.assertEqual(chart.ticks(0, 1), [0, 0.2, 0.4, 0.6, 0.8, 1.0])
        self.assertEqual(chart.ticks(1100, 1250, 3), [1100, 1150, 1200, 1250])
        self.assertEqual(chart.tick_texts([0.018839, 0.0188395, 0.01884]), ["0.018839", "0.0188395", "0.01884"])
        self.assertEqual(chart.tick_texts([0, 0.2, 0.4]), ["0", "0.2", "0.4"])
        self.assertEqual(chart.tick_texts([-20000, -10000, 0]), ["-20000", "-10000", "0"])
        self.assertEqual(chart.ticks(0, 0.29999)[-1], 0.3)
        y = np.zeros(100000)
        y[4321] = 7
        x, thin = chart.thinned(np.arange(100000.0), y)
        self.assertLessEqual(len(x), chart.MOST_POINTS)
        self.assertEqual(thin.max(), 7)
        self.assertEqual((x[0], x[-1]), (0, 99999))

    def test_gaps_stay_gaps(self):
        svg = chart.line_chart([chart.Line("a", np.arange(5.0), np.array([1, 2, np.nan, 3, 4]))], "x", "y")
        self.assertNotIn("nan", svg)
        self.assertEqual(re.search(r'<path d="([^"]*)" fill="none"', svg)[1].count("M"), 2)


if __name__ == "__main__":
    unittest.main()
