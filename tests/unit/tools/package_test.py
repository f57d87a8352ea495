"""The package tools/bplbm: what it offers can be imported, cheaply, and no module reaches for sys.path."""

import pathlib
import subprocess
import sys
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "tools"


def python(code):
    return subprocess.run([sys.executable, "-c", code], cwd=TOOLS, capture_output=True, text=True, timeout=30, check=False)


class Package(unittest.TestCase):
    def test_the_import_takes_no_library(self):
        said = python("import sys, bplbm, bplbm.run\n"
                      "print(*{'numpy', 'h5py', 'matplotlib', 'pandas'} & set(sys.modules))")
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertEqual(said.stdout.strip(), "")

    def test_each_name_is_there_and_no_other(self):
        said = python("import bplbm\nfor name in bplbm.__all__: print(getattr(bplbm, name).__class__)\nbplbm.nonsense")
        self.assertIn("bplbm has no 'nonsense'", said.stderr)
        self.assertGreater(len(said.stdout.splitlines()), 10)

    def test_a_plot_script_of_before_finds_its_names(self):
        said = python("from pictures import Run, animate, draw_speed, quantity, read_table, result, studies, write_table")
        self.assertEqual(said.returncode, 0, said.stderr)

    def test_no_module_reaches_for_the_path(self):
        for path in (TOOLS / "bplbm").rglob("*.py"):
            self.assertNotIn("sys.path", path.read_text(), path)


if __name__ == "__main__":
    unittest.main()
