"""The hard cases of bonds, of viscosity laws and of single steps, run with the default: what is asked of it is met."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools"))

from bplbm.report import stability  # noqa: E402
from bplbm.report.hard import OWN, STEPS, gels, hard_cases  # noqa: E402
from bplbm.report.stability import AUTO, RULE  # noqa: E402


class TheDefault(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        stability.OUT = pathlib.Path(folder.name)

    def test_keeps_momentum_energy_and_time_of_bonds_that_break(self):
        cases = [case for case in hard_cases(True) if pathlib.Path(case.scene).name.startswith("bond")]
        self.assertEqual(len(cases), 2)
        for case in cases:
            became = stability.outcome(case, {"collision": AUTO, "solid_term": AUTO}, True)
            self.assertTrue(became["met"], f"{case.name}: {became}")

    def test_bounds_or_refuses_what_is_thin_thick_or_held(self):
        for case in gels():
            self.assertTrue((OWN / pathlib.Path(case.scene).name).is_dir())
            became = stability.outcome(case, {"collision": AUTO, "solid_term": AUTO}, True)
            self.assertEqual(became["verdict"], "refused" if case.asked == "refused" else "bounded", f"{case.name}: {became}")
            self.assertIsNot(became["met"], False, f"{case.name}: {became}")
            print(f"{case.name}: {became['verdict']} {became['value']}")

    def test_does_in_single_steps_what_is_asked(self):
        values = stability.step_values({"collision": AUTO, **stability.SOLIDS[RULE]}, True)
        for case in STEPS:
            became = stability.outcome_of_steps(case, values)
            self.assertTrue(became["met"], f"{case.name}: {became}")


if __name__ == "__main__":
    unittest.main()
