# SPDX-License-Identifier: MIT
"""leaving_peer.py STAGE HOW: a solid on bplbm_solid that leaves at a stage (connected, agreed, states, running, last,
goodbye, block, refused) by MPI_Finalize only (finalize), by exit, or with its farewell. Its box is that of settling_disc.
"""

import os
import sys

import bplbm_solid
import numpy as np
from mpi4py import MPI

stage, how = sys.argv[1:]


def leave(fluid):
    if how == "exit":
        os._exit(0)
    if how == "finalize":
        MPI.Finalize()
        os._exit(0)
    fluid._open = fluid._open and stage == "block"  # else without the goodbye that leaving the block says
    fluid.__exit__(None, None, None)
    sys.exit(0)


fluid = bplbm_solid.Solid("leaving_peer").__enter__()
if stage == "connected":
    leave(fluid)
gravity = fluid.number("gravity") * fluid.vector("gravity_{}")
try:
    fluid.agree(fluid.vector("{}_lo"), fluid.vector("{}_hi"), (0, 0, 1), gravity * (2 if stage == "refused" else 1),
                fluid.number("solid_step"), int(fluid.number("substeps")))
except bplbm_solid.Refused:
    leave(fluid)
if stage == "agreed":
    leave(fluid)
states = np.array([(4, (0.01, 0.04, 0), (0, 0, 0), (0, 0, 0))], bplbm_solid.STATE)
shapes = np.array([bplbm_solid.disc(4, 0.00125, 1250.0, 1.0)])
if stage == "states":
    fluid._channel.receive = lambda *_: leave(fluid)  # in place of the loads
while fluid.exchange(states, shapes) is not None:
    if fluid.interval == 3:
        if stage == "goodbye":
            fluid.goodbye("has seen enough")
        if stage in ("running", "goodbye", "block"):
            break
leave(fluid)
