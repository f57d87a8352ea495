"""The hard cases: each is run with every operator and scheme, and asked for what its row says."""

import re
from collections.abc import Callable
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from pictures import Run
from report_cases import CASES_OF, array_run, step_of
from report_runs import OUT, is_coupled, merged, module_of, progress, run_scene, verdict

OPERATORS = ("bgk", "trt", "central_moment", "recursive_regularised")
AUTO, RULE = "auto", "by rule"
SOLIDS = {RULE: {}, "Noble–Torczynski": {"solid_term": "noble_torczynski"}, "Holdych": {"solid_term": "holdych"},
          "superposition": {"solid_term": "superposition"},
          "layered Noble–Torczynski": {"solid_term": "layered_noble_torczynski"},
          "layered Holdych": {"solid_term": "layered_holdych"},
          "B = ε": {"solid_term": "noble_torczynski", "weight": "fraction"}, "bounce-back": {"scheme": "bounce_back"},
          "interpolated bounce-back": {"scheme": "interpolated_bounce_back"},
          "implicit IBM": {"scheme": "implicit_immersed_boundary"}}
PAPERS = ("bgk", "Noble–Torczynski")


@dataclass
class Hard:
    """A row: what is asked of runs that differ by an overlay, all of which must come to their end."""

    name: str
    asked: str
    scene: str
    runs: list  # overlays
    judge: Callable = lambda runs: (True, "")  # of the runs -> whether it is met, value; None: told, not judged
    files: tuple = ()
    solids: bool = True  # without any, schemes do not differ
    stops: bool = False  # a run is to be stopped, not to come to its end


# ---- judges ------------------------------------------------------------------------------------------------------


def percent(part):
    """Text of a part of one."""
    return f"{100 * part:.2g} %" if abs(part) < 1 else f"{100 * part:.0f} %"


def force_of(run, begin, end):
    """Vertical force on the disc at each step of a time [s], over its weight."""
    p, table = run.parameters, run.probes()
    weight = p["particle_density"] * np.pi / 4 * p["diameter"]**2 * p["depth"] * -p["gravity_y"]
    return table["fy"][(table["time"] > begin) & (table["time"] < end)] / weight


def noise(begin, end):
    """Change of the force on a disc from one step to the next, rms over its weight: 5 %. (What a running mean of 50
    steps takes away is twice that, since it holds the passing of whole cells, of 23 steps each.)"""
    def judge(runs):
        change = np.std(np.diff(force_of(runs[0], begin, end)))
        return bool(change <= 0.05), percent(change)
    return judge


def jump(begin, end):
    """Largest change of the force on a disc from one step to the next over its weight: 5 %."""
    def judge(runs):
        largest = np.abs(np.diff(force_of(runs[0], begin, end))).max()
        return bool(largest <= 0.05), percent(largest)
    return judge


def rest(runs):
    """Largest speed of a disc over C: 1e-10."""
    p, table = runs[0].parameters, runs[0].probes()
    speed = np.hypot(table["vx"], table["vy"]).max() * p["time_step"] / p["cell"]
    return bool(speed <= 1e-10), f"{speed:.0e}"


def overshoot(runs):
    """Of the highest pressure over that of the inlet: 10 %."""
    run = runs[0]
    over = max(run.frame(name)["pressure"].max() for _, name in run.frames()) / 6.0e5 - 1
    return bool(over <= 0.1), f"{100 * over:+.0f} %"


def drags(runs):
    """Errors of the array's drag [%]."""
    scene, _, measure, exact, *_ = CASES_OF["array"]
    return [100 * (measure(run, module_of(scene)) / exact - 1) for run in runs]


def flat(runs):
    """Half of the range of the drag: 1 %."""
    half = np.ptp(drags(runs)) / 2
    return bool(half <= 1.0), f"±{half:.2g} %"


def told(runs):
    return None, " ".join(f"{e:+.0f}" for e in drags(runs)) + " %"


def drift(runs):
    """Of the mass in 1e5 steps: 1e-12."""
    s = runs[0].summary
    lost = abs(s["mass_drift"]) * 1e5 / s["steps"]
    return bool(lost <= 1e-12), f"{lost:.0e}"


def order(runs):
    """Distance of the ways of two discs that changed their numbers, over a diameter: 1e-10."""
    d = runs[0].parameters["diameter"]
    far = max(np.abs(runs[0].probes(a)[x] - runs[1].probes(3 - a)[x]).max() for a in (1, 2) for x in "xy") / d
    return bool(far <= 1e-10), f"{far:.0e}"


def crossing(runs):
    """Distance of the ways of a disc and of one half a period on, over a diameter: 1e-10."""
    p = runs[0].parameters
    a, b = (run.probes() for run in runs)
    along = b["x"] - a["x"] + 0.5 * p["box_x"]
    far = max(np.abs(along - p["box_x"] * np.round(along / p["box_x"])).max(), np.abs(a["y"] - b["y"]).max()) / p["diameter"]
    return bool(far <= 1e-10), f"{far:.0e}"


def alike(runs):
    """Range of the largest fall velocity over its mean: 1 %."""
    speeds = [-run.probes()["vy"].min() for run in runs]
    part = np.ptp(speeds) / np.mean(speeds)
    return bool(part <= 0.01), percent(part)


def rises(runs):
    """Velocities at the end [mm/s]."""
    return None, " ".join(f"{1e3 * run.probes()['vy'][-1]:.1f}" for run in runs) + " mm/s"


def channel(runs):
    """Errors of the mean velocity in the middle of poiseuille, driven by 8 Pa/m [%]."""
    errors = []
    for run in runs:
        p, u = run.parameters, run.frame(run.frames()[-1][1])["velocity"][:, :, 0]
        exact = 8.0 / p["density"] * p["box_y"]**2 / (12 * p["kinematic_viscosity"])
        errors.append(100 * (u[:, u.shape[1] // 2].mean() / exact - 1))
    return None, " ".join(f"{e:+.1f}" for e in errors) + " %"


# ---- cases ---------------------------------------------------------------------------------------------------------

QUIET = {"output": {"fields_every": 100.0, "probe_every": 0.01}}
EACH = {"output": {"fields_every": 100.0, "probe_every": 1e-6}}  # step
FREE = {"numerics": {"cells_per_diameter": 10, "solid_term": "auto", "collision": "auto"}}


def hard_cases(full):
    """Those that blow something up; in the full report also those that ask for a number alone."""
    yield Hard("cylinder Re 100, D/h 10, open channel", "bounded, or refused", "cylinder_flow",
               [{"run": {"end_time": 12.0 if full else 6.0}}], files=("variant-d10.toml",))
    for re_text, nu in (("1e4", 1e-4), ("1e5", 1e-5)):
        for u in (0.05, 0.1, 0.2) if full else (0.1,):  # a run refuses 0.2; the operators have a test of their own there
            yield Hard(f"shear layer Re {re_text}, u/C {u}", "bounded", "shear_layer",
                       [{"fluid": {"kinematic_viscosity": nu}, "numerics": {"time_step": u / 128}}], solids=False)
    fast = merged(EACH, {"fluid": {"velocity_scale": 0.3}, "numerics": {"cells_per_diameter": 12}, "run": {"end_time": 0.3}})
    yield Hard("settling Re 310, D/h 12, τ 0.505", "force noise ≤ 5 % of the weight a step", "settling_disc", [fast],
               noise(0.1, 0.28), ("variant-glowinski2.toml",))
    for ratio in (1.0, 0.75, 0.5, 0.1):
        light = merged(QUIET, FREE, {"particles": {"density": 1000.0 * ratio, "start": [[0.01, 0.02]]},
                                     "fluid": {"velocity_scale": 0.15}, "run": {"end_time": 0.25}})
        yield Hard(f"free disc, ρ_s/ρ_f {ratio:g}", "at rest to 1e-10 C" if ratio == 1.0 else "stable, or refused",
                   "settling_disc", [light], rest if ratio == 1.0 else Hard.judge)
        if ratio == 0.1 and full:
            yield Hard("free disc, ρ_s/ρ_f 0.1, virtual mass 0.5, 1, 2, 4", "told: it rises alike", "settling_disc",
                       [merged(light, {"coupling": {"virtual_mass": mass}}) for mass in (0.5, 1.0, 2.0, 4.0)], rises,
                       solids=False)
        if ratio == 0.1:
            yield Hard("free disc, ρ_s/ρ_f 0.1, no virtual mass", "told: what the default is for", "settling_disc",
                       [merged(light, {"coupling": {"virtual_mass": 0.0}})], lambda runs: (None, "bounded"), solids=False)
    yield Hard("free disc, τ = 1.5", "bounded", "couette_disc",
               [{"numerics": {"time_step": 0.00333}, "run": {"end_time": 10.0}}])
    yield Hard("pressure jump of 600 kPa into a packing", "overshoot < 10 %", "hydraulic_fracture",
               [{"output": {"fields_every": 2.5e-4, "probe_every": 1e-3}, "run": {"end_time": 0.003}}], overshoot)
    yield Hard("channel between pressures, Δρ/ρ 0.03, 0.01, 0.003", "error told; the step's rule allows 0.03", "poiseuille",
               [{"fluid": {"velocity_scale": 0.0099}, "numerics": {"time_step": 3.125e-4 / (3 * 0.04 / 1000 / change)**0.5}}
                for change in (0.03, 0.01, 0.003)], channel, ("variant-pressure.toml",), solids=False)
    if not full:
        return
    yield Hard("pressure jump, weak bonds: hundreds break at once", "bounded", "hydraulic_fracture",
               [merged(QUIET, {"run": {"end_time": 0.003}})], files=("variant-strength60.toml",))
    yield Hard("cavity Re 10 000", "bounded", "lid_driven_cavity", [{"run": {"end_time": 100.0}}],
               files=("variant-re10000.toml",), solids=False)
    yield Hard("array, τ 0.505 … 1.5, D/h 10", "drag flat within ±1 %", "cylinder_array",
               [array_run(tau, 5e-5) for tau in (0.505, 0.6, 1.5)], flat)
    yield Hard("array, D/h 2, 3, 4, 6, 8", "error told; no claim below 4", "cylinder_array",
               [array_run(0.8, 1e-3 / n) for n in (4, 6, 8, 12, 16)], told)
    for stiffness in ((1e-4, 1e-3), (1e-2,)):
        yield Hard(f"array, springs of {', '.join(map(str, stiffness))}", "told: what the default is for", "cylinder_array",
                   [merged(array_run(0.8, 5e-5), {"numerics": {"scheme": "spring_immersed_boundary", "spring_stiffness": k}})
                    for k in stiffness], told, solids=False)
    yield Hard("closed pores, 1e5 steps", "mass drift ≤ 1e-12", "cylinder_array",
               [array_run(0.8, 2.5e-5, [(x, y) for x in (0.0, 5e-4) for y in (0.0, 5e-4)], 5.1e-4,
                          end_time=1e5 * step_of(0.8, 2.5e-5), steady_below=0.0)], drift)
    yield Hard("a disc too fast for its step", "stopped at 0.2 C", "settling_disc",
               [merged(QUIET, FREE, {"fluid": {"velocity_scale": 0.02}, "run": {"end_time": 0.5}})], stops=True)
    yield Hard("two discs in one cell, numbered either way", "the same ways to 1e-10 D", "drafting_kissing_tumbling",
               [merged(EACH, FREE, {"particles": {"start": start}, "run": {"end_time": 0.2}})
                for start in ([[0.01, 0.07], [0.0101, 0.06799]], [[0.0101, 0.06799], [0.01, 0.07]])], order)
    yield Hard("a disc through a periodic side", "the way of one half a period on to 1e-10 D", "disc_migration",
               [merged(EACH, {"particles": {"start": [[x, 0.009]]}, "run": {"end_time": 0.08}}) for x in (0.0075, 0.0025)],
               crossing)
    yield Hard("settling Re 14, cells uncovered", "force jump ≤ 5 % of the weight a step", "settling_disc",
               [merged(EACH, FREE, {"run": {"end_time": 0.5}})], jump(0.1, 0.5))
    yield Hard("5 to 50 substeps", "fall velocity within 1 %", "settling_disc",
               [merged(FREE, {"output": {"fields_every": 100.0, "probe_every": 0.002}, "coupling": {"substeps": n},
                              "run": {"end_time": 0.5}}) for n in (5, 15, 50)], alike)


def choices(full, solids):
    """Operator and solids of each column."""
    if not solids:
        return [(op, RULE) for op in (AUTO, *OPERATORS)]
    if full:
        return [(AUTO, RULE), *((op, term) for term in SOLIDS for op in OPERATORS)]
    return [(op, RULE) for op in (AUTO, *OPERATORS)] + [(AUTO, term) for term in SOLIDS if term != RULE] + [PAPERS]


def stability(full, again):
    """A row for each case and choice: what became of it, whether it is what was asked, and the value."""
    rows = []
    for case in hard_cases(full):
        for operator, term in choices(full, case.solids):
            rows.append({"case": case.name, "asked": case.asked, "operator": operator, "solids": term,
                         **outcome(case, {"numerics": {"collision": operator, **rule_of(case), **SOLIDS[term]}}, again)})
            r = rows[-1]
            progress("stability", f"{case.name} | {operator}, {term}: {r['verdict']}{', ' + r['value'] if r['value'] else ''}"
                     + ("" if r["met"] is not False else ", missed"))
    return rows


def rule_of(case):
    """A scene that names its solid term leaves it to the rule here."""
    return {"solid_term": AUTO} if case.solids or is_coupled(case.scene) else {}


def outcome(case, change, again):
    runs = []
    for i, overlay in enumerate(case.runs):
        numerics = change["numerics"]
        name = "-".join([case.name, *(str(v) for v in numerics.values()), str(i)])
        folder = OUT / "stability" / re.sub(r"[^\w.]+", "_", name)
        code, error = run_scene(folder, case.scene, merged(overlay, change), case.files, again, 300.0)
        if case.stops and code == 3:
            return {"verdict": "stopped", "met": True, "value": verdict(code, error).split()[-1], "reason": error}
        if code:
            return {"verdict": verdict(code, error), "met": None, "value": "", "reason": error}
        runs.append(Run(folder))
    if case.stops:
        return {"verdict": "not stopped", "met": False, "value": "", "reason": ""}
    met, value = case.judge(runs)
    return {"verdict": "bounded", "met": met, "value": value, "reason": ""}


# ---- text and picture ----------------------------------------------------------------------------------------------


def kind_of(row):
    """One of met, told, missed, refused, blown up."""
    if row["verdict"] == "refused":
        return "refused"
    if row["verdict"].startswith(("blown", "failed")):
        return "blown up"
    return {True: "met", None: "told", False: "missed"}[row["met"]]


def text_of_stability(rows):
    lines = ["## Stability on hard cases", "", "![stability](stability.png)", "",
             "An operator with the solids that the scene's rule takes for it (*by rule*), or with others by name; `auto` and "
             "*by rule* is the default, *papers* what the papers take. Behind a choice: what was measured, or the step at which "
             "it blew up.", "",
             "| case | asked | default | met by | missed by | refused | blown up |", "|---|---|---|---|---|---|---|"]
    for case in dict.fromkeys(r["case"] for r in rows):
        mine = [r for r in rows if r["case"] == case]
        default = next(r for r in mine if (r["operator"], r["solids"]) == (AUTO, RULE))
        others = [r for r in mine if r is not default]
        listed = lambda *kinds: "; ".join(label(r) for r in others if kind_of(r) in kinds) or "–"  # noqa: E731, B023
        said = kind_of(default) + (f", {value_of(default)}" if value_of(default) else "")
        lines.append(f"| {case} | {mine[0]['asked']} | {said} | " + " | ".join(
            listed(*kinds) for kinds in (("met", "told"), ("missed",), ("refused",), ("blown up",))) + " |")
    return lines + [""]


def value_of(row):
    return row["value"] or (row["verdict"].split()[-1] if row["verdict"].startswith("blown") else "")


def name_of(operator, term):
    return f"{operator}, {term}" + (" (papers)" if (operator, term) == PAPERS else "")


def label(row):
    return name_of(row["operator"], row["solids"]) + (f" ({value_of(row)})" if value_of(row) else "")


COLORS = {"met": "#7fbf7f", "told": "#b9d9ee", "missed": "#f0b070", "refused": "#f0e070", "blown up": "#e07070"}


def draw_stability(rows):
    cases = list(dict.fromkeys(r["case"] for r in rows))
    columns = list(dict.fromkeys((r["operator"], r["solids"]) for r in rows))
    figure, axes = plt.subplots(figsize=(0.52 * len(columns) + 3.4, 0.36 * len(cases) + 2.2))
    for r in rows:
        x, y = columns.index((r["operator"], r["solids"])), cases.index(r["case"])
        axes.add_patch(plt.Rectangle((x, y), 1, 1, facecolor=COLORS[kind_of(r)], edgecolor="white"))
        text = value_of(r).removesuffix(" %").replace(" ", "\n")
        axes.text(x + 0.5, y + 0.5, text, ha="center", va="center", fontsize=5 if "\n" not in text else 3.5)
    axes.set_xlim(0, len(columns))
    axes.set_ylim(len(cases), 0)
    axes.set_xticks(np.arange(len(columns)) + 0.5, [name_of(*column) for column in columns], rotation=60, ha="right",
                    rotation_mode="anchor", fontsize=6)
    asked = {r["case"]: r["asked"] for r in rows}
    axes.set_yticks(np.arange(len(cases)) + 0.5, [f"{case}: {asked[case]}" for case in cases], fontsize=6.5)
    axes.grid(False)
    axes.set_title("green: as asked (value) · orange: bounded, but not as asked · blue: told · yellow: refused · "
                   "red: blown up, at step", fontsize=7)
    figure.savefig(OUT / "stability.png", bbox_inches="tight")
    plt.close(figure)
