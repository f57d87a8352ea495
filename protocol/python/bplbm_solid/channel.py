# SPDX-License-Identifier: MIT
"""Frames over MPI: how the two programs find each other, send, receive and part. No wait is endless."""

import os
import signal
import struct
import threading
import time
from typing import Callable, Dict, List, Optional, Set, Tuple

import numpy as np
from mpi4py import MPI

from . import frames
from .errors import BAD_INPUT, FluidFault, FluidLeft, SolidError, TimedOut

FRAME_TAG, URGENT_TAG, ROLE_TAG, LEADER_TAG, PATIENCE_TAG = 7001, 7002, 7003, 7004, 7005
ON_ITS_WAY = 1.0   # a frame that was sent before a farewell [s]
GRACE = 0.6        # after a signal, in which the fluid may still answer [s]
BUSY_TURNS = 200   # of a wait, before the core is offered to others
CROWD = 1e-3       # a wait that lacks so much time shares its core with others, and sleeps [s]
NAP = 2e-5         # between two looks of a wait that sleeps [s]


class Signals:
    """SIGTERM and SIGINT while a session lasts: the fluid gets them as well, ends its interval and says so. Only where it
    does not does this program end by itself, so that the reason that the fluid has is the one that is told."""

    def __init__(self) -> None:
        self.last, self.alive_at = 0, 0.0
        self._before: Dict[int, object] = {}

    def catch(self) -> None:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGTERM, signal.SIGINT):
                self._before[number] = signal.signal(number, self._note)

    def restore(self) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler if handler is not None else signal.SIG_DFL)
        self._before.clear()

    def _note(self, number: int, _frame: object) -> None:
        self.alive_at = self.alive_at if self.last else time.monotonic()
        self.last = number

    def note_answer(self) -> None:
        self.alive_at = time.monotonic()

    def raise_if_alone(self) -> None:
        if self.last and time.monotonic() - self.alive_at > GRACE:
            raise SolidError(f"ended by signal {self.last}: the fluid or mpirun died, or somebody stopped the job")


def connect_timeout() -> float:
    """BPLBM_CONNECT_TIMEOUT, else a minute [s]."""
    value = os.environ.get("BPLBM_CONNECT_TIMEOUT", "60")
    try:
        seconds = float(value)
    except ValueError:
        seconds = -1.0
    if not 0 <= seconds < float("inf"):
        raise SolidError(f"the environment variable BPLBM_CONNECT_TIMEOUT = '{value}' is no time; give seconds, or unset it",
                         BAD_INPUT)
    return seconds


class Channel:
    """`local` holds the ranks of this program, `wire` leads to the fluid's. Collective over both programs when made."""

    def __init__(self, world: "MPI.Intracomm", seconds: float):
        self.timeout = seconds  # of a wait [s]
        self.signals = Signals()
        self.left: Dict[int, float] = {}  # fluid rank -> when its farewell came
        self.failed: Set[int] = set()     # fluid ranks whose fault came
        self._urgent: List["MPI.Request"] = []
        self._outgoing: Dict[int, "MPI.Request"] = {}
        roles = self._roles(world, seconds)
        everybody = world.Dup()
        leader = int(np.flatnonzero(roles != frames.SOLID)[0])
        self.local: "MPI.Intracomm" = everybody.Split(frames.SOLID, world.rank)
        self.wire: "MPI.Intercomm" = self.local.Create_intercomm(0, everybody, leader, LEADER_TAG)
        everybody.Free()
        self.size: int = self.wire.remote_size

    def _roles(self, world: "MPI.Intracomm", seconds: float) -> np.ndarray:
        """Everybody tells everybody its role, before any collective is entered."""
        roles, mine = np.zeros(world.size, "u4"), np.array([frames.SOLID], "u4")
        receives = [world.Irecv(roles[i:i + 1], i, ROLE_TAG) for i in range(world.size)]
        sends = [world.Isend(mine, i, ROLE_TAG) for i in range(world.size)]
        begin = time.monotonic()
        while not self._poll(0.1, lambda: MPI.Request.Testall(receives + sends)):
            seconds = max(seconds, self._told_patience(world))
            if time.monotonic() - begin < seconds:
                continue
            silent = [i for i, request in enumerate(receives) if not request.Test()]
            raise TimedOut(f"rank(s) {', '.join(map(str, silent))} of this MPI job did not say within {seconds:.3g} s what "
                           "they are; is each 'lbm' or a solid of its protocol? Who needs longer to start is waited for with "
                           "coupling.connect_timeout = SECONDS in the scene, or BPLBM_CONNECT_TIMEOUT in the environment")
        if (roles == frames.SOLID).all():
            raise SolidError("no fluid program was started beside it; start: mpirun -np 1 lbm scene.toml : -np 1 "
                             "python3 FILE", BAD_INPUT)
        return roles

    @staticmethod
    def _told_patience(world: "MPI.Intracomm") -> float:
        """How long the fluid's scene wants everybody to be waited for [s]; 0 where it has not said so yet."""
        seconds, told, status = 0.0, np.zeros(1), MPI.Status()
        while world.Iprobe(MPI.ANY_SOURCE, PATIENCE_TAG, status):
            world.Recv(told, status.source, PATIENCE_TAG)
            seconds = max(seconds, told[0])
        return seconds

    # ---- frames ----------------------------------------------------------------------------------------------------

    def send(self, rank: int, kind: int, payload: bytes, what: str) -> None:
        """@param what  the fluid does with it, for the text of a time-out"""
        frame = frames.HEAD.pack(frames.MAGIC, kind, len(payload)) + payload
        if len(frame) > frames.LARGEST:
            raise SolidError(f"a message of {len(frame)} bytes exceeds MPI's 2 GiB: use more ranks")
        request = self._outgoing[rank] = self.wire.Isend(frame, rank, FRAME_TAG)  # kept where a fault interrupts it
        if not self._poll(self.timeout, lambda: request.Test() or self._look()):
            raise TimedOut(f"no answer from fluid rank {rank} for {self.timeout:.3g} s while waiting for {what}")

    def send_all(self, kind: int, payload: bytes, what: str) -> None:
        for rank in range(self.size):
            self.send(rank, kind, payload, what)

    def receive(self, rank: int, kind: int, what: str) -> bytes:
        """The payload of the next frame of a fluid rank, which must be of that kind."""
        status = MPI.Status()
        if not self._poll(self.timeout, lambda: self.wire.Iprobe(rank, FRAME_TAG, status) or self._look(rank, what)):
            raise TimedOut(f"no answer from fluid rank {rank} for {self.timeout:.3g} s while waiting for {what}")
        self.signals.note_answer()
        got, payload = self._take(status)
        if got != kind:
            raise SolidError(f"fluid rank {rank} sent message {got} where {what} was expected")
        return payload

    def _take(self, status: "MPI.Status") -> Tuple[int, bytes]:
        frame = bytearray(status.Get_count(MPI.BYTE))
        self.wire.Recv(frame, status.source, status.tag)
        if len(frame) < frames.HEAD.size:
            raise SolidError(f"a frame of {len(frame)} bytes came, shorter than its own head")
        magic, kind, size = frames.HEAD.unpack_from(frame)
        if magic != frames.MAGIC:
            swapped = struct.unpack(">I", struct.pack("<I", magic))[0] == frames.MAGIC
            raise SolidError("the fluid runs on a machine of the other byte order" if swapped
                             else "the partner does not speak the BPLBM protocol")
        if size != len(frame) - frames.HEAD.size:
            raise SolidError(f"a frame promises {size} bytes and has {len(frame) - frames.HEAD.size}")
        return kind, bytes(memoryview(frame)[frames.HEAD.size:])

    def _look(self, rank: Optional[int] = None, what: str = "") -> bool:
        """@throws  where the wait is in vain: a fault has come, the rank has left, a signal came long ago"""
        self.signals.raise_if_alone()
        self._hear()
        if rank in self.left and time.monotonic() - self.left[rank] > ON_ITS_WAY:
            raise FluidLeft(f"fluid rank {rank} left without {what}")
        return False

    def _hear(self) -> None:
        """Takes a farewell or fault, if there is one. @throws FluidFault"""
        status = MPI.Status()
        if not self.wire.Iprobe(MPI.ANY_SOURCE, URGENT_TAG, status):
            return
        source = status.source
        kind, payload = self._take(status)
        if kind != frames.FAULT:
            self.left[source] = time.monotonic()
            return
        self.failed.add(source)
        fault = frames.Reader(payload)
        code, reason = fault.take("i"), fault.text()
        raise FluidFault(reason, code)

    # ---- the end ---------------------------------------------------------------------------------------------------

    def say(self, kind: int, payload: bytes = b"") -> None:
        """A farewell or fault to every fluid rank; it overtakes everything else."""
        self._frame = frames.HEAD.pack(frames.MAGIC, kind, len(payload)) + payload  # lives as long as its sends
        self._urgent += [self.wire.Isend(self._frame, rank, URGENT_TAG) for rank in range(self.size)]
        self._poll(1.0, lambda: MPI.Request.Testall(self._urgent))

    def await_farewells(self, seconds: float) -> List[int]:
        """@return  fluid ranks that have not said it in that time. @throws FluidFault"""
        missing = lambda: [r for r in range(self.size) if r not in self.left and r not in self.failed]  # noqa: E731

        def done() -> bool:
            self._hear()
            return not missing()

        self._poll(seconds, done)
        return missing()

    def together(self) -> None:
        """Waits for the other ranks of this program."""
        request = self.local.Ibarrier()
        if not self._poll(self.timeout, request.Test):
            raise TimedOut(f"another rank of this program did not come to its end within {self.timeout:.3g} s")

    @staticmethod
    def _poll(seconds: float, ready: Callable[[], bool]) -> bool:
        begin, computed, turn, crowded = time.monotonic(), time.thread_time(), 0, False
        while not ready():
            turn += 1
            waited = time.monotonic() - begin
            if waited > seconds:  # also of a few turns: MPI may offer the core to others at every one
                return ready()
            if turn <= BUSY_TURNS and waited < CROWD:
                continue
            crowded = crowded or waited - (time.thread_time() - computed) > CROWD
            if crowded:
                time.sleep(NAP)
            elif turn > BUSY_TURNS:
                os.sched_yield()
        return True
