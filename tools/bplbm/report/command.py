"""Speed against error of every choice, and which of them survive the hard cases.

    tools/report [--quick|--full] [CASE…]     --list names the cases

One run is one row: a scene of cases/ with an overlay, judged against a reference. What has been run is kept in
out/report and not run again (--again does). Writes report.md, the same as a page (index.html), rows.csv, rows.json and a
picture a case there.
"""

import argparse
import csv
import json
import pathlib
import platform
import re
import subprocess
import sys
import textwrap
import time

import matplotlib.pyplot as plt
from matplotlib.ticker import LogFormatterSciNotation
import numpy as np

from bplbm import pictures  # noqa: F401  (its style)
from bplbm.page.report import report_page
from bplbm.project import ROOT, tool
from bplbm.report.arrays import arrays, draw_arrays, text_of_arrays, write_arrays
from bplbm.report.cases import CASES_OF, FORMER, GROUPS, OURS, PAPERS, SCHEMES, STAIRS
from bplbm.report.details import details
from bplbm.report.fractions import fractions, text_of_fractions
from bplbm.report.needs import needs, text_of_needs
from bplbm.report.runs import OUT, module_of, progress, run_scene, verdict
from bplbm.report.seconds import doubt, text_of_seconds
from bplbm.report.speed import speed, text_of_speed
from bplbm.report.stability import draw_stability, stability, text_of_stability
from bplbm.results import Run
from bplbm.toml_text import toml

PASTED = ("fluid", "numerics", "coupling")  # tables of an overlay that a recommendation shows
COLUMNS = ("Error: mean over places of the body within a cell, spread: its range over them. Load σ: root mean square of what the "
           "measured load does beside a line in the last quarter of a run, over its mean; – where there are few records. "
           "Seconds: of the fluid, without waiting. `rows.csv` has some twenty columns more.")
WIDTH = 120  # columns of prose
SCATTER = 1.2  # of the time of the same run on a shared machine


# ---- tables and pictures -----------------------------------------------------------------------------------------


def measure(case, full, again):
    """One row a configuration, from one run or several places of the body."""
    asked = CASES_OF[case]
    module, rows, built = module_of(asked.scene), [], machine()
    for choice in asked.rows(full):
        label, size = choice.scheme, choice.size
        values, cpu, wall, steps, status, summary = [], [], [], 0, "ok", None
        for i, overlay in enumerate(choice.places):
            folder = OUT / case / re.sub(r"[^\w.]+", "_", f"{label}-{size}-{i}")
            code, error = run_scene(folder, asked.scene, overlay, choice.files, again)
            if code:
                status = verdict(code, error)
                break
            run = Run(folder)
            summary = run.summary
            values.append(asked.value(run, module))
            cpu.append(summary["cpu_seconds"])
            wall.append(summary["wall_seconds"] * (1 - summary["time_share"].get("waiting", 0.0)))
            steps = summary["steps"]
        errors = 100 * (np.array(values) / asked.reference - 1)
        if status == "ok" and not np.all(np.abs(errors) < 1e3):
            status = "blown up"
        row = {"case": case, "scheme": label, "family": choice.family or "", "choice": size, "status": status,
               "error_percent": float(errors.mean()) if status == "ok" else None,
               "spread_percent": float(np.ptp(errors)) if status == "ok" else None,
               "reference": asked.reference, "reference_uncertainty_percent": 100 * asked.uncertainty, "source": asked.source,
               "cpu_seconds": float(np.mean(cpu)) if cpu else None, "seconds": float(np.mean(wall)) if wall else None,
               "steps": steps, "overlay": toml({k: v for k, v in choice.places[0].items() if k in PASTED}), "built": built}
        if summary:
            row.update({key: summary[key] for key in ("mlups", "ma_max", "re_h", "mass_drift", "substeps", "time_share")},
                       tau=summary["parameters"]["tau"], megabytes=sum(summary["megabytes"].values()),
                       **details(case, run, choice.places[0], again))
        rows.append(row)
        text = f"{row['error_percent']:+.2f} % (spread {row['spread_percent']:.2f}), {row['seconds']:.3g} s" \
            if status == "ok" else status
        progress(case, f"{label}, {size}: {text}")
    return rows


def is_default(scheme):
    return scheme.startswith("default")


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


def recommended(rows, wanted):
    """The row to take for an error of at most `wanted` %, or nothing: the cheapest; of those as cheap as it within
    the scatter of a machine the default, and then the most exact."""
    fitting = [r for r in rows if r["family"] == OURS and r["status"] == "ok" and doubt(r) <= wanted]
    least = min((r["seconds"] for r in fitting), default=0.0)
    return min((r for r in fitting if r["seconds"] <= SCATTER * least),
               key=lambda r: (not is_default(r["scheme"]), doubt(r)), default=None)


def said(factors, better, none):
    """A part of a sentence on a list of factors; 0 where none of ours is as exact, or as cheap."""
    good = [f"{f:.2g}" if f < 10 else f"{f:.0f}" for f in sorted(factors) if f]
    if not good:
        return f"at no point {none}"
    text = good[0] if len(good) == 1 else f"{good[0]} … {good[-1]}"
    return f"{text} times {better}" + ("" if len(good) == len(factors) else f" (in {len(good)} of {len(factors)} points)")


def draw_unstable(axes, rows, colors):
    """Hollow marks along the top, for runs without an error or a time."""
    for i, r in enumerate(rows):
        axes.plot(0.16 + 0.022 * i, 0.97, "o", transform=axes.transAxes, mfc="none", markersize=5, color=colors[r["scheme"]])
    if rows:
        axes.set_ylim(top=3 * axes.get_ylim()[1])  # room for them
        axes.text(0.01, 0.97, "came to no end:", transform=axes.transAxes, va="center", fontsize=7)


def draw(case, rows):
    figure, axes = plt.subplots(figsize=(7.6, 4.6))
    labels = list(dict.fromkeys([*(s for s in SCHEMES if any(r["scheme"] == s for r in rows)),
                                 *(r["scheme"] for r in rows)]))
    colors = {label: plt.cm.tab20(2 * i % 20 + 2 * i // 20) for i, label in enumerate(labels)}
    for label in labels:
        mine = [r for r in rows if r["scheme"] == label]
        good = [r for r in mine if r["status"] == "ok"]
        if good:
            x = [r["seconds"] for r in good]
            y = [max(abs(r["error_percent"]), 1e-2) for r in good]
            axes.errorbar(x, y, yerr=[np.minimum([r["spread_percent"] / 2 for r in good], 0.9 * np.array(y)),
                                      [r["spread_percent"] / 2 for r in good]], fmt="o" if is_default(label) else "s",
                          markersize=5 if is_default(label) else 3.5, color=colors[label], elinewidth=0.6, label=label)
    kept = front(rows)
    axes.step([r["seconds"] for r in kept], [doubt(r) for r in kept], where="post", color="0.3", linewidth=0.8, zorder=0,
              label="front (error and half of the spread)")
    uncertainty = rows[0]["reference_uncertainty_percent"]
    if uncertainty > 1e-2:
        axes.axhspan(1e-2, uncertainty, color="0.9", zorder=-1)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(bottom=max(7e-3, axes.get_ylim()[0]))  # a mark on 1e-2 is at most that
    axes.xaxis.set_minor_formatter(LogFormatterSciNotation(minor_thresholds=(1.6, 0.5)))  # where decades are few
    draw_unstable(axes, [r for r in rows if r["status"] != "ok"], colors)
    axes.set_xlabel("seconds of the fluid to the solution, one core")
    axes.set_ylabel("|error| [%]")
    axes.set_title(CASES_OF[case].source, fontsize=9)
    axes.legend(fontsize=6.5, bbox_to_anchor=(1.0, 1.0), loc="upper left")
    figure.savefig(OUT / f"{case}.png", bbox_inches="tight")
    plt.close(figure)


def machine():
    name = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())
    commit = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"], capture_output=True, text=True,
                            check=False).stdout.strip()
    compiler = subprocess.run(["c++", "--version"], capture_output=True, text=True, check=False).stdout.splitlines()[0]
    return f"commit {commit}, {compiler}, {name.group(1) if name else platform.processor()}, one core for the fluid"


def text_of_recommended(rows):
    """What to take for an error of 5, 2 and 1 %, to be pasted into a scene; once where it is the same."""
    wanted = {}
    for limit in (5, 2, 1):
        if best := recommended(rows, limit):
            wanted.setdefault((best["scheme"], best["choice"]), (best, []))[1].append(str(limit))
    lines = []
    for best, limits in wanted.values():
        named = " and ".join([", ".join(limits[:-1]), limits[-1]] if limits[1:] else limits)
        lines += [f"For {named} % at Re_h {best['re_h']:.2g} take {best['scheme']}, {best['choice']}: {best['seconds']:.3g} s. "
                  "Here that is", "```toml", best["overlay"].rstrip("\n"), "```"]
    return lines


def text_of(case, rows):
    lines = [f"## {case}: {CASES_OF[case].source}", "", f"![{case}]({case}.png)", ""]
    lines += text_of_seconds(rows)
    for family, name in ((FORMER, "the former default"), (PAPERS, "the papers' scheme"), (STAIRS, "the staircase")):
        cost, error = advantage(rows, family)
        if not cost:
            lines.append(f"None of {name}'s runs here came to its end.  ")
            continue
        lines.append(f"Ours against the front of {name}: {said(cost, 'faster at its error', 'as exact')}, "
                     f"{said(error, 'more exact in its time', 'as cheap')}.  ")
    lines += [*text_of_recommended(rows), "", "| scheme | choice | error % | spread % | load σ % | seconds | steps | Re_h | Ma | status |",
              "|---|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        ok = r["status"] == "ok"
        noise = f"{r['load_sigma_percent']:.2g}" if ok and "load_sigma_percent" in r else "–"
        lines.append(f"| {r['scheme']} | {r['choice']} | " + (f"{r['error_percent']:+.2f} | {r['spread_percent']:.2f} | {noise} | "
                     f"{r['seconds']:.3g} | {r['steps']} | {r['re_h']:.3g} | {r['ma_max']:.3g}" if ok else "– |" * 6 + " –")
                     + f" | {r['status']} |")
    return lines + [""]


def wrapped(lines):
    """Prose of at most 120 columns; tables, pictures and headings as they are."""
    short = []
    for line in lines:
        if len(line) <= WIDTH or line.startswith(("|", "!", "#")):
            short.append(line)
            continue
        end = "  " if line.endswith("  ") else ""  # a break that stays
        short += textwrap.wrap(line, WIDTH - len(end), break_long_words=False, break_on_hyphens=False)
        short[-1] += end
    return short


def kept(name, rows):
    """Writes rows to a file of their own."""
    (OUT / f"{name}.json").write_text(json.dumps(rows, indent=1) + "\n")
    return rows


def arrays_case(args):
    rows = arrays(args.again)
    write_arrays(rows)
    draw_arrays(rows)
    return text_of_arrays(rows)


def stability_case(args):
    rows = kept("stability", stability(args.full, args.again))
    draw_stability(rows)
    return text_of_stability(rows)


OTHERS = {"arrays": arrays_case,
          "fractions": lambda args: text_of_fractions(fractions(args.again)),
          "stability": stability_case,
          "needs": lambda args: text_of_needs(kept("needs", needs(args.again)))}
BY_NAME = {"speed": lambda args: text_of_speed(kept("speed", speed(args.against, args.rounds)), args.rounds)}  # on idle cores


def main():
    names = [*CASES_OF, *OTHERS, *GROUPS, *BY_NAME]
    p = argparse.ArgumentParser(prog=tool("report"), description=__doc__.splitlines()[0])
    p.add_argument("cases", nargs="*", metavar="CASE", help=f"of {', '.join(names)}; default: all but speed")
    p.add_argument("--quick", action="store_true", help="about ten minutes (default)")
    p.add_argument("--full", action="store_true", help="more cells, steps and cases; under ninety minutes")
    p.add_argument("--list", action="store_true", help="the cases, and nothing else")
    p.add_argument("--look", action="store_true", help=argparse.SUPPRESS)  # at the arguments, and go
    p.add_argument("--against", metavar="DIR", help="of speed: lbm and liggghts of another build, which run in turns with ours")
    p.add_argument("--rounds", type=int, default=5, help="of speed: runs of each case and build (default 5)")
    p.add_argument("--again", action="store_true", help="run also what has been run before")
    args = p.parse_args()
    if args.list:
        print("\n".join([*(f"{name:16} {case.source}" for name, case in CASES_OF.items()),
                         *(f"{name:16} {' and '.join(cases)}" for name, cases in GROUPS.items()),
                         "arrays           error of the drag by solid fraction and cells a diameter",
                         "fractions        solid fraction of a cell: error and cost of some rules",
                         "stability        hard cases, each with every operator and scheme",
                         "needs            each scene against everything on, and its profile",
                         "speed            seconds a coupled second, beside another build with --against DIR"]))
        return 0
    unknown = [c for c in args.cases if c not in names]
    if unknown:
        print(f"report | error | no case '{unknown[0]}'; there are: {', '.join(names)}", file=sys.stderr)
        return 2
    if args.look:
        return 0
    OUT.mkdir(parents=True, exist_ok=True)
    start, text, everything = time.monotonic(), [], []
    for case in [one for name in args.cases or [*CASES_OF, *OTHERS] for one in GROUPS.get(name, (name,))]:
        if case in OTHERS or case in BY_NAME:
            text += {**OTHERS, **BY_NAME}[case](args)
            continue
        rows = measure(case, args.full, args.again)
        draw(case, rows)
        text += text_of(case, rows)
        everything += rows
    markdown = "\n".join(wrapped(["# Speed against error", "", machine(), "", COLUMNS, "", *text])) + "\n"
    (OUT / "report.md").write_text(markdown)
    (OUT / "index.html").write_text(report_page(markdown, OUT))
    if everything:
        (OUT / "rows.json").write_text(json.dumps(everything, indent=1) + "\n")
        columns = list(dict.fromkeys(key for row in everything for key in row if key != "time_share"))
        with open(OUT / "rows.csv", "w", newline="") as f:
            writer = csv.DictWriter(f, columns, extrasaction="ignore")
            writer.writeheader()
            writer.writerows(everything)
    print(f"report | {OUT / 'report.md'}, {OUT / 'index.html'} after {time.monotonic() - start:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
