# SPDX-License-Identifier: GPL-2.0-or-later
"""YADE as the solid: discs or spheres of one size, or equal clumps of them, between walls or in a periodic box, with YADE's
own contact laws.

    mpirun -np 1 lbm scene.toml : -np 1 /usr/bin/python3 tools/engines/yade/engine.py
    tools/run SCENE --engine yade

It imports YADE as a module. (`yade -x engine.py` under mpirun would end in collective calls of YADE's own over all
ranks of the job, the fluid's included, and takes the script's arguments for its own.) Laws and variables: README.md of
this folder.
"""

import os
import pathlib
import sys

from mpi4py import MPI  # noqa: F401  before YADE, which imports it, too

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "protocol" / "python"))  # where it is not installed
import bplbm_solid  # noqa: E402
from clumps import Clumps  # noqa: E402
from grains import Grains  # noqa: E402


def import_yade():
    """Debian's YADE is no module that Python finds. @throws SolidError"""
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # or each step waits for as many threads as there are cores
    prefix = pathlib.Path(os.environ.get("YADE_PREFIX", "/usr"))
    for found in sorted(prefix.glob("lib*/**/yade*/py/yade/__init__.py")):
        sys.path.insert(1, str(found.parents[1]))
        break
    try:
        import yade
    except ImportError as error:
        raise bplbm_solid.SolidError(f"YADE cannot be imported ({error}); apt-get install yade, or set YADE_PREFIX", 2) from error
    return yade


with bplbm_solid.Solid("yade") as fluid:
    if fluid.size > 1:
        raise bplbm_solid.SolidError("the YADE engine runs on one rank; start it with -np 1", 2)
    grains = (Clumps if "clump" in fluid.variables else Grains)(fluid, import_yade())
    O = grains.O
    failed = []

    def exchange():
        """At the beginning of every interval, between YADE's contacts and its motion. What is raised here YADE would
        only print: it is kept, and raised again when YADE has stopped."""
        try:
            if O.iter == 0:
                grains.laws.begin(grains)
            else:
                grains.remove_outside()
                grains.change_by_scene()
            loads = fluid.exchange(grains.states(), grains.shapes(), report=grains.laws.report(grains),
                                   memory=grains.memory)
            if loads is None:
                O.pause()
            else:
                grains.take(loads)
        except BaseException as error:  # noqa: BLE001
            failed.append(error)
            O.pause()

    if fluid.interval:
        grains.restore(*fluid.restart())
    else:
        grains.change_by_scene()
    fluid.agree(grains.lo, grains.hi, grains.periodic, grains.gravity, grains.dt, grains.substeps, len(grains.bodies),
                radius=grains.radii, density=(grains.density, grains.density),
                walls=[wall for wall in grains.walls for _ in range(2)], checkpoints=grains.laws.checkpoints)
    O.run(-1, True)
    if failed:
        raise failed[0]
