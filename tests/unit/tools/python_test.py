"""cases/PYTHON.md is true: its commands are run, its code is run, and what it prints is what stands there (numbers to 1 %)."""

import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

import numpy as np  # noqa: E402
from bplbm import reading  # noqa: E402

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
        np.testing.assert_array_equal(self.field.at(z=9.0, x=0.0), [100, 110, 120])
        with self.assertRaisesRegex(ValueError, "no axis w"):
            self.field.at(w=1)

    def test_is_an_array_to_numpy(self):
        self.assertEqual(np.max(self.field), 123)
        self.assertEqual(self.field.dims, ("z", "y", "x"))
        with self.assertRaisesRegex(ValueError, "no components"):
            _ = self.field.speed

    def test_a_vector_has_a_speed(self):
        vector = reading.Field("velocity", np.full((3, 4, 3), (3.0, 4.0, 0.0)), 0.0, {"x": np.arange(4.0), "y": np.arange(3.0)})
        self.assertEqual((vector.speed.unit, vector.speed.at(x=0, y=0)), ("m/s", 5.0))
        self.assertEqual(vector.at(x=0, y=0).tolist(), [3, 4, 0])


if __name__ == "__main__":
    unittest.main()
