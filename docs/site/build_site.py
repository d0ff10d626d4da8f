#!/usr/bin/env python3
"""Makes the documentation as HTML pages that open from files, without a network.

    build_site.py SITE_FOLDER [--version TEXT] [--api DOXYGEN_FOLDER]

`pages.csv` beside this program lists the pages. Each is a Markdown file of the project, as GitHub reads
them: python3-markdown converts it, and around it come the list of all pages and links to the one before
and the one behind. Links to listed Markdown files lead to their pages; other files of the project that
pages link to or show are copied, and names of headers lead to their reference by Doxygen. A page that is not
listed, or a link to a file that is not there, ends the program with a message.
"""

import argparse
import csv
import html
import os
import pathlib
import re
import shutil
import sys

try:
    import markdown
except ImportError:
    sys.exit("build_site: python3-markdown is not installed; scripts/install-deps.sh docs installs it")

HERE = pathlib.Path(__file__).resolve().parent
SOURCES = HERE.parent.parent
LINK = re.compile(r'\b(href|src)="([^"]*)"')
FENCE = re.compile(r"\s*(```|~~~)")
HEADER = re.compile(r"<code>((?:\w+/)*(\w+)\.hpp)</code>(?!</a>)")
NAME = re.compile(r'(<div id="projectname">)([^<]+)')  # in a page by Doxygen
ITEM = re.compile(r"(\s*)([-*]|\d+\.) ")


class SiteError(Exception):
    """A fault of the pages: one line that says where and what."""


def slug(heading, _separator="-"):
    """The anchor that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def as_github(text):
    """The text with what python3-markdown needs and GitHub does not: a blank line before a list and before a
    fenced block, no words behind the language of a fenced block, and four columns for what belongs to an item."""
    lines, fenced, previous, indent = [], False, "", 0
    for line in text.splitlines():
        if FENCE.match(line):
            if not fenced and previous.strip():
                lines.append("")
            fenced = not fenced
            if fenced:
                line = re.sub(r"(```\w*).*", r"\1", line)
        elif not fenced:
            item = ITEM.match(line)
            if item and previous.strip() and not ITEM.match(previous) and not previous.startswith(" "):
                lines.append("")
            if item:
                indent = len(item[0])
            elif line.strip() and not line.startswith(" "):
                indent = 0
            elif line.startswith(" " * indent) and indent:
                line = "    " + line[indent:]
        lines.append(line)
        previous = line
    return "\n".join(lines)


class Site:
    """The pages, their places, and what is copied beside them."""

    def __init__(self, target, version, sources=SOURCES, listing=HERE / "pages.csv"):
        self.target, self.version, self.sources = pathlib.Path(target), version, sources
        with open(listing, newline="") as file:
            self.pages = list(csv.DictReader(file))
        for page in self.pages:
            page["place"] = self.place(page["source"])
        self.places = {page["source"]: page["place"] for page in self.pages}
        self.has_api = False

    @staticmethod
    def place(source):
        """Where the page of a Markdown file stands in the site."""
        name = source.removeprefix("docs/").removesuffix(".md").lower()
        folder = name.removesuffix("readme").rstrip("/")
        if name.endswith("readme"):
            name = f"{folder}/about" if folder else "readme"
        return name + ".html"

    def build(self, api=None):
        unlisted = sorted(
            str(path.relative_to(self.sources))
            for path in (self.sources / "docs").rglob("*.md")
            if str(path.relative_to(self.sources)) not in self.places
            and "notes" not in path.parent.parts  # those are for makers; a link to one leads to its text
        )
        if unlisted:
            raise SiteError(f"docs/site/pages.csv does not list {', '.join(unlisted)}")
        if self.target.exists():
            shutil.rmtree(self.target)
        self.target.mkdir(parents=True)
        shutil.copy(HERE / "style.css", self.target)
        if api:
            self.copy_api(api)
        for number, page in enumerate(self.pages):
            self.write(number, page)

    def copy_api(self, api):
        """Copies the pages by Doxygen; the project's name at their top leads back to the overview."""
        shutil.copytree(api, self.target / "api")
        for path in (self.target / "api").glob("*.html"):
            text = path.read_text()
            path.write_text(NAME.sub(r'\1<a href="../index.html">\2</a>', text, count=1))
        self.has_api = True

    def write(self, number, page):
        source = self.sources / page["source"]
        if not source.is_file():
            raise SiteError(f"docs/site/pages.csv lists {page['source']}, which is not there")
        converter = markdown.Markdown(
            extensions=["fenced_code", "tables", "toc", "sane_lists"],
            extension_configs={"toc": {"slugify": slug, "toc_depth": "2-3"}},
        )
        body = converter.convert(as_github(source.read_text()))
        body = LINK.sub(lambda found: self.link(page, *found.groups()), body)
        body = HEADER.sub(lambda found: self.header(page, *found.groups()), body)
        body = body.replace("<table>", '<div class="table"><table>').replace("</table>", "</table></div>")
        headings = converter.toc if body.count("<h2") > 2 else ""
        target = self.target / page["place"]
        target.parent.mkdir(parents=True, exist_ok=True)
        before = self.pages[number - 1] if number else None
        behind = self.pages[number + 1] if number + 1 < len(self.pages) else None
        target.write_text(self.frame(page, body, headings, before, behind))

    def header(self, page, path, name):
        """The name of a header, with a link to what Doxygen says of it, if that is part of the site."""
        place = f"api/{name.replace('_', '__')}_8hpp.html"
        if not (self.target / place).is_file():
            return f"<code>{path}</code>"
        return f'<a href="{self.relative(page, place)}"><code>{path}</code></a>'

    def link(self, page, kind, address):
        """The attribute with the address that the link has in the site."""
        address = html.unescape(address)
        if re.match(r"[a-z]+:", address) or address.startswith("#"):
            return f'{kind}="{html.escape(address)}"'
        path, _, anchor = address.partition("#")
        source = os.path.normpath(os.path.join(os.path.dirname(page["source"]), path))
        if source.startswith("..") or not (self.sources / source).exists():
            raise SiteError(f"{page['source']} links to {address}, which is not there")
        place = self.places.get(source) or self.copy(source)
        address = self.relative(page, place) + (f"#{anchor}" if anchor else "")
        return f'{kind}="{html.escape(address)}"'

    def copy(self, source):
        """Copies a file or folder that a page links to; a folder becomes a page with its files."""
        place = source.removeprefix("docs/") if source.startswith("docs/images/") else f"files/{source}"
        origin, target = self.sources / source, self.target / place
        target.parent.mkdir(parents=True, exist_ok=True)
        if origin.is_file():
            shutil.copy(origin, target)
            return place
        names = sorted(path.name for path in origin.iterdir() if path.is_file())
        target.mkdir(exist_ok=True)
        for name in names:
            shutil.copy(origin / name, target)
        items = "".join(f'<li><a href="{html.escape(name)}">{html.escape(name)}</a></li>' for name in names)
        page = {"title": source, "place": f"{place}/index.html"}
        (self.target / page["place"]).write_text(self.frame(page, f"<h1>{html.escape(source)}</h1>\n<ul>{items}</ul>"))
        return page["place"]

    @staticmethod
    def relative(page, place):
        return os.path.relpath(place, os.path.dirname(page["place"]) or ".")

    def navigation(self, page):
        sections = {}
        for other in self.pages:
            sections.setdefault(other["section"], []).append((other["title"], other["place"]))
        if self.has_api:
            sections["Reference"].append(("C++ headers (Doxygen)", "api/index.html"))
        text = ""
        for section, entries in sections.items():
            text += f"<h2>{html.escape(section)}</h2>\n<ul>\n"
            for title, place in entries:
                here = ' aria-current="page"' if place == page["place"] else ""
                text += f'<li><a href="{self.relative(page, place)}"{here}>{html.escape(title)}</a></li>\n'
            text += "</ul>\n"
        return text

    def frame(self, page, body, headings="", before=None, behind=None):
        """The whole page, with links to two others. On a narrow screen the list of pages is folded up."""

        def neighbour(other, word):
            if not other:
                return "<span></span>"
            return f'<a href="{self.relative(page, other["place"])}">{word}{html.escape(other["title"])}</a>'

        inside = f'<details class="here"><summary>On this page</summary>{headings}</details>' if headings else ""
        return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{html.escape(page["title"])} · vdwmesh</title>
<link rel="stylesheet" href="{self.relative(page, "style.css")}">
</head>
<body>
<a class="skip" href="#text">To the text</a>
<input type="checkbox" id="fold" aria-label="Show the list of pages">
<header><label for="fold">☰ Pages</label><a href="{self.relative(page, "index.html")}">vdwmesh {html.escape(self.version)}</a></header>
<nav aria-label="Pages">
{self.navigation(page)}</nav>
<main id="text">
{inside}
{body}
<footer>{neighbour(before, "← ")}{neighbour(behind, "→ ")}</footer>
</main>
</body>
</html>
"""


def main():
    parser = argparse.ArgumentParser(description="Makes the documentation as HTML pages.")
    parser.add_argument("target", metavar="SITE_FOLDER")
    parser.add_argument("--version", default="")
    parser.add_argument("--api", metavar="DOXYGEN_FOLDER")
    arguments = parser.parse_args()
    try:
        Site(arguments.target, arguments.version).build(arguments.api)
    except SiteError as error:
        sys.exit(f"build_site: {error}")


if __name__ == "__main__":
    main()
