"""Results and pictures of cylinder_array. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, drag_results, draw_errors, draw_speed, read_table, studies

DRAG = 51.526949  # F/(mu U) at c = 0.2
SOURCE = "spectral solution of the Stokes flow; Sangani and Acrivos 1982 within 0.03 %"
# 0.5 %: by the place of the cylinder within its cell the error differs by 0.4 % at ten cells, by 0.1 % at 20
TOLERANCE = FINE_TOLERANCE = 0.005


def drag(run):
    """F/(mu U): force on the cylinder a depth over viscosity and mean flux."""
    p, table = run.parameters, read_table(run.folder / "obstacles.csv")
    flux = run.frame(run.frames()[-1][1])["velocity"][:, 0, 0].mean()  # through the left side
    viscosity = p["density"] * p["kinematic_viscosity"]
    return table["fx"][-1] / p["depth"] / (viscosity * flux)


def main():
    run = Run(sys.argv[1])
    others = studies(run)
    p = run.parameters
    drive = p["density"] * 1e-3 * p["box_x"] * p["box_y"] * p["depth"]
    run.write_results(drag_results(run, others, drag, DRAG, SOURCE, drive, TOLERANCE, FINE_TOLERANCE))
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.2), width_ratios=(1, 1.5))
    image = draw_speed(left, run, run.frames()[-1][1], None, length_unit=1e-3)
    left.add_patch(plt.Circle((0.5115, 0.5205), 0.2523131, color="white"))
    left.set_xlabel("x [mm]")
    figure.colorbar(image, ax=left, label="speed [m/s]")
    draw_errors(right, run, others, lambda r: 100 * (drag(r) / DRAG - 1),
                "error of the drag [%], τ = 1.5, 10 cells across")
    figure.tight_layout()
    run.save(figure, "array.png")


if __name__ == "__main__":
    main()
