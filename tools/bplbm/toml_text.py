"""Writing TOML, and laying overlays over a scene as lbm does."""

import json
import tomllib


def value_text(value):
    if isinstance(value, list):
        return "[" + ", ".join(map(value_text, value)) + "]"
    return json.dumps(value, ensure_ascii=False)  # numbers, truth values and texts are the same in both


def toml(tables, prefix=""):
    """Text of nested tables; a list of tables becomes [[name]]."""
    plain = {k: v for k, v in tables.items() if not is_table(v)}
    text = "".join(f"{key} = {value_text(value)}\n" for key, value in plain.items())
    for key, value in tables.items():
        if is_table(value):
            for one in value if isinstance(value, list) else [value]:
                name = f"{prefix}{key}"
                text += (f"[[{name}]]\n" if isinstance(value, list) else f"[{name}]\n") + toml(one, f"{name}.")
    return text


def is_table(value):
    return isinstance(value, dict) or isinstance(value, list) and bool(value) and all(isinstance(v, dict) for v in value)


def laid_over(tables, *overlays):
    """Tables with the keys of overlays in place of their own, one by one; a list is replaced as a whole."""
    out = dict(tables)
    for overlay in overlays:
        for key, value in overlay.items():
            both = isinstance(value, dict) and isinstance(out.get(key), dict)
            out[key] = laid_over(out[key], value) if both else value
    return out


def read_laid_over(paths):
    """The same of files, the first one the scene. Throws OSError or ValueError."""
    tables = []
    for path in paths:
        with open(path, "rb") as file:
            tables.append(tomllib.load(file))
    return laid_over(*tables)
