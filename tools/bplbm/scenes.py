"""Scenes: folders with a scene.toml, overlays beside it, and perhaps a script of the solid and a plot.py."""

import pathlib
import tomllib
from dataclasses import dataclass

from bplbm.project import CASES, INSTALLED, tool


class Unknown(Exception):
    """There is no such scene; says what there is."""


@dataclass(frozen=True)
class Scene:
    """One scene, of cases/ or anywhere."""

    folder: pathlib.Path  # absolute

    @property
    def name(self):
        return self.folder.name

    @property
    def shipped(self):
        return self.folder.parent == CASES

    @property
    def file(self):
        return self.folder / "scene.toml"

    @property
    def is_coupled(self):
        return self.script("liggghts").exists()

    @property
    def is_solid_alone(self):
        """Whether it has no fluid. A file that cannot be read is lbm's to complain of."""
        try:
            return "fluid" not in self.tables()
        except (OSError, ValueError):
            return False

    @property
    def dimension(self):
        """2 or 3, or 0 where the file does not say: that is lbm's to complain of."""
        try:
            return len(self.tables()["box"]["size"])
        except (OSError, ValueError, KeyError, TypeError):
            return 0

    def script(self, engine):
        return self.folder / f"in.{engine}"

    def tables(self):
        """scene.toml as it is written, without overlays. Throws OSError or ValueError."""
        return tomllib.loads(self.file.read_text())

    def variants(self):
        return sorted(p.stem.removeprefix("variant-") for p in self.folder.glob("variant-*.toml"))

    def sets(self):
        return ["resolved"] + [n for n in ("literal", "fine") if (self.folder / f"{n}.toml").exists()]

    def options(self):
        """Choices of its own, from its overlays KEY-VALUE.toml: dict KEY -> values."""
        found = {}
        for path in sorted(self.folder.glob("*-*.toml")):
            key, value = path.stem.split("-", 1)
            if key != "variant":
                found.setdefault(key, []).append(value)
        return found

    def heading(self):
        """First line of its README, else the title in its scene.toml."""
        readme = self.folder / "README.md"
        lines = readme.read_text(errors="replace").splitlines() if readme.is_file() else []
        if lines:
            return lines[0].lstrip("# ")
        try:
            return f"{self.tables().get('title', self.name)} (no README.md)"
        except (OSError, ValueError):  # lbm says what is wrong with it
            return "(no README.md)"


def scenes():
    """Names of the scenes of cases/."""
    return sorted(p.parent.name for p in CASES.glob("*/scene.toml"))


def find(text):
    """The scene of a name in cases/, or of the path of a folder or of its scene.toml. Throws Unknown.

    In a checkout a name of cases/ is that scene wherever one stands; of an installed tree, whose scenes are copied to be
    changed, a folder here comes first.
    """
    path = pathlib.Path(text)
    if text in scenes() and not (INSTALLED and (path / "scene.toml").is_file()):
        return Scene(CASES / text)
    if path.is_file():
        if path.name != "scene.toml":
            raise Unknown(f"{text}: is no scene.toml; give the folder of a scene, or its scene.toml "
                          "(an overlay beside it is chosen by --set, --variant or --KEY)")
        return Scene(path.resolve().parent)
    if (path / "scene.toml").is_file():
        return Scene(path.resolve())
    if path.is_dir():
        raise Unknown(f"{text}: this folder holds no scene.toml; {tool('new')} makes a new scene")
    if text.rstrip("/") in scenes():  # a shell has completed it in cases/
        return Scene(CASES / text.rstrip("/"))
    if "/" in text:
        raise Unknown(f"no scene '{text}': there is no such folder; {tool('new')} makes a new scene")
    if (pathlib.Path(CASES.name) / path / "scene.toml").is_file():  # of an installed tree, whose own scenes lie elsewhere
        raise Unknown(f"no shipped scene '{text}'; the one here is named by its path, {CASES.name}/{text}")
    raise Unknown(f"no scene '{text}'; there are: {', '.join(scenes())}; or give the path of a scene's folder")
