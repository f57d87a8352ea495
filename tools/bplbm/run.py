"""Runs a scene of cases/ as a coupled MPI job, draws its pictures and judges its results.

Called by tools/run, which has built the programs before. Exit codes: 0 ok, 1 fault or lost partner,
2 bad input or refusal, 3 numerics, 4 a result outside its tolerance.
"""

import argparse
import itertools
import json
import os
import re
import shlex
import subprocess
import sys
import time

from bplbm import blanks, early_end, output_folder, placement, programs, solid_alone
from bplbm.logs import OWN_HINT, warning_lines
from bplbm.mpi_job import STOPPED, MpiJob, environment
from bplbm.options import arguments, fail, label, list_scenes, out_folder, scene_files
from bplbm.project import BIN, TOOLS, fluid_program, tool
from bplbm.written import error_text, with_unit

OUT_OF_TOLERANCE = 4
FAULT = 1
WITH_SCRIPT = ("liggghts", "lammps")  # engines that read in.NAME in the scene's folder


def command(args, out):
    progress = "line" if sys.stdout.isatty() else "tenths"
    fluid = [str(fluid_program()), *scene_files(args)]
    fluid += ["--out", str(out), "--threads", str(args.threads), "--progress", progress]
    fluid += ["--set", args.set] + (["--variant", label(args)] if label(args) else [])
    fluid += ["--until", repr(args.until)] if args.until is not None else []
    fluid += ["--force"] if args.force else []
    fluid += ["--record", os.path.abspath(args.record)] if args.record else []
    fluid += [f"--restart={args.restart}"] if args.restart else []
    fluid += [word for key in args.accept for word in ("--accept", key)]
    first = ["mpirun", *placement.UNBOUND, "-np", str(args.fluid_ranks), *fluid]
    solid = solid_command(args, out)
    return first + ([":", "-np", str(args.solid_ranks), *solid] if solid else [])


def solid_command(args, out):
    """The program that moves the particles; nothing for a fluid alone."""
    if not args.scene.is_coupled:
        return []
    if args.engine_command:
        places = {"{folder}": str(args.scene.folder), "{out}": str(out)}
        return [re.sub(r"\{folder\}|\{out\}", lambda found: places[found[0]], word) for word in args.engine_command]
    program = programs.engine_program(args.engine)
    if args.engine not in WITH_SCRIPT:
        return ["/usr/bin/python3", str(program)] if program.suffix == ".py" else [str(program)]
    script = args.scene.script(args.engine)
    if not script.exists():
        fail(f"{args.scene.name} has no {script.name}; write one, or leave --engine out")
    common = ["-in", str(script), "-log", str(out / f"{args.engine}.log"), "-screen", "none"]
    return [str(program), *common] + (["-var", "out_folder", str(out)] if args.engine == "liggghts" else [])


def take_folder(args, out, look=False):
    """Makes the folder ready and holds it for as long as what is returned lives; or looks whether that could be done."""
    try:
        if look:
            return output_folder.check(out, bool(args.out), args.restart, args.force)
        hold, aside = output_folder.take(out, args.scene.name, bool(args.out), args.restart, args.force)
    except output_folder.Refused as refusal:
        fail(refusal)
    except OSError as error:
        fail(f"{error.filename or out}: {error.strerror}; choose another --out")
    if aside:
        print(f"run | kept | the earlier run in {out} is now {aside}")
    return hold


def run_alone(args, out):
    """LIGGGHTS alone in a folder of ours. Returns its exit code."""
    try:
        found = solid_alone.variables(solid_alone.read(scene_files(args)), args.until)
    except solid_alone.Mistake as mistake:
        fail(f"{args.scene.name}: {mistake}")
    if args.force:
        output_folder.remove_run(out)
    script, begin = args.scene.script("liggghts"), time.monotonic()
    line = solid_alone.command(BIN / "liggghts", script, out, found, args.solid_ranks)
    code = start(line, placement.of_job(0, 0, args.solid_ranks, args.no_bind), out)
    if code == 0:
        solid_alone.write_summary(out, args.scene.name, args.set, label(args), found, time.monotonic() - begin)
        add_warnings(out)
        for _, line in warning_lines(out):
            print(f"run | warning | liggghts: {line}", file=sys.stderr)
    elif said := solid_alone.error_in(out / "liggghts.log"):
        print(f"run | error | liggghts: {said}", file=sys.stderr)
    return code


def run_job(args, out):
    """The job in a folder of ours. Returns its exit code."""
    if args.scene.is_solid_alone:
        return run_alone(args, out)
    solids = args.solid_ranks if args.scene.is_coupled else 0
    code = start(command(args, out), placement.of_job(args.fluid_ranks, args.threads, solids, args.no_bind), out)
    if code == 0:
        add_solid_waiting(out)
        add_warnings(out)
    return code


def start(line, place, out):
    """Runs an mpirun line to its end, its processes on their cores; where it fails, error.log in the output folder is what
    it said. Returns its exit code."""
    env = environment(shared=not place.cores)
    print(f"run | cores | {place.describe()}")
    added = " ".join(f"{k}={v}" for k, v in env.items() if os.environ.get(k) != v)
    print(f"run | {added + ' ' if added else ''}{shlex.join(line)}", flush=True)
    job = MpiJob(place.bound(line), env)
    try:
        code = job.run()
    finally:
        place.release()
    log = out / "error.log"
    if code and out.is_dir():
        log.write_text("".join(job.said))
    else:
        log.unlink(missing_ok=True)
    if job.stopped:
        print("run | stopped: the job was told to end", file=sys.stderr)
        return STOPPED
    return code if code in (0, 1, 2, 3) else FAULT


def add_solid_waiting(out):
    """Adds the seconds that LIGGGHTS waited for the fluid, from its log, to summary.json beside the fluid's."""
    log = out / "liggghts.log"
    found = re.search(r"fix lbm/couple: \d+ intervals, (\S+) s of waiting", log.read_text()) if log.exists() else None
    if not found:
        return
    path = out / "summary.json"
    summary = json.loads(path.read_text())
    summary["solid_waiting"] = float(found.group(1))
    summary["units"]["solid_waiting"] = "s"
    hint = hint_of_waiting(summary["waiting"], summary["solid_waiting"], summary["wall_seconds"])
    if hint:
        summary["hint"] = hint
    path.write_text(json.dumps(summary, indent=2, ensure_ascii=False) + "\n")
    print(f"run | waiting: the fluid {summary['waiting']:.3g} s for the solid, the solid {summary['solid_waiting']:.3g} s for "
          f"the fluid, of {summary['wall_seconds']:.3g} s")
    if hint:
        own = "; the fluid's own hint above does not know of that" if own_hint(out) else ""
        print(f"run | hint | {hint}{own}")


def own_hint(out):
    """Whether the fluid has advised on its waiting, of which it knows its own only."""
    log = out / "lbm.log"
    return log.is_file() and re.search(OWN_HINT, log.read_text(errors="replace")) is not None


def hint_of_waiting(fluid, solid, wall):
    """What a job suffered in which both programs waited at the same time. In turns they wait for `wall` seconds in sum;
    what is above that nobody computed in. Returns a sentence, or None where that is less than a third, or 2 s."""
    idle = fluid + solid - wall
    if idle < max(wall / 3, 2.0):
        return None
    return (f"for {100 * idle / wall:.0f} % of the time each program waited for the other one: other work has their cores (load "
            f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} cores); the same job takes a part of that on free ones")


def add_warnings(out):
    """Adds to summary.json what the logs warn of."""
    path = out / "summary.json"
    summary = json.loads(path.read_text())
    summary["warnings"] = [f"{log}: {line}" for log, line in warning_lines(out)]
    path.write_text(json.dumps(summary, indent=2, ensure_ascii=False) + "\n")


def plot(scene, out, **streams):
    """Runs the scene's plot.py, which draws and judges. Returns what subprocess.run does, or None where the scene has no
    plot.py."""
    script = scene.folder / "plot.py"
    if not script.exists():
        return None
    env = dict(os.environ, PYTHONPATH=str(TOOLS), MPLBACKEND="Agg")
    return subprocess.run(["/usr/bin/python3", str(script), str(out)], env=env, check=False, stderr=subprocess.PIPE,
                          text=True, errors="replace", **streams)


def draw(scene, out, until):
    job = plot(scene, out)
    if job is None:
        return
    if job.returncode == 0:
        sys.stderr.write(job.stderr)
        return
    (out / "plot.log").write_text(job.stderr)
    lines = job.stderr.strip().splitlines() or [f"it ended with code {job.returncode}"]
    made = json.loads((out / "summary.json").read_text())["physical_seconds"]
    fail(f"{scene.folder / 'plot.py'} cannot judge and draw this run, which made {made:.6g} s: {lines[-1]}; "
         f"{'a run that --until has cut short may lack what it needs: leave --until out' if until else 'correct it'} "
         f"(its whole message is in {out / 'plot.log'}; the run's numbers are complete)", FAULT)


def first_look(args, out):
    """Pictures and page of the main run before its comparison runs, which may take long. They are drawn again after these.
    An error of plot.py is reported then. Nothing is drawn where comparison runs of an earlier call are still there."""
    if (out / "study").exists():
        return
    job = plot(args.scene, out, stdout=subprocess.DEVNULL)
    if job is None or job.returncode:
        return
    mark_early_end(args, out)
    if wants_page(args):
        make_page(args, out)
    for picture in sorted(out.glob("*.png")):
        print(f"run | picture {picture}")


def announce(args, others):
    """Says how many comparison runs follow. Those that the user has asked for by a choice are not left out."""
    asked_for = any(value == "all" for _, value in arguments(args.words).own)
    print(f"run | {len(others)} comparison run{'s follow' if len(others) > 1 else ' follows'}, then the results and all pictures"
          f"{'' if asked_for else '; --no-study leaves comparison runs out'}", flush=True)


def mark_early_end(args, out):
    if not args.judge:
        early_end.mark(out, scene_files(args))


def wants_page(args):
    return not args.no_page and not args.scene.is_solid_alone


def make_page(args, out, failed=0):
    """index.html of the run, or of one that failed with an exit code; without one says why, for the run is what it is."""
    try:
        about = out, args.scene, scene_files(args), args.words, command(args, out)
        if failed:
            from bplbm.page.failed import write_failed_page
            print(f"run | page {write_failed_page(*about, failed)}", file=sys.stderr)
            return
        from bplbm.page.run import write_page
        print(f"run | page {write_page(*about)}")
    except Exception as error:  # noqa: BLE001
        print(f"run | warning | no page was made: {type(error).__name__}: {error}; the run's numbers are complete",
              file=sys.stderr)


def colored(word, color):
    """A word in an ANSI colour on a terminal that has it; plain in a file, or where NO_COLOR is set."""
    plain = not sys.stdout.isatty() or os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return word if plain else f"\033[{color}m{word}\033[0m"


def judge(out):
    """Prints the results and quantities of summary.json. Returns whether all that were judged are within their tolerance."""
    summary = json.loads((out / "summary.json").read_text())
    for r in summary["results"]:
        if "not_judged" in summary:
            print(f"run | not judged | {r['name']} = {with_unit(r['value'], r['unit'])}: {summary['not_judged']}")
            continue
        verdict = colored("pass", 32) if r["pass"] else colored("MISS", "1;31")
        print(f"run | {verdict} | {r['name']} = {with_unit(r['value'], r['unit'])}, reference {with_unit(r['reference'], r['unit'])} "
              f"({r['source']}), error {error_text(r['error'])}, tolerance {100 * r['tolerance']:.2g} %")
    for q in summary.get("quantities", []):
        print(f"run | told | {q['name']} = {with_unit(q['value'], q['unit'])}")
    return "not_judged" in summary or all(r["pass"] for r in summary["results"])


def comparison_runs(args):
    """Options of the runs beside the main one: the other values of a choice that is `all`, of several all combinations, or
    the lines of the scene's study.txt."""
    plan = args.scene.folder / "study.txt"
    if keys := [key for key, value in args.own if value == "all"]:
        first, *others = itertools.product(*(args.scene.options()[key] for key in keys))
        args.own = list({**dict(args.own), **dict(zip(keys, first, strict=True))}.items())
        return [[word for key, value in zip(keys, values, strict=True) for word in ("--" + key, value)] for values in others]
    if args.no_study or args.set != "resolved" or label(args) or args.until is not None or not plan.exists():
        return []
    return [line.split() for line in plan.read_text().splitlines() if line.strip() and not line.startswith("#")]


def study(args, runs, out):
    """Runs them, each in a folder of its own: --variant trt in study/variant-trt. What they do not say is as in the main
    run."""
    for words in runs:
        other = arguments([str(args.scene.folder), *words])
        folder = out / "study" / "-".join(words).removeprefix("--").replace("---", "_")
        restart = args.restart if (folder / f"{args.restart}.h5").exists() else None
        run = argparse.Namespace(**{**vars(args), "set": other.set if "--set" in words else args.set,
                                    "variant": other.variant or args.variant,
                                    "own": list({**dict(args.own), **dict(other.own)}.items()), "record": None, "restart": restart, "force": not restart})
        hold = take_folder(run, folder)
        code = run_job(run, folder)
        del hold
        if code:
            if folder.is_dir():
                print(f"run | error | the comparison run {' '.join(words)} stopped with exit code {code}; its logs are in "
                      f"{folder}. The main run is complete in {out}", file=sys.stderr)
            return code
    return 0


def check_blanks(args, out):
    """Refuses folders with a blank in their name where the script of the solid needs them."""
    scene = args.scene
    if (scene.is_coupled or scene.is_solid_alone) and args.engine in WITH_SCRIPT and not args.engine_command:
        if why := blanks.refusal(scene.script(args.engine), scene.folder, out, args.restart):
            fail(why)


def main():
    args = arguments(sys.argv[1:])
    if args.list:
        list_scenes(args.scene)
        return 0
    if not args.scene:
        fail(f"which scene? {tool('run')} --list shows them")
    out = output_folder.resolved(args.out or out_folder(args))
    check_blanks(args, out)
    if args.look:
        take_folder(args, out, look=True)
        print(*programs.needed(args))
        return 0
    programs.check(args)
    others = comparison_runs(args)
    hold = take_folder(args, out)
    before = output_folder.files(out)
    try:
        return go(args, others, out)
    finally:
        if hold and out.is_dir():  # what has come besides lbm's own, as pictures: a later run may replace it
            output_folder.add_files(out, output_folder.files(out) - before)


def go(args, others, out):
    """The job, its comparison runs, pictures and results. Returns the exit code."""
    code = run_job(args, out)
    if others and not code:
        first_look(args, out)
        announce(args, others)
        code = study(args, others, out)
        if code and out.is_dir():
            return code
    if not out.is_dir():
        print(f"run | error | {out} has been moved or deleted; leave an output folder where it is until its run has ended, and "
              "then make this run again", file=sys.stderr)
        return code or FAULT
    if code:
        print(f"run | stopped with exit code {code}; logs in {out}", file=sys.stderr)
        if code in (1, 3) and (out / "checkpoint.h5").exists():
            print("run | its last checkpoint is complete: the same command with --restart goes on from there",
                  file=sys.stderr)
        if (out / "fault.h5").exists():
            print("run | states of the fault are kept (fault.*): --restart=fault goes on from them if both sides' are",
                  file=sys.stderr)
        if code in (1, 3) and wants_page(args):
            make_page(args, out, code)
        return code
    try:
        draw(args.scene, out, args.until is not None)
        mark_early_end(args, out)
    finally:  # a plot.py that fails leaves the page, which needs none
        if wants_page(args):
            make_page(args, out)
    good = judge(out)
    print(f"run | outputs in {out}")
    for picture in sorted(out.glob("*.png")):
        print(f"run | picture {picture}")
    return 0 if good else OUT_OF_TOLERANCE


def command_line():
    """main() for the thin command. Ends the process."""
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        print("run | stopped: interrupted by Ctrl-C", file=sys.stderr)
        sys.exit(STOPPED)
