"""Results and pictures of disc_migration. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, animate, draw_speed, quantity, result, studies, write_table

HEIGHT = 0.01
PAPER = {"10 mm": 21 * 3600 + 31 * 60, "40 mm": 95 * 3600 + 26 * 60}  # s of wall time


def track(run):
    probe = run.probes()
    return probe["time"], probe["y"]


def start(run):
    return f"from {1e3 * track(run)[1][0]:.3g} mm"


def difference(run, other):
    """Largest difference of the heights over that of the channel."""
    t, y = track(run)
    return np.abs(y - np.interp(t, *track(other))).max() / HEIGHT


def main():
    run = Run(sys.argv[1])
    others = studies(run)
    results = []
    for name, text in (("variant-step4", "a quarter of the step"), ("set-fine", "half of the cell")):
        if name in others:
            # 2 % of the height: the goal
            results.append(result(f"largest change of y(t) with {text}, over H", difference(run, others[name]),
                                  "1", 0.0, "the same physics", 0.02, scale=1.0))
    long = others.pop("variant-40mm_equilibrium", None)
    ends = [others.pop(name) for name in ("variant-equilibrium9", "variant-equilibrium6") if name in others]
    if len(ends) == 2:
        high, low = (track(r)[1][-1] / HEIGHT for r in ends)
        # 0.01 H: what is asked of two starts
        results.append(result("height at rest from 9 mm, over H", high, "1", low, "the one from 6 mm", 0.01, scale=1.0))
    if len(ends) == 2 and long:
        # 0.02 H: images are 10 and 40 diameters away
        results.append(result("height at rest in the long channel, over H", track(long)[1][-1] / HEIGHT, "1", high,
                              "the one in the short channel", 0.02, scale=1.0))
    if "variant-pressure_jump" in others:
        # 0.5 %: the density falls along the channel, u/C = 0.1
        results.append(result("largest change of y(t) driven by a pressure jump, over H",
                              difference(run, others.pop("variant-pressure_jump")), "1", 0.0, "the same drive", 0.005,
                              scale=1.0))
    t, y = track(run)
    x = np.unwrap(run.probes()["x"], period=run.parameters["box_x"])  # where it would be without the periodic side
    run.write_results(results, [quantity("height at the end", y[-1], "m"),
                                quantity("way along the channel", x[-1] - x[0], "m"),
                                quantity("speed at the end", run.probes()["vx"][-1], "m/s")])
    write_table(run.folder / "history.csv", {"time": t, "x": x, "y": y})
    labels = {"variant-40mm": "from 9 mm, 40 mm long", "variant-step4": "from 9 mm, step / 4", "set-fine": "from 9 mm, cell / 2"}
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.4), width_ratios=(1.6, 1))
    left.plot(track(run)[0], 1e3 * track(run)[1], label=start(run))
    for name, other in others.items():
        label = labels.get(name, start(other))
        left.plot(track(other)[0], 1e3 * track(other)[1], "--" if name in labels else "-", linewidth=1,
                  label=label)
        print(f"run | note | {label}: y = {1e3 * track(other)[1][-1]:.3f} mm at the end, "
              f"{other.summary['wall_seconds']:.2f} s of wall time, {other.summary['steps']} steps")
    paper = PAPER["40 mm" if run.summary["variant"] == "40mm" else "10 mm"]
    print(f"run | note | the paper took {paper / 3600:.1f} h; here {paper / run.summary['wall_seconds']:.0f} times faster")
    print(f"run | note | {start(run)}: y = {1e3 * track(run)[1][-1]:.3f} mm at the end, "
          f"{run.summary['wall_seconds']:.2f} s of wall time, {run.summary['steps']} steps")
    left.set_xlabel("time [s]")
    left.set_ylabel("height of the disc [mm]")
    left.legend(fontsize=7)
    image = draw_speed(right, run, run.frames()[-1][1], None, length_unit=1e-3)
    right.set_xlabel("x [mm]")
    figure.colorbar(image, ax=right, label="speed [m/s]")
    figure.tight_layout()
    run.save(figure, "migration.png")
    animate(run, "animation.gif", lambda ax, t, name: (draw_speed(ax, run, name, 0.14, length_unit=1e-3),
                                                       ax.set_title(f"t = {t:.2f} s")), (4.0, 4.0))


if __name__ == "__main__":
    main()
