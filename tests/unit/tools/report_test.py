"""What tools/report concludes from its rows; nothing is run."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools"))

import report  # noqa: E402
import report_needs  # noqa: E402
from report_cases import OURS, PAPERS  # noqa: E402


def row(scheme, seconds, error, spread=0.0, family=OURS, status="ok"):
    return {"scheme": scheme, "seconds": seconds, "error_percent": error, "spread_percent": spread, "family": family,
            "status": status, "reference_uncertainty_percent": 0.01}


class Recommended(unittest.TestCase):
    def test_is_the_default_where_times_are_alike(self):
        rows = [row("other", 1.0, 1.5), row("default", 1.1, 1.9), row("other", 1.05, 0.1)]
        self.assertEqual(report.recommended(rows, 2.0)["scheme"], "default")
        self.assertEqual(report.recommended(rows, 1.0)["error_percent"], 0.1)

    def test_is_the_cheapest_where_they_are_not(self):
        rows = [row("other", 1.0, 1.5), row("default", 1.3, 0.1)]
        self.assertEqual(report.recommended(rows, 2.0)["scheme"], "other")

    def test_counts_half_of_the_spread_and_nothing_that_failed_or_is_not_ours(self):
        rows = [row("default", 1.0, 1.5, spread=2.0), row("default", 1.0, 0.1, status="blown up"),
                row("default", 1.0, 0.1, family=PAPERS)]
        self.assertIsNone(report.recommended(rows, 2.0))
        self.assertIsNotNone(report.recommended(rows, 2.5))


class Advantage(unittest.TestCase):
    def test_is_told_in_time_and_in_error(self):
        rows = [row("default", 1.0, 1.0), row("papers", 4.0, 2.0, family=PAPERS), row("papers", 0.5, 8.0, family=PAPERS)]
        cost, error = report.advantage(rows, PAPERS)
        self.assertEqual((cost, error), ([0.5, 4.0], [0.0, 2.0]))


class Needs(unittest.TestCase):
    def test_only_what_is_off_is_switched_on(self):
        self.assertEqual(report_needs.everything_on("taylor_green"),
                         {"numerics": {"smagorinsky": 1e-3}, "fluid": {"body_force": [1e-12, 0.0]}})
        self.assertEqual(report_needs.everything_on("suspension_migration"),
                         {"coupling": {"lubrication_range": 1e-9, "virtual_mass": 1e-9}})
        self.assertEqual(len(report_needs.everything_on("ten_cate_sphere")["fluid"]["body_force"]), 3)

    def test_solid_parts_are_of_the_last_run_and_without_the_wait(self):
        table = "Loop time of {0} on 1 procs\n" + "".join(
            f"{key} time (%) = {{{i}}} (1.0)\n" for i, key in enumerate(("Pair", "Neigh", "Comm", "Outpt", "Other"), 1))
        log = table.format(9, 9, 9, 9, 9, 9) + "fix lbm/couple: 4 intervals, 3.5 s of waiting for the fluid, " \
            "0.5 s of it before the first step\n" + table.format(6, 1, 0.5, 0.25, 0.25, 4)
        self.assertEqual(report_needs.solid_parts(log, 4), {"contacts": 250000.0, "neighbours": 125000.0, "ranks": 62500.0,
                                                            "output": 62500.0, "other": 250000.0, "waiting": 750000.0})


if __name__ == "__main__":
    unittest.main()
