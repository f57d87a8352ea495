"""What tools/new makes is accepted by lbm, and runs from any folder with tools/run --no-build."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
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
            self.assertNotIn("warning", checked.stdout + checked.stderr)

    def test_one_runs_where_it_lies(self):
        self.tool("new", "sand")
        run = self.tool("run", "sand/", "--no-build", "--variant", "short")
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        summary = json.loads((self.folder / "out" / "sand-short" / "summary.json").read_text())
        self.assertAlmostEqual(summary["physical_seconds"], 0.2, 3)

    def test_nothing_built_is_said(self):
        self.tool("new", "sand")
        said = subprocess.run([ROOT / "tools" / "run", "sand", "--no-build"], cwd=self.folder, capture_output=True, text=True,
                              timeout=30, env={**os.environ, "BPLBM_PRESET": "nothing"}, check=False)
        self.assertEqual(said.returncode, 2)
        self.assertIn("leave --no-build out, or run tools/build", said.stderr)


if __name__ == "__main__":
    unittest.main()
