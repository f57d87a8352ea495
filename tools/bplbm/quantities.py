"""Numbers that every run has, without a plot.py: of its particles and bonds, at the end and at most; of a flow past solids
its flux and the permeability."""

import h5py
import numpy as np

from bplbm.results import quantity, read_table

ALONE = -1  # the carrier of what is no part of a clump
STEADY = 0.01  # part by which a flux changes from the frame before the last to the last


def default_quantities(run):
    """Quantities of a Run that its scene does not judge: broken bonds, speeds and ways of the particles."""
    found = []
    breaks = run.folder / "breaks.csv"
    if breaks.is_file():
        found.append(quantity("broken bonds", len(breaks.read_text().splitlines()) - 1, "1"))
    probes = run.folder / "probes.csv"
    if probes.is_file() and len(probes.read_text().splitlines()) > 1:
        box = {axis: run.parameters[f"box_{axis}"] for axis in "xyz" if f"box_{axis}" in run.parameters}
        table = read_table(probes)
        whole = ~np.isin(table["id"], spheres_of_clumps(run))
        found += of_particles({name: column[whole] for name, column in table.items()}, box, run.summary["physical_seconds"])
    return found + of_flux(run)


def of_flux(run):
    """Mean velocity over the box in the last frame of a Run whose fluid a steady force, or a pressure difference across
    periodic sides, drives past solids, and the permeability k = ν U/g that it gives where it no longer changes and
    the viscosity is one."""
    p = run.parameters
    drive = {axis: p.get(f"body_force_{axis}", 0.0) + p.get(f"pressure_jump_{axis}", 0.0) / (p.get("density", 1.0) * p.get(f"box_{axis}", 1.0))
             for axis in "xyz"}
    if not any(drive.values()) or not (run.folder / "fields.h5").is_file():
        return []
    frames = run.frames()
    flux = dict(zip("xyz", run.flux(frames[-1][1]))) if frames else {}
    before = dict(zip("xyz", run.flux(frames[-2][1]))) if len(frames) > 1 else {}
    newtonian = "share_at_rest_bound" not in p
    found = []
    for axis, mean in flux.items():
        if not drive[axis]:
            continue
        found.append(quantity(f"mean velocity along {axis}, solids included", mean, "m/s"))
        if newtonian and abs(mean - before.get(axis, 0.0)) < STEADY * abs(mean):
            found.append(quantity(f"permeability along {axis}", p["kinematic_viscosity"] * mean / drive[axis], "m²"))
    return found


def spheres_of_clumps(run):
    """Numbers of the particles that are part of a clump in any frame of a Run: the clump is there as well."""
    parts = set()
    if (run.folder / "fields.h5").is_file():
        with h5py.File(run.folder / "fields.h5") as f:
            for frame in (f[name] for name in f if "particle_carrier" in f[name]):
                parts.update(frame["particles"][:, 0][frame["particle_carrier"][:] != ALONE].astype(int))
    return list(parts)


def of_particles(table, box, end):
    """Quantities of the columns of probes.csv. box: lengths [m] by axis; end: of the run [s]."""
    speed = np.sqrt(sum(table[f"v{axis}"]**2 for axis in box))
    last = table["time"] > end * (1 - 1e-6)  # no row: none is left
    found = [quantity("particles at the end", last.sum(), "1"), quantity("largest speed of a particle", speed.max(), "m/s")]
    for axis, length in box.items():
        ways = displacements(table, axis, length, table["id"][last])
        if len(ways):
            found.append(quantity(f"mean displacement in {axis}", ways.mean(), "m"))
    return found


def displacements(table, axis, length, ids):
    """How far each particle that is still there has come along an axis [m]. One that leaves through a periodic side comes
    back at the other one, a length of the box away: from one row to the next none moves by half of it."""
    order = np.lexsort((table["time"], table["id"]))
    who, where = table["id"][order], table[axis][order]
    steps = np.diff(where)
    steps -= length * np.round(steps / length)
    same = who[1:] == who[:-1]
    _, numbers = np.unique(who, return_inverse=True)
    ways = np.bincount(numbers[1:][same], steps[same], numbers.max() + 1)
    return ways[np.isin(np.unique(who), ids)]
