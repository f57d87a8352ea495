"""Results, pictures and animation of hydraulic_fracture. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, animate, draw_bonds, draw_speed, quantity, result, studies, write_table

INLET = np.array([0.0, 0.05])  # m


def breaks(run):
    """Arrays of all breaks: time since the water came [s], mode, place [m][2], direction of the crack from the
    x axis, across the bond [degrees, -90 … 90]."""
    rows = [line.split(",") for line in (run.folder / "breaks.csv").read_text().splitlines()[1:]]
    return (np.array([float(r[1]) for r in rows]), np.array([r[4] for r in rows], dtype=str),
            np.array([[float(r[6]), float(r[7])] for r in rows]).reshape(-1, 2),
            np.array([(np.degrees(np.arctan2(float(r[10]), float(r[9]))) + 180) % 180 - 90 for r in rows]))


def cloud(place):
    """Length and height of the damage within 50 mm of the inlet [m]; zeros for a handful of breaks."""
    near = place[np.hypot(*(place - INLET).T) < 0.05]
    return np.ptp(near, axis=0) if len(near) >= 10 else np.zeros(2)


def quantities(run):
    time, mode, place, angle = breaks(run)
    length, height = cloud(place)
    first = time[0] if len(time) else np.nan
    return [quantity("bonds broken", len(time), "1"),
            quantity("of them by tension", (mode == "tension").sum(), "1"),
            quantity("cracks within 45° of the horizontal", (np.abs(angle) < 45).sum(), "1"),
            quantity("first break", first, "s"),
            quantity("length of the damage cloud", length, "m"),
            quantity("height of the damage cloud", height, "m"),
            quantity("wide cavity at the inlet", cavity(run, run.frames()[-1][1]), "m²"),
            quantity("Ma = u/c_s", run.summary["ma_max"], "1")]


def write_history(run):
    frames = run.frames()
    times = np.array([t for t, _ in frames])
    time, mode, _, angle = breaks(run)
    count = lambda chosen: np.searchsorted(np.sort(time[chosen]), times)  # noqa: E731
    write_table(run.folder / "history.csv", {
        "time [s]": times, "bonds_broken [1]": count(np.full(len(time), True)), "by_tension [1]": count(mode == "tension"),
        "cracks_within_45_degrees_of_the_horizontal [1]": count(np.abs(angle) < 45),
        "cavity [m²]": [cavity(run, name) for _, name in frames]})


def cavity(run, name):
    """Area without discs around the inlet: free of solid, connected to it [m²]."""
    free = run.frame(name)["solid_fraction"] < 0.05
    inlet = slice(*(round(y / run.parameters["cell"]) for y in (0.0475, 0.0525)))
    side = 2 * round(0.001 / run.parameters["cell"]) + 1  # cells: a free square of 2.5 mm is no pore
    reached = np.zeros_like(free)
    reached[inlet, 0] = free[inlet, 0]
    while True:
        grown = reached.copy()
        grown[1:] |= reached[:-1]
        grown[:-1] |= reached[1:]
        grown[:, 1:] |= reached[:, :-1]
        grown[:, :-1] |= reached[:, 1:]
        grown &= free
        if (grown == reached).all():
            break
        reached = grown
    half = side // 2
    wide = reached[half:-half, half:-half].copy()
    for dy in range(side):
        for dx in range(side):
            wide &= free[dy:free.shape[0] - side + 1 + dy, dx:free.shape[1] - side + 1 + dx]
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
    runs.update({name.removeprefix("variant-").replace("strength", "") + (" N" if "strength" in name else ""): r
                 for name, r in studies(run).items()})
    results = []
    if "400 N" in runs:
        place = breaks(run)[2]
        near = np.hypot(*(place - INLET).T) < 0.04
    if "400 N" in runs and len(place) >= 10:
        # more than half: the block is also pressed against the right wall; breaks all over the box would give 0.25
        results.append(result("part of the breaks within 40 mm of the inlet", near.mean(), "1", 1.0,
                              "Wang, Feng and Wang 2016: the fracture starts and grows from the pipe", 0.5))
    run.write_results(results, quantities(run))
    write_history(run)
    for label, r in runs.items():
        time, mode, place, _ = breaks(r)
        text = f"{len(time)} bonds broken"
        if len(time) >= 10:
            length, height = 1e3 * cloud(place)
            text += (f" ({(mode == 'tension').mean():.0%} by tension), the first at {time[0] * 1e3:.1f} ms; damage "
                     f"cloud at the inlet {length:.0f} mm long, {height:.0f} mm high")
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
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11.0, 3.0))
    time, _, place, angle = breaks(run)
    middle.scatter(1e3 * time, angle, s=6)
    middle.set_ylim(-90, 90)
    middle.set_yticks([-90, -45, 0, 45, 90])
    middle.set_xlabel("time [ms]")
    middle.set_ylabel("crack from the horizontal [°]")
    for label, r in runs.items():
        time = breaks(r)[0]
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
