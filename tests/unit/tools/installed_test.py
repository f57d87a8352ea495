"""An installed tree works from any folder with its one command, wherever it lies, and is never written to."""

import json
import re
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm.checks import documents  # noqa: E402
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

    def environment(self):
        """Without what would lead to this checkout, and with the installed command first."""
        kept = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "BPLBM_PRESET")}
        return {**kept, "PATH": f"{self.prefix / 'bin'}:{kept['PATH']}"}

    def bplbm(self, *words, timeout=60):
        return subprocess.run([self.prefix / "bin" / "bplbm", *words], cwd=self.folder, env=self.environment(), text=True,
                              capture_output=True, timeout=timeout, check=False)

    def succeeds(self, *words):
        said = self.bplbm(*words)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        return said.stdout

    def test_a_shipped_scene_runs_into_the_current_folder(self):
        said = self.succeeds("run", "settling_disc", "--no-study", "--until", "0.6", "--judge")
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

    def test_links_of_all_documents_hold(self):
        found = sorted(self.prefix.rglob("*.md"))
        self.assertGreater(len(found), 100)
        with unittest.mock.patch.object(documents, "ROOT", self.prefix):
            self.assertEqual([said for path in found for said in documents.broken_links(path, path.read_text())], [])

    def test_the_tutorial_can_be_typed(self):
        """Its commands in the words that it gives for an installed tree; the run is cut short, and what follows is left out."""
        text = (self.prefix / "share" / "bplbm" / "cases" / "TUTORIAL.md").read_text()
        first = re.search(r"`(mkdir cases [^`]*)`", text)[1]
        typed = "\n".join(re.findall(r"^```sh\n(.*?)^```$", text, re.M | re.S)[1:])
        typed = typed[:typed.index("tools/run cases/stream\n")] + "tools/run cases/stream --until 0.002\n"
        typed = typed.replace("build/release/bin/lbm check", "bplbm check").replace("tools/", "bplbm ")
        done = subprocess.run(["bash", "-e", "-c", f"{first}\n{typed}"], cwd=self.folder, env=self.environment(), text=True,
                              capture_output=True, timeout=100, check=False)
        self.assertIn(" grains at the start = 60", done.stdout, done.stdout + done.stderr)
        self.assertTrue((self.folder / "out" / "stream" / "stream.png").exists())
        self.assertIn("the one here is named by its path, cases/stream", self.bplbm("run", "stream").stderr)
        (self.folder / "cases" / "common").rename(self.folder / "elsewhere")
        self.assertIn("Cannot open input script", self.bplbm("run", "cases/stream", "--until", "0.002", "--no-page").stderr)

    def test_keys_variables_and_places_are_printed(self):
        self.assertIn("| `numerics.cell` |", self.succeeds("keys"))
        part = self.succeeds("keys", "viscosity.m")
        self.assertIn("| `fluid.viscosity.model` |", part)
        self.assertNotIn("numerics.cell", part)
        self.succeeds("new", "sand")
        self.assertIn("-var solid_step", self.succeeds("check", "sand", "--liggghts-vars"))
        for file in ("sand/scene.toml", "sand/in.liggghts", "sand/README.md"):  # what they name is there
            text = (self.folder / file).read_text()
            self.assertIsNone(re.search(r"tools/|lbm check|`lbm_", text.replace("bplbm check", "")), text)
            for path in re.findall(r"/\S+\.md", text):
                self.assertTrue(pathlib.Path(path).is_file(), path)
        self.assertEqual(self.succeeds("where", "common"), f"{self.prefix}/share/bplbm/cases/common\n")
        self.assertIn("where: one of programs", self.bplbm("where", "nowhere").stderr)

    def test_tab_completes_commands_scenes_and_options(self):
        file = self.prefix / "share" / "bash-completion" / "completions" / "bplbm"
        for words, expected in ((("m",), {"make_packing", "make_clump"}), (("run", "settling_d"), {"settling_disc"}),
                                (("sweep", "--ret"), {"--retry"}), (("make_packing", "--frac"), {"--fraction"}),
                                (("where", "co"), {"common"})):
            line = f"source {file}; COMP_WORDS=(bplbm {' '.join(words)}); COMP_CWORD={len(words)}; _bplbm bplbm; echo ${{COMPREPLY[@]}}"
            said = subprocess.run(["bash", "-c", line], cwd=self.folder, env=self.environment(), text=True, capture_output=True,
                                  timeout=30, check=False)
            self.assertEqual(set(said.stdout.split()), expected, said.stderr)

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
