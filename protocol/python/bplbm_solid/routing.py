# SPDX-License-Identifier: MIT
"""Which fluid ranks a particle goes to, and which shapes a rank must be told."""

import numpy as np

from .errors import BAD_INPUT, SolidError
from .frames import Handshake
from .records import SHAPE


def touching(fluid: Handshake, states: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Indices of the particles that touch a fluid rank's subdomain, grown by radius and reach, themselves or by an image."""
    grown = radius + fluid.reach
    there = np.ones(len(states), bool)
    for k in range(fluid.dimension):
        lo, hi, x = fluid.subdomain_lo[k] - grown, fluid.subdomain_hi[k] + grown, states["x"][:, k]
        if fluid.periodic[k]:  # the first image at or above lo is the one to look at
            length = fluid.box_hi[k] - fluid.box_lo[k]
            x = x - np.floor((x - lo) / length) * length
        there &= (x >= lo) & (x <= hi)
    return np.flatnonzero(there)


def routed_by(shapes: np.ndarray) -> np.ndarray:
    """Of each record the one whose ball says which fluid ranks get it: itself, or its clump's carrier.

    @throws SolidError  a sphere of a clump comes without its carrier"""
    by = np.arange(len(shapes))
    parts = np.flatnonzero((shapes["carrier"] != -1) & (shapes["carrier"] != shapes["id"]))
    if not len(parts):
        return by
    order = np.argsort(shapes["id"], kind="stable")
    place = np.searchsorted(shapes["id"], shapes["carrier"][parts], sorter=order).clip(max=len(shapes) - 1)
    by[parts] = order[place]
    lost = parts[shapes["id"][by[parts]] != shapes["carrier"][parts]]
    if len(lost):
        s = shapes[lost[0]]
        raise SolidError(f"particle {s['id']} is a sphere of clump {s['carrier']}, which this rank does not send: the rank that "
                         "sends a clump sends all its spheres", BAD_INPUT)
    return by


def refuse_astray(fluid: Handshake, states: np.ndarray, interval: int) -> None:
    """@throws SolidError  where a particle is as far outside of the box as that is long"""
    for k in (k for k in range(fluid.dimension) if not fluid.periodic[k]):
        lo, hi, x = fluid.box_lo[k], fluid.box_hi[k], states["x"][:, k]
        far = np.flatnonzero((x < 2 * lo - hi) | (x > 2 * hi - lo))
        if len(far):
            s = states[far[0]]
            raise SolidError(f"particle {s['id']}: its centre ({s['x'][0]:.6g}, {s['x'][1]:.6g}, {s['x'][2]:.6g}) m lies far "
                             f"outside of the box at interval {interval}; correct its place, or take it out", BAD_INPUT)


def _bits(shapes: np.ndarray) -> np.ndarray:
    return shapes.view("u8").reshape(len(shapes), SHAPE.itemsize // 8)


class Told:
    """The shapes that one fluid rank was told last."""

    def __init__(self) -> None:
        self.shapes = np.empty(0, SHAPE)

    def news(self, shapes: np.ndarray) -> np.ndarray:
        """Those of `shapes` that the rank does not know yet; it knows them afterwards, and no others."""
        before, self.shapes = self.shapes, shapes.copy()
        if np.array_equal(before["id"], shapes["id"]):
            return shapes[np.any(_bits(before) != _bits(shapes), axis=1)]
        order = np.argsort(before["id"], kind="stable")
        place = np.searchsorted(before["id"], shapes["id"], sorter=order).clip(max=max(len(before) - 1, 0))
        if not len(before):
            return shapes
        known = before[order[place]]
        return shapes[np.any(_bits(known) != _bits(shapes), axis=1)]
