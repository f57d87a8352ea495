"""The page of tools/report: report.md as one self-contained file whose tables sort by a click.

Understood is what report.md is made of: headings, paragraphs with line breaks, pictures, tables, lists, blocks of code, `code`,
**bold** and [links](to).
"""

import html
import re
import urllib.parse

from bplbm.page.html import page
from bplbm.page.picture import data_url

NUMBER = re.compile(r"[-+]?\d[\d.]*(?:e[-+]?\d+)?")


def inline(text):
    """Code, bold and links of a line."""
    parts = re.split(r"(`[^`]*`)", text)
    out = []
    for part in parts:
        if len(part) > 1 and part[0] == part[-1] == "`":
            out.append(f"<code>{html.escape(part[1:-1])}</code>")
            continue
        part = re.sub(r"\*\*([^*]+)\*\*", r"<b>\1</b>", html.escape(part, quote=False))
        out.append(re.sub(r"\[([^\]]+)\]\(([^)\s]+)\)",
                          lambda m: f'<a href="{html.escape(m[2])}">{m[1]}</a>', part))
    return "".join(out)


def table(lines):
    """Lines of `| a | b |`, the second one the rule below the head."""
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines]
    head = "".join(f"<th>{inline(cell)}</th>" for cell in rows[0])
    body = "".join("<tr>" + "".join(cell_of(cell) for cell in row) + "</tr>" for row in rows[2:])
    return f'<div class="scroll"><table class="sort"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def cell_of(text):
    kind = "n" if NUMBER.fullmatch(text) else "long" if len(text) > 60 else ""
    return f"<td{f' class={kind}' if kind else ''}>{inline(text)}</td>"


def picture(folder, text, name):
    path = folder / urllib.parse.unquote(name)
    source = data_url(path.read_bytes()) if path.is_file() else html.escape(name)
    return f'<figure><img src="{source}" alt="{html.escape(text)}"></figure>'


def block(lines, folder):
    """HTML of neighbouring lines of one kind."""
    first = lines[0]
    if first.startswith("```"):
        return f"<pre>{html.escape(chr(10).join(lines[1:-1]))}</pre>"
    if found := re.match(r"(#+) (.*)", first):
        level = min(len(found[1]), 3)
        return f'<h{level} id="{anchor(found[2])}">{inline(found[2])}</h{level}>'
    if found := re.fullmatch(r"!\[([^\]]*)\]\(([^)]+)\)", first):
        return picture(folder, found[1], found[2])
    if first.startswith("|"):
        return table(lines)
    if first.startswith("- "):
        items = re.split(r"(?m)^- ", "\n".join(lines))[1:]
        return "<ul>" + "".join(f"<li>{inline(' '.join(item.split()))}</li>" for item in items) + "</ul>"
    return "<p>" + " ".join(inline(line.rstrip()) + ("<br>" if line.endswith("  ") else "") for line in lines) + "</p>"


def anchor(heading):
    """The name that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def blocks(text):
    """Groups of lines of one kind."""
    group, code = [], False
    for line in text.splitlines():
        fence = line.startswith("```")
        alone = not code and bool(re.match(r"#+ |!\[", line))
        starts = not code and group and (not line.strip() or fence or alone or line.startswith("|") != group[-1].startswith("|")
                                         or line.startswith("- ") and not group[0].startswith("- "))
        if starts:
            yield group
            group = []
        if line.strip() or code:
            group.append(line)
        code = code != fence
        if group and (alone or fence and not code):
            yield group
            group = []
    if group:
        yield group


def report_page(text, folder):
    """The page of a report's Markdown; pictures that it names lie in the folder."""
    title = re.search(r"^# (.*)", text, re.M)
    return page(title[1] if title else "Report", *(block(lines, folder) for lines in blocks(text)))
