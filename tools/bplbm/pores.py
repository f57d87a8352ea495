"""The water between the discs of a frame: free areas at an inlet, pressure at places."""

import numpy as np


def connected(free, start):
    """Cells of `free` that are linked to those of `start` over sides of cells."""
    reached = start & free
    while True:
        grown = reached.copy()
        grown[1:] |= reached[:-1]
        grown[:-1] |= reached[1:]
        grown[:, 1:] |= reached[:, :-1]
        grown[:, :-1] |= reached[:, 1:]
        grown &= free
        if (grown == reached).all():
            return reached
        reached = grown


def cavity(run, frame, inlet, half_width=0.001):
    """Area around an inlet in the left wall, at heights from … to [m], that has no disc in a square of twice half_width
    and is linked to the inlet [m²]: a free square of that size is no pore."""
    cell = run.parameters["cell"]
    free = frame["solid_fraction"] < 0.05
    start = np.zeros_like(free)
    start[slice(*(round(y / cell) for y in inlet)), 0] = True
    reached = connected(free, start)
    half = round(half_width / cell)
    side = 2 * half + 1
    wide = reached[half:-half, half:-half].copy()
    for dy in range(side):
        for dx in range(side):
            wide &= free[dy:free.shape[0] - side + 1 + dy, dx:free.shape[1] - side + 1 + dx]
    return wide.sum() * cell**2


def pressure_at(run, frame, places, reach=0.0015):
    """Mean of the pressures that the fluid has within a reach of each place [Pa]; 0 where there is no place."""
    cell, pressure = run.parameters["cell"], frame["pressure"]
    found = []
    for x, y in places:
        rows = slice(max(0, int((y - reach) / cell)), int((y + reach) / cell) + 1)
        columns = slice(max(0, int((x - reach) / cell)), int((x + reach) / cell) + 1)
        near = pressure[rows, columns]
        if np.isfinite(near).any():
            found.append(np.nanmean(near))
    return float(np.mean(found)) if found else 0.0
