"""Writes a slotted screen as an .stl file: two bars of keystone profile, whose slot is narrowest above.

    make_screen.py FILE WIDTH   # of the slot [mm], e.g. wide.stl 4.2
"""

import pathlib
import sys

import numpy as np

BOX = 12.0, 6.0        # mm along x, y
BELOW, ABOVE = 6.0, 8.0  # mm, z of the two faces
OPENS = 0.75           # mm by which each side of the slot goes back from above to below

# corners of a bar: 0 … 3 below, 4 … 7 above, counter-clockwise seen from above; facets seen from outside
FACETS = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6),
          (3, 0, 4), (3, 4, 7)]


def bar(below, above):
    """Corners of a bar from (x0, x1) below to (x0, x1) above, across the whole box."""
    return np.array([(x, y, z) for z, (x0, x1) in ((BELOW, below), (ABOVE, above))
                     for x, y in ((x0, 0.0), (x1, 0.0), (x1, BOX[1]), (x0, BOX[1]))])


def main():
    name, width = sys.argv[1], float(sys.argv[2])
    left, right = (BOX[0] - width) / 2, (BOX[0] + width) / 2
    bars = [bar((0.0, left - OPENS), (0.0, left)), bar((right + OPENS, BOX[0]), (right, BOX[0]))]
    lines = ["solid screen"]
    for corners in bars:
        for a, b, c in (corners[list(facet)] for facet in FACETS):
            normal = np.cross(b - a, c - a)
            lines.append("facet normal {:.6g} {:.6g} {:.6g}\n outer loop".format(*normal / np.linalg.norm(normal)))
            lines += ["  vertex {:.6g} {:.6g} {:.6g}".format(*corner) for corner in (a, b, c)]
            lines.append(" endloop\nendfacet")
    pathlib.Path(name).write_text("\n".join([*lines, "endsolid screen", ""]))


if __name__ == "__main__":
    main()
