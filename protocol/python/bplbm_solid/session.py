# SPDX-License-Identifier: MIT
"""A session with the fluid, as an engine uses it."""

import pathlib
import struct
import sys
from dataclasses import replace
from typing import Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from mpi4py import MPI

from . import checkpoints, frames, routing
from .agreement import disagreements
from .channel import Channel, connect_timeout
from .errors import BAD_INPUT, NUMERICS, Refused, SolidError, TimedOut, FluidFault, FluidLeft
from .records import LOAD, SHAPE, STATE
from .report import Report

Vector = Sequence[float]
Arrays = Mapping[str, np.ndarray]
END = 3.0  # in which the partner of a fault may clean up [s]


class Solid:
    """One solid rank's session with all ranks of the fluid, from the `with` line to the end of its block.

    Every rank of the solid program opens one; `agree`, `exchange` and the end are for all of them together. A rank gives the
    particles that it owns, and gets the loads on them. Who leaves the block before the fluid's end says goodbye, and the
    fluid ends in good order; an exception in the block ends both programs, with its text and exit code.
    """

    def __init__(self, program: str, *, world: "Optional[MPI.Intracomm]" = None, version: str = "1"):
        """@param program  name of the engine, for messages
        @param world    all ranks of the job, the fluid's included; MPI.COMM_WORLD where nothing is given"""
        self.program, self._version = program, version
        self._world = MPI.COMM_WORLD if world is None else world
        self.interval = 0  # of the next states
        self.flags = 0     # of the loads that came last, as frames.CHECKPOINT
        self._open = False  # the fluid still waits for states
        self._agreed = False

    # ---- what the fluid offers ---------------------------------------------------------------------------------------

    def text(self, name: str, default: Optional[str] = None) -> str:
        """A variable of the scene, e.g. "solid_step". @throws SolidError  it offers none, and there is no default"""
        if name in self.variables:
            return self.variables[name]
        if default is None:
            raise SolidError(f"the scene offers no variable '{name}'; add it to its [particles.variables]", BAD_INPUT)
        return default

    def number(self, name: str, default: Optional[float] = None) -> float:
        value = self.text(name, None if default is None else repr(default))
        try:
            number = float(value)
        except ValueError:
            number = float("nan")
        if not np.isfinite(number):
            raise SolidError(f"the scene's variable '{name}' = '{value}' is no number; correct its [particles.variables]",
                             BAD_INPUT)
        return number

    def vector(self, pattern: str) -> np.ndarray:
        """Three numbers, e.g. vector("gravity_{}"); 0 where there is none."""
        return np.array([self.number(pattern.format(axis), 0.0) for axis in "xyz"])

    def restart(self) -> Tuple[np.ndarray, Dict[str, np.ndarray]]:
        """What was kept by the checkpoint that a run goes on from whose first interval is not 0: the STATE array of all
        ranks, and the arrays of `memory`. Every rank gets everything, and takes what is its own."""
        return checkpoints.read(self.text("restart_file"))

    # ---- the conversation ----------------------------------------------------------------------------------------------

    def agree(self, box_lo: Vector, box_hi: Vector, periodic: Sequence[bool], gravity: Vector, step: float, substeps: int,
              particles: Optional[int] = None, *, radius: Optional[Vector] = None, density: Optional[Vector] = None,
              checkpoints: bool = True, walls: Optional[Sequence[int]] = None, bodies: Sequence[str] = (),
              dimension: Optional[int] = None, depth: Optional[float] = None,
              buoyancy: Optional[int] = None) -> None:
        """Both sides say what they are, and compare; a difference ends both with exit code 2.

        Say what this program computes with, not what the fluid said: only then does the comparison find a mistake.
        @param box_lo, box_hi  [m], three components
        @param step, substeps  own time step [s], and how many of them are an interval
        @param particles  of all ranks together; None: it is not said
        @param radius, density  smallest and largest of all ranks [m, kg/m³]; None: not said
        @param checkpoints  whether `exchange` may be asked to keep one
        @param walls  for x low, x high, y low … z high: 0 no wall, 1 a wall, 2 one with openings; None: not said
        @param bodies  names of walls that are no side of the box
        @param dimension, depth, buoyancy  2 or 3, [m] and frames.BY_FLUID …; None: as the fluid says
        @throws Refused"""
        fluid = self.fluid
        mine = replace(
            fluid, role=frames.SOLID, program=self.program, program_version=self._version, box_lo=list(map(float, box_lo)),
            box_hi=list(map(float, box_hi)), periodic=[int(bool(p)) for p in periodic], gravity=list(map(float, gravity)),
            step=float(step), fluid_steps=1, solid_steps=int(substeps), first_interval=self.interval,
            schedule=frames.SERIAL, features=frames.CHECKPOINTS if checkpoints else 0, particles=particles,
            radius=None if radius is None else list(map(float, radius)),
            density=None if density is None else list(map(float, density)),
            sides=None if walls is None else [int(w) for w in walls], bodies=list(bodies), variables={},
            dimension=fluid.dimension if dimension is None else dimension, depth=fluid.depth if depth is None else depth,
            buoyancy=fluid.buoyancy if buoyancy is None else buoyancy)
        self._duration = step * substeps  # of an interval [s]
        self._setting = struct.pack("=7d", step, *mine.box_lo, *mine.box_hi)
        self._channel.send_all(frames.HANDSHAKE, frames.encode(mine), "it to take our handshake")
        reasons = disagreements(fluid, mine)
        self._channel.send_all(frames.ANSWER, frames.encode_answer(reasons), "it to take our answer")
        for rank in range(self._channel.size):
            theirs = frames.decode_answer(self._channel.receive(rank, frames.ANSWER, "its answer to our handshake"))
            reasons += [reason for reason in theirs if reason not in reasons]
        if reasons:
            raise Refused(reasons)
        self._told = [routing.Told() for _ in self._fluids]
        self._agreed = True

    @property
    def checkpoint_wanted(self) -> bool:
        """Whether the next `exchange` keeps a checkpoint."""
        return bool(self.flags & frames.CHECKPOINT)

    @property
    def bonds_wanted(self) -> bool:
        """Whether the next report may list its bonds."""
        return bool(self.flags & frames.WANT_BONDS) or self.interval == self.fluid.first_interval

    @property
    def settle(self) -> bool:
        """Whether this program must now set itself up as a restart from a checkpoint here would."""
        return bool(self.flags & frames.SETTLE)

    def exchange(self, states: np.ndarray, shapes: np.ndarray, *, report: Optional[Report] = None,
                 memory: Union[Arrays, Callable[[], Arrays], None] = None) -> Optional[np.ndarray]:
        """Sends the particles of this rank at the beginning of an interval; waits for its loads.

        @param states, shapes  STATE and SHAPE arrays, one each a particle, in the same order
        @param report  what this rank has to say of itself
        @param memory  what a checkpoint must hold beside the states (contacts with a memory, say): arrays by name, or a
                       function that is called for them when one is kept. Those of several ranks are joined.
        @return  LOAD array in the order of the particles, or None at the end
        @throws SolidError, FluidFault, FluidLeft, TimedOut"""
        if not self._agreed:
            raise SolidError("exchange before agree: say first what this program computes with")
        if not self._open:
            raise SolidError("exchange after the last states: the fluid has ended")
        states, shapes = np.ascontiguousarray(states, STATE), np.ascontiguousarray(shapes, SHAPE)
        if not np.array_equal(states["id"], shapes["id"]):
            raise SolidError(f"interval {self.interval}: {len(states)} states and {len(shapes)} shapes are not of the same "
                             "particles in the same order")
        if self.checkpoint_wanted:
            self._keep(states, memory)
        sent = self._send(states, shapes, report)
        if self.flags & frames.LAST:
            self._open = False
            return None
        loads = np.zeros(len(states), LOAD)
        loads["id"], flags = states["id"], 0
        for rank, indices in enumerate(sent):
            flags |= self._add_loads(rank, indices, loads)
        self.flags = flags & ~frames.STOP | (frames.LAST if flags & frames.STOP else 0)
        self.interval += 1
        return loads

    def goodbye(self, reason: str) -> None:
        """Ends the run in good order in place of the next states. (Leaving the block does it, too.)"""
        if self._open:
            self._channel.send_all(frames.GOODBYE, frames.text(reason), "it to take our goodbye")
        self._open = False

    def _send(self, states: np.ndarray, shapes: np.ndarray, report: Optional[Report]) -> List[np.ndarray]:
        """@return  indices of the particles that each fluid rank got"""
        wish = frames.STOP_WISHED if self._channel.signals.last else 0
        head = self.interval, self.interval * self._duration, self.flags & (frames.LAST | frames.CHECKPOINT) | wish
        said = None if report is None else report.encoded(self.bonds_wanted)
        routing.refuse_astray(self.fluid, states, self.interval)
        by, sent = routing.routed_by(shapes), []
        for rank, fluid in enumerate(self._fluids):
            there = routing.touching(fluid, states[by], shapes["radius"][by])
            sent.append(there)
            self._channel.send(rank, frames.STATES, frames.encode_states(
                *head, self._setting, states[there], self._told[rank].news(shapes[there]), said if rank == 0 else None),
                "it to take our states")
        return sent

    def _add_loads(self, rank: int, indices: np.ndarray, loads: np.ndarray) -> int:
        """Adds the part of a fluid rank. @return  its flags"""
        k = self.interval
        interval, flags, part = frames.decode_loads(
            self._channel.receive(rank, frames.LOADS, f"the loads of interval {k}"))
        if interval != k:
            raise SolidError(f"fluid rank {rank} sent interval {interval} where {k} was expected")
        if not np.array_equal(part["id"], loads["id"][indices]):
            raise SolidError(f"fluid rank {rank} answered {len(part)} loads for {len(indices)} particles at interval {k}, or "
                             "those of others")
        for name in ("force", "torque"):
            bad = np.flatnonzero(~np.isfinite(part[name]).all(axis=1))
            if len(bad):
                raise SolidError(f"particle {part['id'][bad[0]]}: hydrodynamic {name} is {tuple(part[name][bad[0]])} at "
                                 f"interval {k}: not finite", NUMERICS)
            loads[name][indices] += part[name]
        return flags

    def _keep(self, states: np.ndarray, memory: Union[Arrays, Callable[[], Arrays], None]) -> None:
        arrays = dict(memory() if callable(memory) else memory or {}, states=states)
        parts = self._channel.local.gather(arrays) if self._channel.local.size > 1 else [arrays]
        if parts is None:  # rank 0 writes
            return
        joined = {name: np.concatenate([part[name] for part in parts]) for name in arrays}
        checkpoints.write(pathlib.Path(self.text("checkpoint")), self.interval, joined)

    # ---- beginning and end -----------------------------------------------------------------------------------------------

    def __enter__(self) -> "Solid":
        try:
            self._channel = Channel(self._world, connect_timeout())
        except SolidError as error:
            self._say(error)
            self._world.Abort(error.exit_code)
        self.comm, self.rank, self.size = self._channel.local, self._channel.local.rank, self._channel.local.size
        self._channel.signals.catch()
        try:
            self._fluids = [frames.decode_handshake(self._channel.receive(rank, frames.HANDSHAKE, "its handshake"))
                            for rank in range(self._channel.size)]
            self.fluid = self._fluids[0]  # what fluid rank 0 says; its subdomain is its own
            self.variables, self.interval = self.fluid.variables, self.fluid.first_interval
            self._open = True
            self._channel.timeout = self.number("coupling_timeout", 60.0)
        except SolidError as error:
            self._leave(error)
        return self

    def __exit__(self, kind, error, trace) -> None:
        if error is None:
            self._end(0)
            return
        if isinstance(error, SystemExit):  # an engine that has seen enough, or a mistake with a text
            code = error.code
            if code is None or code == 0:
                self._end(0)
                return
            error = SolidError(str(code) if isinstance(code, str) else f"left with exit code {code}",
                               code if isinstance(code, int) else 1)
        elif not isinstance(error, SolidError):
            import traceback
            traceback.print_exception(kind, error, trace)
            error = SolidError(f"{kind.__name__}: {error}")
        self._leave(error)

    def _say(self, error: Exception) -> None:
        print(f"{self.program} | error | {error}", file=sys.stderr, flush=True)

    def _leave(self, error: SolidError) -> None:
        """The end after an error. Does not return."""
        if self.rank == 0 or not isinstance(error, (Refused, FluidFault)):  # those reach every rank
            self._say(error)
        if isinstance(error, (Refused, FluidLeft)):  # in good order
            self._open = False
            self._end(error.exit_code)
            sys.exit(error.exit_code)
        try:
            if isinstance(error, FluidFault):
                self._channel.say(frames.FAREWELL)
            else:
                self._channel.say(frames.FAULT, struct.pack("=i", error.exit_code) + frames.text(str(error)))
            self._channel.await_farewells(END)
        except SolidError:  # it has failed as well
            pass
        self._world.Abort(error.exit_code)

    def _end(self, exit_code: int) -> None:
        """The end in good order; mpi4py ends MPI when Python ends."""
        try:
            self.goodbye(f"{self.program} ended")
            self._channel.together()
            self._channel.say(frames.FAREWELL)
            missing = self._channel.await_farewells(self._channel.timeout)
            if missing:
                raise TimedOut(f"no farewell from fluid rank(s) {', '.join(map(str, missing))} for "
                               f"{self._channel.timeout:.3g} s")
        except SolidError as error:
            error.exit_code = exit_code or error.exit_code
            self._leave(error)
        self._channel.signals.restore()
