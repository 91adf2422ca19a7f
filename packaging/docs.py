"""Before and after the site's generator: `docs.py stage DIR` writes its pages, `docs.py finish SITE OUT`
takes a whole site.

Staged are docs/, README as the first page, CONTRIBUTING and CHANGELOG, what pages link to outside docs/, and
the reference made from the program: the design file's fields, the commands' parsers. Finishing follows every
link, and refuses pages that fetch from elsewhere.
"""

from __future__ import annotations

import argparse
import html
import re
import shutil
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from tactcad.cli.main import COMMANDS, overview, parser_of
from tactcad.cli.parser import UNLISTED
from tactcad.design.schema import TEXT_ORIGIN, fields_of, tables_by_family

ROOT = Path(__file__).parents[1]
TOP = {"README.md": "index.md", "CONTRIBUTING.md": "CONTRIBUTING.md", "CHANGELOG.md": "CHANGELOG.md"}
FETCHED = "https://unpkg.com/iframe-worker/shim"
LINK = re.compile(r"\]\(([^)#\s]+)")


def stage(folder: Path) -> None:
    """Write the generator's configuration, every page, and every file that one of them links to; `folder` is
    made anew."""
    shutil.rmtree(folder, ignore_errors=True)
    out = folder / "pages"
    shutil.copytree(ROOT / "docs", out)
    shutil.copy(ROOT / "packaging" / "zensical.toml", folder)
    for name in ("site.css", "worker.js"):
        shutil.copy(ROOT / "packaging" / name, out)
    for source, target in TOP.items():
        (out / target).write_text((ROOT / source).read_text("utf-8").replace("](docs/", "]("), "utf-8")
    for page in out.glob("*.md"):
        text = page.read_text("utf-8").replace("](../README.md", "](index.md").replace("](../", "](")
        page.write_text(text, "utf-8")
        for linked in LINK.findall(text):
            if not (out / linked).exists() and (ROOT / linked).is_file():
                (out / linked).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / linked, out / linked)
                if linked.endswith(".md"):  # docs/ is the site's top
                    whole = (out / linked).read_text("utf-8")
                    (out / linked).write_text(whole.replace("](../../docs/", "](../../"), "utf-8")
    (out / "reference-schema.md").write_text(schema_page(), "utf-8")
    (out / "reference-commands.md").write_text(commands_page(), "utf-8")


def schema_page() -> str:
    return (
        "# The design file\n\nEvery field with its legal values; `tactcad schema` prints the same, `tactcad "
        "schema --json` as "
        "JSON Schema. Lengths in mm, forces in N, stresses in MPa, density in kg/m3 unless a field says "
        "otherwise.\n\n![An element, with the lengths of sheet, element, holes and stop named]"
        "(images/labelled-element.svg)\n\n![The array, with pitch, row pitch, spacer and sheet named]"
        "(images/labelled-array.svg)\n\n"
        f"{markdown_schema()}\n"
    )


def markdown_schema() -> str:
    """What `tactcad schema` prints, with a section and a table of fields for every table of the file."""
    tables = [table for _, tables in tables_by_family() for table in tables]
    lines = []
    for name, kind, may_be_left_out in tables:
        lines += [f"## [{name}]", "", "May be left out.", ""] if may_be_left_out else [f"## [{name}]", ""]
        lines += ["| field | meaning | legal | default |", "|---|---|---|---|"]
        for field, spec, default in fields_of(kind):
            cells = (f"`{field}`", spec.meaning, spec.legal, default)
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
        lines.append("")
    return "\n".join([*lines, "## [origin]", "", TEXT_ORIGIN])


def commands_page() -> str:
    head = (
        "# Commands\n\nDESIGN is a path, or a name in `hardware/`. `tactcad help` prints this list "
        f"and `tactcad help COMMAND` what stands below.\n\n```text\n{overview()}\n```\n"
    )
    return "\n".join([head, *(_command(name) for name in COMMANDS)])


def _command(name: str) -> str:
    """A command as its own parser has it: usage, arguments, examples."""
    parser = parser_of(name)
    shown = [action for action in parser._actions if action.help != UNLISTED]
    rows = [
        "| " + _called(action) + " | " + html.escape(action.help or "").replace("|", "\\|") + " |"
        for action in shown
    ]
    return (
        f"## tactcad {name}\n\n{COMMANDS[name][0].upper()}{COMMANDS[name][1:]}.\n\n"
        f"| argument | meaning |\n|---|---|\n" + "\n".join(rows) + f"\n\n```text\n{parser.epilog}\n```\n"
    )


def _called(action: argparse.Action) -> str:
    name = " ".join(action.option_strings) or str(action.metavar or action.dest)
    value = "" if action.nargs == 0 or not action.option_strings else f" {action.metavar or _choices(action)}"
    return f"`{name}{value}`"


def _choices(action: argparse.Action) -> str:
    return ",".join(map(str, action.choices)) if action.choices else action.dest.upper()


class Page(HTMLParser):
    """A page's references and anchors."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.fetched: list[str] = []
        self.anchors: set[str] = {""}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {k: v for k, v in attrs if v}
        self.anchors |= {given[k] for k in ("id", "name") if k in given}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        elif "src" in given or tag == "link" and given.get("rel") != "canonical" and "href" in given:
            self.fetched.append(given.get("src") or given["href"])


def finish(site: Path) -> list[str]:
    """Faults of the site: broken links, files that would be fetched from elsewhere.

    The generator's help for searching from the disk would be fetched; it is replaced by our own.
    """
    for path in site.rglob("*.html"):
        own = "../" * len(path.relative_to(site).parent.parts) + "worker.js"
        path.write_text(path.read_text("utf-8").replace(FETCHED, own), "utf-8")
    pages = {path: Page(path.read_text("utf-8")) for path in site.rglob("*.html") if path.name != "404.html"}
    wrong = []
    for path, page in pages.items():
        wrong += [f"{path.name}: fetched from elsewhere: {u}" for u in page.fetched if urlsplit(u).netloc]
        for link in page.links + page.fetched:
            parts = urlsplit(link)
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path.resolve()
            if parts.scheme or parts.netloc:
                continue
            if not target.exists():
                wrong.append(f"{path.name}: no such file: {link}")
            elif target in pages and unquote(parts.fragment) not in pages[target].anchors:
                wrong.append(f"{path.name}: no such place: {link}")
    return wrong


if __name__ == "__main__":
    what, *folders = sys.argv[1:]
    if what == "stage":
        stage(Path(folders[0]))
    else:
        site, out = (Path(f).resolve() for f in folders)
        if problems := finish(site):
            sys.exit("\n".join(problems))
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(site, out)
        print(f"{len(list(out.rglob('*.html')))} pages, every link followed: open {out / 'index.html'}")
