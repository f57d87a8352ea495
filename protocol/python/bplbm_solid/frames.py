# SPDX-License-Identifier: MIT
"""Frames to messages and back, from protocol/WIRE.md."""

import struct
from dataclasses import dataclass, field, fields
from typing import Dict, List, Optional

import numpy as np

from .errors import BAD_INPUT, SolidError
from .records import LOAD, SHAPE, STATE

MAGIC, VERSION = 0x4C425042, 4
FLUID, SOLID = 1, 2
HANDSHAKE, ANSWER, STATES, LOADS, GOODBYE, FAULT, FAREWELL = range(1, 8)
LAST, STOP, CHECKPOINT, WANT_BONDS, SETTLE, STOP_WISHED = 1, 2, 4, 8, 16, 32
BY_FLUID, BY_SOLID, NO_BUOYANCY = 0, 1, 2
SERIAL, OVERLAPPED = 0, 1
CHECKPOINTS = 1
HEAD = struct.Struct("=IIQ")
LARGEST = 2**31 - 1  # of an MPI message [bytes]


def _as(form: str):
    """A field of the handshake: s text, l list of texts, v variables, ? optional, other letters as in Python's struct."""
    return field(metadata={"form": form})


@dataclass
class Handshake:
    """Everything that both sides must agree on before the first step; the wire's handshake, field by field."""

    version: int = _as("I")
    role: int = _as("I")
    program: str = _as("s")
    program_version: str = _as("s")
    dimension: int = _as("I")
    box_lo: List[float] = _as("3d")
    box_hi: List[float] = _as("3d")
    periodic: List[int] = _as("3B")
    depth: float = _as("d")
    units: str = _as("s")
    gravity: List[float] = _as("3d")
    buoyancy: int = _as("I")
    step: float = _as("d")
    fluid_steps: int = _as("I")
    solid_steps: int = _as("I")
    first_interval: int = _as("q")
    schedule: int = _as("I")
    features: int = _as("Q")
    particles: Optional[int] = _as("?q")
    radius: Optional[List[float]] = _as("?2d")
    density: Optional[List[float]] = _as("?2d")
    subdomain_lo: List[float] = _as("3d")
    subdomain_hi: List[float] = _as("3d")
    reach: float = _as("d")
    sides: Optional[List[int]] = _as("?6B")
    bodies: List[str] = _as("l")
    variables: Dict[str, str] = _as("v")


class Reader:
    """Takes a payload apart. Every access is within it, or ends with an error."""

    def __init__(self, data: bytes):
        self.data, self.at = data, 0

    def _skip(self, size: int) -> int:
        if size > len(self.data) - self.at:
            raise SolidError(f"a message of the fluid promises {size} bytes more at byte {self.at}, but has "
                             f"{len(self.data) - self.at}")
        self.at += size
        return self.at - size

    def take(self, form: str):
        values = struct.unpack_from("=" + form, self.data, self._skip(struct.calcsize("=" + form)))
        return values[0] if len(values) == 1 else list(values)

    def text(self) -> str:
        size = self.take("Q")
        at = self._skip(size)
        return self.data[at:at + size].decode(errors="replace")

    def texts(self) -> List[str]:
        return [self.text() for _ in range(self.take("Q"))]

    def records(self, kind: np.dtype) -> np.ndarray:
        count = self.take("Q")
        return np.frombuffer(self.data, kind, count, self._skip(count * kind.itemsize))

    def value(self, form: str):
        """A field of the handshake."""
        if form.startswith("?"):
            return self.value(form[1:]) if self.take("B") else None
        if form == "v":
            return {self.text(): self.text() for _ in range(self.take("Q"))}
        return self.text() if form == "s" else self.texts() if form == "l" else self.take(form)


def text(s: str) -> bytes:
    encoded = s.encode()
    return struct.pack("=Q", len(encoded)) + encoded


def texts(several: "list[str]") -> bytes:
    return struct.pack("=Q", len(several)) + b"".join(map(text, several))


def _value(value, form: str) -> bytes:
    if form.startswith("?"):
        return b"\0" if value is None else b"\1" + _value(value, form[1:])
    if form == "v":
        return struct.pack("=Q", len(value)) + b"".join(text(k) + text(v) for k, v in value.items())
    if form in "sl":
        return text(value) if form == "s" else texts(value)
    return struct.pack("=" + form, *(value if isinstance(value, (list, tuple)) else [value]))


def encode(handshake: Handshake) -> bytes:
    return b"".join(_value(getattr(handshake, f.name), f.metadata["form"]) for f in fields(Handshake))


def decode_handshake(payload: bytes) -> Handshake:
    reader = Reader(payload)
    if (version := reader.take("I")) != VERSION:
        raise SolidError(f"protocol version: the fluid speaks {version}, this package {VERSION}; take both of one release",
                         BAD_INPUT)
    reader.at = 0
    return Handshake(**{f.name: reader.value(f.metadata["form"]) for f in fields(Handshake)})


def encode_answer(reasons: "list[str]") -> bytes:
    return struct.pack("=B", not reasons) + texts(reasons)


def decode_answer(payload: bytes) -> "list[str]":
    """@return  the reasons of a refusal, none where it accepts"""
    reader = Reader(payload)
    accept, reasons = reader.take("B"), reader.texts()
    return reasons if reasons or accept else ["the fluid refuses, and does not say why"]


def encode_states(interval: int, time: float, flags: int, setting: bytes, states: np.ndarray, shapes: np.ndarray,
                  report: "bytes | None") -> bytes:
    assert states.dtype == STATE and shapes.dtype == SHAPE
    return b"".join([struct.pack("=qdI", interval, time, flags), setting, struct.pack("=Q", len(states)), states.tobytes(),
                     struct.pack("=Q", len(shapes)), shapes.tobytes(), b"\0" if report is None else b"\1" + report])


def decode_loads(payload: bytes):
    """@return  interval, flags, LOAD array"""
    reader = Reader(payload)
    interval, _, flags = reader.take("q"), reader.take("d"), reader.take("I")
    return interval, flags, reader.records(LOAD)
