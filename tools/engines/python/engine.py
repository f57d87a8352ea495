# SPDX-License-Identifier: MIT
"""A solid program to copy: equal discs or spheres under gravity, springs and dashpots F_n = k δ - γ v_n, and the fluid's loads.

    mpirun -np 1 lbm scene.toml : -np 1 python3 engine.py

Put your own particles in place of these. Everything comes from the variables that the fluid offers. On several ranks each
moves all particles, and speaks for its share of them.
"""

import math
import pathlib
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "protocol" / "python"))  # where it is not installed
import bplbm_solid  # noqa: E402

with bplbm_solid.Solid("engine.py") as fluid:
    lo, hi, gravity = fluid.vector("{}_lo"), fluid.vector("{}_hi"), fluid.number("gravity") * fluid.vector("gravity_{}")
    axes = range(dimension := fluid.fluid.dimension)
    periodic = np.array([fluid.text(f"boundary_{a}") == "p" for a in "xyz"]) | (np.arange(3) >= dimension)
    walls = [a < dimension and fluid.number(f"walls_{'xyz'[a]}") != 0 for a in range(3)]
    dt, substeps = fluid.number("solid_step"), int(fluid.number("substeps"))
    r, density = fluid.number("diameter_max") / 2, fluid.number("density_max")
    ball = bplbm_solid.disc(0, r, density, fluid.number("depth")) if dimension == 2 else bplbm_solid.sphere(0, r, density)
    m, inertia = float(ball["mass"]), float(ball["inertia"])
    k = fluid.number("contact_stiffness", 1e5)
    gamma = 2 * fluid.number("damping_ratio", 0.5) * math.sqrt(m * k)
    epochs = {}  # of the ids whose particles did not come at the beginning

    def inserted(discs, i=1):
        """The particles, less those that the scene takes out at this interval, and with those that come."""
        while f"particle{i}_x" in fluid.variables:
            number = int(fluid.number(f"particle{i}_id", i))
            if fluid.number(f"particle{i}_until", -1) == fluid.interval:
                discs = discs[discs["id"] != number]
            if fluid.number(f"particle{i}_interval", 0) == fluid.interval:
                place, speed = fluid.vector(f"particle{i}_{{}}"), fluid.vector(f"particle{i}_v{{}}")
                discs = np.append(discs, np.array([(number, place, speed, np.zeros(3))], bplbm_solid.STATE))
                epochs[number] = fluid.interval
            i += 1
        return discs

    def push(overlap, approach):
        return np.where(overlap > 0, np.maximum(0, k * overlap + gamma * approach), 0)

    def forces(x, v, load):
        f = load + m * gravity
        for a in (a for a in axes if walls[a]):
            f[:, a] += push(r - x[:, a] + lo[a], -v[:, a]) - push(r - hi[a] + x[:, a], v[:, a])
        for i in range(len(x)):
            n = x[i] - x
            n -= np.where(periodic, (hi - lo) * np.round(n / (hi - lo)), 0)
            distance = np.linalg.norm(n, axis=1)
            distance[i] = np.inf  # itself
            f[i] += (push(2 * r - distance, -np.sum((v[i] - v) * n, axis=1) / distance) / distance) @ n
        return f

    def exchange(discs):
        """Loads of all particles, of which this rank sends every so many."""
        shapes = np.full(len(discs), ball)
        shapes["id"], shapes["epoch"] = discs["id"], [epochs.get(i, 0) for i in discs["id"]]
        mine = discs["id"] % fluid.size == fluid.rank
        loads = fluid.exchange(discs[mine], shapes[mine])
        if loads is None or fluid.size == 1:
            return loads
        both = np.zeros((len(discs), 6))
        both[mine] = np.hstack([loads["force"], loads["torque"]])
        both = fluid.comm.allreduce(both)
        return {"force": both[:, :3], "torque": both[:, 3:]}

    discs = fluid.restart()[0] if fluid.interval else inserted(np.empty(0, bplbm_solid.STATE))
    fluid.agree(lo, hi, periodic, gravity, dt, substeps, len(discs), radius=(r, r), density=(density, density),
                walls=[wall for wall in walls for _ in range(2)])
    while (loads := exchange(discs)) is not None:
        x, v = discs["x"], discs["v"]
        f = forces(x, v, loads["force"])
        for _ in range(substeps):  # velocity Verlet
            v += 0.5 * dt / m * f
            x += dt * v
            f = forces(x, v, loads["force"])
            v += 0.5 * dt / m * f
        discs["omega"] += substeps * dt / inertia * loads["torque"]
        x[:] = np.where(periodic, lo + np.mod(x - lo, hi - lo), x)
        discs = inserted(discs[np.all((x >= lo) & (x <= hi), axis=1)])
