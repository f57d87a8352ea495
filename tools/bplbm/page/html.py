"""The frame of a page: one file that works from disk, light and dark, with tables that sort by a click."""

import html
import numbers
import pathlib
from dataclasses import dataclass

HERE = pathlib.Path(__file__).resolve().parent


@dataclass(frozen=True)
class Cell:
    """A cell of a table that is more than its text."""

    markup: str
    sorted_by: object = ""
    kind: str = ""  # n: a number; long: a sentence


def text(value):
    """What is shown of a value; numbers with five digits, as on the terminal."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, numbers.Real):
        return f"{value:.5g}" if isinstance(value, float) else str(value)
    return str(value)


def cell(value, numeric=False):
    if isinstance(value, Cell):
        kind = f" class={value.kind}" if value.kind else ""
        return f'<td{kind} data-v="{html.escape(str(value.sorted_by))}">{value.markup}</td>'
    is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    sorted_by = f' data-v="{value!r}"' if is_number else ""
    return f'<td{" class=n" if is_number or numeric else ""}{sorted_by}>{html.escape(text(value))}</td>'


def table(heads, rows, sortable=False):
    """A table of values or Cells."""
    numeric = [all(isinstance(r[i], numbers.Real) or isinstance(r[i], Cell) and r[i].kind == "n" or r[i] is None for r in rows)
               for i in range(len(heads))]
    head = "".join(f'<th{" class=n" if n else ""}>{html.escape(h)}</th>' for h, n in zip(heads, numeric, strict=True))
    body = "".join("<tr>" + "".join(map(cell, row, numeric)) + "</tr>" for row in rows)
    return (f'<div class="scroll"><table{" class=sort" if sortable else ""}><thead><tr>{head}</tr></thead>'
            f"<tbody>{body}</tbody></table></div>")


def section(title, *parts):
    """A heading with what stands under it; nothing where there is nothing."""
    inner = "".join(p for p in parts if p)
    return f"<h2>{html.escape(title)}</h2>{inner}" if inner else ""


def row(parts):
    """Parts side by side; nothing where there is none."""
    return f'<div class="row">{"".join(parts)}</div>' if parts else ""


def own(name):
    """Text of a style sheet or script beside this file."""
    return (HERE / name).read_text()


def page(title, *parts, scripts=()):
    """The whole file. scripts: names of files beside this one, as flow.js."""
    code = "".join(map(own, ("sort.js", *scripts)))
    return ('<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
            f"<title>{html.escape(title)}</title><style>{own('page.css')}</style></head>"
            f"<body>{''.join(p for p in parts if p)}<script>{code}</script></body></html>\n")
