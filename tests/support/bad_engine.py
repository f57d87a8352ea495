# SPDX-License-Identifier: MIT
"""bad_engine.py SIN: the Python engine with one thing done wrong, for the judge (bplbm-conformance) to find."""

import os
import pathlib
import runpy
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "protocol" / "python"))

import bplbm_solid  # noqa: E402
import numpy as np  # noqa: E402
from bplbm_solid import checkpoints, frames, routing  # noqa: E402
from bplbm_solid.channel import Channel  # noqa: E402
from mpi4py import MPI  # noqa: E402

Solid, Clump = bplbm_solid.Solid, bplbm_solid.Clump
exchange, number, vector, disc = Solid.exchange, Solid.number, Solid.vector, bplbm_solid.disc
receive, await_farewells, hear = Channel.receive, Channel.await_farewells, Channel._hear
encode_states, decode_handshake, decode_loads = frames.encode_states, frames.decode_handshake, frames.decode_loads
touching = routing.touching


def says(name, value):
    """A variable of the scene is taken for another number. @param value  of the session"""
    Solid.number = lambda self, n, default=None: value(self) if n.endswith(name) else number(self, n, default)


def half_load():
    def halved(self, states, shapes, **more):
        loads = exchange(self, states, shapes, **more)
        if loads is not None:
            loads["force"] *= 0.5
        return loads
    Solid.exchange = halved


def short_way():
    first = []

    def shortened(self, states, shapes, **more):
        first.append(states["x"].copy())
        sent = states.copy()
        sent["x"] -= 1e-3 * (states["x"] - first[0])
        return exchange(self, sent, shapes, **more)
    Solid.exchange = shortened


def unit_depth():
    bplbm_solid.disc = lambda i, r, density, depth, *more: disc(i, r, density, 1.0, *more)


def ring():
    def of_a_ring(*words):
        shape = disc(*words)
        shape["inertia"] *= 2
        return shape
    bplbm_solid.disc = of_a_ring


def no_contact():
    says("contact_stiffness", lambda self: 0.0)


def no_image():
    np.mod = lambda a, b: a


def all_vanish():
    np.all = lambda a, axis: np.full(len(a), a.all())


def early():
    says("_interval", lambda self: 0.0)


def same_epoch():
    def without(self, states, shapes, **more):
        shapes["epoch"] = 0
        return exchange(self, states, shapes, **more)
    Solid.exchange = without


def only_whole_discs():
    def inside(fluid, states, radius):
        there = touching(fluid, states, radius)
        return there[states["x"][there, 0] > fluid.subdomain_lo[0]]
    routing.touching = inside


def never_last():
    frames.encode_states = lambda k, t, flags, *more: encode_states(k, t, flags & ~frames.LAST, *more)


def unasked_checkpoint():
    frames.encode_states = lambda k, t, flags, *more: encode_states(k, t, flags | frames.CHECKPOINT, *more)


def no_checkpoint_file():
    checkpoints.write = lambda *_: None


def any_version():
    frames.decode_handshake = lambda payload: decode_handshake(np.uint32(frames.VERSION).tobytes() + payload[4:])


def agreeable_box():
    Solid.vector = lambda self, pattern: (np.array(self.fluid.box_hi) if pattern == "{}_hi" else vector(self, pattern))


def agreeable_density():
    says("density_max", lambda self: self.fluid.density[1])


def impatient():
    def soon(self, *words):
        self.timeout = 1.0
        return receive(self, *words)
    Channel.receive = soon


def too_patient():
    says("coupling_timeout", lambda self: 60.0)


def not_a_number_is_zero():
    def cleaned(payload):
        interval, flags, loads = decode_loads(payload)
        loads = loads.copy()
        loads["force"] = np.nan_to_num(loads["force"])
        return interval, flags, loads
    frames.decode_loads = cleaned


def deaf():
    Channel._hear = lambda self: None


def no_farewell():
    def gone(self, exit_code):
        MPI.Finalize()
        os._exit(0)
    Solid._end = gone


def hasty_end():
    Channel.await_farewells = lambda self, seconds: await_farewells(self, min(seconds, 1.0))


def stubborn():
    frames.decode_answer = lambda payload: []


def fault_is_farewell():
    def misheard(self):
        try:
            hear(self)
        except bplbm_solid.FluidFault:
            self.left[0] = 0.0
    Channel._hear = misheard


def overlap_counted_twice():
    made = Clump.__init__

    def heavy(self, *words, **more):
        made(self, *words, **more)
        discs = self.shapes["radius"][1:]
        self.mass = self.shapes["mass"][0] = 1000.0 * np.pi * (discs ** 2).sum()
    Clump.__init__ = heavy


def no_turn_of_discs():
    Clump.states = property(lambda self, states=Clump.states: straight(states.fget(self)))


def straight(states):
    states["v"] = states["v"][0]
    return states


def ball_of_a_clump():
    made = Clump.__init__

    def hollow(self, *words, **more):
        made(self, *words, **more)
        self.inertia *= 1.2
        self.shapes["inertia"] *= 1.2
    Clump.__init__ = hollow


ENGINES = {sin: "clump_engine.py" for sin in ("overlap_counted_twice", "no_turn_of_discs", "ball_of_a_clump")}
engine = ENGINES.get(sys.argv[1], "engine.py")
globals()[sys.argv[1]]()
sys.argv = [engine]
runpy.run_path(str(ROOT / "tools" / "engines" / "python" / engine), run_name="__main__")
