# SPDX-License-Identifier: MIT
"""A solid program in Python: discs that move under gravity, springs and the fluid's loads, on one rank.

    mpirun -np 1 lbm scene.toml : -np 1 python3 engine.py

Written from protocol/README.md alone; copy it and put your own particles in place of `Discs`. Everything comes
from the variables that the fluid offers.
"""

import math
import struct
import sys
import time

import numpy as np
from mpi4py import MPI

MAGIC, VERSION = 0x4C425042, 3
HELLO, ANSWER, STATES, LOADS, GOODBYE, FAULT, FAREWELL = range(1, 8)
SOLID, LAST, STOP = 2, 1, 2
FRAME_TAG, URGENT_TAG, ROLE_TAG, LEADER_TAG = 7001, 7002, 7003, 7004
STATE = np.dtype([("id", "i8"), ("x", "f8", 3), ("v", "f8", 3), ("omega", "f8", 3)])
SHAPE = np.dtype([("id", "i8"), ("radius", "f8"), ("mass", "f8"), ("inertia", "f8"), ("type", "i8")])
LOAD = np.dtype([("id", "i8"), ("force", "f8", 3), ("torque", "f8", 3)])
# The hello field by field: s text, ? optional, other letters as in Python's struct.
FIELDS = [("version", "I"), ("role", "I"), ("program", "s"), ("program_version", "s"), ("dimension", "I"),
          ("box_lo", "3d"), ("box_hi", "3d"), ("periodic", "3B"), ("depth", "d"), ("units", "s"), ("gravity", "3d"),
          ("buoyancy", "I"), ("step", "d"), ("fluid_steps", "I"), ("solid_steps", "I"), ("first_interval", "q"),
          ("schedule", "I"), ("features", "Q"), ("particles", "?q"), ("radius", "?2d"), ("density", "?2d"),
          ("subdomain_lo", "3d"), ("subdomain_hi", "3d"), ("reach", "d")]


class Stop(Exception):
    """The end, with an exit code; `told` if the fluid knows already."""

    def __init__(self, reason, code=1, told=False):
        super().__init__(reason)
        self.code, self.told = code, told


def text(s):
    return struct.pack("<Q", len(s.encode())) + s.encode()


class Reader:
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

    def records(self, kind):
        count = self.take("Q")
        self.at += count * kind.itemsize
        return np.frombuffer(self.data, kind, count, self.at - count * kind.itemsize)


def decode_hello(data):
    r, hello = Reader(data), {}
    if (version := struct.unpack_from("<I", data)[0]) != VERSION:
        raise Stop(f"protocol version: the fluid speaks {version}, this engine {VERSION}", 2)
    for name, form in FIELDS:
        optional = form.startswith("?")
        hello[name] = r.text() if form == "s" else None if optional and not r.take("B") else r.take(form.strip("?"))
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
            out += text(value)
        elif form:
            out += struct.pack("<" + form, *(value if isinstance(value, (list, tuple)) else [value]))
    return out + struct.pack("<Q", 0)  # no variables


class Wire:
    """Frames to and from the one fluid rank."""

    def __init__(self):
        world = MPI.COMM_WORLD
        roles = np.zeros(world.size, "u4")
        mine = np.array([SOLID], "u4")
        requests = [world.Irecv(roles[i:i + 1], i, ROLE_TAG) for i in range(world.size)]
        requests += [world.Isend(mine, i, ROLE_TAG) for i in range(world.size)]
        MPI.Request.Waitall(requests)
        everybody = world.Dup()
        self.local = everybody.Split(SOLID, world.rank)
        leader = int(np.flatnonzero(roles != SOLID)[0])
        self.fluid = self.local.Create_intercomm(0, everybody, leader, LEADER_TAG)
        everybody.Free()

    def send(self, kind, payload, tag=FRAME_TAG):
        self.fluid.Send(struct.pack("<IIQ", MAGIC, kind, len(payload)) + payload, 0, tag)

    def receive(self, kind, seconds=60.0):
        end, status = time.monotonic() + seconds, MPI.Status()
        while not self.fluid.Iprobe(0, FRAME_TAG, status):
            if self.fluid.Iprobe(0, URGENT_TAG):
                r = Reader(self._take(URGENT_TAG)[1])
                code, reason = r.take("i"), r.text()
                raise Stop(f"the fluid program stopped: {reason}", code, told=True)
            if time.monotonic() > end:
                raise Stop(f"no answer from the fluid for {seconds} s")
            time.sleep(0)
        got, payload = self._take(FRAME_TAG, status)
        if got != kind:
            raise Stop(f"message {got} where {kind} was expected")
        return payload

    def _take(self, tag, status=None):
        if status is None:
            status = MPI.Status()
            self.fluid.Probe(0, tag, status)
        frame = bytearray(status.Get_count(MPI.BYTE))
        self.fluid.Recv(frame, 0, tag)
        magic, kind, _ = struct.unpack_from("<IIQ", frame)
        if magic != MAGIC:
            raise Stop("the partner does not speak the protocol")
        return kind, bytes(frame[16:])


class Discs:
    """F_n = k δ - γ v_n between discs and with walls; velocity Verlet."""

    def __init__(self, offer):
        number = lambda name, default=None: float(offer.get(name, default))  # noqa: E731
        self.lo = np.array([number(f"{a}_lo") for a in "xyz"])
        self.hi = np.array([number(f"{a}_hi") for a in "xyz"])
        self.periodic = [offer[f"boundary_{a}"] == "p" for a in "xy"]
        self.walls = [number(f"walls_{a}") != 0 for a in "xy"]
        self.r = number("diameter_max") / 2
        self.m = number("density_max") * math.pi * self.r ** 2 * number("depth")
        self.inertia = self.m * self.r ** 2 / 2
        self.k = number("contact_stiffness", 1e5)
        self.gamma = 2 * number("damping_ratio", 0.5) * math.sqrt(self.m * self.k)
        self.g = number("gravity") * np.array([number("gravity_x"), number("gravity_y"), 0.0])
        self.dt, self.offer = number("solid_step"), offer
        self.states = np.zeros(0, STATE)

    def insert(self, interval):
        i = 1
        while f"particle{i}_x" in self.offer:
            value = lambda key: float(self.offer.get(f"particle{i}_{key}", 0))  # noqa: E731, B023
            if value("interval") == interval:
                new = np.zeros(1, STATE)
                new["id"], new["x"][0, :2], new["v"][0, :2] = i, (value("x"), value("y")), (value("vx"), value("vy"))
                self.states = np.concatenate([self.states, new])
            i += 1

    def shapes(self):
        out = np.zeros(len(self.states), SHAPE)
        out["id"], out["radius"], out["mass"], out["inertia"], out["type"] = (
            self.states["id"], self.r, self.m, self.inertia, 1)
        return out

    def push(self, overlap, approach):
        return max(0.0, self.k * overlap + self.gamma * approach) if overlap > 0 else 0.0

    def forces(self, load):
        f, (x, v) = load["force"] + self.m * self.g, (self.states["x"], self.states["v"])
        for i in range(len(x)):
            for a in range(2):
                if self.walls[a]:
                    f[i, a] += self.push(self.r - (x[i, a] - self.lo[a]), -v[i, a])
                    f[i, a] -= self.push(self.r - (self.hi[a] - x[i, a]), v[i, a])
            for j in range(i):
                n, size = x[i] - x[j], self.hi - self.lo
                n -= [size[a] * round(n[a] / size[a]) if a < 2 and self.periodic[a] else 0.0 for a in range(3)]
                distance = np.linalg.norm(n)
                push = self.push(2 * self.r - distance, -np.dot(v[i] - v[j], n) / distance) * n / distance
                f[i] += push
                f[j] -= push
        return f

    def advance(self, steps, load):
        x, v = self.states["x"], self.states["v"]
        f = self.forces(load)
        for _ in range(steps):
            v += 0.5 * self.dt / self.m * f
            x += self.dt * v
            f = self.forces(load)
            v += 0.5 * self.dt / self.m * f
            self.states["omega"] += self.dt / self.inertia * load["torque"]
        keep = np.ones(len(x), bool)
        for a in range(2):
            if self.periodic[a]:
                x[:, a] = self.lo[a] + np.mod(x[:, a] - self.lo[a], self.hi[a] - self.lo[a])
            else:
                keep &= (x[:, a] >= self.lo[a]) & (x[:, a] <= self.hi[a])
        self.states = self.states[keep]


def agree(wire, fluid, discs):
    """Hellos and answers; both sides compare, here what this engine was told against the fluid's hello."""
    offer = fluid["variables"]
    hello = dict(fluid, role=SOLID, program="engine.py", program_version="1", box_lo=list(discs.lo),
                 box_hi=list(discs.hi), periodic=[*map(int, discs.periodic), 1], gravity=list(discs.g), step=discs.dt,
                 fluid_steps=1, solid_steps=int(float(offer["substeps"])), features=0, schedule=0,
                 particles=len(discs.states), radius=None, density=None)
    wire.send(HELLO, encode_hello(hello))
    reasons = [f"box {axis}: fluid {fluid[end][a]} m, solid {hello[end][a]} m"
               for end in ("box_lo", "box_hi") for a, axis in enumerate("xy")
               if abs(fluid[end][a] - hello[end][a]) > 1e-9]
    wire.send(ANSWER, struct.pack("<BQ", not reasons, len(reasons)) + b"".join(map(text, reasons)))
    r = Reader(wire.receive(ANSWER))
    r.take("B")
    reasons += [r.text() for _ in range(r.take("Q"))]
    if reasons:
        raise Stop("fluid and solid disagree: " + "; ".join(reasons), 2, told=True)
    return hello


def run(wire):
    fluid = decode_hello(wire.receive(HELLO))
    discs = Discs(fluid["variables"])
    discs.insert(0)
    hello = agree(wire, fluid, discs)
    known, last, k = {}, False, 0
    while True:
        shapes = discs.shapes()
        new = np.array([s["id"] not in known for s in shapes], bool)
        known = {i: True for i in shapes["id"]}
        head = struct.pack("<qdI", k, k * hello["step"] * hello["solid_steps"], LAST if last else 0)
        wire.send(STATES, head + struct.pack("<Q", len(discs.states)) + discs.states.tobytes()
                  + struct.pack("<Q", new.sum()) + shapes[new].tobytes() + b"\0")  # no bonds
        if last:
            return
        r = Reader(wire.receive(LOADS))
        interval, _, flags = r.take("q"), r.take("d"), r.take("I")
        loads = r.records(LOAD)
        if interval != k or list(loads["id"]) != list(discs.states["id"]):
            raise Stop(f"loads of other particles or of interval {interval} at interval {k}")
        if not (np.isfinite(loads["force"]).all() and np.isfinite(loads["torque"]).all()):
            raise Stop(f"a hydrodynamic load is not finite at interval {k}", 3)
        discs.advance(hello["solid_steps"], loads)
        last, k = bool(flags & STOP), k + 1
        discs.insert(k)


def main():
    wire = Wire()
    try:
        run(wire)
    except Stop as stop:
        print(f"engine.py | error | {stop}", file=sys.stderr, flush=True)
        if stop.code == 2 and stop.told:
            wire.fluid.Disconnect()
            return stop.code  # a refusal: both leave in good order
        if stop.told:
            wire.send(FAREWELL, b"", URGENT_TAG)
        else:
            wire.send(FAULT, struct.pack("<i", stop.code) + text(str(stop)), URGENT_TAG)
        time.sleep(1.0)  # the fluid ends the job
        MPI.COMM_WORLD.Abort(stop.code)
    wire.fluid.Disconnect()
    return 0


if __name__ == "__main__":
    sys.exit(main())
