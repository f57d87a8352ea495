"""Stability: runs the hard cases with each operator and scheme, and tells what became of them."""

import json
import re
import subprocess

import matplotlib.pyplot as plt
import numpy as np

from bplbm.project import BIN
from bplbm.report.hard import STEPS, hard_cases
from bplbm.report.runs import OUT, is_coupled, merged, progress, run_scene, verdict
from bplbm.results import Run

OPERATORS = ("bgk", "trt", "central_moment", "recursive_regularised")
AUTO, RULE = "auto", "by rule"
SOLIDS = {RULE: {}, "Noble–Torczynski": {"solid_term": "noble_torczynski"}, "Holdych": {"solid_term": "holdych"},
          "superposition": {"solid_term": "superposition"},
          "layered Noble–Torczynski": {"solid_term": "layered_noble_torczynski"},
          "layered Holdych": {"solid_term": "layered_holdych"}, "resistance": {"solid_term": "resistance"},
          "layered resistance": {"solid_term": "layered_resistance"},
          "B = ε": {"solid_term": "noble_torczynski", "weight": "fraction"}, "bounce-back": {"scheme": "bounce_back"},
          "interpolated bounce-back": {"scheme": "interpolated_bounce_back"},
          "implicit IBM": {"scheme": "implicit_immersed_boundary"}}
PAPERS = ("bgk", "Noble–Torczynski")
WILD = 1e3  # cells, C, or forces in lattice units: on its way to infinity


def choices(full, solids):
    """Operator and solids of each column."""
    if not solids:
        return [(op, RULE) for op in (AUTO, *OPERATORS)]
    if full:
        return [(AUTO, RULE), *((op, term) for term in SOLIDS for op in OPERATORS if op == "trt" or "resistance" not in term)]
    return [(op, RULE) for op in (AUTO, *OPERATORS)] + [(AUTO, term) for term in SOLIDS if term != RULE] + [PAPERS]


def stability(full, again):
    """A row for each case and choice: what became of it, whether it is what was asked, and the value."""
    rows = [row_of(case, operator, term, outcome(case, {"collision": operator, **rule_of(case), **SOLIDS[term]}, again))
            for case in hard_cases(full) for operator, term in choices(full, case.solids)]
    values = {(operator, term): step_values({"collision": operator, **SOLIDS[term]}, again)
              for operator, term in choices(full, True)}
    return rows + [row_of(case, *choice, outcome_of_steps(case, values[choice]))
                   for case in STEPS for choice in choices(full, True)]


def row_of(case, operator, term, became):
    row = {"case": case.name, "asked": case.asked, "operator": operator, "solids": term, **became}
    progress("stability", f"{case.name} | {operator}, {term}: {row['verdict']}{', ' + row['value'] if row['value'] else ''}"
             + ("" if row["met"] is not False else ", missed"))
    return row


def rule_of(case):
    """A scene that names its solid term leaves it to the rule here."""
    return {"solid_term": AUTO} if case.solids or is_coupled(case.scene) else {}


def folder_of(*words):
    return OUT / "stability" / re.sub(r"[^\w.]+", "_", "-".join(map(str, words)))


def outcome(case, numerics, again):
    runs = []
    for i, overlay in enumerate(case.runs):
        folder = folder_of(case.name, *numerics.values(), i)
        ranks = case.ranks[i] if case.ranks else 1
        code, error = run_scene(folder, case.scene, merged(overlay, {"numerics": numerics}), case.files, again, 300.0, ranks)
        if case.stops and code == 3:
            return {"verdict": "stopped", "met": True, "value": verdict(code, error).split()[-1], "reason": error}
        if code:
            return {"verdict": verdict(code, error), "met": None, "value": "", "reason": error}
        runs.append(Run(folder))
    if case.stops:
        return {"verdict": "not stopped", "met": False, "value": "", "reason": ""}
    met, value = case.judge(runs)
    return {"verdict": "bounded", "met": met, "value": value, "reason": ""}


def step_values(numerics, again):
    """What step_report measures with a choice of numerics: one value a case, or several; None where not finite."""
    kept = folder_of("steps", *numerics.values()).with_suffix(".json")
    if again or not kept.exists():
        words = [word for key, value in numerics.items() for word in (f"--{key.replace('_', '-')}", value)]
        done = subprocess.run([str(BIN / "step_report"), *words], capture_output=True, text=True,
                              timeout=300.0, check=True)
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(done.stdout)
    return json.loads(kept.read_text())


def outcome_of_steps(case, values):
    asked = [value for key in case.judge.keys for value in np.ravel(values[key])]
    if not all(value is not None and abs(value) < WILD for value in asked):
        return {"verdict": "blown up", "met": None, "value": "", "reason": ""}
    met, value = case.judge(values)
    return {"verdict": "bounded", "met": bool(met), "value": value, "reason": ""}


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
    blown_up = re.search(r"blown up at step (\d+)", row["verdict"])
    return row["value"] or (blown_up.group(1) if blown_up else "")


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
