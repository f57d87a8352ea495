"""ParaView shows what a run has written: view.py makes a picture, and all three readers find the fluid, the grains and the
bonds in one place, in two and three dimensions, at the right times. Wants Debian's paraview, and xvfb on a machine without
a screen; without them it says so and is skipped."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from matplotlib.image import imread

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import Run  # noqa: E402

SKIPPED = 77
READERS = ("XDMFReader", "Xdmf3ReaderS", "Xdmf3ReaderT")
# Prints, as JSON, each block that a reader finds in a frame: name, bounds, arrays, cells.
LOOK = """
import json, sys
from paraview import simple as pv, servermanager as sm
path, reader, time = sys.argv[1], sys.argv[2], float(sys.argv[3])
source = pv.XDMFReader(FileNames=[path]) if reader == "XDMFReader" else getattr(pv, reader)(FileName=[path])
source.UpdatePipeline(time)
found = []
names = lambda data: {data.GetArrayName(i): list(data.GetArray(i).GetRange(-1)) for i in range(data.GetNumberOfArrays())}
leaves = sm.Fetch(source).NewIterator()
while not leaves.IsDoneWithTraversal():
    block = leaves.GetCurrentDataObject()
    found.append({"bounds": list(block.GetBounds()), "cells": block.GetNumberOfCells(), "points": block.GetNumberOfPoints(),
                  "of_cells": names(block.GetCellData()), "of_points": names(block.GetPointData())})
    leaves.GoToNextItem()
print("FOUND" + json.dumps({"times": list(source.TimestepValues), "blocks": found}))
"""


def missing():
    """What is not there to look with; empty if all is."""
    if shutil.which("pvpython") is None:
        return "paraview"
    return "" if os.environ.get("DISPLAY") or shutil.which("xvfb-run") else "xvfb"


class View(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        kept = tempfile.TemporaryDirectory()
        cls.addClassCleanup(kept.cleanup)
        cls.folder = pathlib.Path(kept.name)
        for name in ("soil_erosion", "soil_erosion_3d"):
            short = cls.folder / f"{name}.toml"
            short.write_text("[run]\ncheckpoint_every = 0.0\n[output]\nfields_every = 0.0005\n")
            subprocess.run([sys.executable, ROOT / "tools" / "launch.py", name, "--no-study", "--no-page", "--until", "0.001", "--overlay",
                            short, "--out", cls.folder / name], check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                           timeout=200)  # plot.py may miss its times

    def run_in_paraview(self, *words):
        said = subprocess.run(["pvpython", *map(str, words)], capture_output=True, text=True, timeout=200, check=False)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        return said.stdout

    def look(self, name, reader, time):
        script = self.folder / "look.py"
        script.write_text(LOOK)
        said = self.run_in_paraview(script, self.folder / name / "fields.xdmf", reader, time)
        return json.loads(said[said.index("FOUND") + 5:])

    def test_all_readers_find_all_blocks_in_one_place(self):
        for name, dimensions in (("soil_erosion", 2), ("soil_erosion_3d", 3)):
            run = Run(self.folder / name)
            time, frame = run.frames()[-1]
            size = [run.parameters[f"box_{axis}"] for axis in "xyz"[:dimensions]]
            grains, bonds = run.frame(frame)["particles"], run.frame(frame)["bond_state"]
            for reader in READERS:
                with self.subTest(name, reader=reader):
                    seen = self.look(name, reader, time)
                    self.assertEqual([round(t, 6) for t in seen["times"]], [round(t, 6) for t, _ in run.frames()])
                    fluid, particles, lines = (next(b for b in seen["blocks"] if array in {**b["of_cells"], **b["of_points"]})
                                               for array in ("pressure", "radius", "broken"))
                    for axis in range(dimensions):
                        self.assertAlmostEqual(fluid["bounds"][2 * axis], 0.0, 6)
                        self.assertAlmostEqual(fluid["bounds"][2 * axis + 1], size[axis], 6)
                        self.assertAlmostEqual(particles["bounds"][2 * axis], grains[:, 1 + axis].min(), 6)
                        self.assertAlmostEqual(particles["bounds"][2 * axis + 1], grains[:, 1 + axis].max(), 6)
                    self.assertEqual(particles["points"], len(grains))
                    self.assertEqual(lines["cells"], int((bonds == 0).sum()))
                    self.assertEqual(lines["of_cells"]["broken"], [0.0, 0.0])
                    self.assertEqual(set(particles["of_points"]),
                                     {"id", "type", "radius", "velocity", "angular_velocity", "force", "torque"})

    def test_view_makes_a_picture_of_fluid_grains_and_bonds(self):
        for name in ("soil_erosion", "soil_erosion_3d"):
            with self.subTest(name):
                picture = self.folder / f"{name}.png"
                said = self.run_in_paraview(self.folder / name / "view.py", "--out", picture)
                self.assertIn(f"view | picture {picture}", said)
                image = (imread(picture)[..., :3] * 255).astype(int)
                green = (image[..., 1] > image[..., 0] + 30) & (image[..., 1] > image[..., 2] + 20)
                dark = image.sum(axis=-1) < 60  # the fluid at rest
                self.assertGreater(green.mean(), 0.001)
                self.assertGreater(dark.mean(), 0.02)
                self.assertGreater((image.min(axis=-1) > 250).mean(), 0.05)  # the white around the box


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()} is not installed")
        sys.exit(SKIPPED)
    unittest.main()
