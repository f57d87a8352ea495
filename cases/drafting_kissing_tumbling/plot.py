"""Results and pictures of drafting_kissing_tumbling. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_snapshots, result

SOURCE = "what every published simulation shows"


def main():
    run = Run(sys.argv[1])
    follower, leader = run.probes(1), run.probes(2)
    p, t = run.parameters, follower["time"]
    dx, dy = follower["x"] - leader["x"], follower["y"] - leader["y"]
    gap = np.hypot(dx, dy) / p["diameter"] - 1
    kiss = np.flatnonzero(gap < 0.05)
    tumble = np.flatnonzero(np.abs(dx) > np.abs(dy))
    passed = np.flatnonzero(dy < 0)
    first = [t[i[0]] if len(i) else np.nan for i in (kiss, tumble, passed)]
    run.write_results([
        # yes or no: 1 if it happens, in this order, before the end
        result("drafting: the follower catches up", len(kiss) > 0, "yes", 1, SOURCE, 0),
        result("kissing, then tumbling", first[1] > first[0], "yes", 1, SOURCE, 0),
        result("smallest gap", gap.min(), "diameters", 0.0,
               "contact overlap and no lubrication; 5 %", 0.05, scale=1.0)])
    print(f"run | note | kiss at {first[0]:.2f} s, side by side at {first[1]:.2f} s, follower ahead at "
          f"{first[2]:.2f} s")
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.4, 5.0), sharex=True)
    for name, probe in (("follower", follower), ("leader", leader)):
        top.plot(t, -probe["vy"], label=name)
    top.set_ylabel("falling velocity [m/s]")
    top.legend()
    bottom.plot(t, gap)
    bottom.set_ylabel("gap / diameter")
    bottom.set_xlabel("time [s]")
    run.save(figure, "history.png")

    draw_snapshots(run, (0.5, 1.0, 1.5, 2.0, 2.5, 3.0), 0.025, width=1.2)


if __name__ == "__main__":
    main()
