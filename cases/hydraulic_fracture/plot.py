"""Results, pictures and animation of hydraulic_fracture. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from pictures import Run, animate, draw_bonds, draw_speed, result, studies

INLET = np.array([0.0, 0.05])  # m


def breaks(run):
    """Arrays of all breaks: time since the water came [s], mode, place [m][2]."""
    rows = [line.split(",") for line in (run.folder / "breaks.csv").read_text().splitlines()[1:]]
    relaxed = 20000 * run.parameters["interval"] / run.summary["substeps"]
    return (np.array([float(r[1]) for r in rows]) - relaxed, np.array([r[4] for r in rows]),
            np.array([[float(r[6]), float(r[7])] for r in rows]).reshape(-1, 2))


def cavity(run, name):
    """Area without discs around the inlet: free of solid, connected to it [m²]."""
    free = run.frame(name)["solid_fraction"] < 0.05
    reached = np.zeros_like(free)
    reached[95:105, 0] = free[95:105, 0]
    while True:
        grown = reached.copy()
        grown[1:] |= reached[:-1]
        grown[:-1] |= reached[1:]
        grown[:, 1:] |= reached[:, :-1]
        grown[:, :-1] |= reached[:, 1:]
        grown &= free
        # channels of a cell or two between discs are no cavity
        if (grown == reached).all():
            break
        reached = grown
    wide = reached[2:-2, 2:-2].copy()
    for dy in range(5):
        for dx in range(5):
            wide &= free[dy:free.shape[0] - 4 + dy, dx:free.shape[1] - 4 + dx]
    return wide.sum() * run.parameters["cell"] ** 2


def draw(axes, run, time, name):
    image = draw_speed(axes, run, name, 20.0, length_unit=1e-3)
    draw_bonds(axes, run.frame(name), length_unit=1e-3)
    axes.set_title(f"t = {time * 1e3:.0f} ms")
    axes.set_xlabel("x [mm]")
    return image


def main():
    run = Run(sys.argv[1])
    runs = {run.summary["variant"] or "400 N": run}
    runs.update({name[2:].replace("strength", "") + (" N" if "strength" in name else ""): r
                 for name, r in studies(run).items()})
    results = []
    if "400 N" in runs:
        time, mode, place = breaks(run)
        near = np.hypot(*(place - INLET).T) < 0.04
        # most, not all: the block is also pressed against the right wall
        results.append(result("part of the breaks within 40 mm of the inlet", near.mean(), "1", 1.0,
                              "Wang, Feng and Wang 2016: the fracture starts and grows from the pipe", 0.4))
    run.write_results(results)
    for label, r in runs.items():
        time, mode, place = breaks(r)
        text = f"{len(time)} bonds broken"
        if len(time) >= 10:
            cloud = place[np.hypot(*(place - INLET).T) < 0.05]
            text += (f" ({(mode == 'tension').mean():.0%} by tension), the first at {time[0] * 1e3:.1f} ms; damage "
                     f"cloud at the inlet {1e3 * np.ptp(cloud[:, 0]):.0f} mm long, {1e3 * np.ptp(cloud[:, 1]):.0f} mm high")
        last = r.frames()[-1][1]
        print(f"run | note | {label}: {text}; wide cavity {1e6 * cavity(r, last):.0f} mm²; Ma = u/c_s "
              f"{r.summary['ma_max']:.2f}")
    chosen = [label for label in ("400 N", "granular") if label in runs] or list(runs)[:1]
    figure, axes = plt.subplots(len(chosen), 4, figsize=(11.0, 2.9 * len(chosen)), squeeze=False, sharey=True)
    for row, label in zip(axes, chosen):
        frames = runs[label].frames()
        for ax, wanted in zip(row, (0.001, 0.003, 0.008, 0.02)):
            image = draw(ax, runs[label], *min(frames, key=lambda f: abs(f[0] - wanted)))
        row[0].set_ylabel(f"{label}\ny [mm]")
    figure.colorbar(image, ax=axes, label="speed of the fluid [m/s]", fraction=0.02, pad=0.02)
    run.save(figure, "field.png")
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.2, 3.0))
    for label, r in runs.items():
        time, mode, place = breaks(r)
        if len(time):
            left.step(1e3 * time, np.arange(1, len(time) + 1), label=label)
        frames = r.frames()
        right.plot([1e3 * t for t, _ in frames], [1e6 * cavity(r, name) for _, name in frames], label=label)
    left.set_xlabel("time [ms]")
    left.set_ylabel("bonds broken")
    left.legend()
    right.set_xlabel("time [ms]")
    right.set_ylabel("cavity at the inlet [mm²]")
    right.legend()
    figure.tight_layout()
    run.save(figure, "history.png")
    animate(run, "animation.gif", lambda ax, t, name: draw(ax, run, t, name), (4.2, 4.2))


if __name__ == "__main__":
    main()
