"""Rules of the sources that no compiler checks.

    check_sources.py SOURCE_DIR

1. A type has one definition. Two types of one name in one namespace are the same type for the
   linker, which keeps one of their inline functions and drops the other without a word; it shows only
   where a program links both libraries. The same holds for inline constants.
2. The headers that docs/architecture.md lists for users are those that are installed.
3. An installed header includes no header that is not installed.
4. Comments name nothing that does not exist: see comment_names.py.
5. Every source of the library begins with a comment that says what it makes and how.
"""

import collections
import pathlib
import re
import sys

import comment_names

ROOMS = ("src", "cuda", "apps", "python", "integrations")
SUFFIXES = {".hpp", ".cuh", ".cpp", ".cu"}

TOKEN = re.compile(
    r"(?P<namespace>(?:inline\s+)?namespace\s+(?P<space>[\w:]*)\s*\{)"
    r"|(?P<anonymous>namespace\s*\{)"
    r"|(?P<type>(?<!enum )\b(?:struct|class|union|enum\s+class|enum)\s+"
    r"(?:alignas\([^)]*\)\s*)?(?P<name>[\w:]+)\s*(?:final\s*)?(?::[^{;()]*)?\{)"
    r"|(?P<constant>\binline\s+constexpr\s+[\w:<>, ]+?\b(?P<constant_name>\w+)\s*(?:\[[^]]*\]\s*)?[={])"
    r"|(?P<open>\{)|(?P<close>\})"
)


def without_comments(text):
    """The text with comments and the content of literals blanked; line breaks stay."""
    pattern = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.S)
    return pattern.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def definitions(text):
    """Qualified names of the types and inline constants that the text defines with external linkage,
    each with its line."""
    text = without_comments(text)
    scopes = []
    for match in TOKEN.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        if match["close"]:
            if scopes:
                scopes.pop()
            continue
        inside = None not in scopes  # neither in a nameless namespace nor in a function
        if match["constant"]:
            if inside:
                yield "::".join([*scopes, match["constant_name"]]), line
            if match[0].endswith("{"):
                scopes.append(None)
        elif match["type"]:
            if inside:
                yield "::".join([*scopes, match["name"]]), line
            scopes.append(match["name"])
        elif match["namespace"] and match["space"]:
            scopes.append(match["space"])
        else:
            scopes.append(None)


def double_definitions(root):
    places = collections.defaultdict(set)
    for room in ROOMS:
        for path in sorted((root / room).rglob("*")):
            if path.suffix in SUFFIXES:
                for name, line in definitions(path.read_text()):
                    places[name].add((str(path.relative_to(root)), line))
    # The stub of a room stands in for the room and is never linked beside it.
    for name, found in places.items():
        found = {place for place in found if "unavailable" not in place[0]}
        if len(found) > 1:
            where = ", ".join(f"{path}:{line}" for path, line in sorted(found))
            yield f"{name} is defined more than once: {where}"


def installed_headers(root):
    """As cmake/VdwmeshInstall.cmake lists them: a set of 'room/name.hpp'."""
    text = (root / "cmake/VdwmeshInstall.cmake").read_text()
    lists = re.findall(r"set\((\w+)_headers\s+([^)]*)\)", text)
    return {f"{room}/{name}.hpp" for room, names in lists for name in names.split()}


def documented_headers(root):
    """As the table of rooms in docs/architecture.md lists them, in its last column."""
    rows = re.findall(r"^\| `(?:src/)?(\w+)/` \|.*\| ([^|]*) \|$",
                      (root / "docs/architecture.md").read_text(), re.M)  # fmt: skip
    return {f"{room}/{name}.hpp" for room, names in rows for name in re.findall(r"`(\w+)`", names)}


def wrong_headers(root):
    installed, documented = installed_headers(root), documented_headers(root)
    for header in sorted(installed - documented):
        yield f"{header} is installed, but docs/architecture.md does not list it"
    for header in sorted(documented - installed):
        yield f"docs/architecture.md lists {header}, but it is not installed"
    for header in sorted(installed):
        path = root / header if header.startswith("cuda/") else root / "src" / header
        for included in re.findall(r'^#include "([^"]+)"', path.read_text(), re.M):
            if included not in installed:
                yield f"{header} is installed and includes {included}, which is not"


def main(root):
    root = pathlib.Path(root)
    tree = comment_names.Tree(root)
    faults = [*double_definitions(root), *wrong_headers(root), *tree.wrong_names(), *tree.bare_sources()]
    print("\n".join(faults) or "no fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
