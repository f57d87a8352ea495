"""Results, pictures and animation of suspension_migration. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, animate, draw_speed, quantity, read_table, result, write_table

STEP = 8.3333e-7  # s, the paper's
SHOWN = (0, 50_000, 100_000, 200_000, 500_000)  # its steps
HEIGHT, LENGTH, BINS = 0.04, 0.1, 16


def frame_at(run, step):
    return min(run.frames(), key=lambda f: abs(f[0] - step * STEP))


def crossings(run):
    """Times at which discs have been seen to come back through the left side."""
    table = read_table(run.folder / "probes.csv")
    times = []
    for disc in np.unique(table["id"]):
        mine = table["id"] == disc
        jump = np.flatnonzero(np.diff(table["x"][mine]) < -0.5 * LENGTH)
        times.extend(table["time"][mine][jump + 1])
    return np.sort(times)


def fluid_velocity(frame):
    """Mean along x of each row of cells [m/s], over the part of them that is fluid."""
    return np.average(frame["velocity"][..., 0], axis=1, weights=1.0 - frame["solid_fraction"])


def main():
    run = Run(sys.argv[1])
    times = crossings(run)
    last = run.frame(run.frames()[-1][1])
    u = fluid_velocity(last)
    ny = len(u)
    middle, side = u[3 * ny // 8:5 * ny // 8].mean(), u[:ny // 8].mean()
    results = [
        # a frame of the paper's 12 500 steps
        result("first disc through the right side", times[0], "s", 12_500 * STEP,
               "Wang et al. 2017: some have crossed at step 12 500", STEP * 12_500 * 1.01, scale=1.0),
        result("fluid is fastest on the axis", middle > side, "yes", 1, "Wang et al. 2017", 0)]
    run.write_results(results, [
        quantity("crossings of the right side", len(times), "1"),
        quantity("velocity of the fluid around the axis", middle, "m/s"),
        quantity("velocity of the fluid in the eighths at the walls", 0.5 * (side + u[-ny // 8:].mean()), "m/s"),
        quantity("velocity of the discs", last["particles"][:, 4].mean(), "m/s"),
        quantity("Ma = u/c_s", run.summary["ma_max"], "1")])
    print(f"run | note | {len(times)} crossings; fluid {middle:.2f} m/s around the axis, {side:.2f} m/s at the wall; "
          f"{run.summary['wall_seconds']:.0f} s of wall time")
    figure, (left, middle_axes, right) = plt.subplots(1, 3, figsize=(10.5, 3.4), sharey=True)
    columns = {"y": (np.arange(ny) + 0.5) / ny * HEIGHT}
    for step in SHOWN:
        time, name = frame_at(run, step)
        frame = run.frame(name)
        y = (np.arange(ny) + 0.5) / ny * HEIGHT * 1e3
        label = f"step {step}"
        columns[f"fluid_velocity_{step}"] = fluid_velocity(frame)
        columns[f"solid_fraction_{step}"] = frame["solid_fraction"].mean(axis=1)
        left.plot(columns[f"fluid_velocity_{step}"], y, label=label)
        _, _, py, _, vx, *_ = frame["particles"].T
        edges = np.linspace(0, HEIGHT, BINS // 2 + 1)
        bin_of = np.clip(np.digitize(py, edges) - 1, 0, len(edges) - 2)
        mean = [vx[bin_of == b].mean() if (bin_of == b).any() else np.nan for b in range(len(edges) - 1)]
        middle_axes.plot(mean, 5e2 * (edges[1:] + edges[:-1]), "o-", markersize=3, label=label)
        fraction = frame["solid_fraction"].mean(axis=1).reshape(BINS, -1).mean(axis=1)
        right.plot(fraction, (np.arange(BINS) + 0.5) / BINS * HEIGHT * 1e3, label=label)
    left.set_xlabel("fluid velocity [m/s]")
    left.set_ylabel("y [mm]")
    middle_axes.set_xlabel("disc velocity [m/s]")
    right.set_xlabel("solid fraction")
    right.legend(fontsize=7)
    figure.tight_layout()
    run.save(figure, "profiles.png")
    write_table(run.folder / "profiles.csv", columns)
    figure, axes = plt.subplots(2, 2, figsize=(9.5, 4.6), sharex=True, sharey=True)
    for ax, step in zip(axes.flat, SHOWN[1:]):
        time, name = frame_at(run, step)
        image = draw_speed(ax, run, name, None, length_unit=1e-3)
        ax.set_title(f"t = {time * 1e3:.0f} ms")
        figure.colorbar(image, ax=ax, label="speed [m/s]", shrink=0.8)
    run.save(figure, "field.png")
    vmax = 1.2 * np.abs(last["velocity"]).max()
    animate(run, "animation.gif", lambda ax, t, name: (draw_speed(ax, run, name, vmax, length_unit=1e-3),
                                                       ax.set_title(f"t = {t * 1e3:.0f} ms")), (6.0, 2.8))


if __name__ == "__main__":
    main()
