"""Every tool answers --help, those with something to choose --list, and a mistake with code 2; nothing is built for it."""

import pathlib
import shutil
import subprocess
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "tools"
ALL = sorted(p.name for p in TOOLS.iterdir() if p.is_file() and not p.suffix)
LISTS = {"build": "release", "compare": "", "draw_setup": "settling_disc", "fuzz": "codec", "install": "cmake",
         "new": "bonded", "sweep": "settling_disc",
         "report": "stability", "run": "settling_disc", "test": "coupled"}

# Without these a tool says first that they are missing.
NEEDED = {"make_clump": ("none.stl", "3"), "make_packing": "--out x --box 0 1 0 1 --diameter 0.1 0.2".split()}


def answer(tool, *words):
    return subprocess.run([TOOLS / tool, *words], capture_output=True, text=True, timeout=30)


class Answers(unittest.TestCase):
    def test_help(self):
        self.assertGreater(len(ALL), 8)
        for tool in ALL:
            with self.subTest(tool):
                said = answer(tool, "--help")
                self.assertEqual(said.returncode, 0, said.stderr)
                self.assertIn(tool, said.stdout)
                self.assertNotIn("build |", said.stdout)

    def test_list(self):
        for tool, word in LISTS.items():
            with self.subTest(tool):
                said = answer(tool, "--list")
                self.assertEqual(said.returncode, 0, said.stderr)
                self.assertIn(word, said.stdout)

    def test_mistake(self):
        for tool in ALL:
            with self.subTest(tool):
                said = answer(tool, *NEEDED.get(tool, ()), "--nonsense")
                self.assertEqual(said.returncode, 2, said.stdout)
                self.assertIn("--nonsense", said.stderr)

    def test_a_checkout_that_was_moved_says_what_to_do(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder).resolve()
            (root / "tools").mkdir()
            (root / "build" / "release").mkdir(parents=True)
            shutil.copy(TOOLS / "build", root / "tools")
            shutil.copy(TOOLS.parent / "CMakePresets.json", root)
            install = root / "tools" / "install"
            install.write_text("#!/bin/sh\n")
            install.chmod(0o755)
            (root / "build" / "release" / "CMakeCache.txt").write_text("CMAKE_HOME_DIRECTORY:INTERNAL=/where/it/was\n")
            said = subprocess.run([root / "tools" / "build"], capture_output=True, text=True, timeout=30, check=False)
        self.assertEqual(said.returncode, 2)
        self.assertIn(f"was made in /where/it/was, and this checkout lies in {root}", said.stderr)
        self.assertIn("remove build/release, and run this again", said.stderr)


if __name__ == "__main__":
    unittest.main()
