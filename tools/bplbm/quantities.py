"""Numbers that every run has, without a plot.py: of its particles and bonds, at the end and at most; of a flow past solids
its flux and the permeability."""

import h5py
import numpy as np

from bplbm.early_end import STEADY as STEADY_END
from bplbm.results import quantity, read_table

ALONE = -1  # the carrier of what is no part of a clump
YIELDS = "share_at_rest_bound"  # a parameter of fluids whose viscosity is not one number
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


def drives(run):
    """Steady force on the mass [m/s²] of a Run along each axis that has one, a pressure difference across periodic sides
    included."""
    p = run.parameters
    found = {axis: p.get(f"body_force_{axis}", 0.0) + p.get(f"pressure_jump_{axis}", 0.0) / (p.get("density", 1.0) * p.get(f"box_{axis}", 1.0))
             for axis in "xyz"}
    return {axis: drive for axis, drive in found.items() if drive}


def fluxes(run):
    """Times [s] of the last two frames of a Run, or of less, and along each driven axis the mean velocities over the box
    there [m/s]; of a scene without covered cells no axis."""
    driven = drives(run)
    if not driven or not (run.folder / "fields.h5").is_file():
        return [], {}
    frames = run.frames()[-2:]
    means = [dict(zip("xyz", run.flux(name))) for _, name in frames]
    return [time for time, _ in frames], {axis: [m[axis] for m in means if axis in m] for axis in driven if means and axis in means[-1]}


def why_unsteady(run, axis, times, means):
    """Why a flow cannot be called steady; "" where it can: where the run ended for it (run.steady_below), or where the force
    on the obstacles in the last half of the run, or the flux between the last two frames, hardly changed."""
    if run.summary.get("ending", "").startswith(STEADY_END):
        return ""
    if force_is_steady(run, axis):
        return ""
    if len(means) < 2:
        return "one frame does not say whether the flow is steady; give run.steady_below, or a smaller output.fields_every"
    change = abs(means[1] - means[0]) / max(abs(means[1]), abs(means[0]), 1e-300)
    if change < STEADY:
        return ""
    return (f"not steady yet: the mean velocity along {axis} changed by {100 * change:.2g} % from {times[0]:.6g} s to {times[1]:.6g} s, "
            f"the last two frames, more than {100 * STEADY:g} %; run longer, or give run.steady_below or a smaller output.fields_every")


def force_is_steady(run, axis):
    """Whether the force of the fluid on all obstacles of a Run together stays the same in the last half of it: from drag that
    nears its end as 1 - exp(-t/τ) the flux then differs by 1e-4. False where obstacles.csv has too few rows."""
    path = run.folder / "obstacles.csv"
    if not path.is_file():
        return False
    table = read_table(path)
    times, which = np.unique(table["time"], return_inverse=True)
    late = times >= 0.5 * run.summary["physical_seconds"]
    force = np.bincount(which, table[f"f{axis}"], len(times))[late]
    return np.count_nonzero(late) > 2 and np.ptp(force) < STEADY * np.abs(force).max()


def of_flux(run):
    """Mean velocity over the box in the last frame of a Run whose fluid a steady force, or a pressure difference across
    periodic sides, drives past solids, and the permeability k = ν U/g that it gives where it no longer changes and
    the viscosity is one."""
    times, flux = fluxes(run)
    found = []
    for axis, means in flux.items():
        found.append(quantity(f"mean velocity along {axis}, solids included", means[-1], "m/s"))
        if YIELDS not in run.parameters and not why_unsteady(run, axis, times, means):
            found.append(quantity(f"permeability along {axis}", run.parameters["kinematic_viscosity"] * means[-1] / drives(run)[axis], "m²"))
    return found


def not_told(run):
    """Sentences on quantities that a Run could have and lacks: permeabilities, and why."""
    times, flux = fluxes(run)
    if YIELDS in run.parameters:
        return [f"No permeability along {axis}: the viscosity is not one number." for axis in flux]
    whys = {axis: why_unsteady(run, axis, times, means) for axis, means in flux.items()}
    return [f"No permeability along {axis}: {why}." for axis, why in whys.items() if why]


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
