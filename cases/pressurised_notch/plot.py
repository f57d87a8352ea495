"""Results and pictures of pressurised_notch. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import pathlib
import re
import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_bonds, quantity, read_breaks, read_table, result, studies, write_table

SCENE = pathlib.Path(__file__).parent
NOTCH, SLOT = 0.02, 0.006  # m: length and height, as in scene.toml
NEAR = 0.008  # m from the end of the notch: a break there begins the crack
COLUMN = 0.025  # m: how far from the left wall the ground lies above and below the notch


class Start:
    """When the notch of a run begins to grow, and the pressures then [Pa]."""

    def __init__(self, run):
        self.run, self.p = run, run.parameters
        words = run.summary["variant"] or ""
        seed, ramp = (re.search(rf"{key}-(\d+)", words) for key in ("seed", "ramp"))
        self.seed, self.slow = seed.group(1) if seed else "11", bool(ramp) and ramp.group(1) == "40"
        dry = read_table(SCENE / "dry.csv")
        self.dry = dry["pressure"][dry["seed"] == float(self.seed)][0]
        self.middle = 0.5 * self.p["box_y"]
        breaks = read_breaks(run.folder / "breaks.csv")
        near = np.hypot(breaks["place"][:, 0] - NOTCH, breaks["place"][:, 1] - self.middle) < NEAR
        if not near.any():
            raise SystemExit(f"{run.folder}: no bond breaks within {NEAR} m of the notch; raise the pressure or the end time")
        self.time = breaks["time"][near][0]
        self.series = [self.pressures(name) for _, name in run.frames()]
        times = [time for time, _ in run.frames()]
        self.notch, self.ground, self.tip, self.ahead = (np.interp(self.time, times, column) for column in zip(*self.series))

    def pressures(self, name):
        """Means of a frame [Pa]: in the notch, in the ground above and below it from grip to grip, in the pores at its
        end, and in the ground above and below that end."""
        pressure, cell = self.run.frame(name)["pressure"], self.p["cell"]
        x, y = (cell * (np.arange(n) + 0.5) for n in pressure.shape[::-1])
        height = np.abs(y - self.middle)
        end = np.abs(x - NOTCH - 0.005) < 0.0015

        def mean(rows, columns):
            return np.nanmean(pressure[np.ix_(rows, columns)])

        return (mean(height < 0.002, x < NOTCH), mean(height > 0.5 * SLOT, x < COLUMN), mean(height < 0.002, end),
                mean(height > 0.5 * SLOT, (x > NOTCH) & (x < NOTCH + 0.01)))

    def effective(self):
        """The pressure in a dry notch that pulls as much at the first bond ahead [Pa].

        The notch is opened by what its water exceeds the mean of the ground's by, the first bond also by what the pores
        at it exceed their column by; d ahead of the end of a notch of length a the first does √(1 + 2a/d) - 1 times as
        much as the second.
        """
        d = 2.0 * self.run.frame(self.run.frames()[0][1])["particles"][:, 3].mean()
        first = np.sqrt((1 + 2 * NOTCH / d) / np.cos(0.5 * np.pi * NOTCH / self.p["box_x"])) - 1
        return self.notch - self.ground + (self.tip - self.ahead) / first


def mean(values):
    return float(np.mean(list(values)))


def judge(starts):
    found, told = [], []
    for slow, name in ((False, "fast"), (True, "slow")):
        group = [s for s in starts if s.slow == slow]
        if group:
            found.append(result(f"start over that of a dry notch, {name}: effective pressure",
                                mean(s.effective() / s.dry for s in group), "1", 1.0,
                                "slot_traction of bonded_compression, the same three blocks without water", 0.15))
        if group:
            told.append(quantity(f"start over that of a dry notch, {name}: pressure in the notch",
                                 mean(s.notch / s.dry for s in group), "1"))
            told.append(quantity(f"ground's pressure over the notch's, {name}", mean(s.ground / s.notch for s in group), "1"))
    fast, slow = ([s for s in starts if s.slow == kind] for kind in (False, True))
    if len(fast) == len(slow) == 3:
        ratio = mean(s.notch / s.dry for s in slow) / mean(s.notch / s.dry for s in fast)
        found.append(result("leak-off raises the start, 1 if it does", float(ratio > 1), "1", 1.0,
                            "water in the ground presses on both sides of the notch", 0.0))
    return found, told


def draw(starts, run):
    figure, axes = plt.subplots(1, 3, figsize=(12.5, 3.4), layout="constrained")
    s = starts[0]
    time, name = min(run.frames(), key=lambda frame: abs(frame[0] - s.time - 0.0004))
    frame, size = run.frame(name), 1e3 * s.p["box_x"]
    image = axes[0].imshow(1e-3 * frame["pressure"], origin="lower", extent=[0, size, 0, size], cmap="viridis")
    draw_bonds(axes[0], frame, length_unit=1e-3)
    axes[0].grid(False)
    axes[0].set_title(f"bonds and pressure [kPa], t = {1e3 * time:.1f} ms", fontsize=9)
    axes[0].set_xlabel("x [mm]")
    figure.colorbar(image, ax=axes[0], fraction=0.05)
    times = 1e3 * np.array([time for time, _ in run.frames()])
    for column, label in zip(zip(*s.series), ("notch", "ground beside it", "pores at its end")):
        axes[1].plot(times, 1e-3 * np.array(column), label=label)
    axes[1].axvline(1e3 * s.time, color="tab:red", linewidth=0.8)
    axes[1].axhline(1e-3 * s.dry, color="0.5", linestyle="--", label="start without water")
    axes[1].set_xlabel("time [ms]")
    axes[1].set_ylabel("pressure [kPa]")
    axes[1].legend(fontsize=7)
    labels = [f"seed {s.seed}" + (", slow" if s.slow else "") for s in starts]
    place = np.arange(len(starts))
    axes[2].bar(place - 0.2, [s.notch / s.dry for s in starts], 0.4, label="in the notch")
    axes[2].bar(place + 0.2, [s.effective() / s.dry for s in starts], 0.4, label="effective")
    axes[2].axhline(1.0, color="0.3", linewidth=0.8)
    axes[2].set_xticks(place, labels, rotation=30, fontsize=7)
    axes[2].set_ylabel("start pressure over that without water")
    axes[2].set_ylim(0, 1.9)
    axes[2].legend(fontsize=7, loc="upper center", ncols=2)
    run.save(figure, "start.png")


def main():
    run = Run(sys.argv[1])
    starts = sorted([Start(run)] + [Start(other) for other in studies(run).values()], key=lambda s: s.slow)
    found, told = judge(starts)
    run.write_results(found, told + [quantity("pressure in the notch at its start", starts[0].notch, "Pa"),
                                     quantity("Ma = u/c_s", run.summary["ma_max"], "1")])
    write_table(run.folder / "start.csv", {"seed": np.array([float(s.seed) for s in starts]),
                                           "slow": np.array([float(s.slow) for s in starts]),
                                           **{key: np.array([getattr(s, key) for s in starts])
                                              for key in ("time", "notch", "ground", "tip", "dry")},
                                           "effective": np.array([s.effective() for s in starts])})
    for s in starts:
        print(f"run | note | seed {s.seed}{', slow' if s.slow else ''}: the notch grows at {1e3 * s.time:.2f} ms with "
              f"{1e-3 * s.notch:.1f} kPa in it, {1e-3 * s.ground:.1f} kPa in the ground; effective {1e-3 * s.effective():.1f} "
              f"kPa, without water {1e-3 * s.dry:.1f} kPa")
    draw(starts, run)


if __name__ == "__main__":
    main()
