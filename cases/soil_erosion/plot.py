"""Results, pictures and animation of soil_erosion. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, animate, draw_bonds, draw_speed, quantity, read_table, result, studies, write_table

DISCS = 273
PIPES = [(42, 50), (56, 50)]  # lower left corners of the pipe's walls [mm], 2 mm wide


def left_through_pipe(run):
    """Time, and number of discs that are gone."""
    table = read_table(run.folder / "probes.csv")
    times, counts = np.unique(table["time"], return_counts=True)
    return times, DISCS - counts


def breaks(run):
    """Times of the breaks since the water came."""
    lines = (run.folder / "breaks.csv").read_text().splitlines()[1:]
    relaxed = 20000 * run.parameters["interval"] / run.summary["substeps"]
    return np.array([float(line.split(",")[1]) for line in lines]) - relaxed


def draw(axes, run, time, name, vmax):
    image = draw_speed(axes, run, name, vmax, length_unit=1e-3)
    for x, y in PIPES:
        axes.add_patch(plt.Rectangle((x, y), 2, 50, color="0.6"))
    draw_bonds(axes, run.frame(name), length_unit=1e-3)
    axes.set_title(f"t = {time * 1e3:.0f} ms")
    axes.set_xlabel("x [mm]")
    return image


def picture_field(runs):
    figure, axes = plt.subplots(len(runs), 4, figsize=(11.0, 2.9 * len(runs)), squeeze=False, sharey=True)
    vmax = 8.0
    for row, (label, run) in zip(axes, runs.items()):
        frames = run.frames()
        for ax, wanted in zip(row, (0.0, 0.03, 0.1, 0.2)):
            time, name = min(frames, key=lambda f: abs(f[0] - wanted))
            image = draw(ax, run, time, name, vmax)
        row[0].set_ylabel(f"{label}\ny [mm]")
    figure.colorbar(image, ax=axes, label="speed of the fluid [m/s]", fraction=0.02, pad=0.02)
    next(iter(runs.values())).save(figure, "field.png")


def fastest(run):
    """Speed of the fastest disc at each time of the probes [m/s]."""
    table = read_table(run.folder / "probes.csv")
    speed = np.hypot(table["vx"], table["vy"])
    return np.array([speed[table["time"] == t].max() for t in np.unique(table["time"])])


def quantities(run):
    s, p = run.summary, run.parameters
    peak = s["ma_paper"] * p["cell"] / p["time_step"]
    return [quantity("discs gone", left_through_pipe(run)[1][-1], "1"),
            quantity("bonds broken", len(breaks(run)), "1"),
            quantity("fastest disc", fastest(run).max(), "m/s"),
            quantity("peak velocity of the fluid", peak, "m/s"),
            quantity("Re of the peak and a disc of 4 mm", peak * 0.004 / p["kinematic_viscosity"], "1"),
            quantity("Ma = u/c_s", s["ma_max"], "1")]


def picture_history(runs, run):
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.2, 4.4), sharex=True)
    for label, r in runs.items():
        top.plot(*left_through_pipe(r), label=label)
        bottom.plot(left_through_pipe(r)[0], fastest(r), label=label)
    top.set_ylabel("discs gone through the pipe")
    top.legend()
    bottom.set_ylabel("fastest disc [m/s]")
    bottom.set_xlabel("time [s]")
    run.save(figure, "history.png")


def main():
    run = Run(sys.argv[1])
    granular = run.summary["variant"] == "granular"
    runs = {"granular" if granular else "bonded": run}
    runs.update({name.removeprefix("variant-"): r for name, r in studies(run).items()})
    gone = {label: left_through_pipe(r)[1][-1] for label, r in runs.items()}
    results = []
    if "bonded" in runs:
        results.append(result("discs gone, bonded", gone["bonded"], "1", 0,
                              "Wang, Feng and Wang 2016: none", 0, scale=1.0))
    if "granular" in runs and runs["granular"].summary["physical_seconds"] > 0.19:
        results.append(result("discs gone one by one, granular", gone["granular"] >= 5, "yes", 1,
                              "Wang, Feng and Wang 2016: they leave one by one", 0))
    run.write_results(results, quantities(run))
    time, lost = left_through_pipe(run)
    write_table(run.folder / "history.csv", {"time": time, "discs_gone": lost, "fastest_disc": fastest(run),
                                             "bonds_broken": np.searchsorted(np.sort(breaks(run)), time)})
    for label, r in runs.items():
        s = r.summary
        print(f"run | note | {label}: {gone[label]} of {DISCS} discs gone, {len(breaks(r))} bonds broken, "
              f"Ma = u/c_s {s['ma_max']:.2f}, u/C {s['ma_paper']:.2f}, {s['wall_seconds']:.0f} s of wall time")
    picture_field(runs)
    picture_history(runs, run)
    animate(run, "animation.gif", lambda ax, t, name: draw(ax, run, t, name, 8.0), (4.2, 4.2))


if __name__ == "__main__":
    main()
