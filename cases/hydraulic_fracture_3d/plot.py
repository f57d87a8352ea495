"""Results and pictures of hydraulic_fracture_3d. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, quantity, read_table, result, studies
from bplbm.cracks import chain

HOLE = 0.0025  # m: radius of the free borehole along z, in the middle
REACH = 0.007  # m: 1.75 diameters; a break as near as that to the borehole or to a break of the crack is of the crack


class Fracture:
    """The breaks of a run: which are the crack at the borehole, and how it lies."""

    def __init__(self, run):
        self.run = run
        self.least = np.array([0.0, 1.0, 0.0] if "turned" in (run.summary["variant"] or "") else [1.0, 0.0, 0.0])
        breaks = read_table(run.folder / "breaks.csv")
        p = run.parameters
        middle = 0.5 * np.array([p["box_x"], p["box_y"], 0.0])
        self.time, self.mode = breaks["time"], breaks["mode"]
        self.place = np.stack([breaks[k] for k in "xyz"], axis=1) - middle
        self.normal = np.stack([breaks[f"n{k}"] for k in "xyz"], axis=1)
        self.mine = chain(self.place, np.hypot(*self.place[:, :2].T) < HOLE + REACH, REACH)

    def opens_along(self):
        """Unit vector: first axis of the crack tensor, the sum of n n^T over the broken bonds' directions n; and its share."""
        share, axes = np.linalg.eigh(self.normal[self.mine].T @ self.normal[self.mine] / self.mine.sum())
        return axes[:, 2], share[2]

    def thin_along(self):
        """Unit vector along which the crack's places spread least; and the spreads [m], the least first."""
        apart = self.place[self.mine] - self.place[self.mine].mean(axis=0)
        spread, axes = np.linalg.eigh(apart.T @ apart / len(apart))
        return axes[:, 0], np.sqrt(spread)

    def angle(self, direction):
        """To the least stress [degrees]."""
        return np.degrees(np.arccos(min(1.0, abs(direction @ self.least))))


def judge(fractures):
    found, told = [], []
    for name, f in fractures.items():
        (normal, share), (thin, spread) = f.opens_along(), f.thin_along()
        theory = "a fracture opens against the least stress"
        found += [result(f"{name}: angle of the opening to the least stress", f.angle(normal), "°", 0.0, theory, 1.0,
                         scale=30.0),
                  result(f"{name}: angle of the thin side of the crack to it", f.angle(thin), "°", 0.0, theory, 1.0,
                         scale=30.0),
                  result(f"{name}: part of the breaks that hang together with the borehole", f.mine.mean(), "1", 1.0,
                         "one fracture, no cloud all over the block", 0.25)]
        told += [quantity(f"{name}: bonds broken", len(f.time), "1"),
                 quantity(f"{name}: of them by tension", (f.mode == "tension").mean(), "1"),
                 quantity(f"{name}: share of the opening in the crack tensor, a third without direction", share, "1"),
                 quantity(f"{name}: spread across over spread along the crack, in the plane across the borehole",
                          spread[0] / spread[1], "1"),
                 quantity(f"{name}: first break", f.time.min(), "s")]
    if len(fractures) == 2:
        one, other = (f.opens_along()[0] for f in fractures.values())
        turn = np.degrees(np.arccos(min(1.0, abs(one @ other))))
        found.append(result("turn of the opening where the stresses turn by 90°", turn, "°", 90.0,
                            "the stress decides, not the packing", 1.0, scale=30.0))
    return found, told


def draw(fractures, run):
    """The breaks from above, as short lines across the broken bonds; the directions of the bonds; breaks against time."""
    figure, axes = plt.subplots(1, len(fractures) + 1, figsize=(4.3 * (len(fractures) + 1), 3.8), layout="constrained")
    for ax, (name, f) in zip(axes, fractures.items()):
        ax.add_patch(plt.Circle((0, 0), 1e3 * HOLE, color="tab:blue", alpha=0.4))
        for mine, color in ((f.mine, "tab:red"), (~f.mine, "0.6")):
            flat = f.normal[mine][:, 1::-1] * [-2.0, 2.0]
            ends = 1e3 * f.place[mine][:, :2]
            ax.plot(*np.stack([ends - flat, ends + flat], axis=2).transpose(1, 2, 0), color=color, linewidth=1.3)
        arrow = 22.0 * f.least[:2]
        ax.annotate("", arrow, 0.7 * arrow, arrowprops={"arrowstyle": "->"})
        ax.annotate("", -arrow, -0.7 * arrow, arrowprops={"arrowstyle": "->"})
        ax.set(title=f"{name}: broken bonds, seen along the borehole", xlabel="x [mm]", ylabel="y [mm]", xlim=(-27, 27),
               ylim=(-27, 27), aspect="equal")
        axes[-1].step(1e3 * np.sort(f.time), np.arange(1, len(f.time) + 1), where="post", label=name)
    axes[-1].set(xlabel="time [ms]", ylabel="broken bonds")
    axes[-1].legend()
    run.save(figure, "fracture.png")


def main():
    run = Run(sys.argv[1])
    fractures = {"turned" if "turned" in (run.summary["variant"] or "") else "default": Fracture(run)}
    fractures.update({name.removeprefix("variant-"): Fracture(r) for name, r in studies(run).items()})
    run.write_results(*judge(fractures))
    draw(fractures, run)


if __name__ == "__main__":
    main()
