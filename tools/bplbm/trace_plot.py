"""Draws one particle of a recorded exchange: place, velocity and hydrodynamic load. Called by `trace plot`."""

import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from bplbm import pictures  # noqa: E402, F401  (its style)

STATES, LOADS = 3, 4


def rows(file, kind, table, particle):
    """Times and records of a particle, in the order of the frames."""
    records, times, found = file[table][...], [], []
    for frame in file["frames"][...]:
        if frame["kind"] != kind:
            continue
        part = records[frame["first"]:frame["first"] + frame["count"]]
        for record in part[part["id"] == particle]:
            times.append(frame["time"])
            found.append(record)
    return np.array(times), np.array(found)


def main(path, out, particle):
    with h5py.File(path, "r", swmr=True) as file:
        t, states = rows(file, STATES, "states", particle)
        s, loads = rows(file, LOADS, "loads", particle)
    if not len(t):
        print(f"trace | error | {path} holds no particle {particle}", file=sys.stderr)
        return 2
    figure, axes = plt.subplots(3, 1, figsize=(6.6, 6.0), sharex=True)
    for axis, times, values, label in ((axes[0], t, states["x"], "place [m]"), (axes[1], t, states["v"], "velocity [m/s]"),
                                       (axes[2], s, loads["force"], "force of the fluid [N]")):
        for k, name in enumerate("xy"):
            axis.plot(times, values[:, k], label=name)
        axis.set_ylabel(label)
    axes[0].legend()
    axes[0].set_title(f"particle {particle} of {path}", fontsize=9)
    axes[2].set_xlabel("time [s]")
    figure.tight_layout()
    figure.savefig(out)
    print(f"trace | picture | {out}")
    return 0

