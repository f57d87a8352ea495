"""The references against the code: each scene key, script variable, command and word that the code knows stands in its
document, and nothing else does."""

import pathlib
import re
import subprocess
import sys

from bplbm.project import BIN, ROOT

CALL = re.compile(r'\b(?:number|number_or|numbers_or|optional_number|integer|optional_integer|flag_or|choice_or|text_or|text|'
                  r'vector|vector_or_zero|vectors_or_none|range|table|optional_table|tables)\(\s*"(\w+)"'
                  r'|\b\w+(?:<\w+>)?\(t, "(\w+)"')
# of a fix, compared or in a table; of a pair style
WORD = re.compile(r'\b(?:word|key) == "(\w+)"|^ +\{"(\w+)",\s|\bregister\w+\("(\w+)"', re.M)
COMMANDS, SCENE = "liggghts_coupling/docs/commands.md", "lbm_solver/docs/scene.md"


def read(path):
    return (ROOT / path).read_text()


def found(pattern, text):
    """All groups of all matches that hold something."""
    return {group for match in re.finditer(pattern, text) for group in match.groups() if group}


def section(path, heading):
    """Of a README, until the next heading."""
    text = read(path)
    text = text[text.index(heading):]
    return text[:(text + "\n## ").index("\n## ", 5)]


def first_column(text):
    """Words in the first column of a table, each without its table."""
    rows = re.findall(r"^\| ([^|]+) \|", text, re.M)
    return {word for row in rows for quoted in re.findall(r"`([^`]+)`", row) for word in re.findall(r"\w+", quoted)}


def scene_keys():
    readers = sorted((ROOT / "lbm_solver/io").glob("*_reader.cpp"))
    return found(CALL, "".join(reader.read_text() for reader in readers)), \
        first_column(section(SCENE, "## Keys of a scene")) - {"NAME"}


def script_variables():
    """The particle's number and the axis are filled in."""
    offered = read("lbm_solver/coupling/handshake.cpp")
    names = found(r'(?:number|whole)\("(\w+)"|\{"(\w\w+)", ', offered)
    names |= {name.format(axis) for name in found(r'fmt::format\("([\w{}]+)", axis', offered) for axis in "xyz"}
    names |= {name.format(1) for name in found(r'fmt::format\("([\w{}]+)", i \+ 1', offered)}
    names |= found(r'"-var", "(\w+)"|\{"(\w+_folder)"', read("liggghts_coupling/host/main.cpp"))
    return names, first_column(section(COMMANDS, "## What a scene offers"))


def commands():
    """Styles that LIGGGHTS is taught."""
    code = found(r'\["([\w/]+)"\]', read("liggghts_coupling/host/register_styles.cpp")) \
        | found(r'\bname = "(bond/\w+)"', read("liggghts_coupling/bond/pair_bond.cpp"))
    return code, found(r"\b((?:lbm|bond)/\w+)(?= [\[.…a-z])", synopses())


def words_of_commands():
    """Their words, each followed by a value."""
    files = [*(ROOT / "liggghts_coupling").glob("*/fix_*.cpp"),
             ROOT / "liggghts_coupling/bond/pair_bond.cpp"]
    code = {word for file in files for word in found(WORD, file.read_text())}
    return code, found(r"(?<![\w/])([a-z]+) (?=[A-Z\d]|on\b)", synopses()) - {"fix"}


def synopses():
    """Lines and table cells that show how a command is written."""
    return "\n".join(re.findall(r"(?:^|`)((?:fix ID|pair_style gran model) [^`\n]*)", read(COMMANDS), re.M))


def properties():
    return found(r'k\w+ = "(\w+)"', read("liggghts_coupling/bond/pair_bond.cpp")), \
        found(r"property/global (\w+)", read(COMMANDS))


def tabled_words():
    """Words of the synopsis of each command against those of the table below it, each as COMMAND WORD."""
    shown, tabled = set(), set()
    for part in read(COMMANDS).split("\n## ")[1:]:
        lines = re.findall(r"^((?:fix ID|pair_style gran model) .*)$", part, re.M)
        if not lines:
            continue
        name = part.splitlines()[0]
        shown |= {f"{name}: {word}" for word in found(r"(?<![\w/])([a-z]+) (?=[A-Z\d]|on\b)", "\n".join(lines)) - {"fix"}}
        tabled |= {f"{name}: {word}" for word in found(r"(?m)^\| `([a-z]+) ", part)}
    return shown, tabled


def table_of_keys():
    """The table of all keys as lbm prints it."""
    return subprocess.run([str(BIN / "lbm"), "--keys"], capture_output=True, text=True, check=True).stdout


def documented_table():
    """The same as the document has it, with the text before and after."""
    text = read(SCENE)
    start = text.index("| key |", text.index("## Keys of a scene"))
    end = text.index("\n\n", start) + 1
    return text[:start], text[start:end], text[end:]


def write_table():
    before, _, after = documented_table()
    (ROOT / SCENE).write_text(before + table_of_keys() + after)


def main():
    if sys.argv[1:] == ["--write"]:  # the table of keys, from the program that is built
        write_table()
    wrong = 0
    for what, where, (code, text) in (("key", SCENE, scene_keys()), ("variable", COMMANDS, script_variables()),
                                      ("command", COMMANDS, commands()), ("word", COMMANDS, words_of_commands()),
                                      ("word of a table", f"the tables of {COMMANDS}", tabled_words()),
                                      ("property", COMMANDS, properties())):
        for name in sorted(code - text):
            print(f"check | error | the code knows the {what} '{name}', {where} does not")
        for name in sorted(text - code):
            print(f"check | error | {where} has the {what} '{name}', the code does not")
        wrong += len(code ^ text)
        print(f"check | {len(code)} of the kind {what}")
    return 1 if wrong else 0
