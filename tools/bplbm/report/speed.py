"""Seconds that a coupled second takes from start to end, by size and packing fraction, beside another build.

Both builds run every case in turns on one core, fluid and solid together, so that what else the machine does meets both
alike; what counts is the ratio of neighbours. Discs or spheres of ten cells on a lattice sink in a box that is periodic
but for its floor and lid, ten substeps of LIGGGHTS an interval.
"""

import itertools
import json
import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np

from bplbm.mpi_job import environment
from bplbm.project import BIN, CASES
from bplbm.report.runs import ONE_MACHINE, OUT, progress

CELL, CELLS_A_DIAMETER = 1e-3, 10
FULL = {2: np.pi / 4, 3: np.pi / 6}  # of a box that they fill where they touch
DENSITY, SPEED, VISCOSITY, GRAVITY = 1200.0, 0.05, 1e-5, 0.1
LIMIT = 600.0  # seconds of a run

# dimension, cells along an axis, fraction of the box, steps: of one to three seconds each
CASES_OF_SPEED = [(3, 64, 0.15, 300), (3, 101, 0.0, 150), (3, 101, 0.05, 100), (3, 101, 0.15, 80), (3, 101, 0.40, 50),
                  (3, 160, 0.15, 20), (2, 200, 0.10, 8000), (2, 800, 0.10, 500), (2, 800, 0.40, 300)]

SCENE = """title = "speed"
[box]
size = {size}
{periodic}
[fluid]
density = 1000.0
kinematic_viscosity = {viscosity}
gravity = {gravity}
velocity_scale = {speed}
[particles]
diameter = {diameter}
density = {density}
contact_stiffness = 200.0
[particles.variables]
damping_ratio = 0.5
[numerics]
cell = {cell}
[coupling]
substeps = 10
[run]
end_time = {end}
[output]
probe_every = {end}
"""


def counts_of(dimension, cells, fraction):
    """Bodies along each axis that together come nearest to the fraction."""
    wanted = fraction * cells ** dimension / (FULL[dimension] * CELLS_A_DIAMETER ** dimension)
    most, low = int(cells / (1.01 * CELLS_A_DIAMETER)), int(wanted ** (1 / dimension))
    choices = itertools.product([max(1, min(most, low + more)) for more in (0, 1)], repeat=dimension)
    return min(choices, key=lambda counts: abs(np.prod(counts) - wanted))


def centres(dimension, cells, fraction):
    """Of bodies of ten cells on a lattice that fill a part of the box, one where that is none; shifted from layer to layer, so
    that no two lie alike in their cells [m]."""
    counts = counts_of(dimension, cells, fraction)
    grid = np.stack(np.meshgrid(*[(np.arange(n) + 0.5) * cells / n for n in counts], indexing="ij"), axis=-1)
    grid = grid.reshape(-1, dimension)
    room = min(1.0, *(0.4 * (cells / n - CELLS_A_DIAMETER) for n in counts))
    return CELL * (grid + room * (np.modf(grid.sum(axis=1) * 0.618)[0] - 0.5)[:, None])


def write_case(folder, dimension, cells, fraction, steps):
    folder.mkdir(parents=True, exist_ok=True)
    step = CELL / (10.0 * SPEED)  # as the plan has it: C = 10 × the characteristic velocity
    box = f"[{', '.join([str(CELL * cells)] * dimension)}]"
    down = [0.0] * (dimension - 1) + [-GRAVITY]
    (folder / "scene.toml").write_text(SCENE.format(
        size=box, periodic="\n".join(f'sides_{a} = "periodic"' for a in "xyz"[:dimension - 1]), gravity=down, speed=SPEED,
        viscosity=VISCOSITY, diameter=CELL * CELLS_A_DIAMETER, density=DENSITY, cell=CELL, end=step * steps))
    atoms = "".join(f"create_atoms 1 single {x[0]:.12g} {x[1]:.12g} {x[2] if dimension == 3 else 0.0:.12g} units box\n"
                    for x in centres(dimension, cells, fraction))
    common = CASES / "common"
    (folder / "in.liggghts").write_text((common / "box.liggghts").read_text() + atoms +
                                        (common / f"{'spheres' if dimension == 3 else 'discs'}.liggghts").read_text())


def run(bins, folder, name):
    """@return the summary of a run with the programs of a folder, both on one core"""
    out = folder / name
    shutil.rmtree(out, ignore_errors=True)
    core = min(os.sched_getaffinity(0))
    line = ["taskset", "-c", str(core), "mpirun", "--bind-to", "none", "--oversubscribe", "-np", "1", str(bins / "lbm"),
            "scene.toml", "--out", name, "--progress", "none", ":", "-np", "1", str(bins / "liggghts"), "-in", "in.liggghts",
            "-screen", "none", "-log", "none"]
    job = subprocess.run(line, cwd=folder, env={**environment(shared=True), **ONE_MACHINE}, capture_output=True, text=True,
                         timeout=LIMIT, check=False)
    if job.returncode:
        print(f"report | error | speed: {bins}/lbm in {folder}: {(job.stdout + job.stderr).strip().splitlines()[-1]}",
              file=sys.stderr)
        sys.exit(1)
    return json.loads((out / "summary.json").read_text())


def seconds_a_second(summary):
    return summary["wall_seconds"] / summary["physical_seconds"]


def quartiles(values):
    return [float(q) for q in np.percentile(values, [25, 50, 75])]


def speed(against, rounds, cases=None):
    """A row a case. @param against  folder with lbm and liggghts of another build, or None"""
    builds = {"this": BIN} | ({"other": pathlib.Path(against).resolve()} if against else {})
    for bins in builds.values():
        if not all((bins / program).exists() for program in ("lbm", "liggghts")):
            print(f"report | error | --against {bins}: lbm or liggghts is not there; give the bin folder of a build",
                  file=sys.stderr)
            sys.exit(2)
    rows = []
    for dimension, cells, fraction, steps in cases or CASES_OF_SPEED:
        folder = OUT / "speed" / f"{dimension}d-{cells}-{fraction:g}"
        write_case(folder, dimension, cells, fraction, steps)
        times, summary = {name: [] for name in builds}, {}
        for i in range(rounds):
            for name in list(builds)[::1 if i % 2 == 0 else -1]:  # each goes first as often as second
                summary[name] = run(builds[name], folder, name)
                times[name].append(seconds_a_second(summary[name]))
        row = {"dimension": dimension, "cells": cells, "fraction": fraction, "bodies": len(centres(dimension, cells, fraction)),
               "steps": summary["this"]["steps"], "seconds": quartiles(times["this"]), "mlups": float(np.median(
                   [summary["this"]["cells"] * summary["this"]["steps"] / 1e6 / t / summary["this"]["physical_seconds"]
                    for t in times["this"]]))}
        if against:
            row["other"] = quartiles(times["other"])
            row["ratio"] = quartiles(np.array(times["other"]) / np.array(times["this"]))
        rows.append(row)
        progress("speed", line_of(row))
    return rows


def spread(q):
    return f"{q[1]:.3g} ({q[0]:.3g} … {q[2]:.3g})"


def line_of(row):
    text = (f"| {row['dimension']}D {row['cells']}{'²' if row['dimension'] == 2 else '³'} | {100 * row['fraction']:.0f} % "
            f"({row['bodies']}) | {spread(row['seconds'])} | {row['mlups']:.0f} |")
    return text + (f" {spread(row['other'])} | {spread(row['ratio'])} |" if "ratio" in row else "")


def text_of_speed(rows, rounds):
    both = rows and "ratio" in rows[0]
    head = "| box | solid (bodies) | s a coupled second | million updates/s |" + (" other build | times as fast |" if both else "")
    return ["## Seconds of a coupled second", "",
            f"From start to end, fluid and solid on one core, {rounds} runs each{' in turns' if both else ''}: median (quartiles)"
            + ("; times as fast: of neighbours in time." if both else "."), "",
            head, "|" + "---|" * (head.count("|") - 1), *[line_of(row) for row in rows], ""]
