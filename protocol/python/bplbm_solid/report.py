# SPDX-License-Identifier: MIT
"""What a solid may report of itself beside its states; the fluid shows it and writes it to its output."""

import struct
from dataclasses import dataclass, field
from typing import Optional

import numpy as np

from .records import BOND


@dataclass
class BondCounts:
    """Bonds of this rank: how many are there, and since the beginning of the run how many broke by tension and by shear,
    left the box with a particle, or vanished with one that was taken out."""

    intact: int = 0
    tension: int = 0
    shear: int = 0
    left: int = 0
    lost: int = 0


@dataclass
class Report:
    """@param grains_left  through sides that are not periodic, of this rank, since the beginning
    @param bonds  None where there never were any
    @param list   BOND array; sent where the fluid asked for it, and with the first states"""

    grains_left: int = 0
    bonds: Optional[BondCounts] = None
    list: np.ndarray = field(default_factory=lambda: np.empty(0, BOND))

    def encoded(self, with_list: bool) -> bytes:
        b = self.bonds
        counts = b"\0" if b is None else b"\1" + struct.pack("=5q", b.intact, b.tension, b.shear, b.left, b.lost)
        listed = np.ascontiguousarray(self.list if with_list else self.list[:0], BOND)
        return struct.pack("=q", self.grains_left) + counts + struct.pack("=Q", len(listed)) + listed.tobytes()
