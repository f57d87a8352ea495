"""bplbm: which broken bonds are one crack, how wide it is, and what the water does there."""

import pathlib
import sys
import unittest
from unittest import mock

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm.cracks import BondGraph, chain, openings  # noqa: E402
from bplbm.pores import cavity, connected, pressure_at  # noqa: E402

N = 5  # discs a row


def disc(column, row):
    return row * N + column


def lattice():
    """A square lattice of bonds; each square is a pore."""
    places = {disc(x, y): np.array([x, y], dtype=float) for x in range(N) for y in range(N)}
    along = [(disc(x, y), disc(x + 1, y)) for x in range(N - 1) for y in range(N)]
    up = [(disc(x, y), disc(x, y + 1)) for x in range(N) for y in range(N - 1)]
    return BondGraph(places, along + up)


class Crack(unittest.TestCase):
    def setUp(self):
        self.graph = lattice()

    def row(self, y, columns):
        """Upright bonds that a horizontal crack above row y breaks."""
        return [(disc(x, y), disc(x, y + 1)) for x in columns]

    def crack(self, broken, seed=0):
        return list(self.graph.crack(broken, [k == seed for k in range(len(broken))]))

    def test_each_square_is_a_pore_and_the_outside_is_one(self):
        self.assertEqual(len(set(self.graph.faces.values())), (N - 1) ** 2 + 1)
        self.assertEqual(self.graph.sides((disc(0, 0), disc(1, 0))).count(self.graph.outside), 1)
        self.assertNotIn(self.graph.outside, self.graph.sides((disc(1, 1), disc(2, 1))))

    def test_neighbours_along_a_line_are_one_crack(self):
        self.assertEqual(self.crack(self.row(1, range(N))), [True] * N)

    def test_a_bond_in_between_that_holds_ends_it(self):
        self.assertEqual(self.crack(self.row(1, (0, 1, 3, 4))), [True, True, False, False])

    def test_two_cracks_that_both_reach_the_side_stay_two(self):
        self.assertEqual(self.crack(self.row(0, (0, 1)) + self.row(2, (0, 1))), [True, True, False, False])

    def test_a_crack_turns_through_a_pore(self):
        turned = self.row(1, (0, 1)) + [(disc(1, 2), disc(2, 2))]
        self.assertEqual(self.crack(turned), [True] * 3)

    def test_without_a_seed_there_is_none(self):
        self.assertEqual(self.crack(self.row(1, range(3)), seed=9), [False] * 3)

    def test_a_disc_that_hangs_on_one_bond_lies_within_a_pore(self):
        graph = BondGraph({**self.graph.places, 99: np.array([1.5, 1.5])}, self.graph.pairs + [(disc(1, 1), 99)])
        left, right = graph.sides((disc(1, 1), 99))
        self.assertEqual(left, right)
        self.assertNotEqual(left, graph.outside)

    def test_openings_are_gaps_and_never_overlaps(self):
        found = openings({1: np.zeros(2), 2: np.array([3.0, 0.0]), 3: np.array([0.0, 1.0])}, {1: 1.0, 2: 1.0, 3: 1.0},
                         [(1, 2), (1, 3)])
        self.assertEqual(list(found), [1.0, 0.0])


class Chain(unittest.TestCase):
    """Breaks in space, at 0, 1, 2 and 4 m on a line."""

    def chain(self, seeds, reach):
        places = np.array([[x, 0.0, 0.0] for x in (0.0, 1.0, 2.0, 4.0)])
        return list(chain(places, np.isin(range(4), seeds), reach))

    def test_it_goes_on_as_far_as_the_reach(self):
        self.assertEqual(self.chain([0], 1.5), [True, True, True, False])
        self.assertEqual(self.chain([0], 2.5), [True] * 4)

    def test_it_begins_at_a_seed_only(self):
        self.assertEqual(self.chain([3], 1.5), [False, False, False, True])
        self.assertEqual(self.chain([], 1.5), [False] * 4)

    def test_no_breaks_are_no_crack(self):
        self.assertEqual(len(chain(np.zeros((0, 3)), np.zeros(0, dtype=bool), 1.0)), 0)


class Pores(unittest.TestCase):
    run_of = staticmethod(lambda: mock.Mock(parameters={"cell": 0.5}))

    def test_only_what_is_linked_over_sides_counts(self):
        free = np.array([[1, 1, 0, 1], [0, 0, 1, 0]], dtype=bool)
        start = np.zeros_like(free)
        start[0, 0] = True
        self.assertEqual(connected(free, start).sum(), 2)

    def test_a_cavity_is_as_wide_as_the_square(self):
        solid = np.ones((9, 9))
        solid[3:8, 0:5] = 0.0  # a hole of 5 cells at the inlet
        solid[4, 5:8] = 0.0    # and a channel, too narrow
        self.assertAlmostEqual(cavity(self.run_of(), {"solid_fraction": solid}, (2.0, 2.5), half_width=1.0), 0.25)

    def test_pressure_leaves_out_what_is_covered(self):
        pressure = np.full((9, 9), np.nan)
        pressure[4, 4:6] = 3.0, 5.0
        frame = {"pressure": pressure}
        self.assertAlmostEqual(pressure_at(self.run_of(), frame, [(2.5, 2.25)], reach=0.5), 4.0)
        self.assertEqual(pressure_at(self.run_of(), frame, [(0.5, 0.5)], reach=0.5), 0.0)


if __name__ == "__main__":
    unittest.main()
