"""Results and pictures of sphere_array. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, drag_results, draw_errors, draw_slice, read_table, studies

DRAG = 4.292  # K = F/(6 pi mu a U) at c = 0.125
SOURCE = "Zick and Homsy 1982"
# 1 %: the default is off by 0.2 to 0.7 %, by the place of the sphere within its cell, at every relaxation time
TOLERANCE = FINE_TOLERANCE = 0.01


def drag(run):
    """K: force on the sphere over Stokes' for the mean flux."""
    p, table = run.parameters, read_table(run.folder / "obstacles.csv")
    flux = run.frame(run.frames()[-1][1])["velocity"][:, :, 0, 0].mean(dtype=float)  # through the left side
    viscosity = p["density"] * p["kinematic_viscosity"]
    radius = 0.5 * p["box_x"] * 2 * (3 * 0.125 / (4 * np.pi)) ** (1 / 3)
    return table["fx"][-1] / (6 * np.pi * viscosity * radius * flux)


def main():
    run = Run(sys.argv[1])
    others = studies(run)
    p = run.parameters
    drive = p["density"] * 1e-3 * p["box_x"] ** 3
    run.write_results(drag_results(run, others, drag, DRAG, SOURCE, drive, TOLERANCE, FINE_TOLERANCE))
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.2), width_ratios=(1, 1.5))
    image = draw_slice(left, run, run.frames()[-1][1], "y", length_unit=1e-3)
    figure.colorbar(image, ax=left, label="speed [m/s]")
    draw_errors(right, run, others, lambda r: 100 * (drag(r) / DRAG - 1),
                "error of the drag [%], τ = 1.5, 10 cells across")
    figure.tight_layout()
    run.save(figure, "array.png")


if __name__ == "__main__":
    main()
