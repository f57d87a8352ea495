"""Cracks in a bonded block of discs: which broken bonds are one crack, how far it reaches, how wide it is.

A crack in two dimensions runs through the pores. The bonds are the edges of a plane graph, its faces are the pores, and
a bond that breaks joins the two pores at its sides: broken bonds that join the same set of pores are one crack.
"""

import numpy as np


class BondGraph:
    """Bonds as they were made: places of the discs [m] by id, and pairs of ids."""

    def __init__(self, places, pairs):
        self.places, self.pairs = places, [tuple(sorted(pair)) for pair in pairs]
        self.faces = {}  # (a, b) -> number of the pore to the left of the way from a to b
        self.outside = self._walk(self._neighbours())

    def _neighbours(self):
        """Of each disc those that it is bonded to, counter-clockwise."""
        found = {}
        for a, b in self.pairs:
            found.setdefault(a, []).append(b)
            found.setdefault(b, []).append(a)
        for a, others in found.items():
            others.sort(key=lambda b: np.arctan2(*(self.places[b] - self.places[a])[::-1]))
        return found

    def _walk(self, neighbours):
        """Numbers all pores. Returns the number of what lies around the block."""
        areas = []
        for start in [(a, b) for a, others in neighbours.items() for b in others]:
            if start in self.faces:
                continue
            edge, corners = start, []
            while edge not in self.faces:
                self.faces[edge] = len(areas)
                corners.append(self.places[edge[0]])
                a, b = edge
                around = neighbours[b]
                edge = (b, around[around.index(a) - 1])  # the next one clockwise: the pore stays to the left
            x, y = np.array(corners).T
            areas.append(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
        return int(np.argmin(areas)) if areas else -1

    def sides(self, pair):
        """The two pores at a bond."""
        a, b = pair
        return self.faces[a, b], self.faces[b, a]

    def crack(self, broken, seeds):
        """Of the broken bonds those that are one crack with a seed: array of bools.

        broken: pairs of ids; seeds: bools, the broken bonds that a crack may begin with. What lies around the block
        joins nothing: a crack along its side is no crack through it.
        """
        sides = [[face for face in self.sides(pair) if face != self.outside] for pair in broken]
        mine = np.array(seeds, dtype=bool).copy()
        reached = {face for faces, one in zip(sides, mine) for face in faces if one}
        while True:
            more = [k for k in np.flatnonzero(~mine) if reached.intersection(sides[k])]
            if not more:
                return mine
            mine[more] = True
            reached.update(face for k in more for face in sides[k])


def chain(places, seeds, reach):
    """Of breaks in space those that hang together with a seed: array of bools. A crack goes on from a break to all that lie
    within a reach [m] of it; where bonds are no plane graph, this stands for their pores.

    places: [n][3] [m]; seeds: bools.
    """
    mine = np.array(seeds, dtype=bool).copy()
    near = np.linalg.norm(places[:, None] - places[None], axis=2) < reach
    while True:
        grown = mine | near[:, mine].any(axis=1)
        if (grown == mine).all():
            return mine
        mine = grown


def openings(places, radii, pairs):
    """Gaps between the surfaces of pairs of discs [m], 0 where they touch."""
    a, b = np.array(pairs, dtype=int).reshape(-1, 2).T
    apart = [np.hypot(*(places[i] - places[j])) - radii[i] - radii[j] for i, j in zip(a, b)]
    return np.maximum(0.0, np.array(apart))
