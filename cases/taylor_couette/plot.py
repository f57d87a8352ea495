"""Results and picture of taylor_couette. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_speed, read_table, result

R1, R2, SPIN = 0.0016, 0.0032, 1.0
CENTRE = np.array([0.00382, 0.00379])
SOURCE = "4πμΩR₁²R₂²/(R₂² - R₁²)"


def profile(run):
    """Radius and tangential velocity of every cell between the cylinders."""
    frame, p = run.frame(run.frames()[-1][1]), run.parameters
    y, x = np.indices(frame["pressure"].shape)
    arm = (np.stack([x, y]) + 0.5) * p["cell"] - CENTRE[:, None, None]
    r = np.hypot(*arm)
    tangential = (arm[0] * frame["velocity"][..., 1] - arm[1] * frame["velocity"][..., 0]) / r
    gap = (r > R1 + p["cell"]) & (r < R2 - p["cell"])
    return r[gap], tangential[gap]


def exact(r):
    return SPIN * R1**2 / (R2**2 - R1**2) * (R2**2 / r - r)


def main():
    run = Run(sys.argv[1])
    p, table = run.parameters, read_table(run.folder / "obstacles.csv")
    torque = {n: table["torque"][table["obstacle"] == n][-1] / p["depth"] for n in (1, 2)}
    viscosity = p["density"] * p["kinematic_viscosity"]
    reference = 4 * np.pi * viscosity * SPIN * R1**2 * R2**2 / (R2**2 - R1**2)
    r, u = profile(run)
    error = np.sqrt(np.mean((u - exact(r)) ** 2)) / (SPIN * R1)
    run.write_results([
        # 1 %: the error is -0.1 % inside and -0.8 % outside, at a gap of 16 cells
        result("torque on the inner cylinder", -torque[2], "N m/m", reference, SOURCE, 0.01),
        result("torque on the outer cylinder", torque[1], "N m/m", reference, SOURCE, 0.01),
        result("rms error of the velocity", error, "1", 0.0, "exact profile, over the rim's speed",
               0.01, scale=1.0)])
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.2))
    image = draw_speed(left, run, run.frames()[-1][1], None, length_unit=1e-3)
    left.set_xlabel("x [mm]")
    figure.colorbar(image, ax=left, label="speed [m/s]")
    right.plot(r * 1e3, u, ".", markersize=2, label="cells")
    fine = np.linspace(R1, R2, 200)
    right.plot(fine * 1e3, exact(fine), label="exact")
    right.set_xlabel("radius [mm]")
    right.set_ylabel("tangential velocity [m/s]")
    right.legend()
    figure.tight_layout()
    run.save(figure, "couette.png")


if __name__ == "__main__":
    main()
