"""A dozen discs settle to a packing with every engine: the paths part at the first contacts, what they come to does not."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
BIN = pathlib.Path(os.environ.get("BPLBM_BIN", ROOT / "build" / os.environ.get("BPLBM_PRESET", "release") / "bin"))
ENGINES = ROOT / "tools" / "engines"
DIAMETER, WIDTH, END = 0.0025, 0.0115625, 0.6  # m, m, s

SCENE = f"""title = "packing"
[box]
size = [{WIDTH}, 0.02]
sides_x = "wall"
sides_y = "wall"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, -9.8]
velocity_scale = 0.2
[particles]
diameter = {DIAMETER}
density = 2500.0
start = START
contact_stiffness = 1.0e5
[particles.variables]
damping_ratio = 0.5
[coupling]
timeout = 60.0
[numerics]
cells_per_diameter = 8
[run]
end_time = {END}
[output]
probe_every = 0.01
"""
# Without friction, as the engines without a script have none.
COMMON = {"liggghts": "discs.liggghts", "lammps": "discs.lammps"}
FRICTIONLESS = {"liggghts": ("coefficientFriction peratomtypepair 1 0.3", "coefficientFriction peratomtypepair 1 0.0"),
                "lammps": ("NULL 0.3 1", "NULL 0.0 0")}


def starts():
    """Three rows of four, each a little off its place, the same in every run."""
    generator = np.random.default_rng(7)
    return [(1.5e-3 + 2.8e-3 * column + generator.uniform(-1e-4, 1e-4), 4e-3 + 3.5e-3 * row + generator.uniform(-2e-4, 2e-4))
            for row in range(3) for column in range(4)]


def write_scene(folder):
    places = starts()
    (folder / "scene.toml").write_text(SCENE.replace("START", repr([list(p) for p in places])))
    atoms = "".join(f"create_atoms 1 single {x!r} {y!r} 0.0 units box\n" for x, y in places)
    for engine, file in COMMON.items():
        common = ROOT / "cases" / "common"
        rest = (common / file).read_text()
        assert FRICTIONLESS[engine][0] in rest
        (folder / f"in.{engine}").write_text((common / f"box.{engine}").read_text() + atoms
                                             + rest.replace(*FRICTIONLESS[engine]))


def command(engine):
    if engine in COMMON:
        program = BIN / {"liggghts": "liggghts", "lammps": "lammps_engine"}[engine]
        return [program, "-in", f"in.{engine}", "-log", "none", "-screen", "none"]
    if (BIN / f"{engine}_engine").exists():
        return [BIN / f"{engine}_engine"]
    return ["/usr/bin/python3", ENGINES / engine / "engine.py"]


def engines():
    for engine in ("liggghts", "lammps", "yade", "reference", "python", "c", "fortran"):
        there = shutil.which("yade") if engine == "yade" else (
            (BIN / "fortran_engine").exists() if engine == "fortran" else True)
        if there:
            yield engine


def settle(folder, engine):
    """The last states of a run: places and velocities [disc][2]."""
    env = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_mpi_yield_when_idle="1")
    done = subprocess.run(["mpirun", "--bind-to", "none", "--oversubscribe", "-np", "1", BIN / "lbm", "scene.toml",
                           "--progress", "none", "--out", engine, ":", "-np", "1", *command(engine)], cwd=folder, env=env,
                          capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, f"{engine}: {done.stdout}{done.stderr}"
    rows = np.loadtxt(folder / engine / "probes.csv", delimiter=",", skiprows=1)
    last = rows[rows[:, 0] == rows[-1, 0]]
    return last[np.argsort(last[:, 1])][:, 2:6]


def statistics(last):
    """Height of the centre of mass and of the top, contacts a disc with discs and walls, speed."""
    x, y = last[:, 0], last[:, 1]
    apart = np.hypot(x[:, None] - x, y[:, None] - y)
    near = 1.02 * DIAMETER
    pairs = np.count_nonzero(np.triu(apart < near, 1))
    walls = np.count_nonzero(x < near / 2) + np.count_nonzero(x > WIDTH - near / 2) + np.count_nonzero(y < near / 2)
    return {"mean height [D]": y.mean() / DIAMETER, "top [D]": y.max() / DIAMETER,
            "contacts a disc": (2 * pairs + walls) / len(x), "mean speed [mm/s]": 1e3 * np.hypot(*last[:, 2:].T).mean()}


class Packing(unittest.TestCase):
    def test_every_engine_comes_to_the_same(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            write_scene(folder)
            found = {engine: statistics(settle(folder, engine)) for engine in engines()}
        for engine, values in found.items():
            print(f"{engine:10}", *(f"{key} {value:.4f}" for key, value in values.items()))
        self.assertGreater(len(found), 4)
        first = found["liggghts"]
        for engine, values in found.items():
            with self.subTest(engine):
                self.assertAlmostEqual(values["mean height [D]"], first["mean height [D]"], delta=0.05)
                self.assertAlmostEqual(values["top [D]"], first["top [D]"], delta=0.25)
                self.assertAlmostEqual(values["contacts a disc"], first["contacts a disc"], delta=0.5)
                self.assertLess(values["mean speed [mm/s]"], 3.0)  # a disc falls at 150


if __name__ == "__main__":
    unittest.main()
