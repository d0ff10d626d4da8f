"""Links between the documents: every relative one leads to a file, and to a heading of it. The paths in the last
column of the glossary lead to files or folders of src/.

    check_links.py SOURCE_DIR

Code is no text: what stands between backticks or fences is not looked at. Links to other machines are
not followed. The name of a heading is made as the forges make it: small letters, digits, hyphens and
underscores stay, blanks become hyphens, and a heading that comes again gets a number.
"""

import collections
import pathlib
import re
import sys

FENCE = re.compile(r"^ {0,3}(```+|~~~+)[^\n]*\n.*?^ {0,3}\1[ \t]*$", re.M | re.S)
CODE = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)", re.S)
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\[\]]*\])*\]\(\s*<?([^()\s<>]*(?:\([^()\s]*\)[^()\s<>]*)*)>?(?:\s+\"[^\"]*\")?\s*\)")
REFERENCE = re.compile(r"^ {0,3}\[[^\]]+\]:\s*<?(\S+?)>?\s*$", re.M)
HEADING = re.compile(r"^#{1,6}\s+(.+?)\s*#*\s*$", re.M)
ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:", re.I)


def blank(match):
    return re.sub(r"[^\n]", " ", match[0])


def without_code(text):
    return CODE.sub(blank, FENCE.sub(blank, text))


def headings(text):
    """The names by which links find the headings."""
    seen, names = collections.Counter(), set()
    for heading in HEADING.findall(FENCE.sub(blank, text)):
        heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)  # a link shows its text
        name = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        names.add(f"{name}-{seen[name]}" if seen[name] else name)
        seen[name] += 1
    return names


def links(text):
    """Targets with their lines."""
    text = without_code(text)
    for pattern in (LINK, REFERENCE):
        for match in pattern.finditer(text):
            yield match[1], text.count("\n", 0, match.start()) + 1


def documents(root):
    """Everything that is written in Markdown, but for what builds have made."""
    for path in sorted(root.rglob("*.md")):
        if not any(part in ("build", ".git", "node_modules") for part in path.relative_to(root).parts):
            yield path


def wrong_links(root):
    count = 0
    for path in documents(root):
        for target, line in links(path.read_text()):
            count += 1
            if ELSEWHERE.match(target):
                continue
            name, _, anchor = target.partition("#")
            found = (path.parent / name).resolve() if name else path
            place = f"{path.relative_to(root)}:{line}"
            if not found.exists():
                yield f"{place}: {target} leads to no file"
            elif not found.is_relative_to(root):
                yield f"{place}: {target} leads out of the project"
            elif anchor and found.suffix == ".md" and anchor not in headings(found.read_text()):
                yield f"{place}: {target} leads to no heading"
    if not count:
        yield f"no link in {root}"


def wrong_paths(root):
    """Paths of the glossary: what ends its rows between backticks and in small letters; the names of types are not."""
    for line, row in enumerate((root / "docs" / "glossary.md").read_text().splitlines(), 1):
        place = re.search(r"\| `([a-z][a-z_/.]*)` \|$", row)
        if place and not (root / "src" / place[1]).exists():
            yield f"docs/glossary.md:{line}: there is no src/{place[1]}"


def main(root):
    root = pathlib.Path(root).resolve()
    faults = [*wrong_links(root), *wrong_paths(root)]
    print("\n".join(faults) or "no fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
