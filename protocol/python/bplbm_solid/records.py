# SPDX-License-Identifier: MIT
"""The records of the wire as NumPy types, in SI units. In 2D forces, masses and inertias are those of the agreed depth."""

import math

import numpy as np

STATE = np.dtype([("id", "i8"), ("x", "f8", 3), ("v", "f8", 3), ("omega", "f8", 3)])
"""Motion of a particle at the beginning of an interval [m, m/s, rad/s]."""

SHAPE = np.dtype([("id", "i8"), ("radius", "f8"), ("mass", "f8"), ("inertia", "f8"), ("type", "i8"), ("epoch", "i8"),
                  ("carrier", "i8"), ("volume", "f8")])
"""What rarely changes [m, kg, kg m², m³]; type begins at 1, carrier is -1 (itself), volume 0 is that of its ball. A clump:
see `Clump`."""

LOAD = np.dtype([("id", "i8"), ("force", "f8", 3), ("torque", "f8", 3)])
"""Mean hydrodynamic load on a particle over an interval, about its centre [N, N m]."""

BOND = np.dtype([("first", "i8"), ("second", "i8"), ("state", "i8")])
"""A bond between two particles; state is 0 intact, 1 broken by tension, 2 by shear."""


def ball(number: int, radius: float, mass: float, inertia: float, kind: int = 1, epoch: int = 0) -> np.ndarray:
    """A SHAPE. Another epoch says that the number has passed to another particle, which begins anew."""
    return np.array((number, radius, mass, inertia, kind, epoch, -1, 0.0), SHAPE)


def disc(number: int, radius: float, density: float, depth: float, kind: int = 1, epoch: int = 0) -> np.ndarray:
    """The SHAPE of a homogeneous disc of the agreed depth [m, kg/m³, m]."""
    mass = density * math.pi * radius**2 * depth
    return ball(number, radius, mass, mass * radius**2 / 2, kind, epoch)


def sphere(number: int, radius: float, density: float, kind: int = 1, epoch: int = 0) -> np.ndarray:
    """The SHAPE of a homogeneous sphere [m, kg/m³]."""
    mass = density * 4 / 3 * math.pi * radius**3
    return ball(number, radius, mass, 0.4 * mass * radius**2, kind, epoch)
