"""tools/make_clump: moments of meshes and unions, what it fills, what it refuses."""

import io
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import ball_union, clump, clump_packing  # noqa: E402


def box(x, y, z):
    """A closed surface of twelve triangles, from -x/2 to x/2 …"""
    corners = np.array([[a, b, c] for a in (-.5, .5) for b in (-.5, .5) for c in (-.5, .5)]) * [x, y, z]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return np.array([corners[list(t)] for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])


def ball(radius, count=24):
    """A sphere of triangles between circles of latitude."""
    turn, polar = np.linspace(0, 2 * np.pi, count, endpoint=False), np.linspace(0, np.pi, count // 2 + 1)

    def at(i, j):
        p, t = polar[i], turn[j % count]
        return radius * np.array([np.sin(p) * np.cos(t), np.sin(p) * np.sin(t), np.cos(p)])

    triangles = []
    for i in range(count // 2):
        for j in range(count):
            if i > 0:
                triangles.append([at(i, j), at(i + 1, j), at(i, j + 1)])
            if i < count // 2 - 1:
                triangles.append([at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)])
    return np.round(np.array(triangles), 12)


def write(path, corners):
    facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in t) +
                     "endloop\nendfacet\n" for t in corners)
    pathlib.Path(path).write_text(f"solid s\n{facets}endsolid s\n")


def make(folder, *words):
    return subprocess.run([sys.executable, "-m", "bplbm.clump", *words], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT / "tools")}, check=False, timeout=100)


class Moments(unittest.TestCase):
    def test_of_a_box(self):
        body = clump.of_mesh(box(2, 1, 3) + [0.3, -0.2, 0.1])
        self.assertAlmostEqual(body.volume, 6)
        np.testing.assert_allclose(body.centroid, [0.3, -0.2, 0.1])
        np.testing.assert_allclose(body.inertia, np.diag([1 + 9, 4 + 9, 4 + 1]) / 12, atol=1e-12)
        self.assertAlmostEqual(clump.of_mesh(box(2, 1, 3)[:, ::-1]).volume, -6)  # normals inwards

    def test_of_two_spheres(self):
        turn = clump_packing.turns(np.array([[0.3, -0.9, 0.5]]))[0]
        for a, b, d in ((0.5, 0.5, 0.6), (1, 0.4, 0.9), (1, 1, 1.999), (1, 0.4, 0.1), (0.3, 0.3, 2)):
            whole = 4 / 3 * np.pi * np.array([a, b])**3
            lens = np.pi * (a + b - d)**2 * (d * d + 2 * d * (a + b) - 3 * (a - b)**2) / (12 * d)
            lens = whole.min() if d < a - b else lens if d < a + b else 0.0
            for way in np.eye(3)[[0, 2]] @ turn, np.eye(3)[[0, 2]]:
                for along in way:
                    volume, centroid, _ = ball_union.of_spheres([[1, 2, 3], [1, 2, 3] + d * along], [a, b])
                    self.assertAlmostEqual(volume / (whole.sum() - lens), 1, delta=1e-8)
                    if a == b:
                        np.testing.assert_allclose(centroid, [1, 2, 3] + 0.5 * d * along, atol=1e-8)

    def test_of_two_discs(self):
        lens = 2 * 0.25 * np.arccos(0.6) - 0.5 * 0.6 * 0.8
        area, centroid, second = ball_union.of_discs([[0, 1], [0.6, 1]], [0.5, 0.5])
        self.assertAlmostEqual(area, 0.5 * np.pi - lens, delta=1e-12)
        np.testing.assert_allclose(centroid, [0.3, 1], atol=1e-12)
        self.assertGreater(second[0, 0] - 0.3**2, second[1, 1] - 1)

    def test_of_a_union_in_any_orientation(self):
        random = np.random.default_rng(2)
        centres, radii = random.normal(size=(9, 3)) * 0.4, random.uniform(0.2, 0.5, 9)
        radii[3], centres[4], radii[4] = 0.01, centres[5], radii[5]  # one deep within others, one twice
        volume, centroid, second = ball_union.of_spheres(centres, radii)
        points = random.uniform(-2, 2, (200000, 3))
        held = (np.linalg.norm(points[:, None] - centres, axis=2) < radii).any(1)
        self.assertAlmostEqual(64 * held.mean() / volume, 1, delta=0.03)  # of points: σ = 1 %
        np.testing.assert_allclose(points[held].mean(0), centroid, atol=0.03)
        np.testing.assert_allclose(np.cov(points[held].T) + np.outer(centroid, centroid), second, atol=0.03)
        for turn in clump_packing.turns(random.normal(size=(3, 3))):
            turned = ball_union.of_spheres(centres @ turn.T, radii)
            self.assertAlmostEqual(turned[0] / volume, 1, delta=1e-8)
            np.testing.assert_allclose(turned[1], turn @ centroid, atol=1e-8)
            np.testing.assert_allclose(turned[2], turn @ second @ turn.T, atol=1e-8)

    def test_a_surface_with_a_hole_is_not_closed(self):
        self.assertTrue(clump.is_closed(box(1, 1, 1)))
        self.assertFalse(clump.is_closed(box(1, 1, 1)[:-1]))
        self.assertTrue(clump.is_closed(ball(1)))

    def test_what_lies_inside_and_how_deep(self):
        points = np.array([[0, 0, 0], [0.4, 0, 0.1], [0.6, 0, 0], [0.2, 0.49, 0], [0, 0, 0.7]])
        np.testing.assert_array_equal(clump.inside(box(1, 1, 1), points), [True, True, False, True, False])
        np.testing.assert_allclose(clump.distance(box(1, 1, 1), points[:2]), [0.5, 0.1])


class Clump(unittest.TestCase):
    def test_more_spheres_fill_an_ellipsoid_better(self):
        with tempfile.TemporaryDirectory() as folder:
            write(pathlib.Path(folder, "e.stl"), ball(1.0) * [2, 1, 1])
            errors = []
            for count in (2, 9):
                job = make(folder, "e.stl", str(count), "--fineness", "24")
                self.assertEqual(job.returncode, 0, job.stdout + job.stderr)
                self.assertIn(f"nspheres {count}", job.stdout)
                spheres = np.loadtxt(pathlib.Path(folder, f"e-{count}.txt"))
                self.assertEqual(spheres.shape, (count, 4))
                made = clump.Body.of_moments(*ball_union.of_spheres(spheres[:, :3], spheres[:, 3]))
                mesh = clump.of_mesh(ball(1.0) * [2, 1, 1])
                self.assertAlmostEqual(made.volume / mesh.volume, 1, delta=1e-7)  # the radii grow to that
                errors.append(np.abs(np.linalg.eigvalsh(made.inertia) / np.linalg.eigvalsh(mesh.inertia) - 1).max())
            self.assertLess(errors[1], 0.08)
            self.assertLess(errors[1], errors[0])

    def test_mistakes_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            write(pathlib.Path(folder, "open.stl"), box(1, 1, 1)[:-1])
            write(pathlib.Path(folder, "closed.stl"), box(1, 1, 1))
            pathlib.Path(folder, "closed-3.txt").write_text("mine\n")
            write(pathlib.Path(folder, "inward.stl"), box(1, 1, 1)[:, ::-1])
            whole = pathlib.Path(folder, "open.stl").read_text()
            for name, text in (("cut", whole[:whole.rindex("vertex")]), ("line", whole[:whole.rindex("vertex") + 9]), ("none-at-all", "solid s\n")):
                pathlib.Path(folder, f"{name}.stl").write_text(text)
            pathlib.Path(folder, "binary.stl").write_bytes(b"\0" * 80 + (12).to_bytes(4, "little") + b"\0" * 77)
            for words, said in ((["cut.stl", "3"], "holds 32 corners, which are no triangles"), (["line.stl", "3"], "not three numbers"),
                                (["none-at-all.stl", "3"], "no 'facet'"), (["binary.stl", "3"], "announces 12 facets, 684 bytes"),
                                (["inward.stl", "3"], "face inwards"), (["none.stl", "3"], "is no file"), (["open.stl", "3"], "is not closed"),
                                (["open.stl", "0"], "at least one sphere"),
                                (["closed.stl", "3"], "closed-3.txt is there: it is not overwritten"),
                                (["closed.stl", "3", "--out", "closed.stl"], "closed.stl is there"),
                                (["closed.stl", "3", "--out", "open.stl/x"], "give another --out")):
                job = make(folder, *words)
                self.assertEqual(job.returncode, 2)
                self.assertIn(said, job.stderr)
                self.assertNotIn("Traceback", job.stderr)

    def test_long_work_says_how_far_it_has_come(self):
        out = io.StringIO()
        self.assertEqual(list(clump.progress(3, "spheres", every=0, out=out)), [0, 1, 2])
        self.assertIn("clump | 2 of 3 spheres\n", out.getvalue())
        out = io.StringIO()
        list(clump.progress(3, "spheres", out=out))
        self.assertEqual(out.getvalue(), "")


if __name__ == "__main__":
    unittest.main()
