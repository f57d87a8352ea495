"""Where this checkout lies, and its folders."""

import os
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
TOOLS = ROOT / "tools"
CASES = ROOT / "cases"
BIN = ROOT / "build" / os.environ.get("BPLBM_PRESET", "release") / "bin"
