"""Parts of the page of a run that few runs have: sensors, averages, a run cut short; and how to repeat it. No program is
started."""

import json
import pathlib
import re
import unittest
from unittest import mock

import page_test  # beside this file: an output folder as lbm writes one
import h5py
import numpy as np
from bplbm import early_end, written
from bplbm.page import histories, run as page_of_run, sensors
from bplbm.page.failed import write_failed_page
from bplbm.page.setup import LEGIBLE
from bplbm.results import Run
from bplbm.scene_words import COLOR


class Sensors(page_test.Output):
    """What a scene's sensors, averages and held flow wrote is on the page; a scene without them has none of it."""

    PLANE = "time [s],flow [m3/s],momentum_x [N],momentum_y [N],pressure [Pa],fluid_area [m2]\n"
    LINE = "time [s],distance [m],x [m],y [m],pressure [Pa],ux [m/s],uy [m/s]\n"

    def labels(self, charts):
        return [re.search('aria-label="([^"]*)"', chart)[1] for chart in charts]

    def write_tables(self, dimensions=2):
        run = self.write(dimensions)
        (self.out / "sensor-inlet.csv").write_text(self.PLANE + "0,0,0,0,0,0.02\n0.1,2e-4,3e-3,1e-9,24,0.02\n")
        (self.out / "sensor-floor.csv").write_text("time [s],flow [m3/s],fx [N],fy [N]\n0.1,1e-9,0.5,-0.25\n")
        (self.out / "sensor-middle.csv").write_text(self.LINE + "".join(
            f"{t},{x},{x},0.01,{'' if x == 0 else 3.0},{t * (1 + x)},0\n" for t in (0.0, 0.05, 0.1) for x in (0.0, 0.02)))
        (self.out / "sensor-late.csv").write_text(self.PLANE)  # the run has ended before its first row
        (self.out / "flow.csv").write_text("time [s],flow [m3/s],wanted [m3/s],pressure_gradient [Pa/m]\n0,1,2,3\n0.1,2,2,3\n")
        return run

    def test_each_kind_has_its_curves_with_units(self):
        run = self.write_tables()
        self.assertEqual(self.labels(sensors.charts(run)), [
            "flow [m³/s] against time [s]", "mean pressure on planes [Pa] against time [s]",
            "momentum through planes [N] against time [s]", "force on sides [N] against time [s]",
            "middle: velocity in x [m/s] against distance along the line [m]", "mean along middle: velocity in x [m/s] against time [s]",
            "middle: pressure [Pa] against distance along the line [m]", "mean along middle: pressure [Pa] against time [s]"])
        flow, _, momentum, force = sensors.charts(run)[:4]
        self.assertTrue(all(name in flow for name in (">floor<", ">inlet<")) and ">late<" not in flow)
        self.assertTrue(">inlet, x<" in momentum and ">inlet, y<" not in momentum)
        self.assertTrue(">floor, x<" in force and ">floor, y<" in force)
        text = self.page()
        for part in ("<h2>Sensors</h2>", "flow that is held [m³/s]", "its pressure gradient [Pa/m]"):
            self.assertIn(part, text)

    def test_a_mean_along_a_line_leaves_out_what_is_no_number(self):
        table = sensors.read_sensors(self.write_tables())["middle"]
        mean = lambda column: sensors.mean_at(np.array([0.0, 0.05, 0.1]), table["time"], table[column]).tolist()  # noqa: E731
        self.assertEqual(mean("pressure"), [3.0, 3.0, 3.0])
        np.testing.assert_allclose(mean("ux"), [0.0, 0.0505, 0.101])

    def test_many_sensors_share_no_colour(self):
        run = self.write(2)
        for i in range(10):
            (self.out / f"sensor-s{i}.csv").write_text(f"time [s],flow [m3/s],fx [N],fy [N]\n0.1,{i},0,0\n")
        self.assertEqual([chart.count('stroke-width="2"') for chart in sensors.charts(run)[:2]], [8, 2])

    def test_averages_are_pictures_and_a_table(self):
        for dimensions in (2, 3):
            self.write(dimensions)
            shape = (20, 40) if dimensions == 2 else (20, 10, 40)
            with h5py.File(self.out / "averages.h5", "w") as file:
                file.attrs.update({"samples": 101.0, "from": 0.05, "to": 0.1})
                velocity = np.zeros((*shape, 3), np.float32)
                velocity[..., 0], velocity[..., 1] = 0.3, 0.4
                pressure = np.full(shape, -7.0, np.float32)
                pressure[0] = np.nan
                file["velocity_mean"], file["velocity_rms"] = velocity, 0.1 * velocity
                file["pressure_mean"], file["pressure_rms"] = pressure, 0 * pressure
            text = self.page()
            for part in ("<h2>Averages</h2>", "101 samples from 0.05 s to 0.1 s", 'alt="speed of the mean velocity"', "<td>m/s</td>",
                         "mean pressure [Pa]", 'data-v="-7.0"'):
                self.assertIn(part, text, dimensions)
            self.assertEqual("middle plane of y" in text, dimensions == 3)
            self.assertRegex(text, r'data-v="0\.5\d*"')

    def test_a_scene_without_any_reads_nothing(self):
        run = self.write(2)
        with mock.patch.object(sensors, "read_table", side_effect=AssertionError), mock.patch.object(sensors.h5py, "File", side_effect=AssertionError):
            self.assertEqual((sensors.charts(run), sensors.averages(run)), ([], []))
        self.assertNotIn("Sensors", self.page())
        self.assertNotIn("Averages", self.page())


class Written(unittest.TestCase):
    def test_numbers_and_units_read_as_a_person_writes_them(self):
        self.assertEqual([written.error_text(e) for e in (0.0099, -0.5, 1e-6, -1e-6)], ["+0.99 %", "-50.00 %", "0.00 %", "0.00 %"])
        self.assertEqual([written.share_text(s) for s in (0.814, 0.006, 0.005)], ["81 %", "1 %", "<1 %"])
        self.assertEqual([written.unit_text(u) for u in ("m3/s", "kg/m3", "m/s2", "N m", "1")], ["m³/s", "kg/m³", "m/s²", "N m", "1"])
        self.assertEqual((written.with_unit(17.345, "1"), written.with_unit(2, "N")), ("17.345", "2 N"))


class Parts(page_test.Output):
    def test_the_colours_of_a_set_up_are_read_on_a_dark_page_too(self):
        self.assertLessEqual(set(COLOR.values()), set(LEGIBLE))
        for color in LEGIBLE.values():
            red, green, blue = (int(color[k:k + 2], 16) / 255 for k in (1, 3, 5))
            self.assertTrue(0.2 < 0.3 * red + 0.6 * green + 0.1 * blue < 0.6, color)
        self.write(2)
        self.assertIn(f'stroke="{LEGIBLE["tab:blue"]}"', self.page())

    def test_a_run_of_which_only_the_start_was_written_says_so(self):
        self.write(2, frames=1)
        text = write_failed_page(self.out, self.scene, [self.scene.file], ["sand"], ["mpirun"], 3).read_text()
        self.assertIn("Only the state at the start was written", text)
        self.assertNotIn("flow-slide", text)


class Names(unittest.TestCase):
    def test_clumps_are_called_as_messages_call_them(self):
        names = [histories.particle_name(number) for number in (7.0, -2.0, -3.0, -1 - 2**32 - 1, -1 - 3 * 2**32 - 12)]
        self.assertEqual(names, ["particle 7", "clump 1", "clump 2", "clump 1 of the 1. fix rigid", "clump 12 of the 3. fix rigid"])


class Repeat(page_test.Output):
    def test_the_folder_is_part_of_the_command(self):
        self.write(2)
        self.assertIn(f"<pre>cd {pathlib.Path.cwd()}\n", self.page())

    def test_an_installed_tree_has_no_commit(self):
        self.write(2)
        with mock.patch.object(page_of_run, "INSTALLED", True):
            text = self.page()
        self.assertNotIn("commit", text.split("How to repeat it")[1].split("<details>")[0])
        self.assertNotIn("unknown", text)

    def test_a_run_cut_short_is_not_judged(self):
        self.write(2)
        summary = json.loads((self.out / "summary.json").read_text())
        for end, ending, why in ((60.0, "complete", "ended at 0.1 of 60 s"), (0.1005, "complete", None), (0.1, "complete", None),
                                 (60.0, "steady: the velocity changes", None), (60.0, "stopped by a signal", "ended at 0.1 of 60 s")):
            self.scene.file.write_text(page_test.SCENE_2D + f"[run]\nend_time = {end}\n")
            (self.out / "summary.json").write_text(json.dumps({**summary, "ending": ending}))
            early_end.mark(self.out, [self.scene.file])
            marked = json.loads((self.out / "summary.json").read_text())
            self.assertEqual(marked.get("not_judged"), why, ending)
            self.assertEqual([r["pass"] for r in marked["results"]], [None if why else False])
            rows = "".join(page_of_run.results(Run(self.out)))
            self.assertEqual("not judged: ended at 0.1 of 60 s" in rows, bool(why))
            self.assertEqual(">miss<" in rows, not why)
            self.assertIn("not judged" if why else "0 of 1 results pass", repr(Run(self.out)))


if __name__ == "__main__":
    unittest.main()
