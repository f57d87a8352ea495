"""What tools/new makes is accepted by lbm, and runs from any folder with tools/run and tools/sweep --no-build."""

import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import new_scene  # noqa: E402
from bplbm.project import BIN  # noqa: E402

KINDS = [(kind, dimensions) for kind in new_scene.KINDS for dimensions in (2, 3)]


class NewScenes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def tool(self, *words):
        return subprocess.run([ROOT / "tools" / words[0], *words[1:]], cwd=self.folder, capture_output=True, text=True, timeout=60,
                              check=False)

    def test_lbm_accepts_each(self):
        for kind, dimensions in KINDS:
            said = self.tool("new", f"{kind}{dimensions}", "--kind", kind, "--dimensions", str(dimensions))
            self.assertEqual(said.returncode, 0, said.stderr)
            checked = subprocess.run([BIN / "lbm", "check", f"{kind}{dimensions}/scene.toml"], cwd=self.folder, text=True,
                                     capture_output=True, timeout=30, check=False)
            self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
            warnings = [line for line in (checked.stdout + checked.stderr).splitlines() if "warning" in line]
            # templates are coarse, so that they run at once; check says what that costs
            self.assertEqual([line for line in warnings if "cells a diameter the drag is" not in line], [])

    def test_one_runs_where_it_lies(self):
        self.tool("new", "sand")
        run = self.tool("run", "sand/", "--no-build", "--variant", "short")
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        summary = json.loads((self.folder / "out" / "sand-short" / "summary.json").read_text())
        self.assertAlmostEqual(summary["physical_seconds"], 0.2, 3)
        page = self.folder / "out" / "sand-short" / "index.html"
        self.assertIn(f"run | page {page}", run.stdout)
        self.assertNotIn("no page was made", run.stderr)
        for part in ("particle settles in a closed box", 'id="flow-data"', "velocity in y [m/s]", "wait for the other program"):
            self.assertIn(part, page.read_text())
        run = self.tool("run", "sand", "--no-build", "--variant", "short", "--force", "--no-page", "--out", "plain")
        self.assertFalse((self.folder / "plain" / "index.html").exists())

    def test_a_sweep_of_one_keeps_values_results_and_reasons(self):
        self.tool("new", "sand")
        done = self.tool("sweep", "sand", "--no-build", "--variant", "short", "--jobs", "2", "--set", "particles.density=1100,1400,-1",
                         "--let", "fluid.velocity_scale=0.06*particles.density/1000", "--out", "study")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        with open(self.folder / "study" / "sweep.csv") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["status"] for row in rows], ["ok", "ok", "failed"])
        self.assertLess(*(float(row["largest speed of a particle [m/s]"]) for row in rows[:2]))
        self.assertIn("is out of range; give a positive number", rows[2]["reason"])
        overlay = (self.folder / "study" / "overlays" / "density-1400.toml").read_text()
        self.assertAlmostEqual(tomllib.loads(overlay)["fluid"]["velocity_scale"], 0.084)

    def test_nothing_built_is_said(self):
        self.tool("new", "sand")
        said = subprocess.run([ROOT / "tools" / "run", "sand", "--no-build"], cwd=self.folder, capture_output=True, text=True,
                              timeout=30, env={**os.environ, "BPLBM_PRESET": "nothing"}, check=False)
        self.assertEqual(said.returncode, 2)
        self.assertIn("leave --no-build out, or run tools/build", said.stderr)


if __name__ == "__main__":
    unittest.main()
