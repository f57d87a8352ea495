# SPDX-License-Identifier: GPL-2.0-or-later
"""Packings of clumps: bodies of one shape, of discs or spheres that overlap, at random places and orientations, which
push each other away until those of different bodies overlap no more."""

from dataclasses import dataclass
import pathlib
import time

import numpy as np

from bplbm.ball_union import of_discs, of_spheres
from bplbm.project import tool

SILENCE = 5.0  # s from one line of progress to the next
LISTS, PATIENCE = 1000, 2000  # lists of neighbours, at most, and steps with one


@dataclass
class Shape:
    """A clump whose union has the area or volume of a disc or sphere of diameter 1, about its centroid."""
    places: np.ndarray  # [sphere][dimension]
    radii: np.ndarray
    excess: float       # sum of the volumes of its spheres over that of the union


def read_shape(path, dimension):
    """@throws ValueError  what is wrong with the file"""
    try:
        rows = np.loadtxt(path, ndmin=2)
    except OSError:
        raise ValueError(f"{path} cannot be read; give a file of lines x y z radius, as {tool('make_clump')} writes them") from None
    except ValueError as error:
        raise ValueError(f"{path}: {error}; give lines of x y z radius, as {tool('make_clump')} writes them") from None
    if rows.shape[1] != 4 or not np.all(np.isfinite(rows)) or not np.all(rows[:, 3] > 0):
        raise ValueError(f"{path}: give lines of x y z radius, the radius positive, as {tool('make_clump')} writes them")
    if dimension == 2 and np.any(rows[:, 2] != 0):
        raise ValueError(f"{path}: a clump of discs has z = 0; give --box six numbers for one of spheres")
    places, radii = rows[:, :dimension], rows[:, 3]
    if dimension == 2:
        volume, middle, _ = of_discs(places, radii)
        unit, parts = np.sqrt(4 * volume / np.pi), np.pi * radii**2
    else:
        volume, middle, _ = of_spheres(places, radii)
        unit, parts = np.cbrt(6 * volume / np.pi), 4 / 3 * np.pi * radii**3
    return Shape((places - middle) / unit, radii / unit, parts.sum() / volume)


def turns(vectors):
    """Rotation matrices of rotation vectors [n][3]."""
    angle = np.linalg.norm(vectors, axis=1)
    x, y, z = (vectors / np.maximum(angle, 1e-300)[:, None]).T
    zero = np.zeros_like(x)
    cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    sine, cosine = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross)


class Bodies:
    """The clumps of a packing. low, high: corners of the box; periodic: for each direction whether it is."""

    def __init__(self, shape, sizes, low, high, periodic, random):
        self.low, self.high, self.periodic = low, high, periodic
        self.dimension, self.each = len(low), len(shape.radii)
        self.radii = np.repeat(sizes, self.each) * np.tile(shape.radii, len(sizes))
        self.body = np.repeat(np.arange(len(sizes)), self.each)
        self.middles = random.uniform(low + 0.5 * sizes[:, None], high - 0.5 * sizes[:, None])
        arms = np.zeros((len(sizes), self.each, 3))
        arms[:, :, :self.dimension] = sizes[:, None, None] * shape.places
        if self.dimension == 2:
            first = random.uniform(0, 2 * np.pi, len(sizes))[:, None] * [0.0, 0.0, 1.0]
            self.arms = np.einsum("nij,nkj->nki", turns(first), arms)
        else:
            q, _ = np.linalg.qr(random.normal(size=(len(sizes), 3, 3)))
            q *= np.sign(np.linalg.det(q))[:, None, None]
            self.arms = np.einsum("nij,nkj->nki", q, arms)
        # about which a turn of 1 moves its surface by as much as a shift of 1 does
        self.reach = (np.linalg.norm(arms, axis=2) + self.radii.reshape(len(sizes), -1)).max(1)

    def places(self):
        """[sphere][dimension], of those that belong together side by side, whatever periodic sides they cross."""
        return (self.middles[:, None, :] + self.arms[:, :, :self.dimension]).reshape(-1, self.dimension)

    def apart(self, vectors):
        length = self.high - self.low
        return vectors - self.periodic * length * np.round(vectors / length)

    def neighbours(self, skin):
        """Pairs of spheres of different clumps whose surfaces are less than a skin apart."""
        places, found = self.places(), []
        for i in range(len(places) - 1):
            others = slice(i + 1, None)
            near = np.abs(self.apart(places[others] - places[i])).max(1) < self.radii[others] + self.radii[i] + skin
            near &= self.body[others] != self.body[i]
            found.append(np.stack([np.full(near.sum(), i), i + 1 + np.flatnonzero(near)], 1))
        return np.concatenate(found)

    def overlaps(self, pairs):
        """Of pairs of spheres: overlaps, positive, and unit vectors from the first to the second; of walls: the overlap
        along each axis, signed towards the box."""
        places = self.places()
        way = self.apart(places[pairs[:, 1]] - places[pairs[:, 0]])
        far = np.linalg.norm(way, axis=1)
        deep = self.radii[pairs].sum(1) - far
        low = np.maximum(0, self.low + self.radii[:, None] - places)
        high = np.maximum(0, places + self.radii[:, None] - self.high)
        return np.maximum(0, deep), way / np.maximum(far, 1e-300)[:, None], (low - high) * ~self.periodic

    def worst(self, pairs):
        """Largest overlap over the smaller radius."""
        deep, _, walls = self.overlaps(pairs)
        between = (deep / self.radii[pairs].min(1)).max(initial=0)
        return max(between, (np.abs(walls) / self.radii[:, None]).max())

    def push(self, pairs):
        """Forces on the clumps, and torques over their reach."""
        deep, way, force = self.overlaps(pairs)
        for side, sign in ((0, -1.0), (1, 1.0)):
            for k in range(self.dimension):
                force[:, k] += np.bincount(pairs[:, side], sign * deep * way[:, k], minlength=len(force))
        whole = np.zeros((len(force), 3))
        whole[:, :self.dimension] = force
        whole = whole.reshape(-1, self.each, 3)
        torque = np.cross(self.arms, whole).sum(1) / self.reach[:, None]
        return whole.sum(1)[:, :self.dimension], torque

    def move(self, shift, turn):
        """By shifts, and turns as a way of the reach."""
        self.middles = self.middles + shift
        length = self.high - self.low
        self.middles -= self.periodic * length * np.floor((self.middles - self.low) / length)
        self.arms = np.einsum("nij,nkj->nki", turns(turn / self.reach[:, None]), self.arms)


def relax(bodies, overlap):
    """Moves them downhill [FIRE: Bitzek and others, Phys. Rev. Lett. 97 (2006) 170201] until the largest overlap over
    the smaller radius is within the bound, or no more is gained. Returns what is left."""
    skin = 0.3 * bodies.radii.min()
    left = np.inf
    said = time.monotonic()
    for _ in range(LISTS):
        pairs, way = bodies.neighbours(2 * skin), 0.0
        left = bodies.worst(pairs)
        if left <= overlap:
            return left
        if time.monotonic() > said + SILENCE:
            said = time.monotonic()
            print(f"packing | the largest overlap is {left:.2g} radii", flush=True)
        v, w = np.zeros_like(bodies.middles), np.zeros((len(bodies.middles), 3))
        step, mix, downhill = 0.2, 0.1, 0
        for _ in range(PATIENCE):
            force, torque = bodies.push(pairs)
            power = (force * v).sum() + (torque * w).sum()
            size = np.sqrt((force**2).sum() + (torque**2).sum())
            if size < 1e-12 * bodies.radii.min():
                break
            speed = np.sqrt((v**2).sum() + (w**2).sum())
            if power > 0:
                v, w = (1 - mix) * v + mix * speed / size * force, (1 - mix) * w + mix * speed / size * torque
                downhill += 1
                if downhill > 5:
                    step, mix = min(1.1 * step, 0.6), 0.99 * mix
            else:
                v, w, step, mix, downhill = 0 * v, 0 * w, 0.5 * step, 0.1, 0
            v, w = v + step * force, w + step * torque
            furthest = step * (np.linalg.norm(v, axis=1) + np.linalg.norm(w, axis=1)).max()
            part = min(1.0, 0.3 * skin / max(furthest, 1e-300))
            bodies.move(part * step * v, part * step * w)
            way += part * furthest
            if way > skin or bodies.worst(pairs) <= 0.5 * overlap:
                break
    return left


@dataclass
class Packing:
    """Of each sphere its place in the box, diameter, clump (from 1), and through which periodic sides it was moved there;
    what overlap is left over the smaller radius; volumes of a clump's spheres over its own."""
    places: np.ndarray
    diameters: np.ndarray
    clumps: np.ndarray
    images: np.ndarray
    left: float
    excess: float


def pack(path, sizes, low, high, periodic, overlap, random):
    """@param sizes  diameter of the disc or sphere of each clump's area or volume"""
    shape = read_shape(pathlib.Path(path), len(low))
    bodies = Bodies(shape, sizes, low, high, periodic, random)
    left = relax(bodies, overlap)
    places = bodies.places()
    images = (periodic * np.floor((places - low) / (high - low))).astype(int)
    return Packing(places - images * (high - low), 2 * bodies.radii, bodies.body + 1, images, left, shape.excess)
