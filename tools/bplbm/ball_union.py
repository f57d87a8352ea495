# SPDX-License-Identifier: GPL-2.0-or-later
"""Volume of discs or spheres that overlap, and how it is spread, to 1e-8 and better.

Of discs the integrals over the union are sums over the arcs of its edge (divergence theorem), in closed form. Spheres are
cut into slices, unions of discs. Between two heights where a sphere, the circle of two spheres or a point of three begins
or ends, what the slices have is smooth, but for square roots at both ends: quadrature by Gauss in the angle of a cosine."""

import itertools

import numpy as np

NODES = 16       # of the quadrature between two heights
SAME = 1e-12     # of the size of all: heights, and depths in another sphere, that are no difference


def of_discs(centres, radii):
    """Area of a union of discs, its centroid, and the mean of x xᵀ. @param centres  [disc][2]"""
    area, first, second = (m[0] for m in _moments(np.array(centres, float)[None], np.array(radii, float)[None]))
    return area, first / area, second / area


def of_spheres(centres, radii):
    """Volume of a union of spheres, its centroid, and the mean of x xᵀ. @param centres  [sphere][3]"""
    centres, radii = np.array(centres, float), np.array(radii, float)
    node, weight = np.polynomial.legendre.leggauss(NODES)
    angle = 0.5 * np.pi * (node + 1)
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for low, high in itertools.pairwise(_heights(centres, radii)):
        z = low + 0.5 * (high - low) * (1 - np.cos(angle))
        w = 0.25 * np.pi * (high - low) * np.sin(angle) * weight
        there = (centres[:, 2] - radii < z[-1]) & (centres[:, 2] + radii > z[0])
        own = centres[there]
        discs = np.sqrt(np.maximum(0, radii[there]**2 - (z[:, None] - own[:, 2])**2))
        area, moved, spread = _moments(np.broadcast_to(own[:, :2], (NODES, len(own), 2)), discs)
        volume += w @ area
        first += [*(w @ moved), (w * z) @ area]
        second[:2, :2] += np.einsum("s,sij->ij", w, spread)
        second[2, :2] += (w * z) @ moved
        second[2, 2] += (w * z**2) @ area
    second[:2, 2] = second[2, :2]
    return volume, first / volume, second / volume


def _moments(centres, radii):
    """∫ dA, ∫ x dA and ∫ x xᵀ dA over unions of discs. @param centres  [union][disc][2]; a radius of 0: none is there"""
    begin, end = _bare(centres, radii)  # [union][disc][arc]
    sine, cosine = np.sin(end), np.cos(end)
    sine0, cosine0 = np.sin(begin), np.cos(begin)
    turn = end - begin

    def sums(values):
        return values.sum(-1)

    # integrals of 1, n, n n and n n n over the arcs, n = (cos, sin)
    zero = sums(turn)
    one = np.stack([sums(sine - sine0), sums(cosine0 - cosine)], -1)
    double = sums(sine * cosine - sine0 * cosine0) / 2
    mixed = sums(sine**2 - sine0**2) / 2
    two = np.stack([np.stack([zero / 2 + double, mixed], -1), np.stack([mixed, zero / 2 - double], -1)], -1)
    sines, cosines = sums(sine**3 - sine0**3) / 3, sums(cosine**3 - cosine0**3) / 3
    xxx, xxy, xyy, yyy = one[..., 0] - sines, -cosines, sines, one[..., 1] + cosines
    three = np.stack([np.stack([np.stack([xxx, xxy], -1), np.stack([xxy, xyy], -1)], -1),
                      np.stack([np.stack([xxy, xyy], -1), np.stack([xyy, yyy], -1)], -1)], -1)
    c, r = centres, radii
    r1, r2 = r[..., None], r[..., None, None]
    # x = c + r n and x·n = c·n + r; of ds = r dφ; the divergences of x, x x and x x x are 2, 3 and 4 times the integrand
    flux0 = np.einsum("...k,...k", c, one) + r * zero
    flux1 = np.einsum("...k,...ki->...i", c, two) + r1 * one
    flux2 = np.einsum("...k,...kij->...ij", c, three) + r2 * two
    outer = c[..., :, None] * flux1[..., None, :]
    area = r * flux0 / 2
    first = r1 * (c * flux0[..., None] + r1 * flux1) / 3
    second = r2 * (c[..., :, None] * c[..., None, :] * flux0[..., None, None] +
                   r2 * (outer + np.swapaxes(outer, -1, -2)) + r2**2 * flux2) / 4
    return area.sum(1), first.sum(1), second.sum(1)


def _bare(centres, radii):
    """Begins and ends of the arcs of each disc that no other covers, as angles; of equal discs the first has them."""
    way = centres[:, None, :, :] - centres[:, :, None, :]  # [union][of][by]
    far = np.linalg.norm(way, axis=-1)
    own, other = radii[:, :, None], radii[:, None, :]
    number = np.arange(radii.shape[1])
    twins = (far == 0) & (own == other) & (number[None, None, :] < number[None, :, None])
    holds = ((far + own <= other) & ((far > 0) | (own < other))) | twins | (own == 0)
    cuts = (far < own + other) & (far > np.abs(own - other)) & ~holds
    cosine = (far**2 + own**2 - other**2) / (2 * np.where(cuts, far * own, 1.0))
    half = np.where(cuts, np.arccos(np.clip(cosine, -1, 1)), np.where(holds, np.pi, 0.0))
    full = 2 * np.pi
    begin = np.where(cuts, np.arctan2(way[..., 1], way[..., 0]) - half, 0.0) % full
    end = begin + 2 * half
    begin = np.concatenate([begin, np.zeros_like(begin)], -1)  # what passes the full turn goes on from 0
    end = np.concatenate([np.minimum(end, full), np.maximum(end - full, 0.0)], -1)
    order = np.argsort(begin, -1)
    begin, end = np.take_along_axis(begin, order, -1), np.take_along_axis(end, order, -1)
    reached = np.maximum.accumulate(np.concatenate([np.zeros_like(end[..., :1]), end], -1), -1)
    until = np.concatenate([begin, np.full_like(begin[..., :1], full)], -1)
    return reached, np.maximum(reached, until)


def _heights(centres, radii):
    """Where the slices of a union change their kind: z of what begins or ends there and lies in no other sphere."""
    size = 2 * (np.abs(centres - centres[0]).max() + radii.max())
    found = [(centres + [0, 0, sign] * radii[:, None], np.arange(len(radii))[:, None]) for sign in (-1, 1)]
    found += _circles(centres, radii)
    heights = []
    for points, owners in found:
        if not len(points):
            continue
        deep = radii - np.linalg.norm(points[:, None] - centres, axis=2)
        np.put_along_axis(deep, owners, -np.inf, 1)
        heights.append(points[deep.max(1) < 1e3 * SAME * size, 2])
    heights = np.sort(np.concatenate(heights))
    return heights[np.append(True, np.diff(heights) > SAME * size)]


def _circles(centres, radii):
    """Lowest and highest points of the circles in which two spheres cross, and the points that three have in common, with
    the numbers of these spheres."""
    first, second = np.triu_indices(len(radii), 1)
    way = centres[second] - centres[first]
    far = np.linalg.norm(way, axis=1)
    cross = (far < radii[first] + radii[second]) & (far > np.abs(radii[first] - radii[second]))
    first, second, way, far = first[cross], second[cross], way[cross], far[cross]
    axis = way / far[:, None]
    along = (far**2 + radii[first]**2 - radii[second]**2) / (2 * far)
    middle = centres[first] + along[:, None] * axis
    radius = np.sqrt(np.maximum(0, radii[first]**2 - along**2))
    up = np.array([0.0, 0.0, 1.0]) - axis * axis[:, 2:]
    steep = np.linalg.norm(up, axis=1)
    flat = steep < 1e-9
    up = np.where(flat[:, None], np.cross(axis, [1.0, 0.0, 0.0]), up)  # the whole circle is at one height
    up /= np.linalg.norm(up, axis=1)[:, None]
    owners = np.stack([first, second], 1)
    found = [(middle + sign * radius[:, None] * up, owners) for sign in (-1, 1)]
    across = np.cross(axis, up)
    for third in range(len(radii)):  # on each circle: c + ρ (cos up + sin across) at its radius from the third
        use = np.flatnonzero(second < third)
        gap = middle[use] - centres[third]
        a, b = (2 * radius[use] * np.einsum("ij,ij->i", gap, v[use]) for v in (up, across))
        rest = radii[third]**2 - radius[use]**2 - (gap**2).sum(1)
        swing = np.hypot(a, b)
        meets = np.abs(rest) < swing
        use, a, b, rest, swing = use[meets], a[meets], b[meets], rest[meets], swing[meets]
        for sign in (-1, 1):
            angle = np.arctan2(b, a) + sign * np.arccos(rest / swing)
            points = middle[use] + radius[use][:, None] * (np.cos(angle)[:, None] * up[use] + np.sin(angle)[:, None] * across[use])
            found.append((points, np.column_stack([owners[use], np.full(len(use), third)])))
    return found
