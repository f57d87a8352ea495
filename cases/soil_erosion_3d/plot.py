"""Results and pictures of soil_erosion_3d. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_slice, quantity, read_table, result, studies

SPHERES = 303


def breaks(run):
    """Times of broken bonds [s]."""
    lines = (run.folder / "breaks.csv").read_text().splitlines()[1:]
    return np.array([float(line.split(",")[1]) for line in lines])


def top(run):
    """Time, and the highest centre [m]."""
    table = read_table(run.folder / "probes.csv")
    times = np.unique(table["time"])
    return times, np.array([table["z"][table["time"] == t].max() for t in times])


def judged(run, others):
    last = run.frame(run.frames()[-1][1])
    results = [result("spheres at the end", len(last["particles"]), "1", SPHERES, "none may be lost", 0),
               result("mass drift a cell", run.summary["mass_drift"], "1", 0.0,
                      "what the hole and the open top let in and out is booked; round-off of 8000 steps", 1e-10, scale=1.0)]
    if "variant-strong" in others:
        results.append(result("broken bonds, ten times as strong", len(breaks(others["variant-strong"])), "1", 0.0,
                              "ten times what breaks most of the others", 0, scale=1.0))
    return results


def main():
    run = Run(sys.argv[1])
    others = studies(run)
    runs = {"cemented": run, **{name.removeprefix("variant-"): r for name, r in others.items()}}
    told = [quantity(f"highest centre at the end, {name}", 1e3 * top(r)[1][-1], "mm") for name, r in runs.items()]
    run.write_results(judged(run, others), [quantity("broken bonds", len(breaks(run)), "1"), *told])
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.2, 3.0))
    for name, r in runs.items():
        times, height = top(r)
        right.plot(times, 1e3 * height, label=name)
        if name != "granular":
            at = np.sort(breaks(r))
            left.step([0, *at, times[-1]], [0, *range(1, len(at) + 1), len(at)], where="post", label=name)
    left.set(xlabel="time [s]", ylabel="broken bonds of 1380")
    right.set(xlabel="time [s]", ylabel="highest sphere [mm]")
    left.legend()
    right.legend()
    run.save(figure, "history.png")
    rows = {name: r for name, r in runs.items() if name != "strong"}
    frames = {name: [min(r.frames(), key=lambda f: abs(f[0] - t)) for t in (0.04, 0.1, 0.2, 0.4)]
              for name, r in rows.items()}
    figure, axes = plt.subplots(len(rows), 4, figsize=(8.6, 2.9 * len(rows)), sharex=True, sharey=True, squeeze=False)
    for row, (name, r) in zip(axes, rows.items()):
        for ax, (time, frame) in zip(row, frames[name]):
            image = draw_slice(ax, r, frame, "y", vmax=0.4, length_unit=1e-3)
            ax.set_title(f"{name}, {time:.2f} s")
            ax.label_outer()
    figure.colorbar(image, ax=axes, label="speed of the fluid at mid-depth [m/s]", fraction=0.03, pad=0.02)
    run.save(figure, "field.png")


if __name__ == "__main__":
    main()
