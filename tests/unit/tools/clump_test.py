"""tools/make_clump: moments of meshes and unions, what it fills, what it refuses."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import clump  # noqa: E402


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
        self.assertAlmostEqual(clump.of_mesh(box(2, 1, 3)[:, ::-1]).volume, 6)  # normals inwards

    def test_of_a_union(self):
        volume, centroid, second = clump.union_moments(np.array([[-.5, 0, 0], [.5, 0, 0]]), np.ones(2))
        self.assertAlmostEqual(volume / (8 / 3 * np.pi - 2 * np.pi * .25 * 2.5 / 3), 1, delta=1e-3)
        np.testing.assert_allclose(centroid, 0, atol=1e-3)
        self.assertGreater(second[0, 0], second[1, 1])

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
                made = clump.Body.of_moments(*clump.union_moments(spheres[:, :3], spheres[:, 3]))
                mesh = clump.of_mesh(ball(1.0) * [2, 1, 1])
                self.assertAlmostEqual(made.volume / mesh.volume, 1, delta=0.005)  # the radii grow to that
                errors.append(np.abs(np.linalg.eigvalsh(made.inertia) / np.linalg.eigvalsh(mesh.inertia) - 1).max())
            self.assertLess(errors[1], 0.08)
            self.assertLess(errors[1], errors[0])

    def test_mistakes_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            write(pathlib.Path(folder, "open.stl"), box(1, 1, 1)[:-1])
            write(pathlib.Path(folder, "closed.stl"), box(1, 1, 1))
            pathlib.Path(folder, "closed-3.txt").write_text("mine\n")
            for words, said in ((["none.stl", "3"], "is no file"), (["open.stl", "3"], "is not closed"),
                                (["open.stl", "0"], "at least one sphere"),
                                (["closed.stl", "3"], "closed-3.txt is there: it is not overwritten"),
                                (["closed.stl", "3", "--out", "closed.stl"], "closed.stl is there"),
                                (["closed.stl", "3", "--out", "open.stl/x"], "give another --out")):
                job = make(folder, *words)
                self.assertEqual(job.returncode, 2)
                self.assertIn(said, job.stderr)


if __name__ == "__main__":
    unittest.main()
