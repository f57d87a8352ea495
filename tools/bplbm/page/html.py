"""The frame of a page: one file that works from disk, light and dark, with tables that sort by a click."""

import html
import numbers
from dataclasses import dataclass

STYLE = """
:root{color-scheme:light dark;--ink:#1c2430;--soft:#5d6875;--line:#d9dee5;--back:#fff;--card:#f6f8fa;--good:#1a7f37;--bad:#b42318;
--note:#9a6700}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ee;--soft:#a2acb8;--line:#39424d;--back:#14181d;--card:#1c2229;--good:#57c274;
--bad:#ff8a7a;--note:#e3b341}}
*{box-sizing:border-box}body{margin:0 auto;max-width:1080px;padding:24px;font:15px/1.5 system-ui,sans-serif;color:var(--ink);
background:var(--back)}h1{font-size:26px;margin:0 0 2px}h2{font-size:18px;margin:32px 0 8px;padding-bottom:4px;
border-bottom:1px solid var(--line)}.soft{color:var(--soft)}.row{display:flex;flex-wrap:wrap;gap:18px;align-items:flex-start}
.card{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:10px 14px}table{border-collapse:collapse;
font-variant-numeric:tabular-nums}th,td{text-align:left;padding:4px 14px 4px 0;border-bottom:1px solid var(--line);vertical-align:top}
td.n,th.n{text-align:right}table.sort td{white-space:nowrap}table.sort td.long{white-space:normal}td.n{white-space:nowrap}th{vertical-align:bottom}td.long{min-width:260px;font-size:13px}th{font-weight:600;cursor:default}table.sort th{cursor:pointer}table.sort th::after{content:" \\2195";
color:var(--soft);font-size:11px}.scroll{overflow-x:auto}.good{color:var(--good);font-weight:600}.bad{color:var(--bad);font-weight:600}
.note{color:var(--note)}pre{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:10px 14px;overflow-x:auto;
font-size:13px;white-space:pre-wrap;word-break:break-word}img{max-width:100%}figure{margin:0}figcaption{font-size:13px;
color:var(--soft)}svg.chart{width:470px;max-width:100%;font:11px system-ui,sans-serif}svg text{fill:var(--ink)}svg .middle{text-anchor:
middle}svg .end{text-anchor:end}svg .grid{stroke:var(--line);stroke-width:.7}svg .axis{stroke:var(--soft);fill:none}.bar{display:flex;
height:22px;border-radius:5px;overflow:hidden;margin:6px 0}.bar span{display:block}.field img{image-rendering:pixelated;width:100%;
border:1px solid var(--line)}input[type=range]{width:100%}button{font:inherit;padding:2px 12px}
"""

SORTING = """
for(const table of document.querySelectorAll('table.sort'))table.querySelectorAll('th').forEach((head,i)=>head.onclick=()=>{
const body=table.tBodies[0],up=head.dataset.up!=='1',key=r=>r.cells[i].dataset.v??r.cells[i].textContent;head.dataset.up=up?'1':'0';
[...body.rows].sort((a,b)=>{const x=key(a),y=key(b),p=parseFloat(x),q=parseFloat(y);const c=isNaN(p)||isNaN(q)?x.localeCompare(y):p-q;
return up?c:-c}).forEach(r=>body.append(r))});
"""


@dataclass(frozen=True)
class Cell:
    """A cell of a table that is more than its text."""

    markup: str
    sorted_by: object = ""
    kind: str = ""  # n: a number; long: a sentence


def text(value):
    """What is shown of a value; numbers with four digits."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, numbers.Real):
        return f"{value:.4g}" if isinstance(value, float) else str(value)
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


def page(title, *parts, script=""):
    """The whole file."""
    return (f'<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
            f"<title>{html.escape(title)}</title><style>{STYLE}</style></head><body>{''.join(p for p in parts if p)}"
            f"<script>{SORTING}{script}</script></body></html>\n")
