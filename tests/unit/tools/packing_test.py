"""tools/make_packing: bound of the overlaps, sizes, seeds, what it refuses, and LIGGGHTS reads it."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
BIN = ROOT / "build" / os.environ.get("BPLBM_PRESET", "release") / "bin"
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import new_scene  # noqa: E402

BOX = ["--box", "0", "0.06", "0", "0.03", "--diameter", "0.002", "0.004"]


def make(folder, *more, force=True):
    return subprocess.run([sys.executable, "-m", "bplbm.packing", "--out", "p", *BOX, *more, *(["--force"] if force else [])],
                          env={**os.environ, "PYTHONPATH": str(ROOT / "tools")}, cwd=folder, capture_output=True, text=True, check=False, timeout=100)


def largest_overlap(discs, periodic):
    """Brute force over all pairs, images included; overlap over the smaller radius."""
    worst = 0.0
    for i, (x, y, d) in enumerate(discs):
        for x2, y2, d2 in discs[i + 1:]:
            dx = abs(x - x2)
            if periodic:
                dx = min(dx, 0.06 - dx)
            worst = max(worst, (0.5 * (d + d2) - np.hypot(dx, y - y2)) / (0.5 * min(d, d2)))
        ends = [y - d / 2, 0.03 - y - d / 2] + ([] if periodic else [x - d / 2, 0.06 - x - d / 2])
        worst = max(worst, -min(ends) / (0.5 * d))
    return worst


class Packing(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def discs(self):
        return np.loadtxt(pathlib.Path(self.folder.name, "p.csv"), delimiter=",", skiprows=1)

    def test_periodic_and_walled(self):
        for periodic in (True, False):
            job = make(self.folder.name, "--fraction", "0.78", *(["--periodic", "x"] if periodic else []))
            self.assertEqual(job.returncode, 0, job.stdout + job.stderr)
            discs = self.discs()
            self.assertLessEqual(largest_overlap(discs, periodic), 1e-3 + 1e-6)
            self.assertAlmostEqual(np.pi / 4 * (discs[:, 2] ** 2).sum() / (0.06 * 0.03), 0.78, delta=0.01)
            self.assertGreaterEqual(discs[:, 2].min(), 0.002)
            self.assertLessEqual(discs[:, 2].max(), 0.004)

    def test_seed_and_count(self):
        texts = []
        for seed in ("1", "1", "2"):
            job = make(self.folder.name, "--count", "60", "--law", "lognormal", "--seed", seed)
            self.assertEqual(job.returncode, 0, job.stdout + job.stderr)
            self.assertEqual(len(self.discs()), 60)
            texts.append(pathlib.Path(self.folder.name, "p.csv").read_text())
        self.assertEqual(texts[0], texts[1])
        self.assertNotEqual(texts[0], texts[2])

    def test_spheres(self):
        side = 0.012
        job = make(self.folder.name, "--box", *["0", str(side)] * 3, "--fraction", "0.5", "--periodic", "xz")
        self.assertEqual(job.returncode, 0, job.stdout + job.stderr)
        self.assertIn("spheres, volume fraction 0.5", job.stdout)
        spheres = self.discs()
        self.assertEqual(spheres.shape[1], 4)
        places, sizes = spheres[:, :3], spheres[:, 3]
        self.assertGreaterEqual(np.pi / 6 * (sizes**3).sum() / side**3, 0.5)
        self.assertTrue((places >= 0).all() and (places <= side).all())
        worst = (np.maximum(0.5 * sizes - places[:, 1], places[:, 1] + 0.5 * sizes - side) / (0.5 * sizes)).max()  # walls in y
        for i in range(len(sizes) - 1):
            apart = places[i + 1:] - places[i]
            apart[:, [0, 2]] -= side * np.round(apart[:, [0, 2]] / side)
            overlap = 0.5 * (sizes[i] + sizes[i + 1:]) - np.sqrt((apart**2).sum(axis=1))
            worst = max(worst, (overlap / (0.5 * np.minimum(sizes[i], sizes[i + 1:]))).max())
        self.assertLessEqual(worst, 1e-3 + 1e-6)
        script = pathlib.Path(self.folder.name, "p.liggghts").read_text()
        self.assertEqual(script.count("density ${density_max}"), len(sizes))

    def clumps(self, *more):
        """Makes a packing of clumps of three. Returns places and diameters of the spheres, and the clump of each."""
        pathlib.Path(self.folder.name, "three.txt").write_text("-0.5 0 0 0.5\n0.5 0 0 0.5\n0 0 0 0.6\n")
        job = make(self.folder.name, "--clump", "three.txt", *more)
        self.assertEqual(job.returncode, 0, job.stdout + job.stderr)
        script = pathlib.Path(self.folder.name, "p.liggghts").read_text()
        owner = np.array([int(line.split(" mol ")[1].split()[0]) for line in script.splitlines() if line.startswith("set atom")])
        spheres = self.discs()
        self.assertEqual(len(owner), len(spheres))
        return spheres[:, :-1], spheres[:, -1], owner

    def test_clumps(self):
        for side, more in ((np.array([0.06, 0.03]), ["--fraction", "0.7"]),
                           (np.full(3, 0.009), ["--box", *["0", "0.009"] * 3, "--fraction", "0.45"])):
            places, sizes, owner = self.clumps(*more, "--periodic", "x")
            worst = (np.maximum(0.5 * sizes[:, None] - places, places + 0.5 * sizes[:, None] - side)[:, 1:] / (0.5 * sizes[:, None])).max()
            for i in range(len(sizes) - 1):  # brute force over all pairs of different clumps
                apart = places[i + 1:] - places[i]
                apart[:, 0] -= side[0] * np.round(apart[:, 0] / side[0])
                overlap = (0.5 * (sizes[i] + sizes[i + 1:]) - np.linalg.norm(apart, axis=1)) / (0.5 * np.minimum(sizes[i], sizes[i + 1:]))
                worst = max(worst, overlap[owner[i + 1:] != owner[i]].max(initial=0))
            self.assertLessEqual(worst, 1e-3 + 1e-6)
            dense = np.zeros(4000, bool)  # the fraction that the unions fill, by points
            points = np.random.default_rng(1).uniform(0, side, (len(dense), len(side)))
            for place, size in zip(places, sizes):
                apart = points - place
                apart[:, 0] -= side[0] * np.round(apart[:, 0] / side[0])
                dense |= (apart**2).sum(1) < (0.5 * size)**2
            self.assertAlmostEqual(dense.mean(), float(more[-1]), delta=0.035)  # of 4000 points: 1 % each way, and one clump
            self.assertEqual(set(np.bincount(owner)[1:]), {3})

    def test_a_fluid_couples_with_clumps(self):
        _, sizes, owner = self.clumps("--fraction", "0.5", "--periodic", "x", "--diameter", "0.004", "0.005")
        folder = pathlib.Path(self.folder.name)
        (folder / "scene.toml").write_text(f"""[box]
size = [0.06, 0.03]
sides_x = "periodic"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-4
gravity = [0.0, -9.81]
velocity_scale = 0.2
[particles]
diameter = [{sizes.min() * 0.999}, {sizes.max() * 1.001}]
density = [1999.9, 2000.1]
contact_stiffness = 1e4
[numerics]
cell = 0.0005
[coupling]
[run]
end_time = 0.005
[output]
probe_every = 0.005
""")
        common = (ROOT / "cases" / "common" / "box.liggghts").read_text()
        (folder / "in.liggghts").write_text(
            common.replace("atom_style       granular", "atom_style hybrid granular molecular")
            + "variable disc_density equal 2000*${depth}\ninclude p.liggghts\nneigh_modify exclude molecule all\n"
            + "".join(f"fix {n} all property/global {n} peratomtypepair 1 {v}\n" for n, v in (
                ("kn", "${contact_stiffness}"), ("kt", "${contact_stiffness}"), ("gamman", 100), ("gammat", 100), ("coefficientFriction", 0.5)))
            + "pair_style gran model hooke/stiffness tangential history\npair_coeff * *\n"
            + "".join(f"fix {n} all wall/gran model hooke/stiffness tangential history primitive type 1 yplane ${{y_{n}}}\n" for n in ("lo", "hi"))
            + "fix move all rigid molecule\nfix weight all gravity ${gravity} vector ${gravity_x} ${gravity_y} 0\n"
            + "timestep ${solid_step}\nfix fluid all lbm/couple every ${substeps}\nfix flat all enforce2d\nrun ${solid_steps_total}\n")
        env = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        job = subprocess.run(["mpirun", "--oversubscribe", "--bind-to", "none", "-np", "1", BIN / "lbm", "scene.toml", "--out", "out",
                              ":", "-np", "1", BIN / "liggghts", "-in", "in.liggghts", "-screen", "none"],
                             cwd=folder, env=env, capture_output=True, text=True, check=False, timeout=60)
        self.assertEqual(job.returncode, 0, job.stdout + job.stderr)  # densities of 2000 ± 5e-5: the fluid's volume is good to 3e-5
        table = np.loadtxt(folder / "out" / "probes.csv", delimiter=",", skiprows=1)
        first = table[table[:, 0] == 0]
        self.assertEqual(np.count_nonzero(first[:, 1] < -1), owner.max())  # a row of each clump
        self.assertEqual(np.count_nonzero(first[:, 1] > 0), len(sizes))

    def test_clumps_that_are_none_are_refused(self):
        for text, word in (("1 2 3\n", "x y z radius"), ("0 0 0 -1\n", "positive"), ("0 0 1 1\n", "z = 0"), ("a b c d\n", "x y z radius")):
            pathlib.Path(self.folder.name, "bad.txt").write_text(text)
            job = make(self.folder.name, "--clump", "bad.txt")
            self.assertEqual(job.returncode, 2)
            self.assertIn(word, job.stderr)

    def test_a_shape_that_is_not_there(self):
        job = make(self.folder.name, "--clump", "none.txt")
        self.assertEqual(job.returncode, 2)
        self.assertIn("none.txt cannot be read", job.stderr)

    def test_refusals(self):
        for more, word in ((["--fraction", "0.95"], "cannot all fit"), (["--count", "900"], "cannot all fit"),
                           (["--fraction", "nan"], "finite"), (["--count", "0"], "at least 1"), (["--seed", "-1"], "--seed"),
                           (["--box", "0", "nan", "0", "1"], "finite"), (["--overlap", "0"], "positive"),
                           (["--box", "0", "1", "0"], "of spheres also Z_LO Z_HI"), (["--periodic", "z"], "a box of discs has no z"),
                           (["--box", "0", "0.06", "0", "0.03", "0", "0.03", "--fraction", "0.7"], "above 0.66")):
            job = make(self.folder.name, *more)
            self.assertEqual(job.returncode, 2)
            self.assertIn(word, job.stderr)

    def test_another_file_of_that_name_is_not_overwritten(self):
        for name, text in (("p.csv", "my own table\n"), ("p.liggghts", "# my own script\n")):
            path = pathlib.Path(self.folder.name, name)
            path.write_text(text)
            job = make(self.folder.name, "--count", "10")
            self.assertEqual(job.returncode, 2)
            self.assertIn(f"{name} is there and no packing", job.stderr)
            self.assertEqual(path.read_text(), text)
            path.unlink()

    def test_an_earlier_packing_is_replaced_by_force_only(self):
        script = pathlib.Path(self.folder.name, "p.liggghts")
        self.assertEqual(make(self.folder.name, "--count", "10", force=False).returncode, 0)
        before = script.read_text()
        self.assertNotIn("--force", before)
        job = make(self.folder.name, "--count", "12", force=False)
        self.assertEqual((job.returncode, script.read_text()), (2, before))
        self.assertIn("p.liggghts holds another packing, made with --out p --box", job.stderr)
        self.assertEqual(make(self.folder.name, "--count", "10", force=False).returncode, 0)  # the same
        self.assertEqual(make(self.folder.name, "--count", "12").returncode, 0)
        self.assertIn("# 12 discs", script.read_text())
        script.unlink()
        self.assertIn("p.csv is there without p.liggghts", make(self.folder.name, "--count", "12", force=False).stderr)

    def test_the_grains_of_a_new_scene_are_named(self):
        path = pathlib.Path(self.folder.name, "p.liggghts")
        path.write_text(new_scene.packing([([0.0, 0.0], 1e-3)], 2))
        job = make(self.folder.name, "--count", "10", force=False)
        self.assertEqual(job.returncode, 2)
        self.assertIn("p.liggghts holds the grains that tools/new made; --force replaces them", job.stderr)
        self.assertEqual(make(self.folder.name, "--count", "10").returncode, 0)

    def test_its_folder_is_made_before_anything_is_computed(self):
        job = make(self.folder.name, "--count", "10", "--out", "new/q")
        self.assertEqual(job.returncode, 0, job.stderr)
        self.assertIn("10 discs move apart", job.stdout)
        self.assertTrue(pathlib.Path(self.folder.name, "new", "q.csv").exists())
        pathlib.Path(self.folder.name, "file").write_text("")
        job = make(self.folder.name, "--count", "10", "--out", "file/q")
        self.assertEqual((job.returncode, job.stdout), (2, ""))
        self.assertIn("give another --out", job.stderr)

    def test_liggghts_reads_and_bonds_it(self):
        self.assertEqual(make(self.folder.name, "--fraction", "0.8", "--periodic", "x").returncode, 0)
        stiffness = {"contactNormalStiffness": 1e5, "contactShearStiffness": 1e5, "coefficientFriction": 0.3,
                     "contactDampingRatio": 0.5, "bondNormalStiffness": 1e5, "bondShearStiffness": 1e5,
                     "bondTensileStrength": 10, "bondShearStrength": 10}
        properties = "".join(f"fix {n} all property/global {n} peratomtypepair 1 {v}\n" for n, v in stiffness.items())
        pathlib.Path(self.folder.name, "in.bonds").write_text(
            "dimension 2\nunits si\natom_style granular\natom_modify map array\nboundary p f p\nnewton off\n"
            "communicate single vel yes\nregion box block 0 0.06 0 0.03 -0.5 0.5 units box\ncreate_box 1 box\n"
            "neighbor 0.001 bin\nneigh_modify delay 0\nvariable disc_density equal 2000\ninclude p.liggghts\n"
            + properties + "pair_style gran model bond/contact\npair_coeff * *\n"
            "fix make all bond/create gap 1e-5\ntimestep 1e-6\nrun 1\n")
        env = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        job = subprocess.run([BIN / "liggghts", "-in", "in.bonds"], cwd=self.folder.name, env=env,
                             capture_output=True, text=True, check=False, timeout=60)
        self.assertEqual(job.returncode, 0, job.stdout)
        bonds = int(job.stdout.split("bonds created:")[1].split()[0])
        self.assertGreater(bonds, len(self.discs()))  # a dense packing: more than two contacts a disc


if __name__ == "__main__":
    unittest.main()
