"""The package protocol/python: its wheel, its frames and shapes, and the engine that its README shows."""

import dataclasses
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "protocol" / "python"
BIN = ROOT / "build" / os.environ.get("BPLBM_PRESET", "release") / "bin"
sys.path.insert(0, str(PACKAGE))

import bplbm_solid  # noqa: E402
import numpy as np  # noqa: E402
from bplbm_solid import checkpoints, frames, routing  # noqa: E402
from bplbm_solid.agreement import disagreements  # noqa: E402
from bplbm_solid.channel import Channel  # noqa: E402


def handshake(**changes):
    fluid = frames.Handshake(
        version=4, role=frames.FLUID, program="lbm", program_version="1", dimension=2, box_lo=[0.0, 0.0, -0.5],
        box_hi=[1.0, 2.0, 0.5], periodic=[1, 0, 1], depth=1.0, units="SI", gravity=[0.0, -9.81, 0.0], buoyancy=0,
        step=1e-3, fluid_steps=10, solid_steps=5, first_interval=0, schedule=0, features=0, particles=None,
        radius=[0.1, 0.2], density=None, subdomain_lo=[0.0, 0.0, -0.5], subdomain_hi=[0.5, 2.0, 0.5], reach=0.01,
        sides=None, bodies=["plate"], variables={"solid_step": "0.002", "Größe": "1"})
    return dataclasses.replace(fluid, **changes)


def run(words, **more):
    return subprocess.run(words, capture_output=True, text=True, timeout=60, check=False, **more)


class Wheel(unittest.TestCase):
    def test_it_is_built_without_a_network_and_can_be_installed(self):
        folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, folder)
        shutil.copytree(PACKAGE, folder / "source", ignore=shutil.ignore_patterns("__pycache__"))
        pip = [sys.executable, "-m", "pip", "--isolated", "--disable-pip-version-check"]
        offline = dict(os.environ, http_proxy="http://127.0.0.1:9", https_proxy="http://127.0.0.1:9", PIP_NO_INDEX="1")
        built = run([*pip, "wheel", "--no-build-isolation", "--no-deps", "--no-index", "--wheel-dir", folder,
                     folder / "source"], env=offline)
        self.assertEqual(built.returncode, 0, built.stdout + built.stderr)
        wheel, = folder.glob("*.whl")
        self.assertEqual(wheel.name, f"bplbm_solid-{bplbm_solid.__version__}-py3-none-any.whl")
        put = run([*pip, "install", "--no-deps", "--no-index", "--target", folder / "site", wheel], env=offline)
        self.assertEqual(put.returncode, 0, put.stdout + put.stderr)
        code = "import bplbm_solid; print(bplbm_solid.__file__, bplbm_solid.Solid)"
        said = run([sys.executable, "-c", code], env=dict(os.environ, PYTHONPATH=str(folder / "site")), cwd=folder)
        self.assertIn(str(folder / "site"), said.stdout, said.stderr)
        self.assertTrue((folder / "site" / "bplbm_solid" / "py.typed").exists())

    def test_every_name_is_documented_and_typed(self):
        for name in bplbm_solid.__all__:
            thing = getattr(bplbm_solid, name)
            self.assertTrue(isinstance(thing, np.dtype) or thing.__doc__, name)
        for name, method in vars(bplbm_solid.Solid).items():
            if callable(method) and not name.startswith("_"):
                self.assertIn("return", method.__annotations__, name)


class Frames(unittest.TestCase):
    def test_a_handshake_comes_back(self):
        for said in (handshake(), handshake(particles=3, sides=[0, 0, 1, 2, 0, 0], radius=None, density=[1.0, 2.0])):
            self.assertEqual(frames.decode_handshake(frames.encode(said)), said)

    def test_every_cut_of_one_is_an_error(self):
        whole = frames.encode(handshake())
        for size in range(len(whole)):
            with self.assertRaises(bplbm_solid.SolidError):
                frames.decode_handshake(whole[:size])

    def test_another_version_is_refused_with_both(self):
        with self.assertRaisesRegex(bplbm_solid.SolidError, "fluid speaks 99, this package 4") as refused:
            frames.decode_handshake(frames.encode(handshake(version=99)))
        self.assertEqual(refused.exception.exit_code, 2)

    def test_records_have_the_sizes_of_the_wire(self):
        self.assertEqual([k.itemsize for k in (bplbm_solid.STATE, bplbm_solid.SHAPE, bplbm_solid.LOAD, bplbm_solid.BOND)],
                         [80, 64, 56, 24])


class Agreement(unittest.TestCase):
    SAME = handshake(role=frames.SOLID, step=2e-3, fluid_steps=1)

    def test_equal_sides_agree(self):
        self.assertEqual(disagreements(handshake(), self.SAME), [])

    def test_each_difference_is_named(self):
        for word, change in {"box x": {"box_hi": [1.1, 2.0, 0.5]}, "boundary y": {"periodic": [1, 1, 1]},
                             "depth": {"depth": 2.0}, "gravity": {"gravity": [0.0, -9.8, 0.0]}, "buoyancy": {"buoyancy": 1},
                             "substeps": {"solid_steps": 6}, "coupling interval": {"step": 3e-3}, "units": {"units": "cgs"},
                             "first coupling interval": {"first_interval": 7}, "particle radius": {"radius": [0.1, 0.3]},
                             "dimension": {"dimension": 3}, "schedule": {"schedule": 1}, "roles": {"role": 1}}.items():
            found = disagreements(handshake(), dataclasses.replace(self.SAME, **change))
            self.assertTrue(any(reason.startswith(word) or word in reason for reason in found), (word, found))
        wants = handshake(features=frames.CHECKPOINTS, density=[900.0, 1000.0], particles=2)
        found = disagreements(wants, dataclasses.replace(self.SAME, density=[2000.0, 2000.0], particles=3))
        for word in ("checkpoints", "density", "particles"):
            self.assertTrue(any(word in reason for reason in found), word)


class Routing(unittest.TestCase):
    def test_a_rank_gets_what_touches_it_by_any_image(self):
        states = np.zeros(5, bplbm_solid.STATE)
        states["x"][:, 0] = [0.25, 0.55, 0.7, 0.95, 1.25]  # the fluid's part is 0 … 0.5 of 1 m, periodic
        states["x"][:, 1] = 1.0
        there = routing.touching(handshake(), states, np.full(5, 0.1))
        self.assertEqual(there.tolist(), [0, 1, 3, 4])

    def test_a_particle_far_out_is_named(self):
        states = np.zeros(1, bplbm_solid.STATE)
        states["id"], states["x"][0, 1] = 7, 4.5
        with self.assertRaisesRegex(bplbm_solid.SolidError, "particle 7: .* far outside"):
            routing.refuse_astray(handshake(), states, 3)

    def test_a_shape_is_told_once_until_it_changes(self):
        told, generator = routing.Told(), np.random.default_rng(1)
        shapes = np.array([bplbm_solid.disc(i, 0.1, 1000.0, 1.0) for i in range(6)])
        known = {}
        for _ in range(50):
            now = shapes[generator.permutation(6)[:generator.integers(7)]].copy()
            now["type"] = np.where(generator.random(len(now)) < 0.2, 2, 1)
            expected = [s["id"] for s in now if known.get(s["id"]) != s.tobytes()]
            self.assertEqual(told.news(now)["id"].tolist(), expected)
            known = {s["id"]: s.tobytes() for s in now}


class Checkpoints(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.prefix = pathlib.Path(folder.name, "checkpoint")

    def parts(self):
        return sorted(int(p.name.split(".")[1]) for p in self.prefix.parent.iterdir())

    def test_the_two_before_stay(self):
        states = np.zeros(2, bplbm_solid.STATE)
        for interval in (10, 20, 30, 40):
            checkpoints.write(self.prefix, interval, {"states": states, "springs": np.arange(3.0)})
        self.assertEqual(self.parts(), [20, 30, 40])
        checkpoints.write(self.prefix, 25, {"states": states})
        self.assertEqual(self.parts(), [20, 25])
        read, memory = checkpoints.read(f"{self.prefix}.20.solid")
        self.assertEqual((read.tobytes(), memory["springs"].tolist()), (states.tobytes(), [0.0, 1.0, 2.0]))

    def test_what_is_damaged_is_refused(self):
        checkpoints.write(self.prefix, 1, {"states": np.zeros(2, bplbm_solid.STATE)})
        path = pathlib.Path(f"{self.prefix}.1.solid")
        whole = path.read_bytes()
        for damaged in (b"", b"garbage", whole[:len(whole) // 2], whole[:200] + b"\xff" + whole[201:]):
            path.write_bytes(damaged)
            with self.assertRaises(bplbm_solid.SolidError) as refused:
                checkpoints.read(str(path))
            self.assertEqual(refused.exception.exit_code, 2)


class Shapes(unittest.TestCase):
    def test_masses_of_disc_and_sphere(self):
        disc, ball = bplbm_solid.disc(3, 0.1, 1000.0, 0.5), bplbm_solid.sphere(4, 0.1, 1000.0, epoch=7)
        self.assertAlmostEqual(float(disc["mass"]), 5 * math.pi)
        self.assertAlmostEqual(float(disc["inertia"]), 0.025 * math.pi)
        self.assertAlmostEqual(float(ball["mass"]), 4 / 3 * math.pi)
        self.assertEqual((ball["id"], ball["epoch"], ball["carrier"]), (4, 7, -1))


class Clumps(unittest.TestCase):
    def test_a_union_has_the_volume_of_two_balls_less_their_lens(self):
        for apart in (0.3, 1.0, 2.0):
            n = np.array([0.6, 0.64, 0.48]) * apart / 2
            cap = 1 - apart / 2
            volume, centroid, second = bplbm_solid.union_moments([-n, n], [1.0, 1.0])
            self.assertAlmostEqual(volume / (8 / 3 * np.pi - 2 * np.pi * cap**2 * (3 - cap) / 3), 1, delta=1e-4)
            np.testing.assert_allclose(centroid, 0, atol=1e-4)
            axes = np.linalg.eigh(second)[1]
            self.assertAlmostEqual(abs(axes[:, -1] @ n) / np.linalg.norm(n), 1, delta=1e-4)  # longest along the pair
            area = bplbm_solid.union_moments([[-apart / 2, 0, 0], [apart / 2, 0, 0]], [1.0, 1.0], 2, 0.5)[0]
            chord = 2 * math.acos(apart / 2) - apart / 2 * math.sqrt(4 - apart**2)
            self.assertAlmostEqual(area / (0.5 * (2 * np.pi - chord)), 1, delta=1e-4)

    def test_its_records_are_a_carrier_and_spheres_that_name_it(self):
        clump = bplbm_solid.Clump(7, [[0, 0, 0], [0.1, 0, 0]], [0.1, 0.08], 1500.0, spheres=[8, 9])
        clump.x, clump.v, clump.omega = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0, 0]), np.array([0, 0, 2.0])
        states, shapes = clump.states, clump.shapes
        self.assertEqual(list(shapes["carrier"]), [-1, 7, 7])
        self.assertEqual(list(shapes["mass"][1:]), [0, 0])
        self.assertAlmostEqual(shapes["mass"][0] / shapes["volume"][0], 1500.0)
        arm = states["x"][2] - states["x"][0]
        np.testing.assert_allclose(states["v"][2], clump.v + np.cross(clump.omega, arm))
        self.assertAlmostEqual(shapes["radius"][0], max(np.linalg.norm(states["x"][i] - clump.x) + shapes["radius"][i]
                                                        for i in (1, 2)))

    def test_what_is_no_clump_is_refused(self):
        for centre, radius, density in (([0.1, 0, 0], -0.1, 1.0), ([0.1, 0, 0], 0.0, 1.0), ([0.1, 0, 0], math.nan, 1.0),
                                        ([math.inf, 0, 0], 0.1, 1.0), ([0.1, 0, 0], 0.1, -1.0)):
            with self.subTest(centre=centre, radius=radius, density=density):
                with self.assertRaises(bplbm_solid.SolidError) as caught:
                    bplbm_solid.Clump(7, [[0, 0, 0], centre], [0.1, radius], density, spheres=[8, 9])
                self.assertIn("clump 7: its density" if density < 0 else "clump 7: sphere 2 has its", str(caught.exception))
                self.assertEqual(caught.exception.exit_code, 2)
        with self.assertRaisesRegex(bplbm_solid.SolidError, "clump 7: centres of shape"):
            bplbm_solid.Clump(7, [[0, 0, 0]], [0.1, 0.1], 1.0, spheres=[8, 9])

    def test_left_alone_it_keeps_its_angular_momentum(self):
        clump = bplbm_solid.Clump(1, [[0, 0, 0], [0.6, 0.2, 0], [0, 0.7, 0.3]], [0.5, 0.4, 0.3], 1.0, spheres=[2, 3, 4])
        clump.omega = np.array([1.0, 0.5, 0.2])
        momentum = clump.turn @ clump.inertia @ clump.turn.T @ clump.omega
        for _ in range(500):
            clump.move(np.zeros(3), np.zeros(3), 0.01)
        np.testing.assert_allclose(clump.turn @ clump.inertia @ clump.turn.T @ clump.omega, momentum, rtol=1e-9)

    def test_spheres_go_where_their_carrier_goes(self):
        clump = bplbm_solid.Clump(1, [[0, 0, 0], [0.3, 0, 0]], [0.15, 0.15], 1.0, spheres=[2, 3], dimension=2)
        clump.x = np.array([0.7, 1.0, 0.0])  # a sphere of it is beyond the subdomain, at x > 0.5 + 0.15 + 0.01
        by = routing.routed_by(clump.shapes)
        there = routing.touching(handshake(), clump.states[by], clump.shapes["radius"][by])
        self.assertEqual(list(there), [0, 1, 2])
        with self.assertRaisesRegex(bplbm_solid.SolidError, "sphere of clump 1, which this rank does not send"):
            routing.routed_by(clump.shapes[1:])


class Waits(unittest.TestCase):
    def test_a_few_turns_that_take_long_do_not_outlast_its_time(self):
        """MPI may offer the core at every turn: on a busy machine each can take as long as another program's share."""
        asked = []

        def slow():
            asked.append(None)
            time.sleep(0.02)
            return False

        self.assertFalse(Channel._poll(0.1, slow))
        self.assertLess(len(asked), 8)  # 5 or 6 in its time, and a last one

    def test_it_ends_with_the_answer(self):
        for turns in (1, 7, 1000):
            asked = iter(range(1, turns + 1))
            self.assertTrue(Channel._poll(60.0, lambda asked=asked, turns=turns: next(asked) == turns))


class Readme(unittest.TestCase):
    def test_its_engine_lets_a_disc_fall(self):
        code = re.search(r"^```python\n(.*?)^```$", (PACKAGE / "README.md").read_text(), re.M | re.S).group(1)
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "engine.py").write_text(code)
            pathlib.Path(folder, "short.toml").write_text("[numerics]\ncells_per_diameter = 10\n[run]\nend_time = 0.05\n")
            env = dict(os.environ, PYTHONPATH=str(PACKAGE), OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_mpi_yield_when_idle="1")
            done = run(["mpirun", "--bind-to", "none", "--oversubscribe", "-np", "2", BIN / "lbm",
                        ROOT / "cases" / "settling_disc" / "scene.toml", "short.toml", "--progress", "none", "--out", "out",
                        ":", "-np", "1", sys.executable, "engine.py"], env=env, cwd=folder)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            rows = np.loadtxt(pathlib.Path(folder, "out", "probes.csv"), delimiter=",", skiprows=1)
            self.assertLess(rows[-1, 3], 0.0399)  # y [m]; it began at 0.04


if __name__ == "__main__":
    unittest.main()
