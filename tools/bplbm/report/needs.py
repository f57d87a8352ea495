"""Only what a scene needs: what each shipped scene has on and off, what its parts take of time and memory, what
leaving the others out saves, and where a coupled interval goes on both sides."""

import re
import subprocess

from bplbm.costs import SOLID, solid_seconds
from bplbm.project import CASES
from bplbm.project import BIN
from bplbm.report.cases import BEGINNINGS
from bplbm.report.runs import OUT, is_coupled, merged, progress, run_scene
from bplbm.results import Run
from bplbm.scenes import find, scenes

ROUNDS = 2  # of each scene as it is and with everything on, in turn; the faster counts
FLUID = ("placing", "sweep", "loads", "exchange", "waiting", "output")


def everything_on(scene):
    """Overlay of what a scene leaves out and could have, so weak that it changes nothing that could be seen."""
    tables = find(scene).tables()
    numerics, fluid, coupling = (tables.get(name, {}) for name in ("numerics", "fluid", "coupling"))
    overlay = {}
    if not numerics.get("smagorinsky"):
        overlay["numerics"] = {"smagorinsky": 1e-3}
    if not fluid.get("body_force"):
        overlay["fluid"] = {"body_force": [1e-12] + [0.0] * (len(tables["box"]["size"]) - 1)}
    if is_coupled(scene):
        weak = {"lubrication_range": 1e-9, "virtual_mass": 1e-9}
        overlay["coupling"] = {key: value for key, value in weak.items() if not coupling.get(key)}
    return overlay


def beginning(scene):
    """Overlay that ends a long scene early."""
    return {"run": {"end_time": BEGINNINGS[scene]}} if scene in BEGINNINGS else {}


def step_of(summary):
    """Microseconds of the fluid's own work a step."""
    return 1e6 * summary["wall_seconds"] * (1 - summary["time_share"].get("waiting", 0.0)) / summary["steps"]


def needs(again):
    """A row a scene with a fluid."""
    return [row_of(scene, again) for scene in scenes() if not find(scene).is_solid_alone]


def row_of(scene, again):
    short, runs, code = beginning(scene), {}, 0
    for i in range(ROUNDS):
        for name, overlay in (("as it is", short), ("everything on", merged(short, everything_on(scene)))):
            folder = OUT / "needs" / f"{scene}-{name.replace(' ', '_')}-{i}"
            code = code or run_scene(folder, scene, overlay, (), again)[0]
            if not code:
                runs.setdefault(name, []).append(Run(folder))
    best = {name: min(done, key=lambda run: step_of(run.summary)) for name, done in runs.items()}
    row = {"scene": scene, "code": code, **switches(scene), "step": {n: step_of(r.summary) for n, r in best.items()}}
    if "as it is" in best:
        summary = best["as it is"].summary
        row.update({key: summary[key] for key in ("time_share", "megabytes", "physical_seconds")})
        if is_coupled(scene):
            row["interval"] = interval_of(best["as it is"])
    progress("needs", f"{scene}: " + ", ".join(f"{name} {s:.4g} µs a step" for name, s in row["step"].items()))
    return row


def switches(scene):
    """What `lbm check` says is on and off."""
    text = subprocess.run([str(BIN / "lbm"), "check", str(CASES / scene / "scene.toml")], capture_output=True, text=True,
                          check=False).stdout
    return {key: (re.search(rf"^{key} +(.*)$", text, re.M) or ["", ""])[1] for key in ("on", "off")}


def interval_of(run):
    """Microseconds of the parts of a coupling interval: {"fluid": …, "solid": …, "whole": …, "intervals": n}."""
    summary = run.summary
    intervals = round(summary["physical_seconds"] / run.parameters["interval"])
    whole = 1e6 * summary["wall_seconds"] / intervals
    return {"intervals": intervals, "whole": whole,
            "fluid": {part: whole * summary["time_share"].get(part, 0.0) for part in FLUID},
            "solid": solid_parts((run.folder / "liggghts.log").read_text(), intervals)}


def solid_parts(log, intervals):
    """Microseconds of an interval from a log of LIGGGHTS."""
    return {part: 1e6 * s / intervals for part, s in solid_seconds(log).items()}


# ---- text --------------------------------------------------------------------------------------------------------


def shares(parts):
    """The parts above half a percent, the largest first."""
    whole = sum(parts.values())
    return ", ".join(f"{part} {100 * p / whole:.0f} %" for part, p in sorted(parts.items(), key=lambda i: -i[1])
                     if p > 0.005 * whole)


def text_of_needs(rows):
    lines = ["## Only what a scene needs", "",
             "Each scene as it is, and with the turbulence model, body force, lubrication and virtual mass that it does not "
             "ask for, so weak that they change nothing to be seen (`auto` then takes other collisions, as it would): "
             f"microseconds of the fluid's own work a step, the faster of {ROUNDS} runs in turn. Of a long scene its beginning, "
             "in which output, written first and last, has more than its share.", "",
             "| scene | until | on | off | share of the time | memory | µs a step | with everything on |",
             "|---|---|---|---|---|---|---|---|"]
    for r in rows:
        if r["code"]:
            lines.append(f"| {r['scene']} | – | {r['on']} | {r['off']} | – | – | failed ({r['code']}) | – |")
            continue
        plain, full = (r["step"][name] for name in ("as it is", "everything on"))
        size = sum(r["megabytes"].values())
        memory = f"{size:.3g} MB" + (f": {shares(r['megabytes'])}" if len(r["megabytes"]) > 1 else "")
        lines.append(f"| {r['scene']} | {r['physical_seconds']:.3g} s | {r['on']} | {r['off']} | {shares(r['time_share'])} | "
                     f"{memory} | {plain:.3g} | {full:.3g} ({full / plain:.2f} ×) |")
    return lines + [""] + text_of_intervals([r for r in rows if "interval" in r])


def text_of_intervals(rows):
    lines = ["## Where a coupled interval goes", "",
             "Microseconds of the same runs, one thread of the fluid beside one rank of LIGGGHTS: what the fluid does, and "
             "what the solid does meanwhile (its other work: integration, walls, bonds, its side of the exchange).", "",
             f"| scene | intervals | one takes | fluid: {' | '.join(FLUID)} | solid: {' | '.join([*SOLID, 'waiting'])} |",
             "|" + "---|" * (3 + len(FLUID) + len(SOLID) + 1)]
    for r in rows:
        i = r["interval"]
        numbers = [i["whole"], *i["fluid"].values(), *i["solid"].values()]
        lines.append(f"| {r['scene']} | {i['intervals']} | "
                     + " | ".join(f"{n:.0f}" if n >= 10 else f"{n:.1f}" for n in numbers) + " |")
    return lines + [""]
