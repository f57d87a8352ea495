"""cases/PYTHON.md is true: its commands are run, its code is run, and what it prints is what stands there (numbers to 1 %)."""

import contextlib
import io
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

import bplbm  # noqa: E402
import h5py  # noqa: E402
import numpy as np  # noqa: E402
from bplbm import compare, reading  # noqa: E402

NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")


def blocks(path):
    """Kind and text of each block of code."""
    return re.findall(r"^```(\w+)\n(.*?)^```$", path.read_text(), re.M | re.S)


class Page(unittest.TestCase):
    def test_what_it_prints_is_what_stands_there(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        before = os.getcwd()
        os.chdir(folder.name)
        self.addCleanup(os.chdir, before)
        names, printed, compared = {}, "", 0
        for kind, text in blocks(ROOT / "cases" / "PYTHON.md"):
            if kind == "sh":
                for line in text.splitlines():
                    self.command(line)
            elif kind == "python":
                out = io.StringIO()
                with contextlib.redirect_stdout(out):
                    exec(compile(text, "PYTHON.md", "exec"), names)
                printed = out.getvalue()
            else:
                self.same(printed, text)
                compared += 1
        self.assertGreater(compared, 5)

    def command(self, line):
        tool, *words = line.split()
        more = ["--no-build"] if tool == "tools/run" else []
        done = subprocess.run([ROOT / tool, *words, *more], capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}{done.stderr}")

    def same(self, printed, expected):
        self.assertEqual(NUMBER.sub("#", printed), NUMBER.sub("#", expected))
        for a, b in zip(NUMBER.findall(printed), NUMBER.findall(expected), strict=True):
            self.assertAlmostEqual(float(a), float(b), delta=0.01 * abs(float(b)), msg=f"{printed}\n{expected}")


class Tables(unittest.TestCase):
    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.csv")
            path.write_text(text)
            return reading.read_table(path)

    def test_numbers_words_one_row_and_none(self):
        table = self.read("time,mode,force\n1,tension,2.5\n2,shear,nan\n")
        self.assertEqual(table["mode"].tolist(), ["tension", "shear"])
        self.assertEqual((table["time"].tolist(), table.units["force"]), ([1.0, 2.0], "N"))
        self.assertEqual(table.where(table["mode"] == "shear")["time"].tolist(), [2.0])
        self.assertEqual(self.read("time,x\n1,2\n")["x"].tolist(), [2.0])
        self.assertEqual(self.read("time,x\n")["x"].tolist(), [])


class Field(unittest.TestCase):
    """A box of 4 × 3 × 2 cells of 0.5 m, whose value tells the cell."""

    def setUp(self):
        axes = {axis: 0.5 * (np.arange(n) + 0.5) for axis, n in (("x", 4), ("y", 3), ("z", 2))}
        k, j, i = np.meshgrid(range(2), range(3), range(4), indexing="ij")
        self.field = reading.Field("pressure", 100 * k + 10 * j + i, 0.0, axes)

    def test_at_takes_the_nearest_cell_along_each_axis(self):
        self.assertEqual(self.field.at(x=1.8, y=0.7, z=0.9), 113)
        np.testing.assert_array_equal(self.field.at(y=0.0), [[0, 1, 2, 3], [100, 101, 102, 103]])
        np.testing.assert_array_equal(self.field.at(z=1.0, x=0.0), [100, 110, 120])
        with self.assertRaisesRegex(ValueError, "no axis w"):
            self.field.at(w=1)

    def test_a_place_outside_of_the_box_is_refused(self):
        self.assertEqual(self.field.at(x=2.0, y=0, z=1.0 + 1e-9), 103)  # on the edge
        for place in ({"x": 2.1}, {"y": -0.01}, {"x": 0.1, "z": float("nan")}):
            with self.assertRaisesRegex(ValueError, "is outside of the box, which lies between 0 and"):
                self.field.at(**place)

    def test_is_an_array_to_numpy(self):
        self.assertEqual(np.max(self.field), 123)
        self.assertEqual(self.field.dims, ("z", "y", "x"))
        with self.assertRaisesRegex(ValueError, "no components"):
            _ = self.field.speed

    def test_a_vector_has_a_speed(self):
        vector = reading.Field("velocity", np.full((3, 4, 3), (3.0, 4.0, 0.0)), 0.0, {"x": np.arange(4.0), "y": np.arange(3.0)})
        self.assertEqual((vector.speed.unit, vector.speed.at(x=0, y=0)), ("m/s", 5.0))
        self.assertEqual(vector.at(x=0, y=0).tolist(), [3, 4, 0])


PROBES = "time [s],id [1],x [m],y [m],vx [m/s],vy [m/s]\n" + "".join(f"{t},{n},0.{n},0,1,0\n" for t in (0, 1) for n in (3, 4))


class Folder(unittest.TestCase):
    """An output folder of two frames of 4 × 2 cells, made by hand."""

    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.parent = pathlib.Path(kept.name)
        self.folder = self.parent / "sand"
        self.folder.mkdir()
        (self.folder / "summary.json").write_text(json.dumps({
            "scene": "sand", "parameters": {"box_x": 2.0, "box_y": 1.0}, "results": [], "physical_seconds": 1.0,
            "quantities": [{"name": "way", "value": 7.0, "unit": "m"}]}))
        (self.folder / "probes.csv").write_text(PROBES)
        (self.folder / "sensor-floor.csv").write_text("time [s],flow [m3/s]\n0,5\n")
        with h5py.File(self.folder / "fields.h5", "w") as file:
            file.attrs["cell"] = 0.5
            for number, time in enumerate((0.0, 1.0)):
                frame = file.create_group(f"frame{number}")
                frame.attrs["time"] = time
                frame["pressure"] = np.zeros((2, 4))
                frame["bond_ends"], frame["bond_state"] = np.array([[0.1, 0.2], [0.3, 0.4]]), np.array([1.0])
        with h5py.File(self.folder / "averages.h5", "w") as file:
            file.attrs.update({"cell": 0.5, "origin_x": 1.0, "from": 0.2, "to": 0.8, "samples": 3.0})
            for name, values, unit in (("pressure_mean", np.arange(8.0).reshape(2, 4), "Pa"), ("velocity_mean", np.ones((2, 4, 3)), "m/s")):
                file[name] = values
                file[name].attrs["unit"] = unit
        self.run_ = bplbm.Run(self.folder)

    def test_averages_are_fields_with_units_and_coordinates(self):
        averages = self.run_.averages
        self.assertEqual((averages.pressure_mean.unit, averages["velocity_mean"].unit), ("Pa", "m/s"))
        self.assertEqual((averages.pressure_mean.at(x=2.3, y=0.6), averages["samples"]), (6, 3))
        with self.assertRaisesRegex(ValueError, "between 1 and 3 m"):
            averages.pressure_mean.at(x=0.5)
        self.assertEqual(str(averages), "Averages of 3 samples from 0.2 to 0.8 s: pressure_mean [Pa], velocity_mean [m/s]")
        with self.assertRaisesRegex(AttributeError, "have no speed; they have pressure_mean"):
            _ = averages.speed

    def test_bonds_are_in_metres(self):
        self.assertEqual(self.run_.fields[0].bonds.units, {"x1": "m", "y1": "m", "x2": "m", "y2": "m", "state": "1"})

    def test_times_and_particles_that_are_not_there_are_refused(self):
        self.assertEqual((self.run_.fields.at(0.6).time, self.run_.fields.at(1.4).time), (1.0, 1.0))
        for time in (-0.6, 1.6, float("nan")):
            with self.assertRaisesRegex(LookupError, "written from 0 to 1 s"):
                self.run_.fields.at(time)
        self.assertEqual(self.run_.probes(3)["x"].tolist(), [0.3, 0.3])
        self.assertEqual(self.run_.probes(3).units["vx"], "m/s")
        with self.assertRaisesRegex(LookupError, "has no particle 7777; they are 3 … 4"):
            self.run_.probes(7777)

    def test_quantities_are_those_of_the_page(self):
        names = [q["name"] for q in self.run_.quantities]
        self.assertIn("way", names)
        self.assertIn("particles at the end", names)

    def test_sensors_are_tables_by_name(self):
        self.assertEqual(list(self.run_.sensors["floor"]["flow"]), [5.0])

    def test_what_a_folder_lacks_is_said_with_what_it_has(self):
        for ask, said in ((lambda: self.run_.table("probe"), "has no probe.csv; its tables are: probes, sensor-floor"),
                          (lambda: self.run_.breaks, "has no breaks.csv; its tables are"),
                          (lambda: bplbm.Run(self.parent / "snad"), "there is no folder .*snad; in .* there are: sand"),
                          (lambda: bplbm.Run(self.parent), "these in it do: sand")):
            with self.assertRaisesRegex(FileNotFoundError, said):
                ask()
        with unittest.mock.patch.object(sys, "argv", ["compare", str(self.parent / "snad")]), \
                contextlib.redirect_stderr(io.StringIO()) as told:
            self.assertEqual(compare.main(), 2)
        self.assertRegex(told.getvalue(), "compare . error . there is no folder .*snad; in .* there are: sand")
        (self.folder / "averages.h5").unlink()
        with self.assertRaisesRegex(FileNotFoundError, r"has no averages.h5; the scene asks for it with \[average\]"):
            _ = self.run_.averages
        (self.folder / "summary.json").unlink()
        with self.assertRaisesRegex(FileNotFoundError, "is it still at work"):
            bplbm.Run(self.folder)
        (self.folder / "error.log").write_text("lbm | error | too fast\n")
        with self.assertRaisesRegex(FileNotFoundError, "this run has failed .*: too fast; .*error.log holds all"):
            bplbm.Run(self.folder)


class FallInLayers(unittest.TestCase):
    """The mixture moves at y t m/s: a sphere's layers have that of its middle."""

    @staticmethod
    def run_of(velocity):
        fields = [types.SimpleNamespace(time=time, velocity=velocity * time) for time in (0.0, 2.0)]
        return types.SimpleNamespace(folder="here", fields=fields, parameters={"box_y": 4.0, "diameter": 1.0})

    def test_is_against_the_mixture_at_each_ones_height(self):
        velocity = np.zeros((3, 8, 5, 3))
        velocity[..., 2] = (np.arange(8) + 0.5)[None, :, None] / 2
        rows = {"time": np.array([0.0, 1.0, 1.0]), "y": np.array([1.0, 1.0, 2.5]), "vz": np.array([-0.25, 0.5, 0.5])}
        np.testing.assert_allclose(bplbm.fall_in_layers(self.run_of(velocity), rows), [0.25, 0.5, 2.0], atol=1e-12)

    def test_two_dimensions_have_none(self):
        with self.assertRaisesRegex(ValueError, "three dimensions"):
            bplbm.fall_in_layers(self.run_of(np.zeros((8, 5, 2))), {})


if __name__ == "__main__":
    unittest.main()
