"""Runs a scene of cases/ as a coupled MPI job, draws its pictures and judges its results.

Called by tools/run, which has built the programs before. Exit codes: 0 ok, 1 fault or lost partner,
2 bad input or refusal, 3 numerics, 4 a result outside its tolerance.
"""

import argparse
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import time
import tomllib

import output_folder
import solid_alone
from mpi_job import STOPPED, MpiJob, environment

ROOT = pathlib.Path(__file__).resolve().parent.parent
CASES = ROOT / "cases"
OUT_OF_TOLERANCE = 4
FAULT, BAD_INPUT = 1, 2
MOST_THREADS = 1024


def fail(text, code=BAD_INPUT):
    print(f"run | error | {text}", file=sys.stderr)
    sys.exit(code)


def scenes():
    return sorted(p.parent.name for p in CASES.glob("*/scene.toml"))


def variants(scene):
    return sorted(p.stem.removeprefix("variant-") for p in (CASES / scene).glob("variant-*.toml"))


def sets(scene):
    return ["resolved"] + [n for n in ("literal", "fine") if (CASES / scene / f"{n}.toml").exists()]


def options(scene):
    """Choices of a scene's own, from its overlays KEY-VALUE.toml: dict KEY -> values."""
    found = {}
    for path in sorted((CASES / scene).glob("*-*.toml")):
        key, value = path.stem.split("-", 1)
        if key != "variant":
            found.setdefault(key, []).append(value)
    return found


def heading_of(scene):
    """First line of a scene's README, else the title in its scene.toml."""
    readme = CASES / scene / "README.md"
    lines = readme.read_text(errors="replace").splitlines() if readme.is_file() else []
    if lines:
        return lines[0].lstrip("# ")
    try:
        return f"{tomllib.loads((CASES / scene / 'scene.toml').read_text()).get('title', scene)} (no README.md)"
    except (OSError, ValueError):  # lbm says what is wrong with it
        return "(no README.md)"


def list_scenes():
    for scene in scenes():
        heading = heading_of(scene)
        print(f"{scene:20} {heading}")
        own = "".join(f"; --{key} {'|'.join(values)}|all" for key, values in options(scene).items())
        print(f"{'':20} sets: {', '.join(sets(scene))}; variants: {', '.join(variants(scene)) or '-'}{own}")


def whole(text):
    """A number of ranks or threads."""
    if not text.isascii() or not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is no whole number of at least 1")
    return int(text)


def seconds(text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"'{text}' is no positive number of seconds")
    return value


class Parser(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message}; see tools/run --help")


def parser():
    p = Parser(prog="tools/run", description="Runs a scene and draws its pictures.")
    p.add_argument("scene", nargs="?", help="name of a folder in cases/")
    p.add_argument("--list", action="store_true", help="scenes with their sets and variants")
    p.add_argument("--set", default="resolved", help="parameter set: resolved, literal, fine")
    p.add_argument("--variant", default="", help="overlay variant-NAME.toml of the scene")
    p.add_argument("--fluid-ranks", type=whole, default=1, metavar="N")
    p.add_argument("--solid-ranks", type=whole, default=1, metavar="M")
    p.add_argument("--threads", type=whole, default=1, metavar="T", help=f"of the fluid; at most {MOST_THREADS}")
    p.add_argument("--engine", default="liggghts", choices=["liggghts", "lammps", "reference", "python"],
                   help="who moves the particles; the last two suit free discs")
    p.add_argument("--until", type=seconds, metavar="SECONDS", help="stop at this physical time")
    p.add_argument("--record", metavar="FILE", help="write the exchange to a trace")
    p.add_argument("--restart", action="store_const", const="checkpoint", help="go on from the checkpoint in --out")
    p.add_argument("--restart=fault", dest="restart", action="store_const", const="fault",
                   help="go on from the states that both programs kept at a fault")
    p.add_argument("--out", metavar="DIR", help="a new, an empty or an earlier run's folder; default: "
                   "out/SCENE[-SET][-VARIANT], where an earlier run is renamed to ….1, ….2 and so on")
    p.add_argument("--force", action="store_true", help="replace an earlier run in the output folder")
    p.add_argument("--look", action="store_true", help=argparse.SUPPRESS)  # at the arguments, and go
    p.add_argument("--no-study", action="store_true", help="leave out the scene's comparison runs")
    p.epilog = "A scene may have choices of its own (--list), as --start 5 of disc_migration."
    return p


def arguments(words):
    """Checked arguments; `own` holds the scene's own choices as pairs (KEY, VALUE)."""
    args, rest = parser().parse_known_args(words)
    if not args.scene and rest:
        fail(f"no option '{rest[0]}' without a scene; see tools/run --help")
    if not args.scene:
        return args
    if args.scene not in scenes():
        fail(f"no scene '{args.scene}'; there are: {', '.join(scenes())}")
    if args.set not in sets(args.scene):
        fail(f"{args.scene} has no set '{args.set}'; there are: {', '.join(sets(args.scene))}")
    if args.variant and args.variant not in variants(args.scene):
        fail(f"{args.scene} has no variant '{args.variant}'; there are: {', '.join(variants(args.scene)) or 'none'}")
    if args.threads > MOST_THREADS:
        fail(f"--threads {args.threads}: a rank takes at most {MOST_THREADS}; take more --fluid-ranks")
    if args.force and args.restart:
        fail("--force replaces an earlier run and --restart goes on from it; give one of them")
    if solid_alone.is_alone(CASES / args.scene / "scene.toml"):
        check_alone(args)
    known = options(args.scene)
    args.own = []
    while rest:
        key, value = rest.pop(0), rest.pop(0) if rest else ""
        if not key.startswith("--") or key[2:] not in known:
            fail(f"{args.scene} knows no '{key}'; see tools/run --help"
                 + "".join(f", and --{k} {'|'.join(v)}|all" for k, v in known.items()))
        if value != "all" and value not in known[key[2:]]:
            fail(f"{key} of {args.scene} is one of: {', '.join(known[key[2:]])}, all")
        args.own.append((key[2:], value))
    return args


def check_alone(args):
    """LIGGGHTS alone takes no option of the fluid or of the exchange."""
    given = {"--fluid-ranks": args.fluid_ranks > 1, "--threads": args.threads > 1, "--record": args.record,
             "--restart": args.restart, "--engine": args.engine != "liggghts"}
    for option, wrong in given.items():
        if wrong:
            fail(f"{args.scene} has no fluid, LIGGGHTS runs alone: leave {option} out")


def label(args):
    """Name of the overlays beside the set: VARIANT and KEY-VALUE, joined."""
    return "_".join(([args.variant] if args.variant else []) + [f"{key}-{value}" for key, value in args.own])


def out_folder(args):
    parts = [args.scene] + ([args.set] if args.set != "resolved" else []) + ([label(args)] if label(args) else [])
    return ROOT / "out" / "-".join(parts)


def scene_files(args):
    folder = CASES / args.scene
    files = [folder / "scene.toml"]
    files += [folder / f"{args.set}.toml"] if args.set != "resolved" else []
    files += [folder / f"variant-{args.variant}.toml"] if args.variant else []
    files += [folder / f"{key}-{value}.toml" for key, value in args.own]
    return [str(f) for f in files]


def programs():
    return ROOT / "build" / os.environ.get("BPLBM_PRESET", "release") / "bin"


def command(args, out):
    bin_dir = programs()
    progress = "line" if sys.stdout.isatty() else "tenths"
    fluid = [str(bin_dir / "lbm"), *scene_files(args)]
    fluid += ["--out", str(out), "--threads", str(args.threads), "--progress", progress]
    fluid += ["--set", args.set] + (["--variant", label(args)] if label(args) else [])
    fluid += ["--until", repr(args.until)] if args.until is not None else []
    fluid += ["--force"] if args.force else []
    fluid += ["--record", os.path.abspath(args.record)] if args.record else []
    fluid += [f"--restart={args.restart}"] if args.restart else []
    first = ["mpirun", "--bind-to", "none", "--oversubscribe", "-np", str(args.fluid_ranks), *fluid]
    solid = solid_command(args, bin_dir, out)
    return first + ([":", "-np", str(args.solid_ranks), *solid] if solid else [])


def solid_command(args, bin_dir, out):
    """The program that moves the particles; nothing for a fluid alone."""
    if not (CASES / args.scene / "in.liggghts").exists():
        return []
    if args.engine == "reference":
        return [str(bin_dir / "reference_engine")]
    if args.engine == "python":
        return ["/usr/bin/python3", str(ROOT / "tools" / "engines" / "python" / "engine.py")]
    script = CASES / args.scene / f"in.{args.engine}"
    if not script.exists():
        fail(f"{args.scene} has no {script.name}; write one, or leave --engine out")
    common = ["-in", str(script), "-log", str(out / f"{args.engine}.log"), "-screen", "none"]
    if args.engine == "lammps":
        return [str(bin_dir / "lammps_engine"), *common]
    return [str(bin_dir / "liggghts"), *common, "-var", "out_folder", str(out)]


def take_folder(args, out, look=False):
    """Makes the folder ready and holds it for as long as what is returned lives; or looks whether that could be done."""
    try:
        if look:
            return output_folder.check(out, bool(args.out), args.restart, args.force)
        hold, aside = output_folder.take(out, args.scene, bool(args.out), args.restart, args.force)
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
        fail(f"{args.scene}: {mistake}")
    if args.force:
        output_folder.remove_run(out)
    script, begin = CASES / args.scene / "in.liggghts", time.monotonic()
    code = start(solid_alone.command(programs() / "liggghts", script, out, found, args.solid_ranks), args.solid_ranks)
    if code == 0:
        solid_alone.write_summary(out, args.scene, args.set, label(args), found, time.monotonic() - begin)
    elif said := solid_alone.error_in(out / "liggghts.log"):
        print(f"run | error | liggghts: {said}", file=sys.stderr)
    return code


def run_job(args, out):
    """The job in a folder of ours. Returns its exit code."""
    if solid_alone.is_alone(CASES / args.scene / "scene.toml"):
        return run_alone(args, out)
    code = start(command(args, out), args.fluid_ranks * args.threads + args.solid_ranks)
    if code == 0:
        add_solid_waiting(out)
    return code


def start(line, processes):
    """Runs an mpirun line to its end. Returns its exit code."""
    env = environment(processes)
    added = " ".join(f"{k}={v}" for k, v in env.items() if os.environ.get(k) != v)
    print(f"run | {added + ' ' if added else ''}{shlex.join(line)}", flush=True)
    job = MpiJob(line, env)
    code = job.run()
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
    path.write_text(json.dumps(summary, indent=2, ensure_ascii=False) + "\n")
    print(f"run | waiting: the fluid {summary['waiting']:.3g} s for the solid, the solid {summary['solid_waiting']:.3g} s for "
          f"the fluid, of {summary['wall_seconds']:.3g} s")


def draw(scene, out, until):
    script = CASES / scene / "plot.py"
    if not script.exists():
        return
    env = dict(os.environ, PYTHONPATH=str(ROOT / "tools"), MPLBACKEND="Agg")
    job = subprocess.run(["/usr/bin/python3", str(script), str(out)], env=env, check=False, stderr=subprocess.PIPE,
                         text=True, errors="replace")
    if job.returncode == 0:
        sys.stderr.write(job.stderr)
        return
    (out / "plot.log").write_text(job.stderr)
    lines = job.stderr.strip().splitlines() or [f"it ended with code {job.returncode}"]
    made = json.loads((out / "summary.json").read_text())["physical_seconds"]
    fail(f"{script} cannot judge and draw this run, which made {made:.6g} s: {lines[-1]}; "
         f"{'a run that --until has cut short may lack what it needs: leave --until out' if until else 'correct it'} "
         f"(its whole message is in {out / 'plot.log'}; the run's numbers are complete)", FAULT)


def judge(out):
    """Prints the results of summary.json. Returns whether all are within their tolerance."""
    results = json.loads((out / "summary.json").read_text())["results"]
    for r in results:
        verdict = "pass" if r["pass"] else "MISS"
        print(f"run | {verdict} | {r['name']} = {r['value']:.5g} {r['unit']}, reference {r['reference']:.5g} "
              f"({r['source']}), error {100 * r['error']:+.2f} %, tolerance {100 * r['tolerance']:.2g} %")
    return all(r["pass"] for r in results)


def comparison_runs(args):
    """Options of the runs beside the main one: the other values of a choice that is `all`, or the
    lines of the scene's study.txt."""
    plan = CASES / args.scene / "study.txt"
    for i, (key, value) in enumerate(args.own):
        if value == "all":
            first, *others = options(args.scene)[key]
            args.own[i] = (key, first)
            return [["--" + key, other] for other in others]
    if args.no_study or args.set != "resolved" or label(args) or args.until is not None or not plan.exists():
        return []
    return [line.split() for line in plan.read_text().splitlines() if line.strip() and not line.startswith("#")]


def study(args, runs, out):
    """Runs them, each in a folder of its own: --variant trt in study/variant-trt."""
    for words in runs:
        other = arguments([args.scene, *words])
        folder = out / "study" / "-".join(words).removeprefix("--").replace("---", "_")
        restart = args.restart if (folder / f"{args.restart}.h5").exists() else None
        run = argparse.Namespace(**{**vars(args), "set": other.set, "variant": other.variant, "own": other.own,
                                    "record": None, "restart": restart, "force": not restart})
        hold = take_folder(run, folder)
        code = run_job(run, folder)
        del hold
        if code:
            return code
    return 0


def main():
    args = arguments(sys.argv[1:])
    if args.list:
        list_scenes()
        return 0
    if not args.scene:
        fail("which scene? tools/run --list shows them")
    out = output_folder.resolved(args.out or out_folder(args))
    if args.look:
        take_folder(args, out, look=True)
        return 0
    if shutil.which("mpirun") is None:
        fail("mpirun not found; run tools/install")
    others = comparison_runs(args)
    hold = take_folder(args, out)
    before = output_folder.files(out)
    try:
        return go(args, others, out)
    finally:
        if hold:  # what has come besides lbm's own, as pictures: a later run may replace it
            output_folder.add_files(out, output_folder.files(out) - before)


def go(args, others, out):
    """The job, its comparison runs, pictures and results. Returns the exit code."""
    code = run_job(args, out) or study(args, others, out)
    if code:
        print(f"run | stopped with exit code {code}; logs in {out}", file=sys.stderr)
        if code in (1, 3) and (out / "checkpoint.h5").exists():
            print("run | its last checkpoint is complete: the same command with --restart goes on from there",
                  file=sys.stderr)
        if (out / "fault.h5").exists():
            print("run | states of the fault are kept (fault.*): --restart=fault goes on from them if both sides' are",
                  file=sys.stderr)
        return code
    draw(args.scene, out, args.until is not None)
    good = judge(out)
    print(f"run | outputs in {out}")
    for picture in sorted(out.glob("*.png")):
        print(f"run | picture {picture}")
    return 0 if good else OUT_OF_TOLERANCE


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        print("run | stopped: interrupted by Ctrl-C", file=sys.stderr)
        sys.exit(STOPPED)
