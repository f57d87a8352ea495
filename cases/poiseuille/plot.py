"""Results and picture of poiseuille. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, result

# Body force: TRT with Λ = 3/16 has the parabola as an exact solution between half-way walls, what
# remains is round-off; the field file stores single precision, 6e-8 of the largest value.
# Pressures make the flow slightly compressible: the density falls along the channel, and with it the
# error, as Ma² (2.4 % and 0.14 % measured at u/C = 0.1 and 0.025; the scenes take 0.025).
# A flow that is held: its flux is what crosses planes between cells, which at 32 cells is 1/2048 more than the parabola's.
TOLERANCE = {"": 2e-7, "pressure_jump": 3e-3, "pressure": 3e-3, "flow_rate": 1e-3}


def main():
    run = Run(sys.argv[1])
    p = run.parameters
    velocity = run.frame(run.frames()[-1][1])["velocity"]
    h, ny = p["box_y"], velocity.shape[0]
    y = (np.arange(ny) + 0.5) * h / ny
    u = velocity[:, velocity.shape[1] // 2, 0].astype(float)
    exact = 8.0 / p["density"] * y * (h - y) / (2 * p["kinematic_viscosity"])
    variant = run.summary["variant"]
    run.write_results([result("largest error of u / u_max", np.abs(u - exact).max() / exact.max(), "1",
                              0.0, "G y (H - y) / 2ν", TOLERANCE[variant], scale=1.0)])
    figure, ax = plt.subplots(figsize=(4.6, 3.4))
    ax.plot(exact, 100 * y, "0.6", linewidth=3, label="exact")
    ax.plot(u, 100 * y, "o", markersize=3.5, label="BPLBM")
    ax.set_xlabel("u [m/s]")
    ax.set_ylabel("y [cm]")
    ax.legend()
    run.save(figure, "profile.png")


if __name__ == "__main__":
    main()
