"""Error of the drag by solid fraction and cells a diameter: scheme_report's table of arrays and a picture of it."""

import csv
import json
import subprocess

import matplotlib.pyplot as plt

from bplbm.project import BIN
from bplbm.report.runs import OUT, progress

NAMES = {"resistance": "default, bodies at rest: TRT, resistance",
         "layered_resistance": "default, free bodies: TRT, layered resistance",
         "holdych": "TRT, Holdych (former default)", "layered_holdych": "TRT, layered Holdych (former default)"}
DRAWN = (6, 10)  # cells a diameter, about


def arrays(again):
    """Rows of arrays at rest, of moving ones and of free bodies, from scheme_report."""
    kept = OUT / "arrays.json"
    if again or not kept.exists():
        subprocess.run([str(BIN / "scheme_report"), "--arrays", "--json", str(kept)], stdout=subprocess.DEVNULL,
                       timeout=900.0, check=True)
    rows = json.loads(kept.read_text())
    progress("arrays", f"{len(rows['rest'])} arrays at rest, {len(rows['moving'])} that move, {len(rows['free'])} with free bodies")
    return rows


def write_arrays(tables):
    """arrays.csv: the rows at rest, three digits."""
    with open(OUT / "arrays.csv", "w", newline="") as f:
        writer = csv.DictWriter(f, ("body", "solid_term", "fraction", "tau", "cells", "diameter", "error_percent",
                                    "spread_percent"), lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: round(value, 3) if key in ("diameter", "error_percent", "spread_percent") and value is not None
                          else value for key, value in row.items()} for row in tables["rest"])


def at_one(rows, body, term):
    """Rows at τ = 1 by solid fraction: dict fraction -> rows, small bodies first."""
    found = {}
    for r in rows:
        if (r["body"], r["solid_term"], r["tau"]) == (body, term, 1.0):
            found.setdefault(r["fraction"], {})[r["cells"]] = r  # one array is also in the table of τ
    return {fraction: [mine[n] for n in sorted(mine)] for fraction, mine in found.items()}


def draw_arrays(tables):
    rows = tables["rest"]
    figure, panels = plt.subplots(1, 2, figsize=(8.6, 3.6), sharey=True)
    for axes, wanted in zip(panels, DRAWN, strict=True):
        for i, (term, name) in enumerate(NAMES.items()):
            by_fraction = at_one(rows, "disc", term)
            near = [min(mine, key=lambda r: abs(r["diameter"] - wanted)) for mine in by_fraction.values()]
            axes.errorbar([r["fraction"] for r in near], [r["error_percent"] for r in near],
                          yerr=[r["spread_percent"] / 2 for r in near], fmt="o-" if i < 2 else "s--", markersize=4,
                          color=f"C{i}", elinewidth=0.8, capsize=2, label=name)
        axes.axhspan(-1, 1, color="0.92", zorder=-1)
        axes.axhline(0, color="0.3", linewidth=0.8)
        axes.set_xlabel("solid fraction of the array")
        axes.set_title(f"discs, about {wanted} cells a diameter, τ = 1", fontsize=9)
    panels[0].set_ylabel("error of the drag [%]\n(bar: range over places in a cell)")
    panels[0].legend(fontsize=6.5, loc="lower left")
    figure.tight_layout()
    figure.savefig(OUT / "arrays.png", bbox_inches="tight")
    plt.close(figure)


def cell(row):
    if row["error_percent"] is None:  # not a number, to JSON
        return "no end"
    return f"{row['error_percent']:+.2f} ({row['spread_percent']:.2f}) D{row['diameter']:.1f}"


def text_of_arrays(tables):
    rows = tables["rest"]
    lines = ["## Error of the drag by solid fraction", "", "![arrays](arrays.png)", "",
             "Square arrays of discs (Sangani and Acrivos 1982) and simple cubic ones of spheres (Zick and Homsy 1982) at rest in "
             "Stokes flow, τ = 1: error in per cent, mean over four places of the body within a cell, in brackets their range, "
             "and the cells a diameter, which a whole number of cells a period gives. The same as a list: [arrays.csv](arrays.csv), "
             "or `scheme_report --arrays --json FILE`.", ""]
    for term, name in NAMES.items():
        columns = max(len(mine) for mine in at_one(rows, "disc", term).values())
        lines += [f"**{name}**", "", "| array | " + " | ".join(f"D about {d}" for d in (4, 5, 6, 8, 10, 16)) + " |",
                  "|" + "---|" * (1 + columns)]
        lines += [f"| {body}s, c = {fraction} | " + " | ".join(map(cell, mine)) + " |"
                  for body in ("disc", "sphere") for fraction, mine in at_one(rows, body, term).items()] + [""]
    taus = sorted({r["tau"] for r in rows})
    lines += ["Discs, c = 0.2, ten cells a diameter, by relaxation time:", "",
              "| scheme | " + " | ".join(f"τ {tau}" for tau in taus) + " |", "|" + "---|" * (1 + len(taus))]
    for term, name in NAMES.items():
        mine = {r["tau"]: r for r in rows if (r["body"], r["fraction"], r["cells"], r["solid_term"]) == ("disc", 0.2, 20, term)}
        lines.append(f"| {name} | " + " | ".join(cell(mine[tau]) for tau in taus) + " |")
    lines += ["", "Discs that move through the lattice at Re_D = 0.1, τ = 1: error of the mean force and its standard deviation "
              "over the passage of four cells.", "", "| scheme | c | D/h | error % | σ % |", "|---|---|---|---|---|"]
    lines += [f"| {NAMES[r['solid_term']]} | {r['fraction']} | {r['diameter']:.1f} | {r['error_percent']:+.2f} | "
              f"{r['sigma_percent']:.2f} |" for r in tables["moving"]]
    lines += ["", "Free bodies, one a period, moved by their weight at Re_D = 0.1 as a coupled run moves them, the fluid driven against "
              "them, τ = 1: error of the drag and standard deviation of the force.", "",
              "| scheme | array | D/h | density over the fluid's | error % | σ % |", "|---|---|---|---|---|---|"]
    lines += [f"| {NAMES[r['solid_term']]} | {r['body']}s, c = {r['fraction']} | {r['diameter']:.1f} | {r['ratio']} | "
              f"{r['error_percent']:+.2f} | {r['sigma_percent']:.2f} |" for r in tables["free"]]
    return lines + [""]
