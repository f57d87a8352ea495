"""Obstacles from files, as the drawings see them, and the generators of the scenes' files."""

import contextlib
import importlib.util
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))
from bplbm import shapes  # noqa: E402
from bplbm.page.setup import Drawing  # noqa: E402
from bplbm.scenes import find  # noqa: E402
from bplbm.setup_drawing import figure_of  # noqa: E402

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

    def test_a_section_shows_what_is_hollow(self):
        corners = np.array([[[0, 0, 0], [2, 0, 0], [0, 4, 2]], [[0, 5, 0], [1, 5, 0], [0, 6, 1]]], float)
        np.testing.assert_allclose(shapes.section(corners, 2.0), [[[0, 2, 1], [1, 2, 1]]])
        self.assertEqual(shapes.section(corners, 9.0).shape, (0, 2, 3))
        drawing = Drawing({"box": {"size": [0.004, 0.004, 0.004]}, "obstacle": [{"mesh": "mesh.stl", "scale": 0.001}]})
        with triangle() as folder:
            drawing.obstacles(folder)
        self.assertIn('stroke="#444"', drawing.svg())

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

    def test_the_set_up_is_drawn_in_three_dimensions(self):
        for name in ("screen_clogging", "digital_rock"):
            scene = find(name)
            figure = figure_of(scene.tables(), scene.folder)
            axes = figure.axes[0]
            drawn = len(axes.patches) + len(axes.collections) + len(axes.images)
            self.assertGreater(drawn, 1, name)  # the particles' collection is always there
            self.assertEqual(axes.get_ylabel()[0], "z")
            figure.clear()

    def test_a_cylinder_is_drawn_along_its_axis(self):
        box = {"box": {"size": [1.0, 1.0, 1.0]}, "fluid": {"density": 1.0, "kinematic_viscosity": 1.0}}
        for end, corners in (([0.8, 0.5, 0.5], 5), ([0.2, 0.9, 0.5], None)):
            rod = {"from": [0.2, 0.5, 0.5], "to": end, "diameter": 0.1}
            patch = figure_of({**box, "obstacle": [rod]}, pathlib.Path("none")).axes[0].patches[0]
            self.assertEqual(len(patch.get_xy()) if corners else patch.get_radius(), corners or 0.05)

    def test_what_moves_is_said(self):
        drum = {"centre": [0.5, 0.5], "diameter": 0.6, "hollow": True, "motion": "rotation", "angular_velocity": -2.0, "surface_only": True}
        belt = {"from": [0.1, 0.1], "to": [0.3, 0.2], "motion": "linear", "velocity": [0.2, 0.0]}
        tables = {"box": {"size": [1.0, 1.0]}, "fluid": {"density": 1000.0, "kinematic_viscosity": 1e-6}, "obstacle": [drum, belt]}
        drawing = Drawing(tables)
        drawing.obstacles("")
        texts = [text.get_text() for text in figure_of(tables, pathlib.Path("none")).axes[0].texts]
        for said in ("2 rad/s ↻ on its surface", "(0.2, 0) m/s"):
            self.assertIn(said, drawing.svg())
            self.assertIn(said, texts)

    def test_the_sense_of_a_rotation_is_as_it_is_seen(self):
        tables = {"box": {"size": [1.0, 1.0, 1.0]}, "fluid": {"density": 1000.0, "kinematic_viscosity": 1e-6}}
        for axis, speed, said in (([0, 1, 0], 2.0, "2 rad/s ↻ about (0, 1, 0)"), ([0, 1, 0], -2.0, "-2 rad/s ↺ about (0, 1, 0)"),
                                  ([0, -1, 0], 2.0, "2 rad/s ↺ about (0, -1, 0)"), ([0, 0, 1], -2.0, "-2 rad/s about (0, 0, 1)")):
            drum = {"from": [0.5, 0.1, 0.5], "to": [0.5, 0.9, 0.5], "diameter": 0.4, "motion": "rotation", "angular_velocity": speed, "axis": axis}
            drawing = Drawing({**tables, "obstacle": [drum]})
            drawing.obstacles("")
            self.assertIn(f">{said}<", drawing.svg())
            turn = np.cross(np.multiply(axis, speed), [1, 0, 0])[2]  # upwards at the right: against the clock
            self.assertEqual("↺" in said, turn > 0)

    def test_what_lies_beyond_the_box_is_cut(self):
        rod = {"from": [-0.05, 0.01, 0.005], "to": [0.07, 0.01, 0.005], "diameter": 0.002}
        tables = {"box": {"size": [0.02, 0.02, 0.01]}, "fluid": {"density": 1000.0, "kinematic_viscosity": 1e-6}, "obstacle": [rod]}
        drawing = Drawing(tables)
        drawing.obstacles("")
        svg = drawing.svg()
        self.assertIn('<clipPath id="setup-box"><rect x="46" y="46" width="360.0" height="180.0"/>', svg)
        self.assertRegex(svg, r'<g clip-path="url\(#setup-box\)"><path d="M-854.0 136.0L1306.0 136.0"[^>]*/></g>')
        figure = figure_of(tables, pathlib.Path("none"))
        patch = figure.axes[0].patches[0]
        figure.canvas.draw()
        np.testing.assert_allclose(patch.clipbox.extents if patch.get_clip_path() is None else
                                   patch.get_clip_path().get_fully_transformed_path().get_extents().extents,
                                   figure.axes[0].transData.transform([[0, 0], [20, 10]]).ravel())

    def test_a_box_may_begin_anywhere(self):
        """Drawings of one scene in two boxes, the second and all in it moved: they are equal, the axes' numbers apart."""
        def drawn(x, y, dimension):
            middle = [0.0] * (dimension - 2)
            tables = {"box": {"origin": [x, *middle, y], "size": [1.0] * dimension},
                      "fluid": {"density": 1000.0, "kinematic_viscosity": 1e-6},
                      "boundary": [{"side": "left", "kind": "pressure",
                                    **{key: [0.0, y + part] if middle else y + part for key, part in (("from", 0.25), ("to", 0.75))}}],
                      "obstacle": [{"from": [x + 0.25, *middle, y + 0.5], "to": [x + 0.5, *middle, y + 0.75], "motion": "linear",
                                    "velocity": [0.5, *middle, 0.0]},
                                   {"centre": [x + 0.75, *middle, y + 0.75], "diameter": 0.25}],
                      "particles": {"diameter": 0.125, "density": 2500.0, "start": [[x + 0.5, *middle, y + 0.25]]}}
            figure = figure_of(tables, pathlib.Path("none"))
            axes = figure.axes[0]
            figure.canvas.draw()
            places = [artist.get_window_extent().extents for artist in [*axes.patches, *axes.lines, *axes.collections]]
            places += [axes.transData.transform(text.xy) for text in axes.texts if text.xycoords == "data"]
            drawing = Drawing(tables)
            drawing.obstacles("")
            drawing.boundaries()
            return np.concatenate(places), axes.get_xlim(), axes.get_ylim(), drawing.svg()

        for dimension in (2, 3):
            places, x_limits, y_limits, page = drawn(0.0, 0.0, dimension)
            moved, moved_x, moved_y, moved_page = drawn(-4.0, 8.0, dimension)
            self.assertGreater(len(places), 30)
            np.testing.assert_allclose(moved, places, atol=1e-6)
            np.testing.assert_allclose([*moved_x, *moved_y], np.add([*x_limits, *y_limits], [-4, -4, 8, 8]))
            self.assertEqual(moved_page, page)

    def test_the_discs_of_a_clump_have_no_lines_inside(self):
        import matplotlib.pyplot as plt
        from bplbm.pictures import draw_discs
        axes = plt.figure().add_subplot()
        particles = np.array([[-3, 0.5, 0.5, 0.0], [1, 0.4, 0.5, 0.2], [2, 0.6, 0.5, 0.2]])  # the clump's own row first
        draw_discs(axes, particles[:, 1:4], particles)
        self.assertEqual([len(c.get_paths()) for c in axes.collections], [2, 2])
        self.assertEqual(len(axes.collections[1].get_edgecolor()), 0)  # the second covers the first one's lines


if __name__ == "__main__":
    unittest.main()
