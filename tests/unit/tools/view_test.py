"""ParaView shows what a run has written: view.py makes a picture, and all three readers find the fluid, the grains, the
bonds and the obstacles in one place, in two and three dimensions, at the right times. Wants Debian's paraview, and xvfb on a machine without
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
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import Run  # noqa: E402

SKIPPED = 77
READERS = ("XDMFReader", "Xdmf3ReaderS", "Xdmf3ReaderT")
# Prints, as JSON, each block that a reader finds in some frames: bounds, arrays, cells.
LOOK = """
import json, sys
from paraview import simple as pv, servermanager as sm
path, reader, *times = sys.argv[1:]
source = pv.XDMFReader(FileNames=[path]) if reader == "XDMFReader" else getattr(pv, reader)(FileName=[path])
names = lambda data: {data.GetArrayName(i): list(data.GetArray(i).GetRange(-1)) for i in range(data.GetNumberOfArrays())}

def blocks():
    whole = sm.Fetch(source)
    if not whole.IsA("vtkCompositeDataSet"):
        yield whole
        return
    leaves = whole.NewIterator()
    while not leaves.IsDoneWithTraversal():
        yield leaves.GetCurrentDataObject()
        leaves.GoToNextItem()

frames = []
for time in times:
    source.UpdatePipeline(float(time))
    frames.append([{"bounds": list(block.GetBounds()), "cells": block.GetNumberOfCells(), "points": block.GetNumberOfPoints(),
                    "of_cells": names(block.GetCellData()), "of_points": names(block.GetPointData())} for block in blocks()])
print("FOUND" + json.dumps({"times": list(source.TimestepValues), "frames": frames}))
"""
BOX = """[fluid]
density = 1000.0
kinematic_viscosity = 1e-3
velocity_scale = 2.0
[numerics]
cell = 0.001
[output]
fields_every = 0.02
[run]
end_time = 0.02
"""
# Fluids alone with solids that move as they are told: name -> the rest of the scene.
MOVING = {
    "gate": """[box]
size = [0.040, 0.024]
[[obstacle]]
from = [0.004, 0.004]
to = [0.012, 0.020]
motion = "linear"
velocity = [0.5, 0.0]
[[obstacle]]
centre = [0.032, 0.012]
diameter = 0.006
spin = 20.0
""",
    "auger": """[box]
size = [0.030, 0.030, 0.030]
[[obstacle]]
mesh = "blade.stl"
scale = 0.001
motion = "rotation"
axis = [0, 1, 0]
angular_velocity = 78.53981633974483
"""}  # a quarter of a turn
# A blade from y = 4 to 26 mm, as tall as the box and thin, about the middle.
CORNERS = [(x, y, z) for z in (3, 27) for x, y in ((12, 4), (18, 4), (18, 26), (12, 26))]
FACETS = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 0, 4),
          (3, 4, 7)]


def write_moving(folder):
    """The scenes of MOVING, a folder each."""
    for name, rest in MOVING.items():
        (folder / f"scene-{name}").mkdir()
        (folder / f"scene-{name}" / "scene.toml").write_text(f'title = "{name}"\n' + BOX + rest)
    lines = ["solid blade"]
    for facet in FACETS:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex {} {} {}".format(*CORNERS[k]) for k in facet), "endloop", "endfacet"]
    (folder / "scene-auger" / "blade.stl").write_text("\n".join([*lines, "endsolid blade", ""]))


def stone(image):
    """Where a picture has the blue-grey of obstacles, in light and shadow, before white too."""
    red, green, blue = (image[..., k] for k in range(3))
    return (green - red > 0.03 * blue) & (blue - green > 0.03 * blue) & (blue > 40)


def having(blocks, array, *kinds):
    """The block that has an array, of cells or points, or of one kind."""
    return next(b for b in blocks if any(array in b[f"of_{kind}"] for kind in kinds or ("cells", "points")))


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
        for name, until, more in (("soil_erosion", 0.001, ()), ("soil_erosion_3d", 0.001, ()), ("rotating_drum", 0.1, ()),
                                  ("screen_clogging", 0.005, ("--variant", "clumps")), ("digital_rock", 0.01, ())):
            short = cls.folder / f"{name}.toml"
            short.write_text(f"[run]\ncheckpoint_every = 0.0\n[output]\nfields_every = {until / 2}\n")
            cls.launch(name, name, "--until", str(until), "--overlay", short, *more)
        write_moving(cls.folder)
        for name in MOVING:
            cls.launch(cls.folder / f"scene-{name}", name)

    @classmethod
    def launch(cls, scene, name, *words):
        subprocess.run([sys.executable, ROOT / "tools" / "launch.py", scene, "--no-study", "--no-page", "--out", cls.folder / name, *words],
                       check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=200)  # plot.py may miss its times

    def run_in_paraview(self, *words):
        said = subprocess.run(["pvpython", *map(str, words)], capture_output=True, text=True, timeout=200, check=False)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        return said.stdout

    def look(self, name, reader, *times):
        """The run's times, and the blocks of the frames that are nearest to some."""
        script = self.folder / "look.py"
        script.write_text(LOOK)
        said = self.run_in_paraview(script, self.folder / name / "fields.xdmf", reader, *times)
        found = json.loads(said[said.index("FOUND") + 5:])
        return found["times"], found["frames"]

    def test_all_readers_find_all_blocks_in_one_place(self):
        for name, dimensions in (("soil_erosion", 2), ("soil_erosion_3d", 3)):
            run = Run(self.folder / name)
            time, frame = run.frames()[-1]
            size = [run.parameters[f"box_{axis}"] for axis in "xyz"[:dimensions]]
            grains, bonds = run.frame(frame)["particles"], run.frame(frame)["bond_state"]
            for reader in READERS:
                with self.subTest(name, reader=reader):
                    times, (blocks,) = self.look(name, reader, time)
                    self.assertEqual([round(t, 6) for t in times], [round(t, 6) for t, _ in run.frames()])
                    fluid, particles, lines = (having(blocks, array) for array in ("pressure", "radius", "broken"))
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

    def expect_bounds(self, block, *expected):
        for k, value in enumerate(expected):
            self.assertAlmostEqual(block["bounds"][k], value, 6, k)

    def test_all_readers_find_obstacles_where_they_are(self):
        for reader in READERS:
            with self.subTest(reader=reader):
                for time, shift, blocks in zip((0.0, 0.02), (0.0, 0.01), self.look("gate", reader, 0.0, 0.02)[1], strict=True):
                    gate, disc = having(blocks, "obstacle", "cells"), having(blocks, "radius")
                    self.assertEqual(gate["cells"], 5)  # its outline, and the line on the disc, which turns by 0.4
                    self.expect_bounds(gate, 0.004 + shift, 0.032 + 0.003 * np.cos(20.0 * time), 0.004, 0.020)
                    self.expect_bounds(disc, 0.032, 0.032, 0.012, 0.012)
                    self.assertEqual(disc["of_points"]["radius"], [0.003, 0.003])
                upright, level = (having(blocks, "obstacle") for blocks in self.look("auger", reader, 0.0, 0.02)[1])
                self.assertEqual(upright["cells"], 12)
                self.expect_bounds(upright, 0.012, 0.018, 0.004, 0.026, 0.003, 0.027)
                self.expect_bounds(level, 0.003, 0.027, 0.004, 0.026, 0.012, 0.018)
                _, (blocks,) = self.look("screen_clogging", reader, 0.0)
                self.expect_bounds(having(blocks, "obstacle"), 0.0, 0.012, 0.0, 0.006, 0.006, 0.008)
                clumps = having(blocks, "radius")
                self.assertEqual(clumps["points"], 3 * 32)  # of each clump its own row and two spheres
                self.assertIn("carrier", clumps["of_points"])
                for blocks in self.look("digital_rock", reader, 0.0, 0.01)[1]:
                    self.assertEqual(having(blocks, "image_fraction")["of_cells"]["image_fraction"], [0.0, 1.0])

    def picture(self, name, *words):
        picture = self.folder / f"{name}{''.join(map(str, words))}.png"
        said = self.run_in_paraview(self.folder / name / "view.py", "--out", picture, *words)
        self.assertIn(f"view | picture {picture}", said)
        return (imread(picture)[..., :3] * 255).astype(int)

    def test_view_shows_obstacles_where_they_are(self):
        for name in ("screen_clogging", "digital_rock"):
            with self.subTest(name):
                self.assertGreater(stone(self.picture(name)).mean(), 0.02)
        # a quarter of a turn later the blade lies, and is wider than it is tall
        for time, stands in ((0.0, True), (0.02, False)):
            image = self.picture("auger", "--time", time)
            rows, columns = np.nonzero(stone(image[:, image.shape[1] // 2:]))  # the solids whole
            wide, tall = (np.percentile(k, 98) - np.percentile(k, 2) for k in (columns, rows))
            self.assertEqual(tall > wide, stands, (time, wide, tall))
        # the gate is a hole in the fluid, light grey with a dark rim, which moves by a quarter of the box
        left = []
        for time in (0.0, 0.02):
            image = self.picture("gate", "--time", time)
            grey = abs(image - [199, 194, 184]).max(axis=-1) < 6
            left.append(np.percentile(np.nonzero(grey)[1], 5) / image.shape[1])
        self.assertGreater(left[1] - left[0], 0.15)
        drum = self.picture("rotating_drum")
        self.assertGreater((abs(drum - [199, 194, 184]).max(axis=-1) < 6).mean(), 0.05)  # its wall, and grains

    def test_view_makes_a_picture_of_fluid_grains_and_bonds(self):
        for name in ("soil_erosion", "soil_erosion_3d"):
            with self.subTest(name):
                image = self.picture(name)
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
