"""The table of scene keys in lbm_solver/README.md against the reader: every key that the code reads stands there once."""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CALL = re.compile(r'\b(?:number|number_or|numbers_or|optional_number|integer|optional_integer|flag_or|choice_or|text_or|text|'
                  r'vector|vector_or_zero|vectors_or_none|range|table|optional_table|tables)\(\s*"(\w+)"'
                  r'|\b\w+\(t, "(\w+)"')


def code_keys():
    """Names of keys and tables that the reader asks for."""
    text = (ROOT / "lbm_solver/io/scene_reader.cpp").read_text()
    return {key for pair in CALL.findall(text) for key in pair if key}


def described():
    """Names in the first column of the table, each without its table."""
    text = (ROOT / "lbm_solver/README.md").read_text()
    text = text[text.index("## Keys of a scene"):]
    rows = re.findall(r"^\| ([^|]+) \|", text[:text.index("\n## ", 5)], re.M)
    return {word for row in rows for quoted in re.findall(r"`([^`]+)`", row) for word in re.findall(r"\w+", quoted)}


def main():
    code, text = code_keys(), described()
    missing, stale = sorted(code - text), sorted(text - code - {"NAME"})
    for key in missing:
        print(f"check | error | the reader knows '{key}', the table in lbm_solver/README.md does not")
    for key in stale:
        print(f"check | error | the table in lbm_solver/README.md has '{key}', the reader does not ask for it")
    print(f"check | {len(code)} keys and tables of a scene")
    return 1 if missing or stale else 0


if __name__ == "__main__":
    sys.exit(main())
