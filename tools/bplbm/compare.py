"""Results of runs of one scene side by side: what they took, what came out, how long they went alike.

    tools/compare out/soil_erosion out/soil_erosion-literal

Differences are to the first folder. Exit code 2 if a folder holds no finished run.
"""

import argparse
import pathlib
import sys

import numpy as np

from bplbm.project import tool
from bplbm.results import Run, read_table

ALIKE = 1e-10


def rows(run):
    """What is shown of a run: dict of (name, unit) -> number."""
    s, p = run.summary, run.parameters
    shown = {("cell", "m"): p["cell"], ("time step", "s"): p["time_step"],
             ("fluid steps", "1"): s["steps"], ("solid substeps", "1"): s.get("substeps", 0),
             ("physical time", "s"): s["physical_seconds"], ("wall time", "s"): s["wall_seconds"],
             ("CPU time of the fluid", "s"): s["cpu_seconds"], ("Re_h", "1"): s["re_h"]}
    for number in s.get("quantities", []) + s.get("results", []):
        shown[number["name"], number["unit"]] = number["value"]
    return shown


def headings(runs):
    """What each column is: set and variant, with the scene where there are several, or folders where these do not tell."""
    several = len({r.summary["scene"] for r in runs}) > 1
    names = [" ".join(w for w in (r.summary["scene"] if several else "", r.summary["set"], r.summary["variant"]) if w) for r in runs]
    return names if len(set(names)) == len(names) else [str(r.folder) for r in runs]


def notes(runs):
    """What to know before one compares: that scenes differ, that a run was cut short."""
    names = sorted({r.summary["scene"] for r in runs})
    mixed = [f"these are runs of different scenes, {', '.join(names)}: numbers of the same name may mean different things"]
    return (mixed if len(names) > 1 else []) + [f"{r.folder}: not judged: {r.summary['not_judged']}" for r in runs
                                                if "not_judged" in r.summary]


def parted(run, other):
    """Time at which two runs' particles differ by more than ALIKE of the box or of the largest speed, and the
    difference then; (None, largest difference) if never."""
    a, b = (read_table(r.folder / "probes.csv") for r in (run, other))
    length, speed = run.parameters["box_x"], np.hypot(a["vx"], a["vy"]).max()
    states = [{(t, i): values for t, i, *values in zip(*(table[c] for c in ("time", "id", "x", "y", "vx", "vy")))}
              for table in (a, b)]
    largest = 0.0
    for key in sorted(states[0].keys() & states[1].keys()):
        dx, dy, du, dv = np.abs(np.subtract(states[0][key], states[1][key]))
        difference = max(dx / length, dy / length, du / speed, dv / speed)
        if difference > ALIKE:
            return key[0], difference
        largest = max(largest, difference)
    return None, largest


def main():
    p = argparse.ArgumentParser(prog=tool("compare"), description=__doc__.splitlines()[0])
    p.add_argument("folders", nargs="*", metavar="FOLDER", help="output folders, as out/soil_erosion")
    p.add_argument("--list", action="store_true", help="the finished runs in out/, and nothing else")
    p.add_argument("--parting", action="store_true", help="say also how long the particles go alike")
    args = p.parse_args()
    if args.list:
        print("\n".join(sorted(str(path.parent) for path in pathlib.Path("out").glob("*/summary.json"))))
        return 0
    if not args.folders:
        p.error("which runs? --list shows those in out/")
    runs = []
    for folder in args.folders:
        try:
            runs.append(Run(folder))
        except FileNotFoundError as e:  # it says what there is instead
            print(f"compare | error | {e}", file=sys.stderr)
            return 2
        except (OSError, ValueError) as e:
            why = e.strerror if isinstance(e, OSError) else e
            print(f"compare | error | {folder}/summary.json: {why}; this is no finished run: run the scene first",
                  file=sys.stderr)
            return 2
    first = rows(runs[0])
    for note in notes(runs):
        print(f"compare | note | {note}", file=sys.stderr)
    print("| |" + "".join(f" {heading} |" for heading in headings(runs)))
    print("|---|" + "---|" * len(runs))
    for name, unit in first:
        line = f"| {name}{'' if unit == '1' else ' [' + unit + ']'} | {first[name, unit]:.4g} |"
        for run in runs[1:]:
            value, base = rows(run).get((name, unit)), first[name, unit]
            change = f" ({100 * (value / base - 1):+.1f} %)" if value is not None and base and np.isfinite(base) else ""
            line += " – |" if value is None else f" {value:.4g}{change} |"
        print(line)
    for run in runs[1:] if args.parting else []:
        at, largest = parted(runs[0], run)
        print(f"compare | {run.folder}: particles alike to {ALIKE:g} "
              + (f"until {at:.6g} s (then {largest:.1e})" if at is not None else f"to the end (largest difference {largest:.1e})"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
