"""Scenes anywhere: names, paths, overlays that cannot be chosen, and folders made from templates. No program is started."""

import contextlib
import io
import itertools
import os
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm import new_scene, options  # noqa: E402
from bplbm.project import CASES  # noqa: E402
from bplbm.scene_words import drive_text  # noqa: E402
from bplbm.scenes import Unknown, find, scenes  # noqa: E402

SIX = list(itertools.product(new_scene.KINDS, (2, 3)))


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)

    def scene(self, name="sand", *overlays):
        (self.folder / name).mkdir(parents=True)
        for file in ("scene.toml", *overlays):
            (self.folder / name / file).write_text("title = 'x'\n")
        return self.folder / name

    def refusal(self, *words):
        text = io.StringIO()
        with contextlib.redirect_stderr(text), self.assertRaises(SystemExit) as end:
            options.arguments(words)
        self.assertEqual(end.exception.code, 2)
        self.assertEqual(text.getvalue().count("\n"), 1)
        return text.getvalue()


class Find(InFolder):
    def test_a_folder_its_file_a_slash_or_a_name(self):
        folder = self.scene()
        for text in ("sand", "sand/", "./sand", "sand/scene.toml", str(folder), f"{folder}/scene.toml"):
            self.assertEqual(find(text).folder, folder, text)
        for text in ("settling_disc", "settling_disc/", str(CASES / "settling_disc") + "/"):
            self.assertEqual(find(text).folder, CASES / "settling_disc")
            self.assertTrue(find(text).shipped)

    def test_a_name_of_cases_is_that_scene_wherever_one_stands(self):
        self.scene("settling_disc")
        self.assertEqual(find("settling_disc").folder, CASES / "settling_disc")
        self.assertEqual(find("./settling_disc").folder, self.folder / "settling_disc")

    def test_what_is_no_scene_is_said(self):
        (self.folder / "empty").mkdir()
        self.scene("sand", "fine.toml")
        for text, words in (("nothing", "or give the path"), ("empty", "no scene.toml"), ("a/b", "no such folder"),
                            ("sand/fine.toml", "is no scene.toml")):
            with self.assertRaises(Unknown) as caught:
                find(text)
            self.assertIn(words, str(caught.exception))

    def test_output_goes_to_the_current_folder(self):
        self.scene("far/sand")
        self.assertEqual(options.out_folder(options.arguments(["far/sand/"])), self.folder / "out" / "sand")
        self.assertEqual(options.out_folder(options.arguments(["settling_disc"])), ROOT / "out" / "settling_disc")


class Overlays(InFolder):
    def test_a_key_that_is_an_option_is_named(self):
        for key in ("threads", "out", "until"):
            self.scene(key, f"{key}-2.toml")
            text = self.refusal(key)
            self.assertIn(f"{key}-2.toml: --{key} is an option of tools/run", text)
            self.assertIn(f"my_{key}-2.toml", text)

    def test_a_key_that_begins_as_an_option_is_the_scenes(self):
        self.scene("sand", "fluid-water.toml", "fluid-oil.toml")
        self.assertEqual(options.arguments(["sand", "--fluid", "oil"]).own, [("fluid", "oil")])

    def test_no_shipped_scene_has_one(self):
        for name in scenes():
            options.arguments([name])

    def test_any_file_can_be_laid_over_last(self):
        self.scene("sand", "variant-a.toml")
        (self.folder / "mine.toml").write_text("")
        args = options.arguments(["sand", "--variant", "a", "--overlay", "mine.toml"])
        self.assertEqual([pathlib.Path(f).name for f in options.scene_files(args)], ["scene.toml", "variant-a.toml", "mine.toml"])
        self.assertEqual(options.label(args), "a_mine")
        self.assertIn("no such file", self.refusal("sand", "--overlay", "nothing.toml"))


class Words(unittest.TestCase):
    def test_each_shipped_scene_says_what_its_fluid_is(self):
        for name in scenes():
            file = CASES / name / "scene.toml"
            if file.exists() and "fluid" in (scene := tomllib.loads(file.read_text())):
                self.assertRegex(drive_text(scene), r"ρ = .* kg/m³, (ν = .* m²/s|.*K = )", name)

    def test_a_law_is_named_with_its_numbers(self):
        scene = {"box": {"size": [1, 1]}, "fluid": {"density": 1, "flow_rate": 2, "viscosity": {
            "model": "herschel_bulkley", "consistency": 3, "index": 0.5, "yield_stress": 4}}}
        self.assertEqual(drive_text(scene), "ρ = 1 kg/m³, herschel bulkley, K = 3 Pa sⁿ, n = 0.5, σ_y = 4 Pa\nflow 2 m³/s →")


class New(InFolder):
    def test_each_template_is_a_scene(self):
        for kind, dimensions in SIX:
            with self.subTest(kind=kind, dimensions=dimensions):
                folder = new_scene.make(pathlib.Path(f"{kind}{dimensions}"), kind, dimensions)
                tables = find(folder.name).tables()
                self.assertEqual(tables["title"], folder.name)
                self.assertEqual(len(tables["box"]["size"]), dimensions)
                self.assertEqual(len(tables["fluid"]["gravity"]), dimensions)
                for path in folder.rglob("*"):
                    if path.is_file():
                        text = path.read_text()
                        self.assertNotRegex(text, r"(?m)^@|NAME\b(?!\.)|WHAT", path)
                        self.assertNotIn("/../common", text, path)
                self.assertIn("run", tomllib.loads((folder / "variant-short.toml").read_text()))

    def test_grains_of_a_bed_touch_nothing(self):
        for kind, dimensions in SIX:
            if not new_scene.KINDS[kind].bed:
                continue
            tables = tomllib.loads(new_scene.rendered((new_scene.TEMPLATES / kind / "scene.toml").read_text(), "x", dimensions))
            size = tables["box"]["size"]
            grains = new_scene.bed(size, tables["particles"]["diameter"], new_scene.KINDS[kind].bed[dimensions],
                                   new_scene.random.Random(1))
            self.assertGreater(len(grains), 80)
            for i, (a, d) in enumerate(grains):
                self.assertTrue(all(0.5 * d <= x <= length - 0.5 * d for x, length in zip(a, size, strict=True)), (a, d))
                for b, e in grains[:i]:
                    self.assertGreater(sum((x - y)**2 for x, y in zip(a, b, strict=True))**0.5, 0.5 * (d + e))

    def test_nothing_is_overwritten_and_no_name_is_taken_twice(self):
        (self.folder / "full").mkdir()
        (self.folder / "full" / "thesis.txt").write_text("x")
        for name, words in (("full", "exists"), ("settling_disc", "is a scene of cases/"), ("a b", "letters, digits")):
            with self.assertRaises(new_scene.Refused) as caught:
                new_scene.make(pathlib.Path(name), "free", 2)
            self.assertIn(words, str(caught.exception))
        self.assertEqual([p.name for p in (self.folder / "full").iterdir()], ["thesis.txt"])


class Completion(InFolder):
    def completed(self, word):
        line = (f"source {ROOT}/tools/completion.bash; COMP_WORDS=({ROOT}/tools/run {word}); COMP_CWORD=1; "
                f"_bplbm_scene {ROOT}/tools/run; echo ${{COMPREPLY[*]}}")
        return subprocess.run(["bash", "-c", line], capture_output=True, text=True, timeout=30, check=True).stdout.split()

    def test_scenes_folders_and_options(self):
        self.scene("settled")
        self.assertEqual(self.completed("settl"), ["settling_disc", "settled"])
        self.assertEqual(self.completed("--no-b"), ["--no-bind", "--no-build"])


if __name__ == "__main__":
    unittest.main()
