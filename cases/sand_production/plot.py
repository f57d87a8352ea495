"""Results and pictures of sand_production. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_bonds, draw_speed, quantity, read_table, result, studies

PRODUCED = 5  # discs from which on one speaks of sand production: more than what a first rearrangement sheds
STEADY = 0.015  # s: three times the ramp; from here on the flow through unbroken sand is within 0.2 % of that at the end
# The scene's own flow and largest drag where nothing breaks: no measurement, but what the bed did when this was written.
# Unbroken discs stay at their places, so both are the same, within 0.2 %, whatever the strength and the time of the end.
OUTFLOW, OUTFLOW_TOLERANCE = 8.96e-3, 0.02  # m³/s a metre of depth, out of the mouth
DRAG, DRAG_TOLERANCE = 14.1, 0.03  # N

def produced(run):
    """Discs that have left through the mouth."""
    return run.summary.get("grains", {}).get("left", 0)


def history(run):
    """Times, and how many discs have left until then."""
    times, counts = np.unique(read_table(run.folder / "probes.csv")["time"], return_counts=True)
    return times, counts[0] - counts


def largest_drag(run):
    """Of the flow on one disc, at the end [N]."""
    table = read_table(run.folder / "probes.csv")
    last = table.where(table["time"] == table["time"].max())
    return np.hypot(last["fx"], last["fy"]).max()


def outflow(run):
    """Mean over the last quarter of the time [m³/s a metre of depth], positive out of the mouth."""
    table = read_table(run.folder / "sensor-mouth.csv")
    return table["flow"][table["time"] > 0.75 * table["time"].max()].mean()


def quantities(run):
    bonds = run.summary.get("bonds", {})
    return [quantity("discs produced", produced(run), "1"),
            quantity("bonds broken by tension", bonds.get("tension", 0), "1"),
            quantity("bonds broken by shear", bonds.get("shear", 0), "1"),
            quantity("largest drag on a disc at the end", largest_drag(run), "N"),
            quantity("flow out of the mouth at the end", outflow(run), "m³/s")]


def broken(run):
    """Bonds, by tension or shear."""
    bonds = run.summary.get("bonds", {})
    return bonds.get("tension", 0) + bonds.get("shear", 0)


def judged_strong(run):
    """Nothing gives way, although the oil flows and pulls as it should: without flow nothing would give way either."""
    if run.summary["physical_seconds"] < STEADY:
        return []
    return [result("discs produced, strong", produced(run), "1", 0, "the bonds hold what the oil pulls with", 0, scale=1.0),
            result("bonds broken, strong", broken(run), "1", 0, "the bonds hold what the oil pulls with", 0, scale=1.0),
            result("flow out of the mouth, strong", outflow(run), "m³/s", OUTFLOW, "this scene before, unbroken",
                   OUTFLOW_TOLERANCE),
            result("largest drag on a disc, strong", largest_drag(run), "N", DRAG, "this scene before, unbroken",
                   DRAG_TOLERANCE)]


def judged(runs):
    results = []
    for label, run in runs.items():
        if label == "strong":
            results += judged_strong(run)
        if label == "weak" and run.summary["physical_seconds"] >= 0.03:
            results.append(result("sand is produced, weak", produced(run) >= PRODUCED, "yes", 1,
                                  "these bonds carry a third of what the oil pulls with", 0))
    return results


def picture_field(runs, run):
    figure, axes = plt.subplots(len(runs), 3, figsize=(10.0, 3.3 * len(runs)), squeeze=False, sharey=True)
    for row, (label, r) in zip(axes, runs.items()):
        frames = r.frames()
        for ax, wanted in zip(row, (0.012, 0.028, 0.06)):
            time, name = min(frames, key=lambda f: abs(f[0] - wanted))
            image = draw_speed(ax, r, name, 2.0, length_unit=1e-3)
            draw_bonds(ax, r.frame(name), length_unit=1e-3)
            ax.set_title(f"t = {time * 1e3:.0f} ms")
            ax.set_xlabel("x [mm]")
        row[0].set_ylabel(f"{label}\ny [mm]")
    figure.colorbar(image, ax=axes, label="speed of the fluid [m/s]", fraction=0.02, pad=0.02)
    run.save(figure, "field.png")


def picture_history(runs, run):
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.2, 4.4), sharex=True)
    for label, r in runs.items():
        top.plot(*history(r), label=label)
        flow = read_table(r.folder / "sensor-mouth.csv")
        bottom.plot(flow["time"], flow["flow"], label=label)
    top.set_ylabel("discs produced")
    top.legend()
    bottom.set_ylabel("flow out [m³/s]")
    bottom.set_xlabel("time [s]")
    run.save(figure, "history.png")


def main():
    run = Run(sys.argv[1])
    runs = {"weak" if run.summary["variant"] == "weak" else run.summary["variant"] or "strong": run}
    runs.update({name.removeprefix("variant-"): r for name, r in studies(run).items()})
    run.write_results(judged(runs), quantities(run))
    picture_field(runs, run)
    picture_history(runs, run)


if __name__ == "__main__":
    main()
