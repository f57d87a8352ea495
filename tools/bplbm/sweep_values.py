"""What a sweep varies: keys of a scene, lists of values, expressions between keys, and the overlays that follow."""

import ast
import copy
import itertools
import json
import math
import operator
import re
from dataclasses import dataclass

FUNCTIONS = {name: getattr(math, name) for name in ("sqrt", "exp", "log", "sin", "cos", "tan")} | {
    "min": min, "max": max, "abs": abs, "round": round}
OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
             ast.Pow: operator.pow, ast.USub: operator.neg, ast.UAdd: operator.pos}
MOST_RUNS = 10000


class Mistake(Exception):
    """What is wrong with a word of the command line, and what to write instead."""


@dataclass(frozen=True)
class Axis:
    """A key, or a name for expressions alone, and the values that it takes."""

    name: str
    values: tuple


def path_of(key):
    """Parts of a key: `boundary[0].pressure` -> ("boundary", 0, "pressure"). Throws Mistake."""
    if not re.fullmatch(r"\w+(\[\d+\])*(\.\w+(\[\d+\])*)*", key):
        raise Mistake(f"'{key}' is no key; write it as particles.density, or boundary[0].pressure for the first boundary")
    return tuple(int(part) if part.isdigit() else part for part in re.findall(r"\w+", key))


def split_values(text):
    """Parts between commas that are in no brackets."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "[(") - (letter in "])")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


def value_of(word):
    """A number, a truth value, a list, or a text."""
    try:
        return json.loads(word)
    except ValueError:
        return word


def axis(text):
    """KEY=VALUE,VALUE… or KEY=FIRST..LAST. Throws Mistake."""
    name, equals, words = text.partition("=")
    if not equals or not words:
        raise Mistake(f"--set {text}: write it as KEY=VALUE,VALUE or KEY=FIRST..LAST")
    path_of(name)
    values = []
    for word in split_values(words):
        if found := re.fullmatch(r"(-?\d+)\.\.(-?\d+)", word.strip()):
            first, last = map(int, found.groups())
            if abs(last - first) >= MOST_RUNS:
                raise Mistake(f"--set {text}: {word} has more than {MOST_RUNS} values")
            values += range(first, last + 1) if first <= last else range(first, last - 1, -1)
        elif ".." in word:
            raise Mistake(f"--set {text}: '{word}' runs between whole numbers only; list other values, as 0.1,0.2")
        elif not word.strip():
            raise Mistake(f"--set {text}: a value between two commas is missing")
        else:
            values.append(value_of(word.strip()))
    if len({repr(v) for v in values}) < len(values):
        raise Mistake(f"--set {text}: a value is there twice")
    return Axis(name, tuple(values))


def look_up(tables, path):
    """Value at a path. Throws KeyError."""
    for part in path:
        try:
            tables = tables[part]
        except (KeyError, IndexError, TypeError):
            raise KeyError(".".join(map(str, path))) from None
    return tables


def assign(tables, path, value, key):
    """Puts a value at a path. Throws Mistake where a list is too short."""
    *way, last = path
    for here, following in itertools.pairwise(path):
        if isinstance(here, str):
            tables = tables.setdefault(here, [] if isinstance(following, int) else {})
        else:
            tables = item(tables, here, key)
    if isinstance(last, int):
        item(tables, last, key)
    tables[last] = value


def item(tables, index, key):
    if not isinstance(tables, list) or index >= len(tables):
        raise Mistake(f"{key}: the scene has no entry number {index} (the first one is 0)")
    return tables[index]


class Names:
    """What an expression may say: values of the sweep first, then of the scene."""

    def __init__(self, tables, chosen):
        self.tables, self.chosen = tables, chosen

    def value(self, key):
        if key in self.chosen:
            return self.chosen[key]
        if key == "pi":
            return math.pi
        try:
            return look_up(self.tables, path_of(key))
        except KeyError:
            variables = self.tables.get("particles", {}).get("variables", {})
            if key in variables:
                return variables[key]
            raise Mistake(f"nothing is called '{key}': it is neither in the sweep nor in the scene") from None


def evaluate(text, names):
    """Value of an expression of numbers, keys, lists and a few functions. Throws Mistake."""
    def walk(node):
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
            return node.value
        if isinstance(node, ast.List):
            return [walk(part) for part in node.elts]
        if isinstance(node, (ast.Name, ast.Attribute)):
            return names.value(ast.unparse(node))
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
            return names.value(ast.unparse(node))
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](walk(node.left), walk(node.right))
        if isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](walk(node.operand))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS and not node.keywords:
            return FUNCTIONS[node.func.id](*map(walk, node.args))
        raise Mistake(f"'{ast.unparse(node)}' cannot be used; there are numbers, keys, [lists], + - * / **, pi, "
                      + ", ".join(FUNCTIONS))

    try:
        value = walk(ast.parse(text.replace("^", "**"), mode="eval").body)
    except SyntaxError as error:
        raise Mistake(f"'{text}' is no expression: {error.msg}") from None
    except (ArithmeticError, ValueError, TypeError) as error:
        raise Mistake(f"'{text}' has no value: {error}") from None
    for number in value if isinstance(value, list) else [value]:
        if isinstance(number, complex) or isinstance(number, float) and not math.isfinite(number):
            raise Mistake(f"'{text}' has no finite value")
    return value


@dataclass(frozen=True)
class Sweep:
    """Axes and expressions over the tables of a scene."""

    tables: dict
    axes: tuple
    lets: tuple = ()  # (key, expression)

    def __post_init__(self):
        names = [a.name for a in self.axes] + [key for key, _ in self.lets]
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise Mistake(f"'{twice}' is given twice")
        if math.prod(len(a.values) for a in self.axes) > MOST_RUNS:
            raise Mistake(f"these are more than {MOST_RUNS} runs")
        for name in names:
            self.target(name)

    def target(self, name):
        """Path of the scene's key that a name sets; none for one that expressions alone use. Throws Mistake."""
        variables = self.tables.get("particles", {}).get("variables", {})
        path = path_of(name)
        if len(path) == 1:
            if name in variables:
                return ("particles", "variables", name)
            if any(re.search(rf"(?<![\w.]){re.escape(name)}(?![\w.])", text) for _, text in self.lets):
                return None
            raise Mistake(f"'{name}' is no key of the scene and no expression uses it; write the table too, as fluid.density, or "
                          f"add it to [particles.variables], which has {', '.join(variables) or 'nothing'}")
        if path[:2] == ("particles", "variables") and path[2:] and path[2] not in variables:
            raise Mistake(f"the scene has no variable '{path[2]}'; it has {', '.join(variables) or 'none'}")
        return path

    def combinations(self):
        """The values of each run: dicts by name, the last axis fastest."""
        for values in itertools.product(*(a.values for a in self.axes)):
            yield dict(zip((a.name for a in self.axes), values, strict=True))

    def paths(self):
        """Paths of the scene's keys that it sets."""
        return [path for name in (*(a.name for a in self.axes), *(key for key, _ in self.lets)) if (path := self.target(name))]

    def computed(self, chosen):
        """Values of the expressions, by key. Throws Mistake."""
        values = dict(chosen)
        for key, text in self.lets:
            values[key] = evaluate(text, Names(self.tables, values))
        return {key: values[key] for key, _ in self.lets}

    def overlay(self, chosen):
        """Tables of a run's overlay. Throws Mistake."""
        out = {}
        for name, value in {**chosen, **self.computed(chosen)}.items():
            if path := self.target(name):
                if isinstance(self.tables.get(path[0]), list) and path[0] not in out:
                    out[path[0]] = copy.deepcopy(self.tables[path[0]])  # an overlay replaces a list as a whole
                elif len(path) > 2 and isinstance(path[2], int):
                    out.setdefault(path[0], {}).setdefault(path[1], copy.deepcopy(look_up(self.tables, path[:2])))
                assign(out, path, value, name)
        return out

    def label(self, chosen):
        """A folder's name for a run: the last part of each key, with the number of an entry, and its value."""
        short = {name: re.search(r"\w+(\[\d+\])*$", name)[0].replace("[", "_").replace("]", "") for name in chosen}
        ambiguous = [word for word in short.values() if list(short.values()).count(word) > 1]
        words = []
        for name, value in chosen.items():
            told = "_".join(map(str, value)) if isinstance(value, list) else value
            words.append(f"{name if short[name] in ambiguous else short[name]}-{told}")
        return re.sub(r"[^\w.+-]+", "_", "_".join(words)).strip("_")
