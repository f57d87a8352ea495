"""Results and pictures of sand_production. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_bonds, draw_speed, quantity, read_table, result, studies

PRODUCED = 5  # discs from which on one speaks of sand production: more than what a first rearrangement sheds


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


def judged(runs):
    results = []
    for label, run in runs.items():
        if run.summary["physical_seconds"] < 0.059:
            continue
        if label == "strong":
            results.append(result("discs produced, strong", produced(run), "1", 0,
                                  "bonds of more than the largest drag hold", 0, scale=1.0))
        if label == "weak":
            results.append(result("sand is produced, weak", produced(run) >= PRODUCED, "yes", 1,
                                  "bonds of a small part of the largest drag do not", 0))
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
