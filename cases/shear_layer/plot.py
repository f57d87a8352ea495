"""Results and picture of shear_layer. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, result


def vorticity(velocity, cell):
    """Central differences in a periodic box."""
    u, v = velocity[..., 0], velocity[..., 1]
    return ((np.roll(v, -1, 1) - np.roll(v, 1, 1)) - (np.roll(u, -1, 0) - np.roll(u, 1, 0))) / (2 * cell)


def main():
    run = Run(sys.argv[1])
    frames = [(t, run.frame(name)["velocity"].astype(float)) for t, name in run.frames()]
    energy = [(v[..., 0] ** 2 + v[..., 1] ** 2).mean() for _, v in frames]
    speed = np.hypot(frames[-1][1][..., 0], frames[-1][1][..., 1]).max()
    # At Re = 1e4 the flow is known (reference.py); beyond, energy only falls, as there is no force.
    known = abs(run.parameters["kinematic_viscosity"] - 1e-4) < 1e-9
    run.write_results([
        result("time reached", frames[-1][0], "s", 1.5, "bounded to the end", 0.01),
        result("energy at the end / start", energy[-1] / energy[0], "1", *(
            (0.9582, "spectral solution, reference.py", 0.015) if known else (1.0, "only falls, slowly at this Re", 0.1)))]
        + ([result("largest speed at the end", speed, "U", 1.475, "spectral solution, reference.py", 0.03)] if known else []))
    figure, axes = plt.subplots(1, len(frames), figsize=(2.9 * len(frames), 3.0))
    for ax, (time, velocity) in zip(axes, frames):
        ax.imshow(vorticity(velocity, run.parameters["cell"]), origin="lower", extent=[0, 1, 0, 1],
                  cmap="RdBu_r", vmin=-40, vmax=40)
        ax.set_title(f"vorticity, t = {time:.2g}")
        ax.grid(False)
    run.save(figure, "shear_layer.png")


if __name__ == "__main__":
    main()
