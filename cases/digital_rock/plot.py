"""Results and picture of digital_rock. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_slice, quantity, read_table, result, studies

DRAG = 42.1  # K = F/(6π μ a U) of touching spheres in a simple cubic array
SOURCE = "Zick and Homsy 1982, k = 4a²/(3π K)"
FORCE = 1e-2  # m/s² along x
# 1 %: their K has three digits; the sphere's place in the cells and the grey levels of the image change k by 0.5 %
TOLERANCE = 0.01
STAIRCASE = 0.04  # what a surface of whole voxels costs, which the variant shows


def permeability(run):
    """k = ν U / g [m²], U the mean velocity over the box, which is the flux."""
    return run.parameters["kinematic_viscosity"] * run.mean_velocity(run.frames()[-1][1])[0] / FORCE


def main():
    run = Run(sys.argv[1])
    others = studies(run)
    p = run.parameters
    side = p["box_x"]
    exact = 4 * (side / 2)**2 / (3 * np.pi * DRAG)
    porosity = 1 - np.pi / 6
    kozeny = porosity**3 * side**2 / (180 * (1 - porosity)**2)
    load = read_table(run.folder / "obstacles.csv")["fx"][-1]
    run.write_results([
        result("permeability", permeability(run), "m^2", exact, SOURCE,
               STAIRCASE if run.summary.get("variant") == "staircase" else TOLERANCE),
        result("force over driving force", load / (p["density"] * FORCE * side**3), "1", 1.0,
               "momentum balance of steady flow", 1e-3)],
        [quantity("permeability over Kozeny-Carman's", permeability(run) / kozeny, "1")])
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.2), width_ratios=(1, 1.5))
    image = draw_slice(left, run, run.frames()[-1][1], "y", at=0.1 * side, length_unit=1e-3)  # the pores are wide there
    figure.colorbar(image, ax=left, label="speed [µm/s]", format=lambda value, _: f"{1e6 * value:.0f}")
    left.set_xticks([0.0, 0.5, 1.0])
    names = {"set-fine": "grey, a cell a voxel", "variant-averaged": "cut at a threshold, averaged",
             "variant-staircase": "cut at a threshold, a cell a voxel"}
    rows = {"grey, averaged": run, **{names[name]: other for name, other in others.items() if name in names}}
    errors = [100 * (permeability(r) / exact - 1) for r in rows.values()]
    right.axvline(0, color="0.3", linewidth=0.8)
    right.barh(list(rows), errors)
    for i, error in enumerate(errors):
        right.text(max(error, 0), i, f" {error:+.2f} %", va="center")
    right.margins(x=0.25)
    right.invert_yaxis()
    right.set_xlabel("error of the permeability [%]")
    figure.tight_layout()
    run.save(figure, "rock.png")


if __name__ == "__main__":
    main()
