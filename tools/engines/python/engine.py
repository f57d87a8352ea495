# SPDX-License-Identifier: MIT
"""A solid program in fifty lines: equal discs under gravity, springs and dashpots F_n = k δ - γ v_n, and the fluid's loads.

    mpirun -np 1 lbm scene.toml : -np 1 python3 engine.py

Copy it, and put your own particles in place of these. Everything comes from the variables that the fluid offers.
"""

import math

import wire
import numpy as np

with wire.Solid("engine.py") as fluid:
    lo, hi, gravity = fluid.vector("{}_lo"), fluid.vector("{}_hi"), fluid.number("gravity") * fluid.vector("gravity_{}")
    periodic = np.array([fluid.text(f"boundary_{a}") == "p" for a in "xy"] + [True])
    walls = [fluid.number(f"walls_{a}") != 0 for a in "xy"]
    dt, substeps = fluid.number("solid_step"), int(fluid.number("substeps"))
    r = fluid.number("diameter_max") / 2
    m = fluid.number("density_max") * math.pi * r**2 * fluid.number("depth")
    k = fluid.number("contact_stiffness", 1e5)
    gamma = 2 * fluid.number("damping_ratio", 0.5) * math.sqrt(m * k)

    def inserted(discs, i=1):
        """The discs, and those of the scene that come at this interval."""
        while f"particle{i}_x" in fluid.variables:
            if fluid.number(f"particle{i}_interval", 0) == fluid.interval:
                place, speed = fluid.vector(f"particle{i}_{{}}"), fluid.vector(f"particle{i}_v{{}}")
                discs = np.append(discs, np.array([(i, place, speed, np.zeros(3))], wire.STATE))
            i += 1
        return discs

    def push(overlap, approach):
        return np.where(overlap > 0, np.maximum(0, k * overlap + gamma * approach), 0)

    def forces(x, v, load):
        f = load + m * gravity
        for a in (a for a in (0, 1) if walls[a]):
            f[:, a] += push(r - x[:, a] + lo[a], -v[:, a]) - push(r - hi[a] + x[:, a], v[:, a])
        for i in range(len(x)):
            n = x[i] - x
            n -= np.where(periodic, (hi - lo) * np.round(n / (hi - lo)), 0)
            distance = np.linalg.norm(n, axis=1)
            distance[i] = np.inf  # itself
            f[i] += (push(2 * r - distance, -np.sum((v[i] - v) * n, axis=1) / distance) / distance) @ n
        return f

    discs = fluid.restart() if fluid.interval else inserted(np.empty(0, wire.STATE))
    sides = [wall for axis in (*walls, False) for wall in (axis, axis)]
    fluid.agree(lo, hi, periodic, gravity, dt, substeps, len(discs), walls=sides)
    shapes = lambda: np.array([wire.ball(i, r, m, m * r**2 / 2) for i in discs["id"]], wire.SHAPE)  # noqa: E731
    while (loads := fluid.exchange(discs, shapes())) is not None:
        x, v = discs["x"], discs["v"]
        f = forces(x, v, loads["force"])
        for _ in range(substeps):  # velocity Verlet
            v += 0.5 * dt / m * f
            x += dt * v
            f = forces(x, v, loads["force"])
            v += 0.5 * dt / m * f
        discs["omega"] += substeps * dt / (m * r**2 / 2) * loads["torque"]
        x[:] = np.where(periodic, lo + np.mod(x - lo, hi - lo), x)
        discs = inserted(discs[np.all((x >= lo) & (x <= hi), axis=1)])
