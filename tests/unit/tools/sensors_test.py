"""Sensors and averages of a scene: the same on one rank and on two, after a restart as without, and a run without them is the
same run. Starts lbm."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

import h5py  # noqa: E402
import numpy as np  # noqa: E402
from bplbm.project import BIN, CASES  # noqa: E402
from bplbm.reading import read_table  # noqa: E402

SENSORS = """
[average]
from = 1.0
every = 0.05
[[sensor]]
name = "section"
kind = "plane"
axis = "x"
at = 0.0025
every = 0.5
[[sensor]]
name = "profile"
kind = "line"
from = [0.001, 0.0]
to = [0.001, 0.01]
count = 9
every = 1.0
[[sensor]]
name = "floor"
kind = "side"
side = "bottom"
every = 0.3
"""
RUN = "[run]\nend_time = {end}\nsteady_below = 0.0\ncheckpoint_every = 1.3\n[output]\nfields_every = 1.0\n"
NAMES = ("section", "profile", "floor")


class Sensors(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def lbm(self, out, *options, sensors=SENSORS, ranks=1, end=2.0):
        overlay = self.folder / "overlay.toml"
        overlay.write_text(RUN.format(end=end) + sensors)
        environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        line = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", str(ranks), BIN / "lbm", CASES / "poiseuille" / "scene.toml",
                overlay, "--out", self.folder / out, *options]
        said = subprocess.run(line, env=environment, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        return said.stdout

    def tables(self, out):
        return {name: (self.folder / out / f"sensor-{name}.csv").read_text() for name in NAMES}

    def averages(self, out):
        with h5py.File(self.folder / out / "averages.h5") as file:
            return {name: file[name][...] for name in file}, dict(file.attrs)

    def test_two_ranks_and_a_restart_see_the_same(self):
        self.lbm("one")
        self.lbm("two", ranks=2)
        self.assertIn("100 %, ", self.lbm("first", "--until", "1.4"))  # progress counts to it
        self.lbm("first", "--restart")
        values, about = self.averages("one")
        self.assertEqual(about["samples"], 21)
        for other in ("two", "first"):
            self.assertEqual(self.tables(other), self.tables("one"))
            others, attributes = self.averages(other)
            self.assertEqual(attributes["samples"], 21)
            for name, array in values.items():
                np.testing.assert_array_equal(others[name], array, name)
        flow = read_table(self.folder / "one" / "sensor-section.csv")
        self.assertEqual(flow.units["flow"], "m3/s")
        self.assertTrue(np.all(np.diff(flow["flow"]) > 0))  # the force speeds the fluid up

    def test_a_run_without_them_is_the_same_run(self):
        self.lbm("with")
        self.lbm("without", sensors="")
        with h5py.File(self.folder / "with" / "fields.h5") as a, h5py.File(self.folder / "without" / "fields.h5") as b:
            self.assertEqual(list(a), list(b))
            for frame in a:
                for name in a[frame]:
                    np.testing.assert_array_equal(a[frame][name][...], b[frame][name][...])
        self.assertFalse(list((self.folder / "without").glob("sensor-*")))
        self.assertFalse((self.folder / "without" / "averages.h5").exists())


if __name__ == "__main__":
    unittest.main()
