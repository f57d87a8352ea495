# SPDX-License-Identifier: MIT
"""Clumps: rigid bodies of discs or spheres that may overlap. A clump is a carrier, with mass, inertia and volume, and
spheres that name it and have none; the load on it is the carrier's."""

from typing import Sequence, Tuple

import numpy as np

from .errors import BAD_INPUT, SolidError
from .records import SHAPE, STATE

Matrix = np.ndarray


def _intervals(centres: np.ndarray, radii: np.ndarray, y: np.ndarray, z: np.ndarray) -> "Tuple[np.ndarray, np.ndarray]":
    """Where lines along x lie in each ball; of those that miss it an empty interval far out."""
    rest = radii**2 - (y[:, None] - centres[:, 1])**2 - (z[:, None] - centres[:, 2])**2
    half = np.sqrt(np.maximum(rest, 0.0))
    hit = rest > 0.0
    far = 4 * (np.abs(centres).max() + radii.max())
    return np.where(hit, centres[:, 0] - half, far), np.where(hit, centres[:, 0] + half, far)


def union_moments(centres: Sequence[Sequence[float]], radii: Sequence[float], dimension: int = 3,
                  depth: float = 1.0) -> "Tuple[float, np.ndarray, Matrix]":
    """Volume of a union of balls, its centroid, and the mean of x xᵀ about the origin; errors of 3e-5.

    Along x every line of a fine grid is integrated exactly. Of a single ball the formula.
    @param depth  of discs [m]"""
    c, r = np.array(centres, float).reshape(-1, 3), np.array(radii, float).reshape(-1)
    if dimension == 2:
        c = c * [1, 1, 0]
    if len(r) == 1:
        volume = np.pi * r[0]**2 * (depth if dimension == 2 else 4 / 3 * r[0])
        own = r[0]**2 * (np.diag([0.25, 0.25, 0.0]) if dimension == 2 else 0.2 * np.eye(3))
        return float(volume), c[0], np.outer(c[0], c[0]) + own
    lines = 800 if dimension == 2 else 160  # across the smallest, as in wire/ball_union.cpp

    def grid(axis):
        lo, hi = (c[:, axis] - r).min(), (c[:, axis] + r).max()
        count = int(np.ceil(lines * (hi - lo) / (2 * r.min())))
        step = (hi - lo) / count
        return lo + (np.arange(count) + 0.5) * step, step

    y, dy = grid(1)
    z, dz = (np.zeros(1), depth) if dimension == 2 else grid(2)
    y, z = (a.ravel() for a in np.meshgrid(y, z, indexing="ij"))
    begin, end = _intervals(c, r, y, z)
    order = np.argsort(begin, axis=1)
    begin, end = np.take_along_axis(begin, order, 1), np.take_along_axis(end, order, 1)
    reached = np.maximum.accumulate(end, axis=1)
    begin[:, 1:] = np.maximum(begin[:, 1:], reached[:, :-1])
    length = np.maximum(end - begin, 0.0)
    end = begin + length
    sums = {0: length.sum(1), 1: (0.5 * length * (begin + end)).sum(1),
            2: (length * (begin**2 + begin * end + end**2) / 3).sum(1)}
    total = sums[0].sum()
    first = np.array([sums[1].sum(), (y * sums[0]).sum(), (z * sums[0]).sum()]) / total
    xx, xy, xz = sums[2].sum(), (y * sums[1]).sum(), (z * sums[1]).sum()
    yy, yz, zz = (y * y * sums[0]).sum(), (y * z * sums[0]).sum(), (z * z * sums[0]).sum()
    return float(total * dy * dz), first, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) / total


def _check(number: int, centres: np.ndarray, radii: np.ndarray, density: float, spheres: Sequence[int]) -> None:
    """@raise SolidError  what can be no clump, with its number"""
    if centres.shape != (len(radii), 3) or not len(radii) or len(spheres) != len(radii):
        raise SolidError(f"clump {number}: centres of shape {centres.shape}, {len(radii)} radii and {len(spheres)} ids; "
                         "give x, y, z, a radius and an id to each of its spheres", BAD_INPUT)
    for j, (centre, radius) in enumerate(zip(centres, radii), 1):
        if not (np.isfinite(centre).all() and np.isfinite(radius) and radius > 0):
            raise SolidError(f"clump {number}: sphere {j} has its centre at {tuple(map(float, centre))} m and a radius of "
                             f"{radius} m; give finite numbers, the radius above 0", BAD_INPUT)
    if not (np.isfinite(density) and density > 0):
        raise SolidError(f"clump {number}: its density is {density} kg/m³; give one above 0", BAD_INPUT)


class Clump:
    """A homogeneous rigid body of spheres (in two dimensions discs): its shape, its motion, its records.

    Its frame is the one in which the centres are given, moved to the centroid of their union. `x`, `v`, `omega` and the
    matrix `turn` (frame to box) are there to be read and set."""

    def __init__(self, number: int, centres: Sequence[Sequence[float]], radii: Sequence[float], density: float, *,
                 spheres: Sequence[int], dimension: int = 3, depth: float = 1.0, kind: int = 1):
        """@param number, spheres  ids of the carrier and of each sphere, all different
        @param density  [kg/m³]"""
        self.dimension, self.radii = dimension, np.array(radii, float)
        _check(number, np.array(centres, float), self.radii, density, spheres)
        volume, centroid, _ = union_moments(centres, radii, dimension, depth)
        self.arms = np.array(centres, float) - centroid
        _, _, second = union_moments(self.arms, radii, dimension, depth)
        self.volume, self.mass = volume, density * volume
        self.inertia = self.mass * (np.trace(second) * np.eye(3) - second)  # in its frame
        self.x, self.v, self.omega, self.turn = np.zeros(3), np.zeros(3), np.zeros(3), np.eye(3)
        mean = self.inertia[2, 2] if dimension == 2 else np.trace(self.inertia) / 3
        reach = float((np.linalg.norm(self.arms, axis=1) + self.radii).max())
        self.shapes = np.array([(number, reach, self.mass, mean, kind, 0, -1, volume)] +
                               [(i, r, 0.0, 0.0, kind, 0, number, 0.0) for i, r in zip(spheres, self.radii)], SHAPE)

    @property
    def states(self) -> np.ndarray:
        """STATE records of the carrier and of its spheres, in the order of `shapes`."""
        states = np.zeros(len(self.shapes), STATE)
        arms = np.vstack([np.zeros(3), self.arms @ self.turn.T])
        states["id"], states["x"], states["omega"] = self.shapes["id"], self.x + arms, self.omega
        states["v"] = self.v + np.cross(self.omega, arms)
        return states

    def move(self, force: Sequence[float], torque: Sequence[float], dt: float) -> None:
        """A step of its motion as in vacuum: velocity first, then place, angular momentum first, then orientation."""
        force, torque = np.array(force, float), np.array(torque, float)
        if self.dimension == 2:
            force, torque = force * [1, 1, 0], torque * [0, 0, 1]
        self.v = self.v + dt / self.mass * force
        self.x = self.x + dt * self.v
        inertia = self.turn @ self.inertia @ self.turn.T
        momentum = inertia @ self.omega + dt * torque
        if self.dimension == 2:
            self.omega = np.array([0.0, 0.0, momentum[2] / self.inertia[2, 2]])
        else:
            self.omega = np.linalg.solve(inertia, momentum)
            middle = self._turned(0.5 * dt)  # ω there: of the second order
            self.omega = np.linalg.solve(middle @ self.inertia @ middle.T, momentum)
        self.turn = self._turned(dt)
        if self.dimension == 3:
            self.omega = np.linalg.solve(self.turn @ self.inertia @ self.turn.T, momentum)

    def _turned(self, dt: float) -> Matrix:
        angle = np.linalg.norm(self.omega) * dt
        if angle == 0.0:
            return self.turn
        n = self.omega / np.linalg.norm(self.omega)
        k = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
        turn = (np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k) @ self.turn
        u, _, v = np.linalg.svd(turn)  # stays a turn
        return u @ v
