"""The documents: every link leads somewhere, every citation is in the bibliography, every file that they name exists, no
line of prose is wider than 120 characters, every room opens with a README, every README is short, and a room's names the
room's files."""

import pathlib
import re
import subprocess
import sys

from bplbm.project import ROOT

WIDEST = 120  # characters of a line of prose; rows of tables, code and links alone may be longer
LONGEST, LONGEST_ROOT = 60, 80  # lines of a folder's README, and of the first one
BIBLIOGRAPHY = "lbm_solver/docs/bibliography.md"
ROOMS = ("lbm_solver", "liggghts_coupling", "protocol", "tools", "tests")  # each folder has a README
# Folders that hold data of the room above, and READMEs that are a text of their own.
DATA = re.compile(r"tests/(fuzz/corpus|unit/lbm_solver/pictures|hard/|support/stopped)|tools/bplbm/templates/|protocol/python/bplbm_solid")
LONG = {"protocol/python/README.md"}  # the page of a package
# Rooms whose README names each of their files, but for those whose name says enough.
NAMED = re.compile(r"(lbm_solver/\w+|liggghts_coupling/\w+|protocol/(wire|transport|program|solid)|"
                   r"tests/(coupled|fuzz|performance|physics|sanitized|support))/[^/]+$")
UNNAMED = {"README.md", "CMakeLists.txt", "LICENSE"}
WRITTEN_BY_TOOLS = re.compile(r"cases/report/")
TAG = re.compile(r"(?<![\w`])\[(?:after |see )?([A-Z]?[a-z]*[A-Z][A-Za-z]+(?:19|20)\d\d"
                 r"(?:, [A-Z][A-Za-z]+(?:19|20)\d\d)*)\](?!\()")


def tracked(*patterns):
    """Files of the repository; of a copy without git, all files."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", *patterns], cwd=ROOT,
                            capture_output=True, text=True, check=False)
    if listed.returncode == 0:
        return sorted(ROOT / line for line in listed.stdout.splitlines() if (ROOT / line).is_file())
    return sorted(p for pattern in patterns for p in ROOT.rglob(pattern) if "build" not in p.parts)


def name(path):
    return path.relative_to(ROOT).as_posix()


def prose(text):
    """Lines outside of code, with their numbers."""
    code = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            code = not code
        elif not code:
            yield number, line


def anchor(heading):
    """Of a heading, as GitHub and most other renderers make it."""
    heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.replace("`", ""))
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def anchors(path):
    return {anchor(line.lstrip("#")) for _, line in prose(path.read_text()) if line.startswith("#")}


def broken_links(path, text):
    for number, line in prose(text):
        for target in re.findall(r"\]\(([^)\s]+)\)", line):
            file, _, place = target.partition("#")
            if file.startswith(("http://", "https://")) or target == "TUTORIAL":  # filled in by tools/new
                continue
            there = (path.parent / file).resolve() if file else path
            if not there.exists():
                yield f"{name(path)}:{number}: the link {target} leads nowhere"
            elif place and place not in anchors(there):
                yield f"{name(path)}:{number}: {file or 'this page'} has no heading #{place}"


def wide_lines(path, text):
    if WRITTEN_BY_TOOLS.match(name(path)):
        return
    for number, line in prose(text):
        if len(line) > WIDEST and not line.lstrip().startswith("|"):
            yield f"{name(path)}:{number}: {len(line)} characters, more than {WIDEST}"


ITEM = re.compile(r"\s*(?:[-*] |\d+\. )?")


def filled(paragraph):
    """A paragraph or an item of a list, its words anew in lines of at most the width; code in backquotes stays whole."""
    mark = ITEM.match(paragraph[0])[0]
    words = re.findall(r"(?:[^\s`]*`[^`]*`[^\s`]*)+|\S+", " ".join([paragraph[0][len(mark):], *paragraph[1:]]))
    lines, line = [], mark + words[0]
    for word in words[1:]:
        if len(line) + 1 + len(word) > WIDEST:
            lines.append(line)
            line = " " * len(mark) + word
        else:
            line += " " + word
    return [*lines, line]


def wrapped(text):
    """A document whose paragraphs with too wide a line are filled anew."""
    lines, paragraph, code = [], [], False

    def end():
        lines.extend(filled(paragraph) if any(len(line) > WIDEST for line in paragraph) else paragraph)
        paragraph.clear()

    for line in text.split("\n"):
        fence = line.lstrip().startswith("```")
        code = code != fence
        if code or fence or not line.strip() or line.lstrip().startswith(("|", "#", "<", "![")):
            end()
            lines.append(line)
            continue
        if ITEM.match(line)[0].strip():
            end()
        paragraph.append(line)
    end()
    return "\n".join(lines)


def lost_files(path, text):
    """Files that a recipe or a table names by their path from the root."""
    for number, line in prose(text):
        for file in re.findall(r"`((?:lbm_solver|liggghts_coupling|protocol|tests|tools)/[\w/.\-]+)`", line):
            capitals = any(part.split(".")[0].split("_")[-1].isupper() for part in file.split("/"))  # NAME.h
            if not capitals and not (ROOT / file).exists() and not list(ROOT.glob(file + ".*")):
                yield f"{name(path)}:{number}: there is no {file}"


def unknown_citations(known):
    for path in tracked("*.md", "*.h", "*.cpp", "*.py"):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            for tags in TAG.findall(line):
                for tag in tags.split(", "):
                    if tag not in known:
                        yield f"{name(path)}:{number}: [{tag}] is not in {BIBLIOGRAPHY}"


def rooms_without_readme():
    folders = {path.parent for path in tracked() if name(path).split("/")[0] in ROOMS and not DATA.match(name(path))}
    for folder in sorted(folders):
        readme = folder / "README.md"
        if not readme.exists():
            yield f"{name(folder)} has no README.md"


def long_readmes():
    for path in tracked("*README.md"):
        longest = LONGEST_ROOT if path.parent == ROOT else LONGEST
        if name(path) not in LONG and not WRITTEN_BY_TOOLS.match(name(path)) \
                and len(path.read_text().splitlines()) > longest:
            yield f"{name(path)} has more than {longest} lines"


def unnamed_files():
    """Files of a room that its README does not name."""
    rooms = {path.parent for path in tracked("*.h", "*.cpp", "*.c", "*.py") if NAMED.match(name(path))}
    for room in sorted(rooms):
        text = (room / "README.md").read_text()
        for path in sorted(tracked(name(room) + "/*")):
            stem = path.name.split(".")[0]
            if path.parent == room and path.name not in UNNAMED and not re.search(rf"\b{re.escape(stem)}\b", text):
                yield f"{name(room)}/README.md does not say what {path.name} is"


def complaints():
    known = set(re.findall(r"^- \*\*(\w+)\*\*", (ROOT / BIBLIOGRAPHY).read_text(), re.M))
    for path in tracked("*.md"):
        text = path.read_text()
        yield from broken_links(path, text)
        yield from wide_lines(path, text)
        yield from lost_files(path, text)
    yield from unknown_citations(known)
    yield from rooms_without_readme()
    yield from long_readmes()
    yield from unnamed_files()


def main():
    if sys.argv[1:] == ["--wrap"]:
        for path in tracked("*.md"):
            text = path.read_text()
            if list(wide_lines(path, text)):
                path.write_text(wrapped(text))
    found = list(complaints())
    print("\n".join(found) or f"check | {len(tracked('*.md'))} documents hold together")
    return 1 if found else 0
