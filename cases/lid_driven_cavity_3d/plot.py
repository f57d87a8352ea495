"""Results and picture of lid_driven_cavity_3d. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_slice, result

# Albensoeder and Kuhlmann, J. Comput. Phys. 206 (2005) 536, spectral, Re 1000: least u on the vertical, largest
# and least v on the horizontal centre line. From memory; that all three agree is what vouches for them.
REFERENCE = {"least u": -0.2803833, "largest v": 0.2466510, "least v": -0.4350163}
# Of the lid's speed: 64 cells an edge leave a boundary layer of some three cells at the lid's sides.
TOLERANCE = 0.02


def middle(values, axis):
    """Mean of the two layers at the middle of an axis with an even number of cells."""
    n = values.shape[axis]
    return 0.5 * (np.take(values, n // 2 - 1, axis) + np.take(values, n // 2, axis))


def main():
    run = Run(sys.argv[1])
    last = run.frames()[-1][1]
    plane = middle(run.frame(last)["velocity"].astype(float), 0)  # [y][x][3] at z = ½
    u, v = middle(plane, 1)[:, 0], middle(plane, 0)[:, 1]
    at = (np.arange(len(u)) + 0.5) / len(u)
    found = {"least u": u.min(), "largest v": v.max(), "least v": v.min()}
    run.write_results([result(name, value, "U", REFERENCE[name], "Albensoeder and Kuhlmann 2005", TOLERANCE,
                              scale=1.0) for name, value in found.items()])
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.6))
    image = draw_slice(left, run, last, "z", vmax=0.6, length_unit=1.0)
    left.streamplot(at, at, plane[..., 0], plane[..., 1], color="w", linewidth=0.4, density=1.3, arrowsize=0.5)
    figure.colorbar(image, ax=left, label="speed at z = ½ [U]")
    right.plot(at, u, label="u(y) at x = z = ½")
    right.plot(at, v, label="v(x) at y = z = ½")
    for value in REFERENCE.values():
        right.axhline(value, color="0.5", linewidth=0.8, linestyle=":")
    right.set_xlabel("y, x")
    right.legend(title="dotted: reference extremes")
    run.save(figure, "cavity.png")


if __name__ == "__main__":
    main()
