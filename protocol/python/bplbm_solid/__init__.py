# SPDX-License-Identifier: MIT
"""The solid's side of BPLBM's protocol, for a particle program in Python on any number of ranks.

    import bplbm_solid

    with bplbm_solid.Solid("my engine") as fluid:
        fluid.agree(box_lo, box_hi, periodic, gravity, step, substeps, radius=(r, r), density=(rho, rho))
        while (loads := fluid.exchange(states, shapes)) is not None:
            ...  # substeps with loads["force"] [N] and loads["torque"] [N m]; then new states and shapes

README.md beside this package has a whole engine; protocol/WIRE.md has the wire itself.
"""

from .clump import Clump, union_moments
from .errors import FluidFault, FluidLeft, Refused, SolidError, TimedOut
from .records import BOND, LOAD, SHAPE, STATE, ball, disc, sphere
from .report import BondCounts, Report
from .session import Solid

__all__ = ["BOND", "LOAD", "SHAPE", "STATE", "BondCounts", "Clump", "FluidFault", "FluidLeft", "Refused", "Report", "Solid",
           "SolidError", "TimedOut", "ball", "disc", "sphere",
           "union_moments"]
__version__ = "0.1.0"
