"""An installed tree works from any folder with its one command, wherever it lies, and is never written to."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm.project import BIN  # noqa: E402

BUILD = BIN.parent


def files(folder):
    """Name -> (size, time of change) of all files below a folder."""
    return {p: (p.stat().st_size, p.stat().st_mtime_ns) for p in folder.rglob("*") if p.is_file()}


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.kept.cleanup)
        first = pathlib.Path(cls.kept.name) / "first"
        subprocess.run(["cmake", "--install", BUILD, "--prefix", first], check=True, stdout=subprocess.DEVNULL, timeout=60)
        cls.prefix = first.rename(first.with_name("moved"))  # it may be moved as a whole
        cls.before = files(cls.prefix)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()

    def bplbm(self, *words, timeout=60):
        environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "BPLBM_PRESET")}
        return subprocess.run([self.prefix / "bin" / "bplbm", *words], cwd=self.folder, env=environment, text=True,
                              capture_output=True, timeout=timeout, check=False)

    def succeeds(self, *words):
        said = self.bplbm(*words)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        return said.stdout

    def test_a_shipped_scene_runs_into_the_current_folder(self):
        said = self.succeeds("run", "settling_disc", "--no-study", "--until", "0.6")
        self.assertIn("pass | Re_max at D/Δx = 20", said)
        out = self.folder / "out" / "settling_disc"
        self.assertAlmostEqual(json.loads((out / "summary.json").read_text())["physical_seconds"], 0.6, 3)
        self.assertIn("bplbm run settling_disc", (out / "index.html").read_text())
        self.assertTrue((out / "field.png").exists())
        self.assertEqual(files(self.prefix), self.before)

    def test_a_new_scene_is_made_checked_run_swept_and_compared(self):
        self.assertIn("bplbm run sand", self.succeeds("new", "sand"))
        self.assertIn("grid         80 × 240 cells", self.succeeds("check", "sand"))
        self.succeeds("run", "sand", "--variant", "short")
        self.succeeds("sweep", "sand", "--set", "particles.density=1100,1250", "--variant", "short")
        self.assertIn("| fluid steps | 480 | 480 (+0.0 %) |", self.succeeds("compare", "out/sand-short", "out/sand-short"))
        self.assertTrue((self.folder / "out" / "sand-short-sweep" / "index.html").exists())
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["out", "sand"])
        self.assertEqual(files(self.prefix), self.before)

    def test_a_folder_here_comes_before_a_shipped_scene_of_its_name(self):
        self.succeeds("new", "sand")
        (self.folder / "sand").rename(self.folder / "settling_disc")
        self.assertIn("grid         80 × 240 cells", self.succeeds("check", "settling_disc"))

    def test_every_command_answers_help(self):
        for name in ("new", "run", "sweep", "compare", "draw_setup", "make_packing", "report", "check", "trace", "replay"):
            with self.subTest(name):
                said = self.succeeds(name, "--help")
                self.assertNotIn("tools/", said)
        self.assertIn(str(self.prefix / "share" / "bplbm" / "cases"), self.succeeds("where"))

    def test_mistakes_end_with_2(self):
        for words, expected in ((("fly",), "there is no command 'fly'; there are: new, run"),
                                (("run", "nowhere"), "no scene 'nowhere'"),
                                (("run", "settling_disc", "--engine", "lammps"), "is not part of the package")):
            said = self.bplbm(*words)
            self.assertEqual(said.returncode, 2, said.stdout)
            self.assertIn(expected, said.stderr)

    def test_a_processor_that_lacks_what_the_programs_need_is_refused(self):
        needed = self.prefix / "lib" / "bplbm" / "cpu_features"
        kept = needed.read_text()
        needed.write_text(kept + "tomorrow42\n")
        try:
            said = self.bplbm("run", "settling_disc")
        finally:
            needed.write_text(kept)
            type(self).before = files(self.prefix)
        self.assertEqual(said.returncode, 2)
        self.assertIn("compiled for a processor with tomorrow42, which this machine lacks", said.stderr)


if __name__ == "__main__":
    unittest.main()
