# SPDX-License-Identifier: GPL-2.0-or-later
"""Drag of rigid bodies of touching spheres in slow flow, by a shell of small beads [BloomfieldDaltonVanHolde1967].

    python3 tests/reference/shell_model.py

Each sphere is a shell of beads of the Rotne-Prager-Yamakawa mobility; the drag is extrapolated to beads of no size. It
gives force over 6πμaU and torque over 8πμa³ω:

    body         along x   along y   about x   about y   known
    sphere         0.9997    0.9997    1.0004    1.0003  1, 1, 1, 1
    pair, x axis   1.2898    1.4489    1.8036    3.7397  1.2903 [StimsonJeffery1926], 1.4486, 3/2 ζ(3) = 1.8031
    tetrahedron    1.7829    1.7831    6.007     6.009   -

The pair's drag across is that of two spheres that cannot turn: 0.724 a sphere. (0.716, which is often quoted, is that
of two that touch and roll.) tests/physics/clumps_test.cpp compares clumps with these numbers.
"""

import numpy as np


def shell(count):
    """Points spread evenly over a unit sphere."""
    i = np.arange(count) + 0.5
    polar, turn = np.arccos(1 - 2 * i / count), np.pi * (1 + np.sqrt(5)) * i
    return np.c_[np.cos(turn) * np.sin(polar), np.sin(turn) * np.sin(polar), np.cos(polar)]


def mobility(x, s):
    """Of beads of radius s at x, in a fluid of viscosity 1."""
    d = x[:, None] - x[None]
    r = np.linalg.norm(d, axis=2)
    np.fill_diagonal(r, 1.0)
    e = d / r[..., None]
    apart = r >= 2 * s
    even = np.where(apart, 3 * s / (4 * r) * (1 + 2 * s * s / (3 * r * r)), 1 - 9 * r / (32 * s))
    along = np.where(apart, 3 * s / (4 * r) * (1 - 2 * s * s / (r * r)), 3 * r / (32 * s))
    m = even[..., None, None] * np.eye(3) + along[..., None, None] * e[..., :, None] * e[..., None, :]
    m[np.arange(len(x)), np.arange(len(x))] = np.eye(3)
    return m.transpose(0, 2, 1, 3).reshape(3 * len(x), 3 * len(x)) / (6 * np.pi * s)


def resistance(centres, beads):
    """Of unit spheres: along x, along y, about x, about y; and the beads' radius."""
    centres = np.array(centres, float) - np.mean(centres, axis=0)
    points = [shell(beads) + c for c in centres]
    points = [p[np.all([np.linalg.norm(p - o, axis=1) >= 1 - 1e-12 for j, o in enumerate(centres) if j != i], axis=0)]
              if len(centres) > 1 else p for i, p in enumerate(points)]
    x = np.vstack(points)
    s = 0.95 * 0.5 * np.sqrt(4 * np.pi / beads)
    motion = np.zeros((3 * len(x), 6))
    for k in range(3):
        unit = np.eye(3)[k]
        motion[:, k], motion[:, 3 + k] = np.tile(unit, len(x)), np.cross(unit, x).ravel()
    drag = motion.T @ np.linalg.solve(mobility(x, s), motion)
    return [drag[0, 0] / (6 * np.pi), drag[1, 1] / (6 * np.pi), drag[3, 3] / (8 * np.pi), drag[4, 4] / (8 * np.pi)], s


if __name__ == "__main__":
    corner = 1 / np.sqrt(2)
    bodies = {"sphere": [(0, 0, 0)], "pair": [(-1, 0, 0), (1, 0, 0)],
              "tetrahedron": [(corner, corner, corner), (corner, -corner, -corner), (-corner, corner, -corner),
                              (-corner, -corner, corner)]}
    for name, centres in bodies.items():
        runs = [resistance(centres, n) for n in ((150, 300, 600, 1000) if len(centres) < 4 else (80, 140, 240, 380))]
        sizes = [s for _, s in runs]
        print(name, *(f"{np.polyfit(sizes, [drag[k] for drag, _ in runs], 2)[2]:.4f}" for k in range(4)))
