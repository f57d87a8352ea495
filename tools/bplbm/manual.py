"""All documents as one manual: they are copied beside their pictures, put in an order for readers, and made by mkdocs."""

import functools
import http.server
import re
import shutil
import subprocess
import sys

from bplbm.checks.documents import name, prose, tracked
from bplbm.project import ROOT

SOURCE, SITE = ROOT / "out" / "manual.source", ROOT / "out" / "manual"
PICTURES = ("*.png", "*.svg")

STYLE = """
.wy-nav-content { max-width: 1150px }
.rst-content table { margin-bottom: 24px }
.rst-content table td, .rst-content table th { padding: 4px 8px; border: 1px solid #e1e4e5 }
.rst-content table td, .rst-content table code { white-space: normal }
"""

# Readers, and what they read first; every other document comes under the last heading, by its folder.
READERS = {
    "Start": ["README.md", "cases/TUTORIAL.md", "cases/RUNNING.md", "cases/TROUBLESHOOTING.md", "cases/PYTHON.md"],
    "Scenes": ["cases/README.md", "cases/*/*.md"],
    "Reference": ["lbm_solver/docs/scene.md", "lbm_solver/docs/output.md", "liggghts_coupling/docs/commands.md",
                  "lbm_solver/docs/parallel.md"],
    "Theory": [f"lbm_solver/docs/{page}.md" for page in ("collision", "solids", "resistance", "boundaries", "loads")]
    + ["liggghts_coupling/bond/README.md", "lbm_solver/docs/bibliography.md"],
    "Evidence": ["tests/EVIDENCE.md", "lbm_solver/docs/defaults.md", "lbm_solver/docs/performance.md",
                 "cases/report/README.md", "cases/report/full/README.md"],
    "Contributing": ["CONTRIBUTING.md", "protocol/README.md", "protocol/WIRE.md", "CHANGELOG.md"],
    "Rooms": ["**/*.md"],
}


def fail(text):
    print(f"manual | error | {text}", file=sys.stderr)
    sys.exit(2)


def title(text, default):
    """Its first heading, as plain text."""
    heading = next((line.lstrip("# ") for _, line in prose(text) if line.startswith("# ")), default)
    return re.sub(r"`|\[([^\]]*)\]\([^)]*\)", r"\1", heading)


def adapted(text):
    """For a Markdown that wants a blank line before a list."""
    lines, code = [], False
    item = re.compile(r"\s*([-*]|\d+\.) ")
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            code = not code
        before = lines[-1] if lines else ""
        if not code and item.match(line) and before.strip() and not item.match(before) and not before.startswith(" "):
            lines.append("")
        lines.append(line)
    return "\n".join(lines) + "\n"


def order(documents):
    """(reader, [(title, file)]) of every document, each once."""
    left = {name(path): path for path in documents}
    for reader, patterns in READERS.items():
        pages = []
        for pattern in patterns:
            for path in sorted(ROOT.glob(pattern)):
                if left.pop(name(path), None):
                    pages.append((title(path.read_text(), path.stem), name(path)))
        yield reader, pages


def quoted(text):
    """For YAML: a title may hold any character."""
    return "'" + text.replace("'", "''") + "'"


def settings(documents):
    """mkdocs.yml."""
    lines = ["site_name: BPLBM", f"docs_dir: {quoted(str(SOURCE))}", f"site_dir: {quoted(str(SITE))}", "theme: readthedocs",
             "use_directory_urls: false", "extra_css: [manual.css]",
             "plugins: [search]", "markdown_extensions: [tables, fenced_code, sane_lists]", "nav:"]
    for reader, pages in order(documents):
        lines.append(f"  - {quoted(reader)}:")
        lines += [f"      - {quoted(page)}: {quoted(file)}" for page, file in pages]
    return "\n".join(lines) + "\n"


def linked_files(documents):
    """Other files that documents link: sources, tables, the licence."""
    targets = {(path.parent / target.split("#")[0]).resolve() for path in documents
               for _, line in prose(path.read_text()) for target in re.findall(r"\]\(([^)\s]+)\)", line)}
    return sorted(path for path in targets if path.is_file() and path.suffix != ".md" and ROOT in path.parents)


def build():
    """@return the manual's first page"""
    shutil.rmtree(SOURCE, ignore_errors=True)
    documents = [path for path in tracked("*.md") if "templates" not in path.parts]
    for path in {*documents, *tracked(*PICTURES), *linked_files(documents)}:
        copy = SOURCE / name(path)
        copy.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md":
            copy.write_text(adapted(path.read_text()))
        else:
            shutil.copy(path, copy)
    (SOURCE / "manual.css").write_text(STYLE)
    config = SOURCE.with_suffix(".yml")
    config.write_text(settings(documents))
    made = subprocess.run(["mkdocs", "build", "--quiet", "--clean", "--config-file", str(config)], capture_output=True,
                          text=True, check=False)
    if made.returncode:
        print(made.stdout + made.stderr, file=sys.stderr)
        fail("mkdocs failed; its output is above")
    shutil.rmtree(SOURCE)
    config.unlink()
    return SITE / "index.html"


def main(words):
    port = 8000
    if len(words) > 1:
        if len(words) > 2 or not words[1].isdigit():
            fail(f"--serve takes a port, not '{' '.join(words[1:])}'")
        port = int(words[1])
    print(f"manual | {build()}")
    if words:
        print(f"manual | http://localhost:{port} (Ctrl-C ends it)")
        handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(SITE))
        try:
            http.server.ThreadingHTTPServer(("localhost", port), handler).serve_forever()
        except KeyboardInterrupt:
            pass


if __name__ == "__main__":
    main(sys.argv[1:])
