"""Runs a scene of cases/ as a coupled MPI job, draws its pictures and judges its results.

Called by tools/run, which has built the programs before. Exit codes: 0 ok, 1 fault or lost partner,
2 bad input or refusal, 3 numerics, 4 a result outside its tolerance.
"""

import argparse
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CASES = ROOT / "cases"
OUT_OF_TOLERANCE = 4
BAD_INPUT = 2


def fail(text):
    print(f"run | error | {text}", file=sys.stderr)
    sys.exit(BAD_INPUT)


def scenes():
    return sorted(p.parent.name for p in CASES.glob("*/scene.toml"))


def variants(scene):
    return sorted(p.stem.removeprefix("variant-") for p in (CASES / scene).glob("variant-*.toml"))


def sets(scene):
    return ["resolved"] + [n for n in ("literal", "fine") if (CASES / scene / f"{n}.toml").exists()]


def list_scenes():
    for scene in scenes():
        heading = (CASES / scene / "README.md").read_text().splitlines()[0].lstrip("# ")
        print(f"{scene:20} {heading}")
        print(f"{'':20} sets: {', '.join(sets(scene))}; variants: {', '.join(variants(scene)) or '-'}")


def arguments():
    p = argparse.ArgumentParser(prog="tools/run", description="Runs a scene and draws its pictures.")
    p.add_argument("scene", nargs="?", help="name of a folder in cases/")
    p.add_argument("--list", action="store_true", help="scenes with their sets and variants")
    p.add_argument("--set", default="resolved", help="parameter set: resolved, literal, fine")
    p.add_argument("--variant", default="", help="overlay variant-NAME.toml of the scene")
    p.add_argument("--fluid-ranks", type=int, default=1, metavar="N")
    p.add_argument("--solid-ranks", type=int, default=1, metavar="M")
    p.add_argument("--threads", type=int, default=1, metavar="T", help="of the fluid")
    p.add_argument("--until", type=float, metavar="SECONDS", help="stop at this physical time")
    p.add_argument("--record", metavar="FILE", help="write the exchange to a trace")
    p.add_argument("--restart", action="store_true", help="go on from the checkpoint in --out")
    p.add_argument("--out", metavar="DIR", help="default: out/SCENE[-SET][-VARIANT]")
    p.add_argument("--no-study", action="store_true", help="leave out the scene's comparison runs")
    return p.parse_args()


def check_names(scene, set_name, variant):
    if scene not in scenes():
        fail(f"no scene '{scene}'; there are: {', '.join(scenes())}")
    if set_name not in sets(scene):
        fail(f"{scene} has no set '{set_name}'; there are: {', '.join(sets(scene))}")
    if variant and variant not in variants(scene):
        fail(f"{scene} has no variant '{variant}'; there are: {', '.join(variants(scene)) or 'none'}")


def out_folder(scene, set_name, variant):
    parts = [scene] + ([set_name] if set_name != "resolved" else []) + ([variant] if variant else [])
    return ROOT / "out" / "-".join(parts)


def scene_files(scene, set_name, variant):
    folder = CASES / scene
    files = [folder / "scene.toml"]
    files += [folder / f"{set_name}.toml"] if set_name != "resolved" else []
    files += [folder / f"variant-{variant}.toml"] if variant else []
    return [str(f) for f in files]


def environment(processes):
    """What Open MPI needs: permission to run as root, and polite waits on a full machine."""
    env = dict(os.environ)
    if os.geteuid() == 0:
        env.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    if processes > (os.cpu_count() or 1):
        env["OMPI_MCA_mpi_yield_when_idle"] = "1"
    return env


def command(args, out):
    bin_dir = ROOT / "build" / os.environ.get("BPLBM_PRESET", "release") / "bin"
    progress = "line" if sys.stdout.isatty() else "tenths"
    fluid = [str(bin_dir / "lbm"), *scene_files(args.scene, args.set, args.variant)]
    fluid += ["--out", str(out), "--threads", str(args.threads), "--progress", progress]
    fluid += ["--set", args.set] + (["--variant", args.variant] if args.variant else [])
    fluid += ["--until", repr(args.until)] if args.until else []
    fluid += ["--record", os.path.abspath(args.record)] if args.record else []
    fluid += ["--restart"] if args.restart else []
    script = str(CASES / args.scene / "in.liggghts")
    first = ["mpirun", "--bind-to", "none", "--oversubscribe", "-np", str(args.fluid_ranks), *fluid]
    if not os.path.exists(script):
        return first
    solid = [str(bin_dir / "liggghts"), "-in", script, "-log", str(out / "liggghts.log"), "-screen", "none",
             "-var", "out_folder", str(out)]
    return first + [":", "-np", str(args.solid_ranks), *solid]


def run_job(args, out):
    if shutil.which("mpirun") is None:
        fail("mpirun not found; run tools/install")
    if not args.restart:
        shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True, exist_ok=True)
    line = command(args, out)
    env = environment(args.fluid_ranks * args.threads + args.solid_ranks)
    added = " ".join(f"{k}={v}" for k, v in env.items() if os.environ.get(k) != v)
    print(f"run | {added + ' ' if added else ''}{shlex.join(line)}", flush=True)
    code = subprocess.run(line, env=env, check=False).returncode
    return code if code in (0, 1, 2, 3) else 1


def draw(scene, out):
    script = CASES / scene / "plot.py"
    if not script.exists():
        return
    env = dict(os.environ, PYTHONPATH=str(ROOT / "tools"), MPLBACKEND="Agg")
    subprocess.run(["/usr/bin/python3", str(script), str(out)], env=env, check=True)


def judge(out):
    """Prints the results of summary.json. Returns whether all are within their tolerance."""
    results = json.loads((out / "summary.json").read_text())["results"]
    for r in results:
        verdict = "pass" if r["pass"] else "MISS"
        print(f"run | {verdict} | {r['name']} = {r['value']:.5g} {r['unit']}, reference {r['reference']:.5g} "
              f"({r['source']}), error {100 * r['error']:+.2f} %, tolerance {100 * r['tolerance']:.2g} %")
    return all(r["pass"] for r in results)


def study(args, out):
    """The scene's comparison runs: one line `SET VARIANT` each in study.txt, `-` for none."""
    plan = CASES / args.scene / "study.txt"
    if args.no_study or args.set != "resolved" or args.variant or args.until or not plan.exists():
        return 0
    for line in plan.read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        set_name, variant = (word if word != "-" else "" for word in line.split())
        run = argparse.Namespace(**{**vars(args), "set": set_name or "resolved", "variant": variant,
                                    "record": None})
        code = run_job(run, out / "study" / line.replace(" ", "_"))
        if code:
            return code
    return 0


def main():
    args = arguments()
    if args.list:
        list_scenes()
        return 0
    if not args.scene:
        fail("which scene? tools/run --list shows them")
    check_names(args.scene, args.set, args.variant)
    out = pathlib.Path(args.out).resolve() if args.out else out_folder(args.scene, args.set, args.variant)
    code = run_job(args, out) or study(args, out)
    if code:
        print(f"run | stopped with exit code {code}; logs in {out}", file=sys.stderr)
        return code
    draw(args.scene, out)
    good = judge(out)
    print(f"run | outputs in {out}")
    for picture in sorted(out.glob("*.png")):
        print(f"run | picture {picture}")
    return 0 if good else OUT_OF_TOLERANCE


if __name__ == "__main__":
    sys.exit(main())
