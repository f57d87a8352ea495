# SPDX-License-Identifier: GPL-2.0-or-later
"""The documents are true: links, citations, files, commands, the table of keys; and the checks can fail."""

import json
import pathlib
import re
import subprocess
import sys
import unittest
import unittest.mock
from urllib.parse import unquote

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import manual  # noqa: E402
from bplbm.checks import commands, documents, includes, keys  # noqa: E402

README = ROOT / "README.md"


class Documents(unittest.TestCase):
    def test_they_hold_together(self):
        self.assertGreater(len(documents.tracked("*.md")), 80)
        self.assertEqual(list(documents.complaints()), [])

    def test_what_is_wrong_is_found(self):
        for text, part in (("[a](nowhere.md)", "leads nowhere"), ("[a](README.md#nothing-there)", "no heading #nothing-there"),
                           ("[a](#nothing-there)", "this page has no heading")):
            with self.subTest(text):
                self.assertIn(part, " ".join(documents.broken_links(README, text)))
        self.assertEqual(list(documents.broken_links(README, "[a](CONTRIBUTING.md#recipes)\n```\n[b](c)\n```")), [])
        self.assertIn("121 characters", " ".join(documents.wide_lines(README, "x" * 121)))
        self.assertEqual(list(documents.wide_lines(README, "| " + "x" * 121 + "\n```\n" + "x" * 121)), [])
        self.assertIn("there is no lbm_solver/nothing.h", " ".join(documents.lost_files(README, "`lbm_solver/nothing.h`")))
        self.assertEqual(list(documents.lost_files(README, "`lbm_solver/solver/fluid` `lbm_solver/solver/kernel_NAME.cpp`")), [])

    def test_wide_paragraphs_are_filled_anew(self):
        word = "w" * 50
        text = f"# H\n\n- {word} {word} `a b`\n  {word}\n- short\n\n```\n{word * 3}\n```\n| {word * 3} |\n"
        self.assertEqual(documents.wrapped(text), text)
        wide = text.replace("`a b`", "`a b` then some more")
        self.assertEqual(documents.wrapped(wide), wide.replace(" then some more\n ", " then some\n  more"))

    def test_a_long_readme_is_found(self):
        with unittest.mock.patch.object(documents, "LONGEST", 5):
            self.assertIn("lbm_solver/base/README.md has more than 5 lines", list(documents.long_readmes()))

    def test_a_citation_that_is_in_no_bibliography_is_found(self):
        cited = " ".join(documents.unknown_citations(set()))
        for tag in ("Ladd1994", "NobleTorczynski1998", "PotyondyCundall2004", "DeRosis2016"):
            self.assertIn(f"[{tag}]", cited)

    def test_headings_become_anchors(self):
        self.assertEqual(documents.anchor(" What is `left`, and the radius"), "what-is-left-and-the-radius")


class Includes(unittest.TestCase):
    def test_a_unit_whose_sources_know_each_other_is_found(self):
        lists = "set(numbers_1\n  solver/fluid.cpp solver/wale.cpp lattice/lattice.cpp)\nset(readers\n  io/log.cpp)"
        self.assertEqual(len(list(includes.mixed_units(lists))), 2)  # each knows the other


class Commands(unittest.TestCase):
    def test_all_are_known(self):
        self.assertEqual(list(commands.complaints()), [])

    def test_what_is_wrong_is_found(self):
        def found(command):
            return [p for words in commands.parts(command)
                    for p in (commands.of_a_tool if words[0].startswith("tools/") else commands.of_a_program)(words, "")]
        self.assertEqual(found("tools/nothing"), ["there is no such tool"])
        self.assertEqual(found("tools/sweep NAME --nonsense 3"), ["knows no --nonsense"])
        self.assertIn("nonsense", " ".join(found("tools/run settling_disc --nonsense")))
        self.assertIn("no variant 'nothing'", " ".join(found("tools/run settling_disc --variant nothing")))
        self.assertEqual(found("mpirun -np 1 lbm --nonsense : -np 1 liggghts -in x"), ["knows no --nonsense"])
        self.assertEqual(found("A=1 tools/run settling_disc --threads 2  # yes"), [])

    def test_code_is_told_from_drawings(self):
        text = "```\ntools/run a \\\n  --set fine\nlbm        liggghts\n```\n`trace info x`, `scene.toml`"
        self.assertEqual([c for _, c in commands.commands(text)], ["tools/run a --set fine", "trace info x"])


class Keys(unittest.TestCase):
    def test_the_table_is_what_lbm_prints(self):
        self.assertEqual(keys.documented_table()[1], keys.table_of_keys(), "python3 tools/check_keys.py --write mends it")


class Manual(unittest.TestCase):
    def test_every_document_has_one_place(self):
        listed = documents.tracked("*.md")
        placed = [file for _, pages in manual.order(listed) for _, file in pages]
        self.assertEqual(sorted(placed), sorted(documents.name(path) for path in listed))

    def test_a_list_gets_a_blank_line_and_code_does_not(self):
        self.assertEqual(manual.adapted("a:\n- b\n- c\n```\nd\n- e\n```"), "a:\n\n- b\n- c\n```\nd\n- e\n```\n")

    def test_it_is_made_and_its_links_lead_somewhere(self):
        done = subprocess.run([ROOT / "tools/manual"], capture_output=True, text=True, timeout=100, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        pages = sorted(manual.SITE.rglob("*.html"))
        self.assertGreater(len(pages), 80)
        lost = []
        for page in pages:
            for target in re.findall(r'<a [^>]*href="([^"#:]+)(?:#[^"]*)?"', page.read_text()):
                if page.name != "404.html" and not (page.parent / unquote(target)).exists():
                    lost.append(f"{page.relative_to(manual.SITE)}: {target}")
        self.assertEqual(lost, [])
        found = json.loads((manual.SITE / "search" / "search_index.json").read_text())["docs"]
        self.assertIn("lbm_solver/docs/loads.html#lubrication", [entry["location"] for entry in found])


if __name__ == "__main__":
    unittest.main()
