"""Obstacles from files, as the drawings see them, and the generators of the scenes' files."""

import contextlib
import importlib.util
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))
from bplbm import shapes  # noqa: E402
from bplbm.page.setup import Drawing  # noqa: E402

PICTURES = ROOT / "tests/unit/lbm_solver/pictures"


def module_of(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@contextlib.contextmanager
def triangle():
    """A folder with mesh.stl, one triangle whose normal has parts along x, y and z."""
    with tempfile.TemporaryDirectory() as folder:
        corners = "".join(f"vertex {x} {y} {z}\n" for x, y, z in ((0, 0, 1), (2, 0, 1), (0, 4, 3)))
        pathlib.Path(folder, "mesh.stl").write_text(f"solid one\nfacet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n")
        yield folder


class Meshes(unittest.TestCase):
    def test_a_mesh_is_scaled_turned_and_moved(self):
        obstacle = {"mesh": "mesh.stl", "scale": 0.001, "rotate": [0, 0, 1, 90], "move": [0.006, 0.0, 0.0]}
        with triangle() as folder:
            corners = shapes.placed_mesh(obstacle, folder)
        np.testing.assert_allclose(corners, [[[0.006, 0, 0.001], [0.006, 0.002, 0.001], [0.002, 0, 0.003]]], atol=1e-12)

    def test_a_binary_mesh_is_read(self):
        corners = np.arange(18, dtype="<f4").reshape(2, 3, 3)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "mesh.stl")
            facets = b"".join(bytes(12) + one.tobytes() + bytes(2) for one in corners)
            path.write_bytes(bytes(80) + (2).to_bytes(4, "little") + facets)
            np.testing.assert_array_equal(shapes.read_stl(path), corners)

    def test_the_screen_is_what_its_script_makes(self):
        case = ROOT / "cases/screen_clogging"
        script = module_of(case / "make_screen.py")
        for name, width in (("wide", "4.5"), ("narrow", "1.2")):
            with tempfile.TemporaryDirectory() as folder, mock.patch("sys.argv", ["", f"{folder}/screen.stl", width]):
                script.main()
                self.assertEqual(pathlib.Path(folder, "screen.stl").read_text(), (case / f"{name}.stl").read_text())


class Images(unittest.TestCase):
    def test_pictures_are_taken_as_they_are_seen(self):
        for name in ("grey8.png", "stack.tif"):
            levels = shapes.grey_levels({"image": name}, PICTURES)
            self.assertEqual(np.reshape(levels, -1)[:6].tolist(), [40, 50, 60, 10, 20, 30])

    def test_levels_become_fractions(self):
        part = {"image": "grey8.png", "cut_from": [1, 0], "cut_to": [3, 2]}
        cut = shapes.solid_fraction({**part, "threshold": 30}, PICTURES)
        self.assertEqual(cut.tolist(), [[1, 1], [0, 1]])
        grey = shapes.solid_fraction({**part, "grey_levels": [60, 20]}, PICTURES)
        self.assertEqual(grey.tolist(), [[0.25, 0], [1, 0.75]])

    def test_the_rock_is_what_its_script_makes(self):
        case = ROOT / "cases/digital_rock"
        with h5py.File(case / "rock.h5") as kept:
            np.testing.assert_array_equal(module_of(case / "make_rock.py").rock(64), kept["grey"][...])

    def test_the_page_draws_both(self):
        drawing = Drawing({"box": {"size": [0.012, 0.006, 0.02]}, "obstacle": [{"mesh": "mesh.stl", "scale": 0.001}]})
        with triangle() as folder:
            drawing.obstacles(folder)
        self.assertIn("<path d=\"M", drawing.svg())
        rock = {"image": "rock.h5", "dataset": "/grey", "voxel": 1.5625e-5, "grey_levels": [0, 255]}
        drawing = Drawing({"box": {"size": [0.001, 0.001, 0.001]}, "obstacle": [rock]})
        drawing.obstacles(ROOT / "cases/digital_rock")
        self.assertIn("data:image/png;base64,", drawing.svg())


if __name__ == "__main__":
    unittest.main()
