"""Numbers that every run has, without a plot.py: of its particles and bonds, at the end and at most."""

import numpy as np

from bplbm.results import quantity, read_table


def default_quantities(run):
    """Quantities of a Run that its scene does not judge: broken bonds, speeds and ways of the particles."""
    found = []
    breaks = run.folder / "breaks.csv"
    if breaks.is_file():
        found.append(quantity("broken bonds", breaks.read_text().count("\n") - 1, "1"))
    probes = run.folder / "probes.csv"
    if probes.is_file():
        found += of_particles(read_table(probes))
    return found


def of_particles(table):
    """Quantities of the columns of probes.csv."""
    times = table["time"]
    if not len(times):
        return []
    axes = [a for a in "xyz" if a in table]
    speed = np.sqrt(sum(table[f"v{a}"]**2 for a in axes))
    first, last = times == times.min(), times == times.max()
    found = [quantity("particles at the end", last.sum(), "1"), quantity("largest speed of a particle", speed.max(), "m/s")]
    starts = dict(zip(table["id"][first], zip(*(table[a][first] for a in axes), strict=True), strict=True))
    ends = dict(zip(table["id"][last], zip(*(table[a][last] for a in axes), strict=True), strict=True))
    ways = np.array([np.subtract(ends[i], starts[i]) for i in starts.keys() & ends.keys()])
    if len(ways):
        found += [quantity(f"mean displacement in {a}", ways[:, k].mean(), "m") for k, a in enumerate(axes)]
    return found
