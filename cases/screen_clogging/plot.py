"""Results and pictures of screen_clogging. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_slice, quantity, read_table, result, studies

BELOW, ABOVE = 0.006, 0.008  # m, the screen's faces


def passed(run):
    """Grains that have gone through the slot, of all, and times [s] with how many had by then."""
    table = read_table(run.folder / "probes.csv")
    if np.any(table["id"] < -1):  # a clump has a row of its own beside those of its spheres
        clumps = table["id"] < -1
        table = {name: column[clumps] for name, column in table.items()}
    times = np.unique(table["time"])
    count = np.count_nonzero(table["time"] == times[0])
    under = table["z"] < BELOW  # seen there, so a grain that leaves by another way does not count
    ids, at = np.unique(table["id"][under], return_index=True)
    arrivals = table["time"][under][at] if len(ids) else np.array([])
    return count, times, np.array([np.count_nonzero(arrivals <= t) for t in times])


def main():
    run = Run(sys.argv[1])
    others = studies(run)
    count, times, through = passed(run)
    results = [result("grains through the wide slot", through[-1] / count, "1", 1.0,
                      "a slot of three grains holds none but those that rest on the bars", 0.15)]
    told = [quantity("grains", count, "1")]
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.6, 3.6), width_ratios=(1, 1.4))
    image = draw_slice(left, run, min(run.frames(), key=lambda f: abs(f[0] - 0.1))[1], "y", length_unit=1e-3)
    figure.colorbar(image, ax=left, label="speed [m/s]")
    right.plot(times, 100 * through / count, label="spheres, slot of 3 grains")
    if "variant-narrow" in others:
        narrow = others["variant-narrow"]
        held, held_times, held_through = passed(narrow)
        results.append(result("grains through the narrow slot", held_through[-1] / held, "1", 0.0,
                              "a slot of 0.8 grains", 0, scale=1.0))
        told.append(quantity("flux with the slot clogged", narrow.mean_velocity(narrow.frames()[-1][1])[2], "m/s"))
        right.plot(held_times, 100 * held_through / held, label="spheres, slot of 0.8 grains")
    if "variant-clumps" in others:
        count, times, through = passed(others["variant-clumps"])
        results.append(result("clumps through the wide slot", through[-1] / count, "1", 1.0,
                              "it is twice as wide as a clump is long", 0.2))
        told.append(quantity("clumps", count, "1"))
        right.plot(times, 100 * through / count, label="clumps of two, slot of 3 grains")
    run.write_results(results, told)
    right.set(xlabel="time [s]", ylabel="grains through the slot [%]")
    right.legend()
    figure.tight_layout()
    run.save(figure, "screen.png")


if __name__ == "__main__":
    main()
