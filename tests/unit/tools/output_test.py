"""The folder of tools/run, and how it ends: nothing of anybody's is lost, and every end is a sentence. No program of
ours is started."""

import contextlib
import fcntl
import io
import json
import pathlib
import runpy
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import compare, output_folder, run, scenes  # noqa: E402
from bplbm.output_folder import Refused  # noqa: E402


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out = self.folder / "out"

    def write(self, name, text="x"):
        path = self.out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def take(self, chosen=True, restart=None, force=False):
        hold, aside = output_folder.take(self.out, "scene", chosen, restart, force)
        hold.file.close()
        return aside

    def refusal(self, **how):
        with self.assertRaises(Refused) as caught:
            self.take(**how)
        return str(caught.exception)


class Folder(InFolder):
    def test_of_somebody_else_is_refused_and_left_alone(self):
        self.write("thesis.txt")
        for force in (False, True):
            self.assertIn("is not empty, and no output folder", self.refusal(force=force))
        self.assertEqual([p.name for p in self.out.iterdir()], ["thesis.txt"])

    def test_a_chosen_folder_with_a_run_is_refused(self):
        self.take()
        self.write("summary.json")
        self.assertIn("--force to replace that run", self.refusal())
        self.assertNotIn("--restart", self.refusal())
        self.write("checkpoint.h5")
        self.assertIn("--restart to go on", self.refusal())
        self.assertIsNone(self.take(force=True))
        self.assertIsNone(self.take(restart="checkpoint"))
        self.assertTrue((self.out / "summary.json").exists())  # lbm replaces it, once the run begins

    def test_the_scenes_own_folder_is_set_aside(self):
        self.assertIsNone(self.take(chosen=False))
        self.assertIsNone(self.take(chosen=False))  # there was no run yet
        for name in ("out.1", "out.2"):
            self.write("summary.json", name)
            self.write("study/set-fine/summary.json", name)
            self.assertEqual(self.take(chosen=False).name, name)
            self.assertEqual((self.folder / name / "study/set-fine/summary.json").read_text(), name)
        self.write("summary.json")
        self.assertIsNone(self.take(chosen=False, force=True))

    def test_an_unmarked_folder_of_the_scene_is_set_aside_whatever_it_holds(self):
        self.write("thesis.txt")
        self.assertEqual(self.take(chosen=False), self.folder / "out.1")
        self.assertTrue((self.folder / "out.1/thesis.txt").exists())

    def test_a_file_or_nothing_to_go_on_from(self):
        self.assertIn("no such folder to go on from", self.refusal(restart="checkpoint"))
        self.out.write_text("x")
        self.assertIn("is no folder", self.refusal())

    def test_one_run_at_a_time(self):
        hold, _ = output_folder.take(self.out, "scene", True, None, False)
        self.write("probes.csv")
        self.assertIn("another tools/run is at work", self.refusal(force=True))
        hold.file.close()
        self.write(".bplbm.lock", "4711 elsewhere\n")
        self.assertIn("process 4711 on host elsewhere", self.refusal(force=True))
        self.assertIn(f"delete {self.out}/.bplbm.lock", self.refusal(force=True))
        self.write(".bplbm.lock", "")
        with open(self.out / ".bplbm.lock") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assertIn("on this host writes into it", self.refusal(force=True))
        self.assertIsNone(self.take(force=True))

    def test_what_a_run_has_drawn_stands_in_the_mark(self):
        self.take()
        before = output_folder.files(self.out)
        self.write("field.png")
        output_folder.add_files(self.out, output_folder.files(self.out) - before)
        self.assertIn("\nfile field.png\n", (self.out / ".bplbm").read_text())


class Command(InFolder):
    def main(self, *words):
        text = io.StringIO()
        with mock.patch.object(sys, "argv", ["run", *words]), contextlib.redirect_stdout(text), \
                contextlib.redirect_stderr(text):
            try:
                return run.main(), text.getvalue()
            except SystemExit as end:
                return end.code, text.getvalue()

    def test_numbers_that_mean_nothing(self):
        for words in (["--until", "nan"], ["--until", "inf"], ["--until", "-1"], ["--until", "0"], ["--threads", "100000"],
                      ["--threads", "0"], ["--fluid-ranks", "0"], ["--solid-ranks", "-1"], ["--force", "--restart"]):
            code, text = self.main("settling_disc", *words, "--look")
            self.assertEqual(code, 2, text)
            self.assertTrue(text.startswith("run | error | ") and text.count("\n") == 1, text)
            self.assertIn(words[0], text)

    def test_a_refused_folder_is_said_before_anything_is_built(self):
        self.write("thesis.txt")
        code, text = self.main("settling_disc", "--out", str(self.out), "--look")
        self.assertEqual(code, 2)
        self.assertIn("give a new or an empty folder", text)

    def test_a_scene_without_a_readme_is_listed(self):
        for name, heading in (("bare", None), ("empty", ""), ("full", "# A full one\n")):
            (self.folder / name).mkdir()
            (self.folder / name / "scene.toml").write_text('title = "the title"\n')
            if heading is not None:
                (self.folder / name / "README.md").write_text(heading)
        (self.folder / "broken").mkdir()
        (self.folder / "broken" / "scene.toml").write_text("[box")
        with mock.patch.object(scenes, "CASES", self.folder):
            code, text = self.main("--list")
        self.assertEqual(code, 0)
        for words in ("bare                 the title (no README.md)", "empty                the title", "full                 A full",
                      "broken               (no README.md)"):
            self.assertIn(words, text)

    def test_a_blank_in_a_folder_that_the_script_names_is_refused(self):
        """Only there: a scene or an output folder that the script does not name may have one."""
        script = "# ${scene_folder}\ninclude ${scene_folder}/more.liggghts\n"
        for name, text, more, out, words in (
                ("a b/s", script, "", "out", "in.liggghts, line 2, names files in it; rename every folder of this path"),
                ("a b/t", "run 1 # ${scene_folder}\n", "", "out", ""), ("u", script, "", "o ut", ""),
                ("v", script, "dump x ${out_folder}/x\n", "o ut", "more.liggghts, line 1, names files in it; give --out a folder")):
            scene = self.folder / name
            scene.mkdir(parents=True)
            (scene / "scene.toml").write_text("[fluid]\n[box]\nsize = [1.0, 1.0]\n")
            (scene / "in.liggghts").write_text(text)
            (scene / "more.liggghts").write_text(more)
            code, said = self.main(str(scene), "--out", str(self.folder / out), "--look")
            self.assertEqual(code, 2 if words else 0, said)
            self.assertIn(words, said)
            if words:
                self.assertIn("has a blank in its name", said)

    def test_columns_of_a_comparison_say_what_they_are(self):
        def run_of(scene, variant, folder):
            return mock.Mock(summary={"scene": scene, "set": "resolved", "variant": variant}, folder=folder)

        for runs, heads in (([run_of("a", "", "o"), run_of("a", "trt", "p")], ["resolved", "resolved trt"]),
                            ([run_of("a", "", "o"), run_of("b", "", "p")], ["a resolved", "b resolved"]),
                            ([run_of("a", "", "out/a"), run_of("a", "", "out/a.1")], ["out/a", "out/a.1"])):
            self.assertEqual(compare.headings(runs), heads)
            self.assertEqual(any("these are runs of different scenes, a, b" in note for note in compare.notes(runs)), heads[0] == "a resolved")
        runs[1].summary["not_judged"] = "ended at 0.1 of 60 s"
        self.assertEqual(compare.notes(runs), ["out/a.1: not judged: ended at 0.1 of 60 s"])

    def test_view_without_paraview_says_how_to_start_it(self):
        with mock.patch.dict(sys.modules, {"paraview": None}), self.assertRaises(SystemExit) as end:
            runpy.run_path(str(ROOT / "lbm_solver" / "io" / "view.py"))
        self.assertIn("this Python has no ParaView; start it as: pvpython view.py", end.exception.code)

    def test_a_folder_that_vanishes_during_the_run(self):
        def vanish(_args, out):
            out.rename(self.folder / "elsewhere")
            return 1

        with mock.patch.object(run, "run_job", vanish), mock.patch.object(run.programs, "check"):
            code, text = self.main("settling_disc", "--out", str(self.out), "--no-study")
        self.assertEqual(code, 1)
        self.assertIn(f"run | error | {self.out} has been moved or deleted", text)
        self.assertNotIn("Traceback", text)

    def test_a_folder_that_vanishes_during_a_comparison_run(self):
        def vanish(_args, out):
            if out == self.out:
                return 0
            self.out.rename(self.folder / "elsewhere")
            return 1

        with mock.patch.object(run, "run_job", vanish), mock.patch.object(run.programs, "check"), \
                mock.patch.object(run, "first_look"):
            code, text = self.main("settling_disc", "--out", str(self.out))
        self.assertEqual(code, 1)
        self.assertIn(f"run | error | {self.out} has been moved or deleted", text)
        self.assertNotIn("The main run is complete", text)

    def test_a_run_that_its_plot_script_cannot_draw(self):
        (self.folder / "scene").mkdir()
        (self.folder / "scene" / "plot.py").write_text("[][0]\n")
        self.write("summary.json", json.dumps({"physical_seconds": 0.01, "results": []}))
        for until, words in ((True, "--until has cut short"), (False, "correct it")):
            text = io.StringIO()
            with contextlib.redirect_stderr(text), self.assertRaises(SystemExit) as end:
                run.draw(scenes.Scene(self.folder / "scene"), self.out, until)
            self.assertEqual(end.exception.code, 1)
            self.assertEqual(text.getvalue().count("\n"), 1)
            self.assertNotIn("Traceback", text.getvalue())
            for word in ("which made 0.01 s: IndexError: list index out of range", words):
                self.assertIn(word, text.getvalue())
        self.assertIn("Traceback", (self.out / "plot.log").read_text())


class Stop(InFolder):
    """A stand-in for mpirun that starts an `lbm`, notes what signals come, and ends as it is told."""

    LBM = """import signal, sys, time
open("/proc/self/comm", "w").write("lbm")
def end(*_): open("told", "a").write("lbm "); sys.exit(1)
if sys.argv[1] == "patient": signal.signal(signal.SIGTERM, end)
else: signal.signal(signal.SIGTERM, signal.SIG_IGN)
open("ready", "w").close()
time.sleep(30)
"""
    MPIRUN = """import signal, subprocess, sys
child = subprocess.Popen([sys.executable, "lbm.py", sys.argv[1]])
def end(*_): open("told", "a").write("mpirun "); child.kill(); sys.exit(1)
signal.signal(signal.SIGTERM, end)
sys.exit(child.wait())
"""

    def start(self, kind):
        (self.folder / "lbm.py").write_text(self.LBM)
        (self.folder / "mpirun.py").write_text(self.MPIRUN)
        code = (f"import sys; sys.path.insert(0, {str(ROOT / 'tools')!r})\nfrom bplbm.mpi_job import MpiJob\nimport os\n"
                f"job = MpiJob([sys.executable, 'mpirun.py', {kind!r}], dict(os.environ))\n"
                "code = job.run()\nprint('ended', code, job.stopped)")
        job = subprocess.Popen([sys.executable, "-c", code], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               text=True)
        self.addCleanup(job.kill)
        self.wait_for("ready")
        return job

    def wait_for(self, name):
        end = time.monotonic() + 15
        while not (self.folder / name).exists():
            self.assertLess(time.monotonic(), end, f"no {name}")
            time.sleep(0.02)

    def test_the_first_tells_the_fluid(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            for name in ("told", "ready"):
                (self.folder / name).unlink(missing_ok=True)
            job = self.start("patient")
            job.send_signal(number)
            text, _ = job.communicate(timeout=60)
            self.assertIn("stopping: the fluid ends its coupling interval", text)
            self.assertIn("ended 1 True", text)
            self.assertNotIn("Traceback", text)
            self.assertEqual((self.folder / "told").read_text(), "lbm ")

    def test_the_second_ends_mpirun(self):
        job = self.start("deaf")
        job.send_signal(signal.SIGINT)
        time.sleep(0.5)
        job.send_signal(signal.SIGINT)
        text, _ = job.communicate(timeout=60)
        self.assertIn("ended 1 True", text)
        self.assertEqual((self.folder / "told").read_text(), "mpirun ")

    def test_a_killed_launcher_leaves_no_job(self):
        job = self.start("patient")
        job.kill()
        job.communicate(timeout=60)
        self.wait_for("told")
        self.assertEqual((self.folder / "told").read_text(), "mpirun ")


if __name__ == "__main__":
    unittest.main()
