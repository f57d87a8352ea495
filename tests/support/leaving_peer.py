# SPDX-License-Identifier: MIT
"""leaving_peer.py STAGE HOW: a solid on wire.py that leaves at a stage (connected, agreed, states, running, last, refused)
by MPI_Finalize only (finalize), by exit, or with its farewell. Its box is that of settling_disc.
"""

import os
import sys

import wire
import numpy as np
from mpi4py import MPI

stage, how = sys.argv[1:]


def leave(fluid):
    if how == "exit":
        os._exit(0)
    if how == "finalize":
        MPI.Finalize()
        os._exit(0)
    fluid.__exit__(None, None, None)
    sys.exit(0)


fluid = wire.Solid("leaving_peer").__enter__()
if stage == "connected":
    leave(fluid)
gravity = fluid.number("gravity") * fluid.vector("gravity_{}")
try:
    fluid.agree(fluid.vector("{}_lo"), fluid.vector("{}_hi"), (0, 0, 1), gravity * (2 if stage == "refused" else 1),
                fluid.number("solid_step"), int(fluid.number("substeps")))
except wire.Stop:
    leave(fluid)
if stage == "agreed":
    leave(fluid)
states = np.array([(4, (0.01, 0.04, 0), (0, 0, 0), (0, 0, 0))], wire.STATE)
mass = 1250.0 * np.pi * 0.00125**2
shapes = np.array([wire.ball(4, 0.00125, mass, 0.5 * mass * 0.00125**2)], wire.SHAPE)
if stage == "states":
    fluid._receive = lambda kind: leave(fluid)  # in place of the loads
while fluid.exchange(states, shapes) is not None:
    if stage == "running" and fluid.interval == 3:
        break
leave(fluid)
