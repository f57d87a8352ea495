# SPDX-License-Identifier: MIT
"""A solid program to copy: equal clumps under gravity and the fluid's loads, which do not meet.

    mpirun -np 1 lbm scene.toml : -np 1 python3 clump_engine.py

One clump stands at each of the scene's `particles.start`. Its discs or spheres are a variable of the scene, places about
any point and radius each, in metres:

    [particles.variables]
    clump = "-0.001,0,0,0.002:0.001,0,0,0.002"
"""

import pathlib
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "protocol" / "python"))  # where it is not installed
import bplbm_solid  # noqa: E402

with bplbm_solid.Solid("clump_engine.py") as fluid:
    try:
        parts = np.array([[float(n) for n in part.split(",")] for part in fluid.text("clump").split(":")]).reshape(-1, 4)
    except ValueError as error:
        raise bplbm_solid.SolidError(f"clump = '{fluid.text('clump')}' is no list of x,y,z,r:x,y,z,r…; correct "
                                     "[particles.variables]", bplbm_solid.errors.BAD_INPUT) from error
    density, dt, substeps = fluid.number("density_max"), fluid.number("solid_step"), int(fluid.number("substeps"))
    lo, hi, gravity = fluid.vector("{}_lo"), fluid.vector("{}_hi"), fluid.number("gravity") * fluid.vector("gravity_{}")
    dimension = fluid.fluid.dimension
    periodic = np.array([fluid.text(f"boundary_{a}") == "p" for a in "xyz"]) | (np.arange(3) >= dimension)
    walls = [a < dimension and fluid.number(f"walls_{'xyz'[a]}") != 0 for a in range(3)]
    clumps = []
    while f"particle{(i := len(clumps) + 1)}_x" in fluid.variables:
        clump = bplbm_solid.Clump(i, parts[:, :3], parts[:, 3], density, dimension=dimension,
                                  spheres=[1000 * i + j for j in range(len(parts))],
                                  depth=fluid.number("depth") if dimension == 2 else 1.0)
        clump.x = fluid.vector(f"particle{i}_{{}}")
        clumps.append(clump)
    shapes = np.concatenate([c.shapes for c in clumps])
    first = np.arange(len(clumps)) * (len(parts) + 1)  # of each clump the carrier's record

    fluid.agree(lo, hi, periodic, gravity, dt, substeps, len(clumps), radius=(parts[:, 3].min(), parts[:, 3].max()),
                density=(density, density), checkpoints=False, walls=[wall for wall in walls for _ in range(2)])
    while (loads := fluid.exchange(np.concatenate([c.states for c in clumps]), shapes)) is not None:
        for clump, load in zip(clumps, loads[first]):
            for _ in range(substeps):
                clump.move(load["force"] + clump.mass * gravity, load["torque"], dt)
