"""Results and picture of couette_disc. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_speed, result

SHEAR = 0.1  # 1/s


def main():
    run = Run(sys.argv[1])
    probe, p = run.probes(), run.parameters
    run.write_results([
        # 1 %: D/H = 0.1, Re = 0.1, and ten cells across
        result("angular velocity", probe["omega"][-1], "1/s", -SHEAR / 2, "-γ/2, Stokes flow", 0.01),
        result("drift of the centre", probe["y"][-1], "m", p["box_y"] / 2,
               "symmetry; 0.1 % of a diameter", 0.001, scale=p["diameter"])])
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.0))
    image = draw_speed(left, run, run.frames()[-1][1], None, length_unit=1e-3)
    left.set_xlabel("x [mm]")
    figure.colorbar(image, ax=left, label="speed [m/s]")
    right.plot(probe["time"], probe["omega"] / SHEAR)
    right.axhline(-0.5, color="0.5", linewidth=0.8)
    right.set_xlabel("time [s]")
    right.set_ylabel("angular velocity / shear rate")
    figure.tight_layout()
    run.save(figure, "turning.png")


if __name__ == "__main__":
    main()
