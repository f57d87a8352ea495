"""Runs a scene with all combinations of some values, and puts the results into one table and one page.

    tools/sweep settling_disc --set particles.density=1100,1250,1500 --set fluid.kinematic_viscosity=1e-5,2e-5
    tools/sweep erosion --set bond_strength=100,200,400 --set seed=1..5 --jobs 2
    tools/sweep bed --set phi=0.1,0.2,0.3 --let 'fluid.body_force=[0, phi*(particles.density/fluid.density-1)*9.81]'

A name without a table is one of [particles.variables], or, if an expression uses it, a name for expressions. What has been
run is kept and not run again: the same command goes on with what is missing, and other values and keys only add runs and
columns. Where the scene or an option as --until has changed, the earlier folder is kept beside, as DIR.1, and all begins anew.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
import tomllib
from dataclasses import dataclass

from bplbm import output_folder
from bplbm.mpi_job import reason_of
from bplbm.options import arguments, label, out_folder, scene_files, whole
from bplbm import scene_keys
from bplbm.project import TOOLS, tool
from bplbm.scenes import scenes
from bplbm.sweep_values import Mistake, Sweep, axis, look_up, path_of
from bplbm.toml_text import read_laid_over, toml

OUT_OF_TOLERANCE = 4
MOST_LETTERS = 200  # of a file's name
WAYS = {0: "ok", 1: "fault", 2: "refused", 3: "numerics", OUT_OF_TOLERANCE: "out of tolerance"}
ANSWERED = (0, OUT_OF_TOLERANCE)  # runs that came to their end
HELP_ON_MORE = f"Other options are those of {tool('run')}, as --variant, --until or --threads, and reach every run."


def fail(text):
    print(f"sweep | error | {text}", file=sys.stderr)
    sys.exit(2)


class Parser(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message}; see {tool('sweep')} --help")


def parser():
    p = Parser(prog=tool("sweep"), description=__doc__.replace("tools/sweep", tool("sweep")), epilog=HELP_ON_MORE, allow_abbrev=False,
               formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("scene", nargs="?", help="name of a folder in cases/, or the path of a scene's folder or scene.toml")
    p.add_argument("--set", action="append", default=[], metavar="KEY=VALUES",
                   help="values between commas, or 1..5; repeatable")
    p.add_argument("--let", action="append", default=[], metavar="KEY=EXPRESSION",
                   help="a key that follows from others; repeatable, later ones may use earlier ones")
    p.add_argument("--parameter-set", default="resolved", metavar="NAME", help=f"what {tool('run')} calls --set: resolved, literal, fine")
    p.add_argument("--jobs", type=whole, default=1, metavar="N", help="runs at the same time")
    p.add_argument("--out", metavar="DIR", help="a new folder or that of an earlier sweep; default: out/SCENE-sweep")
    p.add_argument("--retry", action="store_true", help="run again what has failed")
    p.add_argument("--no-build", action="store_true", help="take the programs as they are built; install and build nothing")
    p.add_argument("--list", action="store_true", help="print the runs and start none")
    p.add_argument("--look", action="store_true", help=argparse.SUPPRESS)  # at the arguments, and go
    return p


def let(text):
    key, equals, expression = text.partition("=")
    if not equals or not expression:
        raise Mistake(f"--let {text}: write it as KEY=EXPRESSION")
    path_of(key)
    return key, expression


class Table:
    """What is known of each run of a sweep's folder: sweep.json, written whole after each run."""

    def __init__(self, folder):
        self.folder, self.path, self.lock = folder, folder / "sweep.json", threading.Lock()
        told = json.loads(self.path.read_text()) if self.path.exists() else {}
        self.rows, self.base = told.get("runs", {}), told.get("base")

    def differs(self, base, runs):
        """Whether what is there follows from another scene or other options, or runs of these names from other overlays."""
        return bool(self.rows) and (self.base != base or any(self.rows.get(run.name, {"made_of": run.made_of})["made_of"] != run.made_of
                                                             for run in runs))

    def finished(self):
        return sum(row["code"] in ANSWERED for row in self.rows.values())

    def add(self, name, row):
        with self.lock:
            self.rows[name] = row
            part = self.path.with_suffix(".part")
            part.write_text(json.dumps({"base": self.base, "runs": self.rows}, indent=1, ensure_ascii=False) + "\n")
            part.replace(self.path)

    def has(self, name, made_of, retry):
        row = self.rows.get(name)
        return row is not None and row["made_of"] == made_of and (row["code"] in ANSWERED or not retry)


def named_files(tables, folder):
    """Files of a scene's folder that its tables name: meshes, images, tables in time."""
    if isinstance(tables, str):
        return [folder / tables] if 0 < len(tables) < MOST_LETTERS and (folder / tables).is_file() else []
    parts = tables.values() if isinstance(tables, dict) else tables if isinstance(tables, list) else ()
    return [path for part in parts for path in named_files(part, folder)]


def made_of(args, overlay):
    """A hash of all that a run follows from: scene, overlays, files that they name, scripts, and the other options."""
    digest = hashlib.sha256(overlay.encode())
    folder, files = args.scene.folder, scene_files(args)
    named = {*named_files(read_laid_over(files), folder), *named_files(tomllib.loads(overlay), folder)}
    for path in sorted({*map(pathlib.Path, files), *named, *folder.glob("*.liggghts"), *folder.glob("*/*.liggghts"),
                        *folder.parent.glob("common/*.liggghts"), *folder.glob("in.*"), *folder.glob("plot.py")}):
        digest.update(path.read_bytes())
    digest.update(repr((args.engine_command or args.engine, args.until)).encode())
    return digest.hexdigest()[:16]


def results_of(folder):
    """Results, quantities and costs of a finished run: dict "name [unit]" -> number."""
    from bplbm.results import Run
    run = Run(folder)
    summary = run.summary
    numbers = {}
    for number in [*summary["results"], *run.quantities]:
        unit = "" if number["unit"] == "1" else f" [{number['unit']}]"
        numbers.setdefault(number["name"] + unit, number["value"])
    return {**numbers, "physical time [s]": summary["physical_seconds"], "largest Ma": summary["ma_max"],
            "mass drift": summary["mass_drift"], "wall time [s]": summary["wall_seconds"]}


def reason_of_finished(folder):
    """Why the results of a finished run count for nothing, as after --until, or which of them missed their reference; else
    empty."""
    summary = json.loads((folder / "summary.json").read_text())
    if why := summary.get("not_judged"):
        return f"not judged: {why}"
    return "; ".join(f"{r['name']} is {100 * r['error']:+.1f} % off, tolerance {100 * r['tolerance']:.2g} %" for r in summary["results"]
                     if not r["pass"])


@dataclass(frozen=True)
class Planned:
    """A run: its name, the values of the axes and of the expressions by key, its overlay, and a hash of what it is made of."""

    name: str
    values: dict
    computed: dict
    overlay: str
    made_of: str


class Runner:
    """Starts the runs, some at a time, and ends them in good order at Ctrl-C."""

    def __init__(self, words, table):
        self.words, self.table = words, table
        self.stopped, self.jobs = threading.Event(), set()

    def run(self, run):
        if self.stopped.is_set():
            return
        folder, name = self.table.folder, run.name
        file = folder / "overlays" / f"{name}.toml"
        file.write_text(run.overlay)
        line = [sys.executable, str(TOOLS / "launch.py"), *self.words, "--no-study", "--force", "--overlay", str(file),
                "--out", str(folder / name)]
        with open(folder / "logs" / f"{name}.log", "w") as log:
            start = time.monotonic()
            with subprocess.Popen(line, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True,
                                  env={**os.environ, "MPLBACKEND": "Agg"}) as job:
                self.jobs.add(job)
                if self.stopped.is_set():  # just now, and nobody has told this one
                    job.send_signal(signal.SIGINT)
                code = job.wait()
                self.jobs.discard(job)
        if self.stopped.is_set():
            return
        text = (folder / "logs" / f"{name}.log").read_text(errors="replace")
        row = {"values": run.values, "computed": run.computed, "made_of": run.made_of, "code": code,
               "seconds": round(time.monotonic() - start, 2),
               "reason": reason_of_finished(folder / name) if code in ANSWERED else reason_of(text)[:400],
               "results": results_of(folder / name) if code in ANSWERED else {}}
        self.table.add(name, row)
        reason = f" | {row['reason']}" if row["reason"] else ""
        print(f"sweep | {name} | {WAYS.get(code, code)}, {row['seconds']:.3g} s{reason}", flush=True)

    def stop(self, *_):
        """Each run is told once, as by Ctrl-C; a second one ends it at once."""
        self.stopped.set()
        for job in list(self.jobs):
            job.send_signal(signal.SIGINT)

    def all(self, runs, jobs):
        """All runs, some at the same time."""
        before = {s: signal.signal(s, self.stop) for s in (signal.SIGINT, signal.SIGTERM)}
        try:
            with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
                for done in [pool.submit(self.run, run) for run in runs]:
                    done.result()
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def planned(sweep, args):
    """Each run. Throws Mistake."""
    runs = []
    for chosen in sweep.combinations():
        overlay = toml(sweep.overlay(chosen))
        runs.append(Planned(sweep.label(chosen), chosen, sweep.computed(chosen), overlay, made_of(args, overlay)))
    if len({run.name for run in runs}) < len(runs):
        raise Mistake("two runs would have the same name; write values that differ in letters and digits")
    return runs


def take_folder(folder, scene):
    """Makes the folder ours, unless it is somebody else's. Returns a Hold on it."""
    if folder.exists() and not folder.is_dir():
        fail(f"{folder}: is no folder; choose another --out")
    if not output_folder.is_empty(folder) and not (output_folder.is_marked(folder) and (folder / "overlays").is_dir()):
        fail(f"{folder}: is not empty, and no folder of an earlier sweep; choose another --out")
    output_folder.mark(folder, scene.name)
    for name in ("overlays", "logs"):
        (folder / name).mkdir(exist_ok=True)
    try:
        return output_folder.Hold(folder)
    except output_folder.Refused as refused:
        fail(refused)


def take_table(out, args, runs):
    """A Hold on the folder, and the Table in it. A folder whose runs follow from another scene or other options is kept
    beside."""
    base = made_of(args, "")
    hold = take_folder(out, args.scene)
    table = Table(out)
    if table.differs(base, runs):
        if finished := table.finished():
            hold.file.close()
            aside = output_folder.set_aside(out)
            print(f"sweep | kept | the earlier sweep in {out} is now {aside}: its {finished} finished runs follow from another "
                  "scene, other options or other expressions; this command begins anew")
            hold = take_folder(out, args.scene)
            table = Table(out)
        table.rows = {}
    table.base = base
    return hold, table


def columns_of_values(sweep, rows):
    """Keys that vary between the rows (the axes of all of them), and all columns of values: name [unit] -> value of each row.
    What a run has not set is as the scene has it, or empty."""
    axes = list(dict.fromkeys([*(a.name for a in sweep.axes), *(name for row in rows.values() for name in row["values"])]))
    lets = dict.fromkeys(name for row in rows.values() for name in row.get("computed", {}) if name not in axes)
    columns = {}
    for name in (*axes, *lets):
        try:
            path = sweep.target(name)
        except Mistake:  # a name for expressions of an earlier command
            path = None
        of_scene = value_at(sweep.tables, path) if path else ""
        for row in rows.values():
            row.setdefault("all", {})[name] = {**row.get("computed", {}), **row["values"]}.get(name, of_scene)
        columns[name] = scene_keys.with_unit(name, path)
    return axes, columns


def value_at(tables, path):
    try:
        return look_up(tables, path)
    except KeyError:
        return ""


def checked(args):
    """Arguments of tools/run that a sweep can pass on."""
    for name in ("out", "restart", "force", "record", "overlay"):
        if getattr(args, name):
            fail(f"--{name} is of a single run, and cannot be given to a sweep")
    if key := next((key for key, value in args.own if value == "all"), None):
        fail(f"--{key} all: a sweep takes one value of it")
    return args


def main():
    options, rest = parser().parse_known_args()
    if not options.scene:
        if rest:
            fail(f"no option '{rest[0]}' without a scene; see {tool('sweep')} --help")
        if options.list:
            print("\n".join(scenes()))
            return 0
        fail(f"which scene? as {tool('sweep')} settling_disc --set particles.density=1100,1250")
    words = [options.scene, *rest, "--set", options.parameter_set]
    args = checked(arguments(words))
    try:
        if not options.set:
            raise Mistake("nothing is varied; add --set KEY=VALUE,VALUE")
        sweep = Sweep(read_laid_over(scene_files(args)), tuple(map(axis, options.set)), tuple(map(let, options.let)))
        if not args.scene.is_solid_alone:
            scene_keys.check(sweep.paths())
        runs = planned(sweep, args)
    except Mistake as mistake:
        fail(mistake)
    except (OSError, ValueError) as error:
        fail(f"{args.scene.file}: {error}")
    if options.list:
        for run in runs:
            print(f"# {run.name}\n{run.overlay}")
        return 0
    if options.look:
        return 0
    out = pathlib.Path(options.out or f"{out_folder(args)}-sweep").resolve()
    return go(args, words, options, sweep, runs, out)


def go(args, words, options, sweep, runs, out):
    """The runs that are missing, the table and the page. Returns the exit code."""
    from bplbm.page.sweep import write_page, write_table  # they need numpy, which --look does without
    hold, table = take_table(out, args, runs)
    missing = [run for run in runs if not table.has(run.name, run.made_of, options.retry)]
    if len(missing) < len(runs):
        print(f"sweep | {len(runs) - len(missing)} of {len(runs)} runs are there already")
    if others := set(table.rows) - {run.name for run in runs}:
        print(f"sweep | {len(others)} earlier runs of other values or keys stay in the table")
    runner = Runner(words, table)
    runner.all(missing, options.jobs)
    rows = {name: table.rows[name] for name in dict.fromkeys([*(run.name for run in runs), *table.rows]) if name in table.rows}
    axes, varied = columns_of_values(sweep, rows)
    print(f"sweep | table {write_table(out, varied, rows)}")
    print(f"sweep | page {write_page(out, args.scene, label(args), axes, varied, rows, sys.argv[1:])}")
    hold.file.close()
    rows = {run.name: rows[run.name] for run in runs if run.name in rows}  # what this command has asked for
    if runner.stopped.is_set():
        print("sweep | stopped: the same command goes on with what is missing", file=sys.stderr)
        return 1
    failed = sum(row["code"] not in ANSWERED for row in rows.values())
    if failed:
        print(f"sweep | {failed} of {len(rows)} runs failed; their reasons are in the table, what they said in {out / 'logs'}",
              file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
