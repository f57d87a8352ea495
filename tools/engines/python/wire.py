# SPDX-License-Identifier: MIT
"""The solid's side of the wire for an engine in Python, on one rank, with one fluid rank; from protocol/README.md alone.

    with wire.Solid("my engine") as fluid:
        fluid.agree(box_lo, box_hi, periodic, gravity, step, substeps)
        while (loads := fluid.exchange(states, shapes)) is not None:
            ...  # substeps with loads["force"] [N] and loads["torque"] [N m]; then new states, and shapes

Where `fluid.interval` is not 0 at the start, the run goes on with the states of `fluid.restart()`. Who has more to keep than states (contacts with a memory, say)
gives `agree(..., checkpoints=False)`, and scenes with checkpoints are refused.

Errors reach the fluid, and those of the fluid end this program with its exit code.
"""

import pathlib
import struct
import sys
import time

import numpy as np
from mpi4py import MPI

STATE = np.dtype([("id", "i8"), ("x", "f8", 3), ("v", "f8", 3), ("omega", "f8", 3)])  # m, m/s, rad/s
SHAPE = np.dtype([("id", "i8"), ("radius", "f8"), ("mass", "f8"), ("inertia", "f8"), ("type", "i8"), ("epoch", "i8"),
                  ("carrier", "i8"), ("volume", "f8")])  # m, kg, kg m², …, m³
LOAD = np.dtype([("id", "i8"), ("force", "f8", 3), ("torque", "f8", 3)])

MAGIC, VERSION, SOLID, LAST, STOP, CHECKPOINT = 0x4C425042, 4, 2, 1, 2, 4
HELLO, ANSWER, STATES, LOADS, GOODBYE, FAULT, FAREWELL = range(1, 8)
FRAME_TAG, URGENT_TAG, ROLE_TAG, LEADER_TAG = 7001, 7002, 7003, 7004
# The hello field by field: s text, l list of texts, ? optional, other letters as in Python's struct.
FIELDS = [("version", "I"), ("role", "I"), ("program", "s"), ("program_version", "s"), ("dimension", "I"),
          ("box_lo", "3d"), ("box_hi", "3d"), ("periodic", "3B"), ("depth", "d"), ("units", "s"), ("gravity", "3d"),
          ("buoyancy", "I"), ("step", "d"), ("fluid_steps", "I"), ("solid_steps", "I"), ("first_interval", "q"),
          ("schedule", "I"), ("features", "Q"), ("particles", "?q"), ("radius", "?2d"), ("density", "?2d"),
          ("subdomain_lo", "3d"), ("subdomain_hi", "3d"), ("reach", "d"), ("sides", "?6B"), ("bodies", "l")]


def ball(number, radius, mass, inertia, kind=1, epoch=0):
    """A SHAPE. Another epoch says that the number has passed to another particle, which starts anew."""
    return np.array((number, radius, mass, inertia, kind, epoch, -1, 0.0), SHAPE)  # its own carrier, a ball's volume


class Stop(Exception):
    """The end, with an exit code; `told` if the fluid knows already."""

    def __init__(self, reason, code=1, told=False):
        super().__init__(reason)
        self.code, self.told = code, told


class Solid:
    """A session with the fluid. `interval` is the number of the next states."""

    def __init__(self, program):
        self.program, self.interval, self.known, self.flags, self.timeout, self.left = program, 0, {}, 0, 60.0, False

    # ---- what an engine calls ----------------------------------------------------------------------------------

    def text(self, name, default=None):
        """A variable that the fluid offers, e.g. "solid_step"."""
        if name not in self.variables and default is None:
            raise Stop(f"the scene offers no variable '{name}'", 2)
        return self.variables.get(name, default)

    def number(self, name, default=None):
        return float(self.text(name, default))

    def vector(self, pattern):
        """Three numbers, e.g. vector("gravity_{}"); 0 where there is none."""
        return np.array([self.number(pattern.format(axis), 0.0) for axis in "xyz"])

    def restart(self):
        """STATE array of the checkpoint that a run goes on from which does not begin at interval 0."""
        try:
            return np.load(self.text("restart_file"))
        except ValueError as error:
            raise Stop(f"{self.text('restart_file')} is no checkpoint of this engine: {error}", 2) from error

    def agree(self, box_lo, box_hi, periodic, gravity, step, substeps, particles=None, checkpoints=True, walls=None):
        """Both sides compare what they are; a difference ends both. SI units, three components each.
        walls: for x low, x high, y low … z high, whether a wall stops particles there; None: it is not said."""
        self.duration = step * substeps  # of an interval [s]
        mine = dict(self.fluid, role=SOLID, program=self.program, program_version="1", box_lo=list(box_lo),
                    box_hi=list(box_hi), periodic=list(periodic), gravity=list(gravity), step=step, fluid_steps=1,
                    solid_steps=substeps, features=int(checkpoints), schedule=0, particles=particles,
                    radius=None, density=None,
                    sides=None if walls is None else [int(bool(w)) for w in walls], bodies=[])
        self.setting = struct.pack("<7d", step, *box_lo, *box_hi)
        self._send(HELLO, encode_hello(mine))
        reasons = [f"box {axis}: fluid {self.fluid[end][a]} m, solid {mine[end][a]} m"
                   for end in ("box_lo", "box_hi") for a, axis in enumerate("xy")
                   if abs(self.fluid[end][a] - mine[end][a]) > 1e-9]
        self._send(ANSWER, struct.pack("<BQ", not reasons, len(reasons)) + b"".join(map(encode_text, reasons)))
        theirs = Reader(self._receive(ANSWER))
        theirs.take("B")
        reasons += [theirs.text() for _ in range(theirs.take("Q"))]
        if reasons:
            raise Stop("fluid and solid disagree: " + "; ".join(reasons), 2, told=True)

    def exchange(self, states, shapes):
        """Sends STATE and SHAPE arrays [particle]; returns LOAD [particle] in their order, or None at the end."""
        now = [(shape["id"].item(), shape.tobytes()) for shape in shapes]
        new = np.array([self.known.get(number) != shape for number, shape in now], bool)
        self.known = dict(now)
        if self.flags & CHECKPOINT:
            self._keep(states)
        head = struct.pack("<qdI", self.interval, self.interval * self.duration, self.flags)
        self._send(STATES, head + self.setting + struct.pack("<Q", len(states)) + states.tobytes()
                   + struct.pack("<Q", new.sum()) + shapes[new].tobytes() + b"\0")  # no bonds
        if self.flags & LAST:
            return None
        reply = Reader(self._receive(LOADS))
        interval, _, flags = reply.take("q"), reply.take("d"), reply.take("I")
        loads = reply.records(LOAD)
        if interval != self.interval or not np.array_equal(loads["id"], states["id"]):
            raise Stop(f"loads of other particles or of interval {interval} at interval {self.interval}")
        if not (np.isfinite(loads["force"]).all() and np.isfinite(loads["torque"]).all()):
            raise Stop(f"a hydrodynamic load is not finite at interval {self.interval}", 3)
        self.flags = (LAST if flags & STOP else 0) | flags & CHECKPOINT
        self.interval += 1
        return loads

    def _keep(self, states):
        """Writes the states of a checkpoint, whole or not at all; the one before stays, the fluid may still need it."""
        prefix = pathlib.Path(self.text("checkpoint"))
        whole = prefix.with_name(f"{prefix.name}.{self.interval}.solid")
        part = whole.with_name(whole.name + ".part")
        try:
            with part.open("wb") as file:
                np.save(file, states)
            part.rename(whole)
        except OSError as error:
            part.unlink(missing_ok=True)
            raise Stop(f"the checkpoint {whole} cannot be written ({error}); is the disk full?") from error
        for old in prefix.parent.glob(prefix.name + ".*.solid"):
            if old.name not in (whole.name, self.kept):
                old.unlink()
        self.kept = whole.name

    # ---- the session ---------------------------------------------------------------------------------------------

    def __enter__(self):
        world = MPI.COMM_WORLD
        roles, mine = np.zeros(world.size, "u4"), np.array([SOLID], "u4")
        requests = [world.Irecv(roles[i:i + 1], i, ROLE_TAG) for i in range(world.size)]
        requests += [world.Isend(mine, i, ROLE_TAG) for i in range(world.size)]
        MPI.Request.Waitall(requests)
        everybody = world.Dup()
        leader = int(np.flatnonzero(roles != SOLID)[0])
        self.wire = everybody.Split(SOLID, world.rank).Create_intercomm(0, everybody, leader, LEADER_TAG)
        everybody.Free()
        try:
            self.fluid = decode_hello(self._receive(HELLO))
        except Stop as stop:
            self._leave(stop)
        self.variables, self.interval = self.fluid["variables"], self.fluid["first_interval"]
        self.timeout = self.number("coupling_timeout", self.timeout)  # longest wait [s]
        self.kept = pathlib.Path(self.text("restart_file", "none")).name
        return self

    def __exit__(self, kind, error, trace):
        if error is not None:
            self._leave(error if isinstance(error, Stop) else Stop(f"{kind.__name__}: {error}"))
        self._part()

    def _leave(self, stop):
        print(f"{self.program} | error | {stop}", file=sys.stderr, flush=True)
        if stop.code == 2 and stop.told:  # a refusal: both leave in good order
            self._part()
            sys.exit(stop.code)
        if stop.told:
            self._send(FAREWELL, b"", URGENT_TAG)
        else:
            self._send(FAULT, struct.pack("<i", stop.code) + encode_text(str(stop)), URGENT_TAG)
        time.sleep(1.0)  # the fluid ends the job
        MPI.COMM_WORLD.Abort(stop.code)

    def _part(self):
        """The end in good order: nothing more to say. (mpi4py ends MPI when Python ends.)"""
        self._send(FAREWELL, b"", URGENT_TAG)
        end = time.monotonic() + self.timeout
        while not self.left and not self.wire.Iprobe(0, URGENT_TAG):
            if time.monotonic() > end:
                self._leave(Stop(f"no farewell from the fluid for {self.timeout} s"))
            time.sleep(0.001)
        kind, payload = (FAREWELL, b"") if self.left else self._take(URGENT_TAG)
        if kind == FAULT:
            fault = Reader(payload)
            code, reason = fault.take("i"), fault.text()
            self._leave(Stop(f"the fluid program stopped: {reason}", code))

    def _send(self, kind, payload, tag=FRAME_TAG):
        self.wire.Send(struct.pack("<IIQ", MAGIC, kind, len(payload)) + payload, 0, tag)

    def _receive(self, kind):
        end = time.monotonic() + self.timeout
        while not self.wire.Iprobe(0, FRAME_TAG):
            if self.wire.Iprobe(0, URGENT_TAG):
                urgent, payload = self._take(URGENT_TAG)
                if urgent == FAULT:
                    fault = Reader(payload)
                    code, reason = fault.take("i"), fault.text()
                    raise Stop(f"the fluid program stopped: {reason}", code, told=True)
                self.left, end = True, time.monotonic() + 1.0  # what it sent before may still be on its way
            if time.monotonic() > end:
                raise Stop("the fluid left" if self.left else f"no answer from the fluid for {self.timeout} s")
            time.sleep(0)
        got, payload = self._take(FRAME_TAG)
        if got != kind:
            raise Stop(f"message {got} where {kind} was expected")
        return payload

    def _take(self, tag):
        status = MPI.Status()
        self.wire.Probe(0, tag, status)
        frame = bytearray(status.Get_count(MPI.BYTE))
        self.wire.Recv(frame, 0, tag)
        magic, kind, _ = struct.unpack_from("<IIQ", frame)
        if magic != MAGIC:
            raise Stop("the partner does not speak the protocol")
        return kind, bytes(frame[16:])


# ---- frames ----------------------------------------------------------------------------------------------------------

class Reader:
    """Takes a payload apart."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values[0] if len(values) == 1 else list(values)

    def text(self):
        size = self.take("Q")
        self.at += size
        return self.data[self.at - size:self.at].decode()

    def texts(self):
        return [self.text() for _ in range(self.take("Q"))]

    def records(self, kind):
        count = self.take("Q")
        self.at += count * kind.itemsize
        return np.frombuffer(self.data, kind, count, self.at - count * kind.itemsize)


def encode_text(s):
    return struct.pack("<Q", len(s.encode())) + s.encode()


def decode_hello(data):
    r, hello = Reader(data), {}
    if (version := struct.unpack_from("<I", data)[0]) != VERSION:
        raise Stop(f"protocol version: the fluid speaks {version}, this engine {VERSION}", 2)
    for name, form in FIELDS:
        optional = form.startswith("?")
        if form == "s":
            hello[name] = r.text()
        elif form == "l":
            hello[name] = r.texts()
        else:
            hello[name] = None if optional and not r.take("B") else r.take(form.strip("?"))
    hello["variables"] = {r.text(): r.text() for _ in range(r.take("Q"))}
    return hello


def encode_hello(hello):
    out = b""
    for name, form in FIELDS:
        value = hello[name]
        if form.startswith("?"):
            out += struct.pack("<B", value is not None)
            form = form[1:] if value is not None else ""
        if form == "s":
            out += encode_text(value)
        elif form == "l":
            out += struct.pack("<Q", len(value)) + b"".join(map(encode_text, value))
        elif form:
            out += struct.pack("<" + form, *(value if isinstance(value, (list, tuple)) else [value]))
    return out + struct.pack("<Q", 0)  # no variables
