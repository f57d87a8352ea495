"""The page of a run: made from an output folder alone, in two and three dimensions, and self-contained. No program is
started."""

import contextlib
import io
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zlib
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

import h5py  # noqa: E402
import numpy as np  # noqa: E402
from bplbm import pictures, result, run as launcher  # noqa: E402
from bplbm.page import flow, histories, picture  # noqa: E402
from bplbm.page.failed import write_failed_page  # noqa: E402
from bplbm.page.run import write_page  # noqa: E402
from bplbm.quantities import default_quantities, not_told, of_particles  # noqa: E402
from bplbm.reading import PARTICLE, Table  # noqa: E402
from bplbm.results import Run  # noqa: E402
from bplbm.scenes import Scene  # noqa: E402

SCENE_2D = """title = "<sand>"
[box]
size = [0.04, 0.02]
sides_x = "periodic"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-6
gravity = [0.0, -9.81]
[[boundary]]
side = "top"
kind = "pressure"
from = 0.01
to = 0.03
[[obstacle]]
centre = [0.03, 0.01]
diameter = 0.004
[particles]
diameter = 0.002
density = 2500.0
"""
SCENE_3D = """title = "sand"
[box]
size = [0.04, 0.01, 0.02]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-6
[[boundary]]
side = "left"
kind = "velocity"
velocity = [0.1, 0.0, 0.0]
from = [0.0, 0.01]
to = [0.01, 0.02]
[[boundary]]
side = "bottom"
kind = "pressure"
[particles]
diameter = 0.002
density = 2500.0
"""


def decoded(data):
    """Indices of a PNG that picture.png has made: [row][column], the first row on top."""
    width, height = (int.from_bytes(data[at:at + 4]) for at in (16, 20))
    start = data.index(b"IDAT") + 4
    return np.frombuffer(zlib.decompress(data[start:data.index(b"IEND") - 8]), np.uint8).reshape(height, width + 1)[:, 1:]


class Output(unittest.TestCase):
    """An output folder as lbm writes one: 40 × (10 ×) 20 cells of 1 mm, two particles, one broken bond."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out = self.folder / "out"
        self.out.mkdir()
        (self.folder / "sand").mkdir()
        self.scene = Scene(self.folder / "sand")

    def write(self, dimensions, frames=4):
        self.scene.file.write_text(SCENE_2D if dimensions == 2 else SCENE_3D)
        size = [0.04, 0.02] if dimensions == 2 else [0.04, 0.01, 0.02]
        box = {f"box_{axis}": length for axis, length in zip("xyz", size)}  # noqa: B905
        (self.out / "summary.json").write_text(json.dumps({
            "scene": "sand", "set": "resolved", "variant": "", "versions": {"lbm": "1"}, "ending": "complete", "cells": 800,
            "steps": 100, "substeps": 5, "physical_seconds": 0.1, "wall_seconds": 2.0, "cpu_seconds": 1.5, "mlups": 1.0,
            "time_share": {"sweep": 0.75, "waiting": 0.25}, "megabytes": {"populations": 1.0}, "waiting": 0.5, "ma_max": 0.1,
            "mass_drift": 0.0, "results": [result("height & rest", 1.2, "m", 1.0, "a <source>", 0.1)], "quantities": [],
            "parameters": {**box, "cell": 1e-3, "interval": 1e-3}}))
        (self.out / "lbm.log").write_text("scene  sand\nnumbers  Re 7\n\n  0 | warning | <too fast>\nhint   more cores\n")
        (self.out / "liggghts.log").write_text("WARNING: a wall <moves>\n    700  2\nLoop time of 1.0 on 1 procs for 500 steps\n" + "".join(
            f"{key} time (%) = {s} (1)\n" for key, s in (("Pair", 0.5), ("Neigh", 0.1), ("Comm", 0.1), ("Outpt", 0.1), ("Other", 0.2))))
        (self.out / "breaks.csv").write_text("step,time,id1,id2,mode,force\n300,0.06,1,2,1,5\n")
        head = "time,id,x,y,vx,vy,omega,fx,fy,torque" if dimensions == 2 else "time,id,x,y,z,vx,vy,vz,wx,wy,wz,fx,fy,fz,tx,ty,tz"
        rows = [",".join([f"{0.01 * k}", str(i), *["0.005"] * dimensions, *["0.1"] * (len(head.split(",")) - 2 - dimensions)])
                for k in range(11) for i in (1, 2)]
        (self.out / "probes.csv").write_text("\n".join([head, *rows]) + "\n")
        shape = (20, 40) if dimensions == 2 else (20, 10, 40)
        with h5py.File(self.out / "fields.h5", "w") as file:
            file.attrs["cell"] = 1e-3
            for k in range(frames):
                group = file.create_group(f"frame{k:06}")
                group.attrs["time"] = 0.1 * k / max(1, frames - 1)
                velocity = np.zeros((*shape, 3), np.float32)
                velocity[..., 0] = np.arange(40) * 1e-3 * k
                group["velocity"] = velocity
                pressure = np.full(shape, 5.0, np.float32)
                pressure[0] = np.nan
                group["pressure"] = pressure
                place = [[0.005, 0.005], [0.007, 0.005]] if dimensions == 2 else [[0.005, 0.005, 0.005], [0.007, 0.0095, 0.005]]
                rest = [0.001, 0, 0, 0, 1] if dimensions == 2 else [0.001, 0, 0, 0, 0, 0, 0, 1]
                group["particles"] = np.array([[i + 1, *p, *rest] for i, p in enumerate(place)], float)
                if dimensions == 2:
                    group["bond_ends"], group["bond_state"] = np.array(place, float), np.array([1.0])
        return Run(self.out)

    def page(self):
        return write_page(self.out, self.scene, [self.scene.file], ["sand", "--out", "o u t"], ["mpirun", "lbm"]).read_text()


class Page(Output):
    def test_has_all_parts_in_two_and_three_dimensions(self):
        for dimensions in (2, 3):
            self.write(dimensions)
            text = self.page()
            for part in ("Results", "Set-up", "Flow", "Histories", "Where the time went", "What was on", "Warnings", "How to repeat it",
                         "height &amp; rest", ">miss<", "a &lt;source&gt;", "&lt;too fast&gt;", "a wall &lt;moves&gt;", "more cores",
                         "broken bonds", "tools/run sand --out &#x27;o u t&#x27;", "stream and collide 75 %", "contacts 50 %"):
                self.assertIn(part, text, dimensions)
            self.assertNotRegex(text, r"""(src|href)=["']?(https?:|//|[\w./]+\.(js|css))""")
            self.assertNotIn("<too fast>", text)
            self.assertNotIn(">nan<", text)

    def test_needs_neither_fields_nor_particles(self):
        self.write(2)
        for name in ("fields.h5", "probes.csv", "breaks.csv", "liggghts.log", "lbm.log"):
            (self.out / name).unlink()
        text = self.page()
        self.assertIn("Where the time went", text)
        self.assertNotIn("<h2>Flow</h2>", text)

    def test_tables_of_a_head_alone_are_no_fault(self):
        self.write(2)
        for name in ("probes", "breaks"):
            path = self.out / f"{name}.csv"
            path.write_text(path.read_text().splitlines()[0] + "\n")
        self.assertIn("broken bonds", self.page())

    def test_holds_what_plot_has_drawn(self):
        self.write(2)
        (self.out / "own.png").write_bytes(picture.png(np.zeros((2, 2), np.uint8), np.zeros((256, 3), np.uint8)))
        self.assertRegex(self.page(), r'<img src="data:image/png;base64,[^"]*" alt="own.png">')

    def test_a_clump_and_its_spheres_are_one_particle(self):
        run = self.write(2)
        self.assertEqual(default_quantities(run)[1]["value"], 2)
        with h5py.File(self.out / "fields.h5", "a") as f:
            for frame in f.values():
                frame["particle_carrier"] = np.array([-1.0, 1.0])  # the second is a sphere of the first
        self.assertEqual(default_quantities(run)[1]["value"], 1)
        before = self.page().count('stroke="#6b5d43"')
        with h5py.File(self.out / "fields.h5", "a") as f:
            for frame in f.values():
                frame["particles"][0, PARTICLE[2].index("radius")] = 0.0
        self.assertEqual(self.page().count('stroke="#6b5d43"'), before - 1)
        self.assertEqual(len(flow.read_planes(run)[0].discs), 1)

    def test_a_driven_flow_past_solids_has_its_permeability(self):
        run = self.write(2)
        run.parameters.update({"body_force_x": 0.5, "kinematic_viscosity": 1e-6, "density": 1000.0})
        self.assertNotIn("permeability along x", [q["name"] for q in default_quantities(run)])
        with h5py.File(self.out / "fields.h5", "a") as f:
            for frame in f.values():
                frame.attrs["flux_x"], frame.attrs["flux_y"] = 2e-3, 0.0
        found = {q["name"]: q["value"] for q in default_quantities(run)}
        self.assertEqual(found["mean velocity along x, solids included"], 2e-3)
        self.assertAlmostEqual(found["permeability along x"], 4e-9, 20)
        self.assertNotIn("permeability along y", found)
        last = run.frames()[-1][1]
        with h5py.File(self.out / "fields.h5", "a") as f:
            f[last].attrs["flux_x"] = 1e-3  # it still changes
        self.assertNotIn("permeability along x", [q["name"] for q in default_quantities(run)])
        self.assertRegex(not_told(run)[0], "No permeability along x: not steady yet: .* changed by 50 % from ")
        summary = json.loads((self.out / "summary.json").read_text())
        parameters = {**summary["parameters"], **run.parameters}
        (self.out / "summary.json").write_text(json.dumps({**summary, "parameters": parameters}))
        self.assertIn("No permeability along x: not steady yet", self.page())
        with h5py.File(self.out / "fields.h5", "a") as f:
            for name in set(f) - {last}:
                del f[name]
        self.assertIn("one frame does not say", not_told(run)[0])
        end = run.summary["physical_seconds"]
        for slowness, steady in ((0.05, True), (0.5, False)):  # of the drag, over the time of the run
            rows = [f"{part * end},{k},{1 - np.exp(-part / slowness)},0" for part in np.linspace(0, 1, 11) for k in (1, 2)]
            (self.out / "obstacles.csv").write_text("\n".join(["time,id,fx,fy", *rows]) + "\n")
            self.assertEqual("permeability along x" in [q["name"] for q in default_quantities(run)], steady)
            self.assertEqual(not_told(run) == [], steady)
        run.summary["ending"] = "steady: the velocity changes by less than 1e-05 a turnover"
        self.assertIn("permeability along x", [q["name"] for q in default_quantities(run)])
        self.assertEqual(not_told(run), [])

    def test_both_waiting_at_once_is_said(self):
        self.assertIsNone(launcher.hint_of_waiting(0.5, 9.6, 10.0))  # in turns
        self.assertIsNone(launcher.hint_of_waiting(0.9, 0.9, 1.0))  # too short to matter
        self.assertIn("for 90 % of the time each program waited", launcher.hint_of_waiting(9.4, 9.6, 10.0))

    def test_the_whole_job_takes_the_place_of_the_fluids_own_hint(self):
        self.write(2)
        (self.out / "lbm.log").write_text("hint         the fluid waits 98 % of its time for the solid: --solid-ranks\n")
        hints = lambda: self.page().split("Warnings and hints")[1]  # noqa: E731
        self.assertIn("the fluid waits 98 %", hints())
        summary = json.loads((self.out / "summary.json").read_text())
        (self.out / "summary.json").write_text(json.dumps({**summary, "hint": "each program waited for the other one"}))
        self.assertNotIn("the fluid waits 98 %", hints())
        self.assertIn("each program waited", hints())

    def test_is_light(self):
        self.write(2, frames=100)
        text = self.page()
        self.assertLess(len(text), 1_000_000)
        code = "import bplbm.page.run, sys; sys.exit('matplotlib' in sys.modules)"  # it would take as long as all else
        self.assertEqual(subprocess.run([sys.executable, "-c", code], cwd=ROOT / "tools", timeout=60, check=False).returncode, 0)
        self.assertEqual(text.count('"speed": "data:'), picture.MOST_FRAMES)

    def test_a_run_without_one_is_complete_all_the_same(self):
        text = io.StringIO()
        args = mock.Mock(scene=self.scene, overlay=[], set="resolved", variant="", own=[], words=[])
        with contextlib.redirect_stderr(text), mock.patch.object(launcher, "command", lambda *_: []):
            launcher.make_page(args, self.out)
        self.assertRegex(text.getvalue(), r"run \| warning \| no page was made: .*; the run's numbers are complete\n")


class Warnings(unittest.TestCase):
    """What the logs warn of, in summary.json."""

    def test_of_all_logs_come_once_with_the_name_of_their_log(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)
            (out / "summary.json").write_text('{"steps": 7}')
            (out / "lbm.log").write_text("0 | plan | a step\n0 | warning | soft contact\n0 | warning | soft contact\n")
            (out / "log.liggghts").write_text("no log of ours\n")
            (out / "liggghts.log").write_text("WARNING: Old word (input.cpp:12)\nStep Atoms\n"
                                              "liggghts | warning | Old word (at the line: pair_style old)\n"
                                              "WARNING: Lost a grain (thermo.cpp:3)\n")
            launcher.add_warnings(out)
            summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary["steps"], 7)
        self.assertEqual(sorted(summary["warnings"]), sorted([
            "lbm.log: 0 | warning | soft contact",
            "liggghts.log: liggghts | warning | Old word (at the line: pair_style old)",
            "liggghts.log: WARNING: Lost a grain (thermo.cpp:3)"]))


class Failed(Output):
    def failed_page(self):
        return write_failed_page(self.out, self.scene, [self.scene.file], ["sand"], ["mpirun", "lbm"], 3).read_text()

    def test_says_why_and_shows_what_was_made(self):
        for dimensions in (2, 3):
            self.write(dimensions)
            (self.out / "summary.json").unlink()
            (self.out / "error.log").write_text("lbm | error | interval 7: the fluid moves at <9> m/s\nliggghts | error | the fluid "
                                                "program stopped: numerics\n")
            text = self.failed_page()
            for part in ("exit code 3", "numerics", "after 0.1 s of flow", "<b>interval 7: the fluid moves at &lt;9&gt; m/s</b>",
                         "Set-up", "Flow until then", "Histories until then", "force of the fluid in", "&lt;too fast&gt;", "tools/run sand"):
                self.assertIn(part, text, dimensions)

    def test_a_signal_is_said(self):
        self.write(2)
        (self.out / "error.log").write_text("Primary job  terminated normally, but 1 process returned\n-----\n")
        (self.out / "lbm.log").write_text("duration     1 s\n\nending       stopped by a signal\n")
        self.assertIn("<b>stopped by a signal</b>", self.failed_page())
        (self.out / "error.log").write_text("liggghts | error | lost atoms\n")
        self.assertIn("<b>lost atoms</b>", self.failed_page())

    def test_needs_nothing_but_the_scene(self):
        self.write(2)
        for path in self.out.iterdir():
            path.unlink()
        text = self.failed_page()
        self.assertIn("nothing was said", text)
        self.assertIn("after 0 s of flow", text)

    def test_a_file_that_was_cut_off_costs_its_part_only(self):
        self.write(2)
        (self.out / "summary.json").unlink()
        fields = self.out / "fields.h5"
        fields.write_bytes(fields.read_bytes()[:3000])
        text = self.failed_page()
        self.assertNotIn("Flow until then", text)
        self.assertIn("Histories until then", text)


class Flow(Output):
    def test_particles_that_the_plane_cuts(self):
        plane = flow.read_planes(self.write(3))[-1]
        self.assertEqual(plane.speed.shape, (20, 40))
        np.testing.assert_allclose(plane.discs, [[0.005, 0.005, 0.001]])  # the other one lies 4.5 mm off

    def test_solids_are_grey(self):
        run = self.write(2)  # whose lowest row of cells has no pressure: a solid covers it whole
        plane = flow.read_planes(run)[-1]
        speeds = pictures.speed_of_fluid(run.frame("frame000003"))
        for speed in (plane.speed, speeds):
            self.assertTrue(np.isnan(speed[0]).all())
            np.testing.assert_allclose(speed[1:], np.tile(np.arange(40) * 3e-3, (19, 1)), rtol=1e-6)
        self.assertEqual(plane.fluid, (speeds[1:].mean(), np.float32(0.117)))  # of the fluid alone
        scale = flow.scales([plane])["speed"]
        self.assertEqual(scale.high, np.float32(0.117))
        self.assertTrue((scale.indices(plane.speed)[0] == picture.NOTHING).all())
        self.assertEqual(tuple(np.round(pictures.SPEED(np.nan)[:3], 2)), (0.6, 0.6, 0.6))

    def test_the_drawing_counts_from_the_upper_left_corner(self):
        run = self.write(2)
        plane = flow.read_planes(run)[-1]
        discs, bonds = flow.places(plane, (0.0, 0.0), (0.04, 0.02))
        self.assertEqual(discs, [125.0, 375.0, 25.0, 175.0, 375.0, 25.0])
        self.assertEqual(bonds, [125.0, 375.0, 175.0, 375.0, 1])

    def test_a_bond_that_drifted_apart_is_no_line(self):
        run = self.write(2)
        with h5py.File(self.out / "fields.h5", "r+") as file:
            file["frame000003/bond_ends"][...] = [[0.0, 0.0], [0.03, 0.0]]
        self.assertEqual([len(plane.bonds) for plane in flow.read_planes(run)], [1, 1, 1, 0])

    def test_a_viscosity_has_a_button_and_a_scale_of_its_logarithm(self):
        for dimensions in (2, 3):
            run = self.write(dimensions)
            self.assertNotIn('data-kind="viscosity"', flow.animation(run, flow.read_planes(run)))
            with h5py.File(self.out / "fields.h5", "r+") as file:
                for group in file.values():
                    nu = np.full(group["pressure"].shape, 1e-5, np.float32)
                    nu[..., 0], nu[..., 1] = 1e-3, np.nan
                    group["viscosity"] = nu
            planes = flow.read_planes(run)
            bar = flow.scales(planes)["viscosity"]
            self.assertEqual((round(bar.low, 3), round(bar.high, 3)), (-5, -3))
            self.assertIn('data-kind="viscosity"', flow.animation(run, planes))
            self.assertEqual(run.fields[0].viscosity.unit, "m2/s")

    def test_breaks_lie_at_the_times_of_their_table(self):
        run = self.write(2)  # whose solid had moved alone for 200 of its steps
        for times, steps in (([0.06], [0, 0.06, 0.06, 0.1]), ([0.02, -0.01], [-0.01, -0.01, -0.01, 0.02, 0.02, 0.1])):
            with mock.patch.object(histories, "line_chart") as drawn:
                histories.of_breaks(Table({"time": np.array(times)}), run)
            line, = drawn.call_args.args[0]
            self.assertEqual(line.x.tolist(), steps)
            self.assertEqual(line.y.tolist(), np.repeat(range(len(times) + 1), 2).tolist())


class Quantities(unittest.TestCase):
    def columns(self, rows):
        return {name: np.array(column, float) for name, column in zip(("time", "id", "x", "y", "vx", "vy"), zip(*rows))}  # noqa: B905

    def told(self, rows, end=1.0):
        return {q["name"]: q["value"] for q in of_particles(self.columns(rows), {"x": 1.0, "y": 1.0}, end)}

    def test_a_way_goes_on_through_a_periodic_side(self):
        told = self.told([(0, 1, 0.8, 0.5, 3, 4), (0.5, 1, 0.1, 0.5, 0, 0), (1, 1, 0.4, 0.3, 0, 0), (0, 2, 0.2, 0.2, 0, 0),
                          (0.5, 2, 0.2, 0.2, 0, 0), (1, 2, 0.2, 0.2, 0, 0)])
        self.assertAlmostEqual(told["mean displacement in x"], 0.3)
        self.assertAlmostEqual(told["mean displacement in y"], -0.1)
        self.assertEqual((told["particles at the end"], told["largest speed of a particle"]), (2, 5))

    def test_those_that_have_left_are_not_there(self):
        rows = [(0, 1, 0.1, 0.5, 0, 0), (0, 2, 0.2, 0.2, 0, 0), (1, 2, 0.3, 0.2, 0, 0)]
        self.assertEqual(self.told(rows)["particles at the end"], 1)
        self.assertAlmostEqual(self.told(rows)["mean displacement in x"], 0.1)
        self.assertEqual(self.told(rows[:2]), {"particles at the end": 0, "largest speed of a particle": 0})


class Picture(unittest.TestCase):
    def test_is_read_back_and_marks_what_is_no_number(self):
        scale = picture.Scale(0.0, 2.0, picture.HOT)
        indices = scale.indices(np.array([[0.0, 1.0], [2.0, np.nan], [-5.0, 7.0]]))
        np.testing.assert_array_equal(decoded(picture.png(indices, scale.palette())), indices)
        self.assertEqual(indices.tolist(), [[0, 127], [254, picture.NOTHING], [0, 254]])
        palette = scale.palette()
        self.assertEqual((palette[0].tolist(), palette[254].tolist(), palette[255].tolist()),
                         ([0, 0, 4], [252, 253, 191], list(picture.GREY)))

    def test_large_fields_are_thinned(self):
        self.assertEqual(picture.coarser(np.zeros((1000, 100))).shape, (250, 25))
        self.assertEqual(picture.coarser(np.zeros((10, 320))).shape, (10, 320))
        self.assertEqual([f for f in picture.chosen_frames(range(100))][::23], [0, 99])


if __name__ == "__main__":
    unittest.main()
