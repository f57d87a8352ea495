# SPDX-License-Identifier: GPL-2.0-or-later
"""Fills a closed surface with spheres that overlap, and writes the file of LIGGGHTS' particletemplate/multisphere.

The spheres lie in the surface: each is as large as fits at its centre. They are taken one after another, each where it
adds most to what is filled. In the end all radii grow by one factor, so that the volume of their union is that of the
surface."""

import argparse
import pathlib
import sys
import time
from dataclasses import dataclass

import numpy as np

from .ball_union import of_spheres
from .project import tool
from .shapes import read_stl


@dataclass
class Body:
    """Volume, centroid and inertia over mass about it."""
    volume: float
    centroid: np.ndarray
    inertia: np.ndarray

    @classmethod
    def of_moments(cls, volume, centroid, second):
        about = second - np.outer(centroid, centroid)
        return cls(volume, centroid, np.trace(about) * np.eye(3) - about)


def of_mesh(corners):
    """A closed surface as the sum of tetrahedra from the origin; one that faces inwards has a negative volume."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    parts = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    volume = parts.sum()
    total = a + b + c
    first = (parts[:, None] * total).sum(0) / 4
    second = np.einsum("t,ti,tj->ij", parts, total, total)
    for corner in (a, b, c):
        second += np.einsum("t,ti,tj->ij", parts, corner, corner)
    return Body.of_moments(volume, first / volume, second / 20 / volume)


def is_closed(corners):
    """Whether every edge has exactly two triangles, one in each direction."""
    _, number = np.unique(np.round(corners.reshape(-1, 3), 9), axis=0, return_inverse=True)
    number = number.reshape(-1, 3)
    edges = np.concatenate([number[:, [0, 1]], number[:, [1, 2]], number[:, [2, 0]]])
    there = {tuple(e) for e in edges}
    return len(there) == len(edges) and all((j, i) in there for i, j in there)


def inside(corners, points):
    """Which points a closed surface encloses: crossings of a line along x, beside no edge by chance."""
    shift = 1e-7 * np.ptp(corners.reshape(-1, 3), axis=0)
    p = points + np.array([0.0, shift[1] * 0.618, shift[2] * 0.414])
    crossings = np.zeros(len(p), int)
    for a, b, c in corners:
        near = np.flatnonzero((p[:, 1] >= min(a[1], b[1], c[1])) & (p[:, 1] <= max(a[1], b[1], c[1])) &
                              (p[:, 2] >= min(a[2], b[2], c[2])) & (p[:, 2] <= max(a[2], b[2], c[2])))
        area = (b[1] - a[1]) * (c[2] - a[2]) - (c[1] - a[1]) * (b[2] - a[2])
        if not len(near) or area == 0:
            continue
        q = p[near]
        u = ((q[:, 1] - a[1]) * (c[2] - a[2]) - (c[1] - a[1]) * (q[:, 2] - a[2])) / area
        v = ((b[1] - a[1]) * (q[:, 2] - a[2]) - (q[:, 1] - a[1]) * (b[2] - a[2])) / area
        x = a[0] + u * (b[0] - a[0]) + v * (c[0] - a[0])
        crossings[near] += (u >= 0) & (v >= 0) & (u + v <= 1) & (x > q[:, 0])
    return crossings % 2 == 1


def distance(corners, points):
    """Of points to the nearest triangle."""
    nearest = np.full(len(points), np.inf)
    for k in progress(len(corners), "triangles measured"):
        a, b, c = corners[k]
        nearest = np.minimum(nearest, _to_triangle(points, a, b, c))
    return nearest


def _to_segment(p, a, b):
    along = b - a
    t = np.clip((p - a) @ along / max(along @ along, 1e-300), 0, 1)
    return np.linalg.norm(p - a - t[:, None] * along, axis=1)


def _to_triangle(p, a, b, c):
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal)
    edges = np.minimum(np.minimum(_to_segment(p, a, b), _to_segment(p, b, c)), _to_segment(p, c, a))
    if size == 0:
        return edges
    normal = normal / size
    over = (((p - a) @ np.cross(normal, b - a) >= 0) & ((p - b) @ np.cross(normal, c - b) >= 0) &
            ((p - c) @ np.cross(normal, a - c) >= 0))
    return np.where(over, np.abs((p - a) @ normal), edges)


def progress(count, what, every=2.0, out=sys.stderr):
    """Counts to a number, and says how far it has come every so many seconds [s]; of what is done sooner nothing."""
    said = time.monotonic()
    for k in range(count):
        if time.monotonic() - said >= every:
            said = time.monotonic()
            print(f"clump | {k} of {count} {what}", file=out, flush=True)
        yield k


def fill(corners, count, fineness=40):
    """@return  centres and radii. @param fineness  points along the longest axis where a sphere may be"""
    lo, hi = corners.reshape(-1, 3).min(0), corners.reshape(-1, 3).max(0)
    step = (hi - lo).max() / fineness
    axes = [np.arange(lo[k] + 0.5 * step, hi[k], step) for k in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    points = points[inside(corners, points)]
    points = np.vstack([points, of_mesh(corners).centroid])
    radius = distance(corners, points)
    filled, centres, radii = np.zeros(len(points), bool), [], []
    for _ in progress(count, "spheres placed"):
        # the largest that fit, and those beside what is empty: the best of four hundred
        empty = np.flatnonzero(~filled)
        if not len(empty):
            break
        worth = radius * (1 + ~filled)
        order = np.argsort(-worth)[:: max(1, len(points) // 4000)][:400]
        reach = empty[:: max(1, len(empty) // 1500)]
        gain = (np.linalg.norm(points[order][:, None] - points[reach][None], axis=2) < radius[order][:, None]).sum(1)
        best = order[np.argmax(gain)]
        centres.append(points[best])
        radii.append(radius[best])
        filled |= np.linalg.norm(points - points[best], axis=1) < radius[best]
    return np.array(centres), np.array(radii)


def grown(centres, radii, volume):
    """Radii times the factor with which the union has that volume: to 1e-9 of it."""
    low, high = 0.0, 1.0
    while of_spheres(centres, high * radii)[0] < volume:
        low, high = high, 2 * high
    factor = high
    for _ in range(60):
        there = of_spheres(centres, factor * radii)[0]
        if abs(there / volume - 1) < 1e-9:
            break
        low, high = (factor, high) if there < volume else (low, factor)
        factor *= np.cbrt(volume / there)
        if not low < factor < high:
            factor = 0.5 * (low + high)
    return factor * radii


def report(mesh, clump):
    """Lines of what differs between the surface and the clump."""
    inertia = [np.sort(np.linalg.eigvalsh(b.inertia)) for b in (mesh, clump)]
    off = np.linalg.norm(clump.centroid - mesh.centroid) / np.cbrt(3 * mesh.volume / 4 / np.pi)
    return [f"volume {mesh.volume:.6g}, clump {clump.volume:.6g}: {100 * (clump.volume / mesh.volume - 1):+.2f} %",
            "inertia over mass " + ", ".join(f"{a:.4g}" for a in inertia[0]) + "; clump " +
            ", ".join(f"{100 * (b / a - 1):+.2f} %" for a, b in zip(*inertia)),
            f"centroid {100 * off:.2f} % of the radius of its volume off"]


def main():
    parser = argparse.ArgumentParser(prog=tool("make_clump"), description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh", type=pathlib.Path, help="a closed surface, .stl")
    parser.add_argument("spheres", type=int, help="how many")
    parser.add_argument("--out", type=pathlib.Path, help="default: MESH-SPHERES.txt beside the mesh")
    parser.add_argument("--force", action="store_true", help="replace a file of that name")
    parser.add_argument("--fineness", type=int, default=40, help="places along the longest axis (40)")
    options = parser.parse_args()
    if options.spheres < 1 or options.fineness < 8:
        parser.error("give at least one sphere, and a fineness of at least 8")
    if not options.mesh.is_file():
        parser.error(f"{options.mesh} is no file; give a closed surface as .stl")
    try:
        corners = read_stl(options.mesh)
    except ValueError as error:
        parser.error(str(error))
    if not is_closed(corners):
        parser.error(f"{options.mesh} is not closed: it does not say what is inside; close it")
    out = options.out or options.mesh.with_name(f"{options.mesh.stem}-{options.spheres}.txt")
    if out.is_dir() or out.exists() and not options.force:
        parser.error(f"{out} is there: it is not overwritten; give another --out" + ("" if out.is_dir() else ", or --force to replace it"))
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        parser.error(f"{out.parent}: {error.strerror}; give another --out")
    mesh = of_mesh(corners)
    if not mesh.volume > 0:
        parser.error(f"{options.mesh} has triangles that face inwards: it encloses less than nothing; turn them, so that the corners "
                     "of each run anticlockwise as seen from outside")
    centres, radii = fill(corners, options.spheres, options.fineness)
    radii = grown(centres, radii, mesh.volume)
    centres = centres - of_spheres(centres, radii)[1]
    clump = Body.of_moments(*of_spheres(centres, radii))
    mesh.centroid = mesh.centroid - mesh.centroid  # the clump's frame is about its own
    out.write_text("".join(f"{x:.9g} {y:.9g} {z:.9g} {r:.9g}\n" for (x, y, z), r in zip(centres, radii)))
    print("\n".join(report(mesh, clump)))
    print(f"{len(radii)} spheres, in the unit of the mesh: {out}\n"
          f"fix ID all particletemplate/multisphere SEED atom_type 1 density constant RHO nspheres {len(radii)} "
          f"ntry 1000000 spheres file {out.name} scale 1.0 type 1")


if __name__ == "__main__":
    main()
