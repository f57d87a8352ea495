# SPDX-License-Identifier: GPL-2.0-or-later
"""Every message of cases/TROUBLESHOOTING.md stands in a test that produces it."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]


def messages():
    """First column of the tables, the parts between backquotes."""
    for line in (ROOT / "cases/TROUBLESHOOTING.md").read_text().splitlines():
        if line.startswith("| `"):
            yield from re.findall(r"`([^`]+)`", line.split("|")[1])


class Troubleshooting(unittest.TestCase):
    def test_every_message_is_produced_by_a_test(self):
        sources = [p for p in (ROOT / "tests").rglob("*") if p.suffix in (".cpp", ".h", ".py") and p != pathlib.Path(__file__)]
        # a text that goes on in the next line of a source is one text
        text = re.sub(r'"\s*\n\s*"', "", "\n".join(p.read_text() for p in sources))
        found = list(messages())
        self.assertGreater(len(found), 20)
        self.assertEqual([m for m in found if m not in text], [])


if __name__ == "__main__":
    unittest.main()
