"""Which programs tools/run builds for a scene; none is started."""

import pathlib
import shutil
import sys
import tempfile
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import programs  # noqa: E402
from bplbm.options import arguments  # noqa: E402


class Programs(unittest.TestCase):
    def test_only_what_a_run_needs_is_built(self):
        """tools/run builds what --look prints."""
        for words, there, targets in (
                (["settling_disc"], False, ["lbm_2d", "liggghts"]), (["settling_disc"], True, ["lbm", "liggghts"]),
                (["ten_cate_sphere"], False, ["lbm", "liggghts"]), (["cylinder_flow"], False, ["lbm_2d"]),
                (["cylinder_flow", "--overlay", str(ROOT / "cases" / "sphere_array" / "variant-single.toml")], False, ["lbm"]),
                (["settling_disc", "--engine", "lammps"], True, ["lbm", "lammps_engine"]),
                (["settling_disc", "--engine", "c"], True, ["lbm", "c_engine"]),
                (["settling_disc", "--engine", "python"], True, ["lbm"]),
                (["settling_disc", "--engine-command", "true"], True, ["lbm"])):
            with tempfile.TemporaryDirectory() as folder:
                lbm = pathlib.Path(folder) / "lbm"
                if there:
                    lbm.touch()
                with mock.patch.object(programs, "BIN", lbm.parent):
                    self.assertEqual(programs.needed(arguments(words)), targets, words)

    def test_a_comparison_run_in_single_precision_asks_for_the_whole_program(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "scene"
            shutil.copytree(ROOT / "cases" / "cylinder_flow", scene)
            with mock.patch.object(programs, "BIN", pathlib.Path(folder)):
                self.assertEqual(programs.needed(arguments([str(scene)])), ["lbm_2d"])
                (scene / "variant-floats.toml").write_text('[numerics]\nprecision = "single"\n')
                self.assertEqual(programs.needed(arguments([str(scene)])), ["lbm"])


if __name__ == "__main__":
    unittest.main()
