"""tools/run judges results and maps exit codes; no program is started."""

import contextlib
import io
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import command, mpi_job, output_folder, placement, result, run, solid_alone, told_once  # noqa: E402
from bplbm.options import arguments, scene_files  # noqa: E402
from bplbm.scenes import Scene, find, scenes  # noqa: E402


class Result(unittest.TestCase):
    def test_inside_and_outside(self):
        self.assertTrue(result("a", 1.02, "1", 1.0, "here", 0.03)["pass"])
        self.assertFalse(result("a", 1.04, "1", 1.0, "here", 0.03)["pass"])
        self.assertFalse(result("a", float("nan"), "1", 1.0, "here", 0.03)["pass"])

    def test_scale_replaces_a_reference_of_zero(self):
        r = result("a", 0.5, "m/s", 0.0, "here", 0.1, scale=10.0)
        self.assertAlmostEqual(r["error"], 0.05)
        self.assertTrue(r["pass"])


class ToldOnce(unittest.TestCase):
    RULE = 74 * "-" + "\n"
    ABORT = RULE + "MPI_ABORT was invoked on rank 0\nwith errorcode 2.\n" + RULE

    def shown(self, text):
        seen = []
        screen = told_once.ToldOnce(seen.append)
        for line in text.splitlines(keepends=True):
            screen.line(line)
        screen.end()
        return "".join(seen)

    def test_an_error_of_both_programs_is_seen_once_and_mpirun_adds_nothing(self):
        fault = "lbm | error | too fast\n"
        self.assertEqual(self.shown(fault + "liggghts | error | the fluid program stopped: too fast\n" + self.ABORT),
                         fault + "liggghts | error | the fluid program stopped as lbm says\n")
        refusal = "they disagree:\n  - step\n  - box\n"
        self.assertEqual(self.shown(f"liggghts | error | {refusal}lbm | error | {refusal}run | logs\n  - other\n"),
                         f"liggghts | error | {refusal}lbm | error | as liggghts says\nrun | logs\n  - other\n")

    def test_nothing_else_is_kept_back(self):
        for text in (self.ABORT, "lbm | error | a\n" + self.RULE + "no slots\n" + self.RULE, self.RULE, "lbm | error | a\n" + self.RULE + "b\n",
                     self.RULE + 40 * "a table\n", "lbm | error | a\nlbm | error | a\n", "lbm | error | a\nliggghts | error | b\n  - c\n"):
            self.assertEqual(self.shown(text), text)

    def test_the_reason_is_what_was_said_first_with_its_list(self):
        text = "liggghts | error | they disagree:\n  - step\n  - box\nlbm | error | as liggghts says\nrun | stopped\n"
        self.assertEqual(mpi_job.reason_of(text), "they disagree: step; box")
        self.assertEqual(mpi_job.reason_of("liggghts | error | lost\nlbm | error | the solid program stopped as liggghts says\n"), "lost")


class Launch(unittest.TestCase):
    def run_main(self, *arguments, job_code=0, value=1.0):
        """Exit code and output of tools/run with jobs that are only pretended. job_code: of each, or of one after another."""
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)

            def job(args, place):
                place.mkdir(parents=True, exist_ok=True)
                (out / "summary.json").write_text(json.dumps(
                    {"results": [result("number", value, "1", 1.0, "test", 0.03)]}))
                return job_code if isinstance(job_code, int) else next(job_code)

            text = io.StringIO()
            with mock.patch.object(run, "run_job", job), mock.patch.object(run, "draw"), \
                    mock.patch.object(sys, "argv", ["run", *arguments, "--out", folder]), \
                    contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
                try:
                    return run.main(), text.getvalue()
                except SystemExit as end:
                    return end.code, text.getvalue()

    def test_a_result_inside_its_tolerance_is_0(self):
        self.assertEqual(self.run_main("settling_disc", "--no-study")[0], 0)

    def test_a_result_outside_its_tolerance_is_4(self):
        code, text = self.run_main("settling_disc", "--no-study", value=1.2)
        self.assertEqual(code, 4)
        self.assertIn("MISS", text)

    def test_a_run_cut_short_is_not_judged(self):
        with mock.patch.object(run.early_end, "early_end", lambda *_: "ended at 0.1 of 2 s"):
            code, text = self.run_main("settling_disc", "--no-study", value=1.2)
        self.assertEqual(code, 0)
        self.assertIn("run | not judged | number = 1.2: ended at 0.1 of 2 s\n", text)
        self.assertNotIn("MISS", text)

    def test_results_and_quantities_are_printed_with_their_units_and_without_colour_in_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            out, text = pathlib.Path(folder), io.StringIO()
            (out / "summary.json").write_text(json.dumps({
                "results": [result("drag", 1.01, "1", 1.0, "test", 0.03), result("speed", 2.0, "m/s", 1.0, "test", 0.03)],
                "quantities": [{"name": "grains gone", "value": 3.0, "unit": "1"}]}))
            with contextlib.redirect_stdout(text):
                self.assertFalse(run.judge(out))
        self.assertEqual(text.getvalue(), "run | pass | drag = 1.01, reference 1 (test), error +1.00 %, tolerance 3 %\n"
                         "run | MISS | speed = 2 m/s, reference 1 m/s (test), error +100.00 %, tolerance 3 %\n"
                         "run | told | grains gone = 3\n")

    def test_a_terminal_has_colour_unless_it_wants_none(self):
        for environment, expected in (({"TERM": "xterm"}, "\033[32mpass\033[0m"), ({"TERM": "xterm", "NO_COLOR": "1"}, "pass"),
                                      ({"TERM": "dumb"}, "pass")):
            with mock.patch.object(sys.stdout, "isatty", lambda: True, create=True), \
                    mock.patch.dict("os.environ", environment, clear=True):
                self.assertEqual(run.colored("pass", 32), expected)

    def test_pictures_are_there_before_the_comparison_runs(self):
        """A plot.py that fails is reported at the end, when it is run again: the comparison runs are made all the same."""
        follow, hint = "comparison runs? follow", "--no-study leaves"
        for words, code, seen in ((["settling_disc"], 0, ["page", "| picture", "3 comparison runs follow", hint, "compared"]),
                                  (["settling_disc", "--no-page"], 0, ["| picture", "3 comparison runs follow", hint, "compared"]),
                                  (["settling_disc"], 1, ["3 comparison runs follow", hint, "compared"]),
                                  (["bonded_compression"], 0, ["| picture", "35 comparison runs follow", hint, "compared"]),
                                  (["disc_migration", "--start", "all"], 0, ["page", "| picture", "4 comparison runs follow", "compared"])):
            def plot(scene, out, code=code, **_):
                (out / "field.png").touch()
                return subprocess.CompletedProcess([], code)

            with mock.patch.object(run, "plot", plot), mock.patch.object(run, "make_page", lambda *_: print("page")), \
                    mock.patch.object(run, "study", lambda *_: print("compared")):
                ended, text = self.run_main(*words)
            self.assertEqual(ended, 0)
            before = text[:text.index("compared") + len("compared")]
            self.assertEqual(re.findall(rf"page|\| picture|\d+ {follow}|{hint}|compared", before), seen)

    def test_a_comparison_run_that_fails_leaves_the_page_of_the_main_run(self):
        codes, pages = iter((0, 3)), []
        with mock.patch.object(run, "plot", lambda *_, **__: subprocess.CompletedProcess([], 0)), \
                mock.patch.object(run, "make_page", lambda *about: pages.append(about[2:])):
            code, text = self.run_main("settling_disc", job_code=codes)
        self.assertEqual((code, pages), (3, [()]))
        self.assertIn("the comparison run --variant d10 stopped with exit code 3; its logs are in ", text)

    def test_the_codes_of_the_programs_pass_through(self):
        for job_code in (1, 2, 3):
            self.assertEqual(self.run_main("settling_disc", "--no-study", job_code=job_code)[0], job_code)

    def test_unknown_names_are_listed(self):
        for words, expected in ((["nothing"], "settling_disc"),
                                (["settling_disc", "--set", "nothing"], "resolved, fine"),
                                (["settling_disc", "--variant", "nothing"], "d10, glowinski2, no_inner_inertia")):
            code, text = self.run_main(*words)
            self.assertEqual(code, 2)
            self.assertIn(expected, text)

    def test_own_choices_become_overlays(self):
        args = arguments(["disc_migration", "--start", "6", "--initial", "rest"])
        self.assertEqual([pathlib.Path(f).name for f in scene_files(args)],
                         ["scene.toml", "start-6.toml", "initial-rest.toml"])
        for words, expected in ((["--start", "4"], "5, 6, 7, 8, 9, all"), (["--end", "4"], "knows no '--end'")):
            code, text = self.run_main("disc_migration", *words)
            self.assertEqual(code, 2)
            self.assertIn(expected, text)

    def test_all_values_of_a_choice_are_the_run_and_its_comparisons(self):
        args = arguments(["disc_migration", "--start", "all"])
        self.assertEqual(run.comparison_runs(args), [["--start", v] for v in "6789"])
        self.assertEqual(args.own, [("start", "5")])

    def test_several_choices_with_all_are_all_combinations(self):
        args = arguments(["disc_migration", "--start", "all", "--initial", "all", "--set", "fine"])
        runs = run.comparison_runs(args)
        self.assertEqual(args.own, [("start", "5"), ("initial", "developed")])
        self.assertEqual((len(runs), runs[0], runs[-1]), (9, ["--start", "5", "--initial", "rest"], ["--start", "9", "--initial", "rest"]))
        for path in scene_files(args):
            self.assertTrue(pathlib.Path(path).is_file(), path)

    def test_what_a_comparison_does_not_vary_is_as_in_the_main_run(self):
        args, made = arguments(["disc_migration", "--start", "all", "--initial", "rest", "--set", "fine"]), []
        runs = run.comparison_runs(args)
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(run, "take_folder"), \
                mock.patch.object(run, "run_job", lambda args, out: made.append((args, out.name))):
            run.study(args, runs, pathlib.Path(folder))
        self.assertEqual([name for _, name in made], ["start-6", "start-7", "start-8", "start-9"])
        self.assertEqual([pathlib.Path(f).name for f in scene_files(made[0][0])],
                         ["scene.toml", "fine.toml", "start-6.toml", "initial-rest.toml"])

    def test_a_choice_given_twice_or_all_of_one_where_one_counts_is_refused(self):
        self.assertIn("--start is given twice", self.run_main("disc_migration", "--start", "5", "--start", "6")[1])
        text = io.StringIO()
        with contextlib.redirect_stderr(text), self.assertRaises(SystemExit) as end:
            command.check(["disc_migration", "--start", "all"])
        self.assertEqual(end.exception.code, 2)
        self.assertIn("--start all: bplbm check takes one value of it: 5, 6, 7, 8, 9", text.getvalue())

    def test_one_scene_is_listed_by_its_path(self):
        code, text = self.run_main(str(ROOT / "cases" / "disc_migration"), "--list")
        self.assertEqual((code, text.count("\n"), text[:14]), (0, 2, "disc_migration"))
        self.assertIn("no scene 'nope'", self.run_main("nope", "--list")[1])

    def test_check_knows_what_run_would_refuse(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = Scene(pathlib.Path(folder))
            for table, script, words in (("[coupling]", True, None), ("", False, None), ("", True, "has no [coupling], but its folder has"),
                                         ("[coupling]", False, "has [coupling], but its folder has no in.liggghts"), ("[", True, None)):
                scene.file.write_text(table)
                scene.script("liggghts").touch() if script else scene.script("liggghts").unlink(missing_ok=True)
                note = command.note_on_partner(scene, [scene.file])
                self.assertIn(words, note) if words else self.assertIsNone(note)
        for name in scenes():
            if not find(name).is_solid_alone:
                self.assertIsNone(command.note_on_partner(find(name), [find(name).file]), name)

    def test_the_command_names_both_programs_by_absolute_path(self):
        args = mock.Mock(scene=find("settling_disc"), overlay=[], set="fine", variant="d10", own=[], engine="liggghts", engine_command=None,
                         threads=2, until=None, record=None, restart=False, accept=[], fluid_ranks=1, solid_ranks=3)
        line = run.command(args, pathlib.Path("/somewhere"))
        split = line.index(":")
        self.assertTrue(line[line.index("1") + 1].endswith("/bin/lbm"))
        self.assertTrue(line[split + 3].startswith("/") and line[split + 3].endswith("/bin/liggghts"))
        self.assertEqual(line[split + 2], "3")
        self.assertTrue(any(word.endswith("fine.toml") for word in line))

    def solid(self, *words):
        args = arguments(["settling_disc", *words])
        return run.solid_command(args, pathlib.Path("/somewhere"))

    def test_each_engine_and_any_command_can_be_the_solid(self):
        self.assertTrue(self.solid()[0].endswith("/bin/liggghts"))
        self.assertTrue(self.solid("--engine", "lammps")[0].endswith("/bin/lammps_engine"))
        for name in ("reference", "c", "fortran"):
            self.assertTrue(self.solid("--engine", name)[0].endswith(f"/bin/{name}_engine"))
        for name in ("yade", "python"):
            self.assertTrue(self.solid("--engine", name)[1].endswith(f"/engines/{name}/engine.py"))
        self.assertEqual(self.solid("--engine-command", "python3 'my engine.py' {folder}/in.{x} {out}/log"),
                         ["python3", "my engine.py", f"{ROOT}/cases/settling_disc/in.{{x}}", "/somewhere/log"])

    def test_a_command_that_cannot_be_started_says_why(self):
        for words, said in ((["--engine-command", "python3 'a"], "No closing quotation"), (["--engine-command", ""], "no program"),
                            (["--engine-command", "no_such_engine"], "no program 'no_such_engine'"),
                            (["--engine-command", "true", "--engine", "yade"], "give one of them")):
            code, text = self.run_main("settling_disc", *words)
            self.assertEqual(code, 2)
            self.assertIn(said, text)


class Cores(unittest.TestCase):
    """Which cores a job's processes get."""

    def place(self, wanted, there=(0, 2, 4, 6), folder="", **more):
        with mock.patch.object(placement, "cores", lambda: list(there)):
            return placement.Placement(wanted, folder=folder, **more)

    def test_each_process_has_its_own(self):
        with tempfile.TemporaryDirectory() as folder:
            place = self.place([("fluid", 2), ("solid", 1)], folder=folder)
            self.assertEqual(place.cores, [[0, 2], [4]])
            self.assertEqual(place.describe(), "fluid on 0,2, solid on 4")
            line = place.bound(["mpirun", *placement.UNBOUND, "-np", "1", "lbm"])
            self.assertEqual(line[-3:], ["-np", "1", "lbm"])
            self.assertEqual(pathlib.Path(line[line.index("--rankfile") + 1]).read_text(),
                             "rank 0=localhost slot=0,2\nrank 1=localhost slot=4\n")
            place.release()

    def test_a_second_job_takes_others_and_a_third_none(self):
        with tempfile.TemporaryDirectory() as folder:
            first, second = (self.place([("fluid", 1), ("solid", 1)], folder=folder) for _ in range(2))
            self.assertEqual((first.cores, second.cores), ([[0], [2]], [[4], [6]]))
            third = self.place([("fluid", 1)], folder=folder)
            self.assertEqual(third.cores, [])
            self.assertIn("other jobs hold the cores", third.describe())
            first.release()
            again = self.place([("fluid", 1)], folder=folder)
            self.assertEqual(again.cores, [[0]])
            for place in (second, again):
                place.release()

    def test_too_few_cores_or_the_users_wish_leave_the_line_as_it_is(self):
        line = ["mpirun", *placement.UNBOUND, "-np", "1", "lbm"]
        for place, why in ((self.place([("fluid", 4), ("solid", 1)]), "5 busy threads on 4 cores"),
                           (placement.of_job(1, 1, 1, no_bind=True), "--no-bind")):
            self.assertEqual(place.bound(line), line)
            self.assertIn(why, place.describe())
        with mock.patch.dict("os.environ", {"SLURM_JOB_ID": "7"}):
            self.assertIn("batch", placement.of_job(1, 1, 1).describe())

    def test_numbers_as_mpirun_reads_them(self):
        self.assertEqual(placement.runs([0, 1, 2, 5, 7, 8]), "0-2,5,7-8")
        self.assertEqual(placement.runs([3]), "3")

    def test_of_two_hardware_threads_of_a_core_one_counts(self):
        with tempfile.TemporaryDirectory() as folder:
            for cpu in range(4):
                place = pathlib.Path(folder, f"cpu{cpu}/topology")
                place.mkdir(parents=True)
                (place / "thread_siblings_list").write_text(f"{cpu % 2},{cpu % 2 + 2}\n")
            with mock.patch.object(placement, "TOPOLOGY", pathlib.Path(folder)), \
                    mock.patch("os.sched_getaffinity", lambda _: {1, 2, 3}):
                self.assertEqual(placement.cores(), [1, 2])

    def test_only_processes_that_share_cores_wait_politely(self):
        self.assertNotIn("OMPI_MCA_mpi_yield_when_idle", mpi_job.environment(shared=False))
        self.assertEqual(mpi_job.environment(shared=True)["OMPI_MCA_mpi_yield_when_idle"], "1")

    @unittest.skipIf(shutil.which("mpirun") is None or len(placement.cores()) < 2, "needs mpirun and two cores")
    def test_mpirun_binds_both_programs(self):
        with tempfile.TemporaryDirectory() as folder:
            place = placement.Placement([("fluid", 1), ("solid", 1)], folder=folder)
            show = ["-np", "1", "/usr/bin/python3", "-c", "import os; print(sorted(os.sched_getaffinity(0)))"]
            job = subprocess.run(place.bound(["mpirun", *placement.UNBOUND, *show, ":", *show]), capture_output=True, text=True,
                                 env=mpi_job.environment(shared=False), check=False, timeout=60)
            told = re.findall(r"\[[^\]]*\]", job.stdout)  # mpirun may part a line from its end
            self.assertEqual(sorted(told), sorted(f"[{c[0]}]" for c in place.cores), job.stderr)
            place.release()


class SolidAlone(unittest.TestCase):
    """A scene without a fluid."""

    run_main = Launch.run_main

    SCENE = {"box": {"size": [0.1, 0.2]}, "run": {"time_step": 1e-6, "end_time": 1e-3},
             "particles": {"diameter": [0.001, 0.002], "density": 2000.0, "contact_stiffness": 1e7,
                           "variables": {"speed": 0.5, "law": "bond/contact", "pulled": True}}}

    def changed(self, **tables):
        return solid_alone.merged(self.SCENE, tables)

    def test_only_a_scene_without_a_fluid_is_one(self):
        alone = {name for name in scenes() if find(name).is_solid_alone}
        self.assertEqual(alone, {"bonded_compression"})

    def test_the_script_gets_what_the_fluid_offers_to_others(self):
        found = solid_alone.variables(self.SCENE)
        for name, text in {"x_hi": "0.1", "y_hi": "0.2", "boundary_z": "p", "diameter_min": "0.001", "solid_step": "1e-06",
                           "solid_steps_total": "1000", "law": "bond/contact", "pulled": "1"}.items():
            self.assertEqual(found[name], text)
        self.assertEqual(solid_alone.variables(self.SCENE, until=2e-6)["solid_steps_total"], "2")

    def test_the_command_is_one_program_with_its_variables(self):
        line = solid_alone.command("/bin/liggghts", "/case/in.liggghts", pathlib.Path("/out"), {"speed": "0.5"}, 2)
        self.assertNotIn(":", line)
        self.assertEqual(line[line.index("-np") + 1], "2")
        self.assertEqual(line[-3:], ["-var", "speed", "0.5"])

    def test_mistakes_say_what_and_where(self):
        for tables, expected in (({"run": {"time_step": 0.0}}, "run.time_step = 0.0: must be a positive number"),
                                 ({"fluids": {}}, "knows no [fluids]"),
                                 ({"box": {"length": 1.0}}, "knows no box.length; [box] has: size"),
                                 ({"box": {"size": 1.0}}, "must be two or three lengths"),
                                 ({"particles": {"density": float("nan")}}, "particles.density = nan"),
                                 ({"particles": {"variables": {"x_lo": 1}}}, "gives this variable already"),
                                 ({"particles": {"variables": {"scene_folder": "x"}}}, "gives this variable already"),
                                 ({"particles": {"variables": {"a": [1]}}}, "a number or one word"),
                                 ({"particles": {"variables": {"a": 'x" && "1'}}}, "a number or one word"),
                                 ({"particles": {"variables": {"a": "../../tmp/evil"}}}, "no path out of")):
            with self.assertRaises(solid_alone.Mistake) as caught:
                solid_alone.variables(self.changed(**tables))
            self.assertIn(expected, str(caught.exception))
        with self.assertRaises(solid_alone.Mistake) as caught:
            solid_alone.variables({key: value for key, value in self.SCENE.items() if key != "run"})
        self.assertIn("lacks run.", str(caught.exception))

    def test_options_of_the_fluid_are_refused(self):
        for words in (["--fluid-ranks", "2"], ["--threads", "2"], ["--record", "a.h5"], ["--engine", "python"],
                      ["--engine-command", "true"],
                      ["--restart"]):
            code, text = self.run_main("bonded_compression", *words)
            self.assertEqual(code, 2)
            self.assertIn(f"leave {words[0]} out", text)

    def test_force_replaces_the_files_of_a_run_and_no_others(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)
            output_folder.mark(out, "scene")
            for name in ("summary.json", "breaks.csv", "curves.png", "thesis.txt"):
                (out / name).write_text("x")
            output_folder.add_files(out, ["curves.png", "../thesis.txt"])
            output_folder.remove_run(out)
            self.assertEqual({p.name for p in out.iterdir()}, {output_folder.MARK, "thesis.txt"})


if __name__ == "__main__":
    unittest.main()
