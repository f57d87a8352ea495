"""Speed against error of every choice, and which of them survive the hard cases.

    tools/report [--quick|--full] [CASE…]     CASE: array, cylinder, couette, settling, stability, features

One run is one row: a scene of cases/ with an overlay, judged against a reference. What has been run is kept in
out/report and not run again (--again does). Writes report.md, rows.csv, rows.json and a picture a case there.
"""

import argparse
import csv
import importlib.util
import json
import os
import pathlib
import platform
import re
import resource
import subprocess
import sys
import time

import matplotlib.pyplot as plt
import numpy as np
from launch import CASES, ROOT, environment
from pictures import Run, read_table

OUT = ROOT / "out" / "report"
OURS, PAPERS, STAIRS = "ours", "papers", "staircase"
SCHEMES = {
    "default, bodies at rest: TRT, Holdych": (OURS, {}),
    "default, free bodies: TRT, layered Holdych": (OURS, {"solid_term": "layered_holdych"}),
    "central moments, layered Noble–Torczynski":
        (None, {"collision": "central_moment", "solid_term": "layered_noble_torczynski"}),
    "TRT, Noble–Torczynski": (None, {"collision": "trt", "solid_term": "noble_torczynski"}),
    "papers: BGK, Noble–Torczynski": (PAPERS, {"collision": "bgk", "solid_term": "noble_torczynski"}),
    "BGK, Noble–Torczynski, B = ε": (None, {"collision": "bgk", "solid_term": "noble_torczynski", "weight": "fraction"}),
    "staircase: BGK, bounce-back": (STAIRS, {"collision": "bgk", "scheme": "bounce_back"}),
    "TRT, bounce-back": (STAIRS, {"collision": "trt", "scheme": "bounce_back"}),
    "TRT, interpolated bounce-back": (None, {"collision": "trt", "scheme": "interpolated_bounce_back"}),
    "TRT, implicit immersed boundary": (None, {"collision": "trt", "scheme": "implicit_immersed_boundary"}),
}


def toml(tables):
    """Text of an overlay; a list of tables becomes [[name]]."""
    value = lambda v: json.dumps(v) if not isinstance(v, bool) else str(v).lower()  # noqa: E731
    text = ""
    for name, table in tables.items():
        for one in table if isinstance(table, list) else [table]:
            text += (f"[[{name}]]\n" if isinstance(table, list) else f"[{name}]\n")
            text += "".join(f"{k} = {value(v)}\n" for k, v in one.items())
    return text


def merged(*overlays):
    out = {}
    for overlay in overlays:
        for name, table in overlay.items():
            out[name] = table if isinstance(table, list) else {**out.get(name, {}), **table}
    return out


def module_of(scene):
    spec = importlib.util.spec_from_file_location(f"plot_{scene}", CASES / scene / "plot.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run_scene(folder, scene, overlay, files=(), again=False, limit=900.0):
    """Runs a scene with an overlay, unless it has been. Returns exit code, its last error line, peak MB."""
    folder.mkdir(parents=True, exist_ok=True)
    text, done = toml(overlay), folder / "row.json"
    if not again and done.exists():
        kept = json.loads(done.read_text())
        if kept["overlay"] == text:
            return kept["code"], kept["error"], kept["megabytes"]
    (folder / "overlay.toml").write_text(text)
    bin_dir = ROOT / "build" / os.environ.get("BPLBM_PRESET", "release") / "bin"
    paths = [str(CASES / scene / f) for f in ("scene.toml", *files)] + [str(folder / "overlay.toml")]
    line = ["mpirun", "--bind-to", "none", "--oversubscribe", "-np", "1", str(bin_dir / "lbm"), *paths, "--out",
            str(folder), "--progress", "none"]
    script = CASES / scene / "in.liggghts"
    if script.exists():
        line += [":", "-np", "1", str(bin_dir / "liggghts"), "-in", str(script), "-log", "none", "-screen", "none",
                 "-var", "out_folder", str(folder)]
    try:
        job = subprocess.run(line, env=environment(2), capture_output=True, text=True, timeout=limit, check=False)
        code, output = job.returncode, job.stdout + job.stderr
    except subprocess.TimeoutExpired:
        code, output = 124, f"lbm | error | took longer than {limit:.0f} s"
    errors = re.findall(r"lbm \| error \| (.*)", output)
    megabytes = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    error = errors[-1] if errors else ""
    done.write_text(json.dumps({"overlay": text, "code": code, "error": error, "megabytes": megabytes}))
    return code, error, megabytes


# ---- cases: name -> rows (label, family, overlays of places, files), and how to measure ----------------------------


def array_rows(full):
    sides = [1e-4, 5e-5, 2.5e-5] + ([1.25e-5] if full else [])
    for label, (family, numerics) in SCHEMES.items():
        for h in sides:
            for tau in (0.505, 0.6, 1.0, 1.5) if full else (0.6, 1.5):
                if tau < 0.6 and h < 2e-5:
                    continue
                step = (tau - 0.5) / 3 * h * h / 1e-6
                places = [{"obstacle": [{"centre": [0.0005 + x * h, 0.0005 + y * h], "diameter": 5.046265044e-4}],
                           "numerics": {**numerics, "cell": h, "time_step": step},
                           "run": {"end_time": 8.0}, "output": {"fields_every": 8.0, "probe_every": 0.1}}
                          for x, y in ((0, 0), (0.5, 0.5), (0.23, 0.41))]
                yield label, family, f"D/h {5.046e-4 / h:.0f}, τ {tau}", places, ()


def cylinder_rows(full):
    for label, (family, numerics) in SCHEMES.items():
        if "free bodies" in label or "implicit" in label:
            continue
        for h in (0.01, 0.005) if full or family else (0.01,):
            yield label, family, f"D/h {0.1 / h:.0f}", [{"numerics": {**numerics, "cell": h}}], ()


def couette_rows(full):
    for label, (family, numerics) in SCHEMES.items():
        if "bodies at rest" in label or "implicit" in label or (label.startswith("BGK") and not family):
            continue
        for h in (2e-4, 1e-4) + ((5e-5,) if full else ()):
            yield label, family, f"gap/h {1.6e-3 / h:.0f}", [{"numerics": {**numerics, "cell": h}}], ()


def settling_rows(full):
    fall = {"run": {"end_time": 0.6}, "output": {"fields_every": 0.6, "probe_every": 0.002}}
    for label, (family, numerics) in SCHEMES.items():
        if "bodies at rest" in label or "implicit" in label or "B = ε" in label:
            continue
        for cells in (5, 10, 20) + ((40,) if full else ()):
            coupling = {"substeps": 1} if family == PAPERS else {}
            overlay = merged(fall, {"numerics": {"collision": "auto", "solid_term": "auto", **numerics,
                                                 "cells_per_diameter": cells}, "coupling": coupling})
            if coupling:  # soft enough for one solid step a fluid step; it falls, and touches nothing until then
                overlay = merged(overlay, {"particles": {"contact_stiffness": 100.0}})
            yield label, family, f"D/h {cells}", [overlay], ()
    for text, change in (("step × 2", {"fluid": {"velocity_scale": 0.03}}), ("step / 4", {"fluid": {"velocity_scale": 0.24}}),
                         ("overlapped", {"coupling": {"schedule": "overlapped"}}),
                         ("3 fluid steps an interval", {"coupling": {"fluid_steps": 3}})):
        yield SCHEMES_FREE, OURS, f"D/h 10, {text}", [merged(fall, {"numerics": {"cells_per_diameter": 10}}, change)], ()


SCHEMES_FREE = "default, free bodies: TRT, layered Holdych"
COUETTE = 4 * np.pi * 1e-3 * 1.0 * 0.0016**2 * 0.0032**2 / (0.0032**2 - 0.0016**2)


def couette_torque(run, module):
    table = read_table(run.folder / "obstacles.csv")
    return -table["torque"][table["obstacle"] == 2][-1] / run.parameters["depth"]


CASES_OF = {  # scene, rows, measure, reference, its uncertainty, source
    "array": ("cylinder_array", array_rows, lambda run, m: m.drag(run), 51.526949, 3e-4,
              "drag of a square array, Stokes flow; spectral, Sangani and Acrivos 1982"),
    "cylinder": ("cylinder_flow", cylinder_rows, lambda run, m: m.coefficients(run)[1][-1], 5.57953523384, 1e-6,
                 "drag of a cylinder at Re 20; Schäfer and Turek 2D-1"),
    "couette": ("taylor_couette", couette_rows, couette_torque, COUETTE, 1e-9, "torque between cylinders; exact"),
    "settling": ("settling_disc", settling_rows, lambda run, m: m.reynolds(run)[1].max(), 17.345, 4.3e-3,
                 "largest Re of a settling disc; 17.27 … 17.42 in the literature"),
}

# ---- hard cases --------------------------------------------------------------------------------------------------

OPERATORS = ("bgk", "trt", "central_moment", "recursive_regularised", "auto")
BODIES = {"auto": {}, "Noble–Torczynski": {"solid_term": "noble_torczynski"}, "Holdych": {"solid_term": "holdych"},
          "superposition": {"solid_term": "superposition"}, "B = ε": {"solid_term": "noble_torczynski", "weight": "fraction"},
          "bounce-back": {"scheme": "bounce_back"}, "implicit IBM": {"scheme": "implicit_immersed_boundary"}}
QUIET = {"output": {"fields_every": 100.0, "probe_every": 0.01}}


def hard_cases(full):
    """name, scene, files, overlay, whether a free body is in it."""
    yield "cylinder Re 100, D/h 10, open channel", "cylinder_flow", ("variant-d10.toml",), \
        {"run": {"end_time": 12.0 if full else 6.0}}, True
    for re_text, nu in (("1e4", 1e-4), ("1e5", 1e-5)):
        for u in (0.05, 0.1, 0.2) if full else (0.1,):
            yield f"shear layer Re {re_text}, u/C {u}", "shear_layer", (), \
                {"fluid": {"kinematic_viscosity": nu}, "numerics": {"time_step": u / 128}}, False
    yield "settling Re 480, D/h 12", "settling_disc", ("variant-glowinski2.toml",), \
        merged(QUIET, {"numerics": {"cells_per_diameter": 12}, "run": {"end_time": 0.5}}), True
    for ratio in (1.0, 0.5, 0.1):
        yield f"free disc, ρ_s/ρ_f {ratio:g}", "settling_disc", (), \
            merged(QUIET, {"particles": {"density": 1000.0 * ratio, "start": [[0.01, 0.02]]},
                           "numerics": {"cells_per_diameter": 10, "solid_term": "auto", "collision": "auto"},
                           "fluid": {"velocity_scale": 0.15}, "run": {"end_time": 0.25}}), True
    yield "free disc, τ = 1.5", "couette_disc", (), {"numerics": {"time_step": 0.00333}, "run": {"end_time": 10.0}}, True
    yield "pressure jump of 600 kPa into a packing", "hydraulic_fracture", (), \
        merged(QUIET, {"run": {"end_time": 0.003}}), True
    if full:
        yield "cavity Re 10 000", "lid_driven_cavity", ("variant-re10000.toml",), {"run": {"end_time": 100.0}}, False


def verdict(code, error, end):
    if code == 0:
        return "bounded"
    if code == 2:
        return "refused"
    found = re.search(r"interval (\d+)", error)
    return f"blown up at step {found.group(1)}" if code == 3 and found else f"failed ({code})"


def stability(full, again):
    """Rows of the matrix: case, choice, verdict."""
    rows = []
    for name, scene, files, overlay, body in hard_cases(full):
        choices = [(op, {"numerics": {"collision": op}}) for op in OPERATORS]
        if body:
            choices += [(f"{term} with auto", {"numerics": {"collision": "auto", "solid_term": "auto", **n}})
                        for term, n in BODIES.items() if term != "auto"]
        for choice, change in choices:
            folder = OUT / "stability" / re.sub(r"[^\w.]+", "_", f"{name}-{choice}")
            code, error, _ = run_scene(folder, scene, merged(overlay, change), files, again, 300.0)
            rows.append({"case": name, "choice": choice, "verdict": verdict(code, error, 0), "reason": error})
            progress("stability", f"{name} | {choice}: {rows[-1]['verdict']}")
    return rows


# ---- only what a scene needs -------------------------------------------------------------------------------------

EVERYTHING = {"numerics": {"smagorinsky": 1e-3}, "fluid": {"body_force": [1e-12, 0.0]}}
FEATURE_SCENES = {"taylor_green": {}, "cylinder_flow": {"run": {"end_time": 8.0}}, "lid_driven_cavity": {"run": {"end_time": 20.0}},
                  "settling_disc": {}, "couette_disc": {"run": {"end_time": 20.0}}, "disc_migration": {},
                  "drafting_kissing_tumbling": {}, "suspension_migration": {"run": {"end_time": 0.05}}}


def features(again):
    """Each scene as it is, and with a turbulence model, a body force, lubrication and a virtual mass that it does
    not need, which change nothing that could be seen: what leaving them out saves."""
    rows = []
    for scene, short in FEATURE_SCENES.items():
        coupled = (CASES / scene / "in.liggghts").exists()
        on = merged(short, EVERYTHING, {"coupling": {"lubrication_range": 1e-6, "virtual_mass": 1e-9}} if coupled else {})
        seconds, share, code = {}, {}, 0
        for name, overlay in (("as it is", short), ("everything on", on)):
            folder = OUT / "features" / f"{scene}-{name.replace(' ', '_')}"
            code = code or run_scene(folder, scene, overlay, (), again)[0]
            if not code:
                summary = Run(folder).summary
                seconds[name], share[name] = summary["cpu_seconds"], summary["time_share"]
        check = subprocess.run([str(ROOT / "build" / os.environ.get("BPLBM_PRESET", "release") / "bin" / "lbm"), "check",
                                str(CASES / scene / "scene.toml")], capture_output=True, text=True, check=False).stdout
        line = lambda key: (re.search(rf"^{key} +(.*)$", check, re.M) or ["", ""])[1]  # noqa: E731, B023
        rows.append({"scene": scene, "on": line("on"), "off": line("off"), "memory": line("cost").split(";")[0], "code": code,
                     "cpu_seconds": seconds, "time_share": share.get("as it is", {})})
        progress("features", f"{scene}: {seconds}")
    return rows


def text_of_features(rows):
    lines = ["## Only what a scene needs", "", "| scene | on | off | memory | share of the time | CPU s | with everything on |",
             "|---|---|---|---|---|---|---|"]
    for r in rows:
        share = ", ".join(f"{part} {100 * s:.0f} %" for part, s in r["time_share"].items() if s > 0.005)
        c = r["cpu_seconds"]
        both = f"{c['as it is']:.3g} | {c['everything on']:.3g} ({c['everything on'] / c['as it is']:.2f} ×)" if len(c) == 2 else "– | –"
        lines.append(f"| {r['scene']} | {r['on']} | {r['off']} | {r['memory']} | {share} | {both} |")
    return lines + [""]


# ---- tables and pictures -----------------------------------------------------------------------------------------


def progress(case, text):
    print(f"report | {case} | {text}", flush=True)


def measure(case, full, again):
    """One row a configuration, from one run or several places of the body."""
    scene, make_rows, value_of, reference, uncertainty, source = CASES_OF[case]
    module, rows = module_of(scene), []
    for label, family, size, places, files in make_rows(full):
        values, cpu, wall, steps, status, memory, summary = [], [], [], 0, "ok", 0.0, None
        for i, overlay in enumerate(places):
            folder = OUT / case / re.sub(r"[^\w.]+", "_", f"{label}-{size}-{i}")
            code, error, memory = run_scene(folder, scene, overlay, files, again)
            if code:
                status = verdict(code, error, 0)
                break
            run = Run(folder)
            summary = run.summary
            values.append(value_of(run, module))
            cpu.append(summary["cpu_seconds"])
            wall.append(summary["wall_seconds"] * (1 - summary["time_share"].get("waiting", 0.0)))
            steps = summary["steps"]
        errors = 100 * (np.array(values) / reference - 1)
        if status == "ok" and not np.all(np.abs(errors) < 1e3):
            status = "blown up"
        row = {"case": case, "scheme": label, "family": family or "", "choice": size, "status": status,
               "error_percent": float(errors.mean()) if status == "ok" else None,
               "spread_percent": float(np.ptp(errors)) if status == "ok" else None,
               "reference": reference, "reference_uncertainty_percent": 100 * uncertainty, "source": source,
               "cpu_seconds": float(np.mean(cpu)) if cpu else None, "seconds": float(np.mean(wall)) if wall else None,
               "steps": steps, "peak_megabytes": memory}
        if summary:
            row.update({key: summary[key] for key in ("mlups", "ma_max", "re_h", "mass_drift", "substeps")},
                       tau=summary["parameters"]["tau"], time_share=summary["time_share"], precision="double")
        rows.append(row)
        text = f"{row['error_percent']:+.2f} % (spread {row['spread_percent']:.2f}), {row['seconds']:.3g} s" \
            if status == "ok" else status
        progress(case, f"{label}, {size}: {text}")
    return rows


def doubt(row):
    """Error that a user must reckon with: mean and half of the spread over places, at least the reference's own."""
    return max(abs(row["error_percent"]) + row["spread_percent"] / 2, row["reference_uncertainty_percent"])


def front(rows):
    """Rows that no other beats in both time and error, from the cheapest on."""
    kept = []
    for r in sorted((r for r in rows if r["status"] == "ok"), key=lambda r: (r["seconds"], doubt(r))):
        if not kept or doubt(r) < doubt(kept[-1]):
            kept.append(r)
    return kept


def advantage(rows, family):
    """Against each row of another family's front: what ours needs less time for at most its error, and less error
    in at most its time (5 % of slack). Two lists of factors."""
    ours, cost, error = [r for r in rows if r["family"] == OURS and r["status"] == "ok"], [], []
    for other in front([r for r in rows if r["family"] == family]):
        cost += [max((other["seconds"] / r["seconds"] for r in ours if doubt(r) <= doubt(other)), default=0.0)]
        error += [max((doubt(other) / doubt(r) for r in ours if r["seconds"] <= 1.05 * other["seconds"]), default=0.0)]
    return cost, error


def said(factors):
    """A sentence's worth of a list of factors; 0 where none of ours is as exact, or as cheap."""
    good = [f for f in factors if f]
    if not good:
        return "never 1"
    text = f"{min(good):.2g}" if len(good) == 1 else f"{min(good):.2g} … {max(good):.2g}"
    return text + ("" if len(good) == len(factors) else f" (in {len(good)} of {len(factors)} points)")


def draw(case, rows):
    figure, axes = plt.subplots(figsize=(7.6, 4.6))
    colors = {label: f"C{i % 10}" for i, label in enumerate(SCHEMES)}
    for label in SCHEMES:
        mine = [r for r in rows if r["scheme"] == label]
        good = [r for r in mine if r["status"] == "ok"]
        if good:
            x = [r["seconds"] for r in good]
            y = [max(abs(r["error_percent"]), 1e-2) for r in good]
            axes.errorbar(x, y, yerr=[np.minimum([r["spread_percent"] / 2 for r in good], 0.9 * np.array(y)),
                                      [r["spread_percent"] / 2 for r in good]], fmt="o" if "default" in label else "s",
                          markersize=5 if "default" in label else 3.5, color=colors[label], elinewidth=0.6, label=label)
        for r in mine:
            if r["status"] != "ok":
                axes.plot(r["seconds"] or axes.get_xlim()[0], 100, "o", mfc="none", color=colors[label])
    kept = front(rows)
    axes.step([r["seconds"] for r in kept], [doubt(r) for r in kept], where="post", color="0.3", linewidth=0.8, zorder=0,
              label="front (error and half of the spread)")
    uncertainty = rows[0]["reference_uncertainty_percent"]
    if uncertainty > 1e-2:
        axes.axhspan(1e-2, uncertainty, color="0.9", zorder=-1)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("seconds of the fluid to the solution, one core")
    axes.set_ylabel("|error| [%]")
    axes.set_title(CASES_OF[case][5], fontsize=9)
    axes.legend(fontsize=6.5, bbox_to_anchor=(1.0, 1.0), loc="upper left")
    figure.savefig(OUT / f"{case}.png", bbox_inches="tight")
    plt.close(figure)


def draw_stability(rows):
    cases = list(dict.fromkeys(r["case"] for r in rows))
    choices = list(dict.fromkeys(r["choice"] for r in rows))
    table = {(r["case"], r["choice"]): r["verdict"] for r in rows}
    color = {"bounded": "#7fbf7f", "refused": "#f0d060", "": "white"}
    figure, axes = plt.subplots(figsize=(0.75 * len(choices) + 3.0, 0.36 * len(cases) + 1.6))
    for j, case in enumerate(cases):
        for i, choice in enumerate(choices):
            v = table.get((case, choice), "")
            axes.add_patch(plt.Rectangle((i, j), 1, 1, facecolor=color.get(v, "#e07070"), edgecolor="white"))
            if v.startswith("blown"):
                axes.text(i + 0.5, j + 0.5, v.split()[-1], ha="center", va="center", fontsize=6)
    axes.set_xlim(0, len(choices))
    axes.set_ylim(len(cases), 0)
    axes.set_xticks(np.arange(len(choices)) + 0.5, choices, rotation=40, ha="right", fontsize=7)
    axes.set_yticks(np.arange(len(cases)) + 0.5, cases, fontsize=7)
    axes.grid(False)
    axes.set_title("green bounded · yellow refused · red blown up, at step", fontsize=8)
    figure.savefig(OUT / "stability.png", bbox_inches="tight")
    plt.close(figure)


def machine():
    name = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())
    commit = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"], capture_output=True, text=True,
                            check=False).stdout.strip()
    compiler = subprocess.run(["c++", "--version"], capture_output=True, text=True, check=False).stdout.splitlines()[0]
    return f"commit {commit}, {compiler}, {name.group(1) if name else platform.processor()}, one core for the fluid"


def text_of(case, rows):
    lines = [f"## {case}: {CASES_OF[case][5]}", "", f"![{case}]({case}.png)", ""]
    for family, name in ((PAPERS, "the papers' scheme"), (STAIRS, "the staircase")):
        cost, error = advantage(rows, family)
        if not cost:
            lines.append(f"None of {name}'s runs here came to its end.  ")
            continue
        lines.append(f"Ours against the front of {name}: {said(cost)} times faster at its error, {said(error)} times more exact in its time.  ")
    good = [r for r in rows if r["family"] == OURS and r["status"] == "ok"]
    for wanted in (5.0, 2.0, 1.0):
        fitting = [r for r in good if doubt(r) <= wanted]
        if fitting:
            best = min(fitting, key=lambda r: r["seconds"])
            lines.append(f"For {wanted:g} % take {best['scheme']}, {best['choice']}: {best['seconds']:.3g} s.  ")
    lines += ["", "| scheme | choice | error % | spread % | seconds | steps | Re_h | Ma | status |", "|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        ok = r["status"] == "ok"
        lines.append(f"| {r['scheme']} | {r['choice']} | " + (f"{r['error_percent']:+.2f} | {r['spread_percent']:.2f} | "
                     f"{r['seconds']:.3g} | {r['steps']} | {r['re_h']:.3g} | {r['ma_max']:.3g}" if ok else "– | – | – | – | – | –")
                     + f" | {r['status']} |")
    return lines + [""]


def text_of_stability(rows):
    lines = ["## Stability on hard cases", "", "![stability](stability.png)", "", "| case | choice | verdict |", "|---|---|---|"]
    return lines + [f"| {r['case']} | {r['choice']} | {r['verdict']} |" for r in rows] + [""]


def main():
    names = [*CASES_OF, "stability", "features"]
    p = argparse.ArgumentParser(prog="tools/report", description=__doc__.splitlines()[0])
    p.add_argument("cases", nargs="*", metavar="CASE", help=f"of {', '.join(names)}; default: all")
    p.add_argument("--quick", action="store_true", help="under ten minutes (default)")
    p.add_argument("--full", action="store_true", help="more cells, steps and cases; under ninety minutes")
    p.add_argument("--again", action="store_true", help="run also what has been run before")
    args = p.parse_args()
    unknown = [c for c in args.cases if c not in names]
    if unknown:
        print(f"report | error | no case '{unknown[0]}'; there are: {', '.join(names)}", file=sys.stderr)
        return 2
    OUT.mkdir(parents=True, exist_ok=True)
    start, text, everything = time.monotonic(), [], []
    for case in args.cases or names:
        if case == "stability":
            rows = stability(args.full, args.again)
            draw_stability(rows)
            text += text_of_stability(rows)
            (OUT / "stability.json").write_text(json.dumps(rows, indent=1) + "\n")
            continue
        if case == "features":
            text += text_of_features(features(args.again))
            continue
        rows = measure(case, args.full, args.again)
        draw(case, rows)
        text += text_of(case, rows)
        everything += rows
    (OUT / "report.md").write_text("\n".join([f"# Speed against error\n\n{machine()}\n", *text]) + "\n")
    if everything:
        (OUT / "rows.json").write_text(json.dumps(everything, indent=1) + "\n")
        columns = [k for k in everything[0] if k != "time_share"]
        with open(OUT / "rows.csv", "w", newline="") as f:
            writer = csv.DictWriter(f, columns, extrasaction="ignore")
            writer.writeheader()
            writer.writerows(everything)
    print(f"report | {OUT / 'report.md'} after {time.monotonic() - start:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
