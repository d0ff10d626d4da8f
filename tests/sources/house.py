"""Figures of the house, and limits on them: how much there is to learn before one can change a file.

    house.py SOURCE_DIR [--program PROGRAM]

Prints each figure beside its limit in house.csv, and fails where one is beyond it. Lines are printed alone. A change that
makes a figure better lowers its limit as well; one that needs a higher limit says in its message why.
"""

import argparse
import collections
import csv
import pathlib
import re
import subprocess
import sys

PRODUCT = ("src", "cuda", "apps", "python", "integrations")
CODE = {".hpp", ".cpp", ".cuh", ".cu"}
SCRIPTS = {".py", ".pyi", ".js", ".css", ".html"}
# A definition; not the state of a class that its source defines (`struct Name::State`), nor a parameter of a template.
TYPE = re.compile(r"^\s*(?:template\s*<[^>]*>\s*)?(?:class|struct)\s+([A-Z]\w+)\b(?!::|,)[^;{(]*\{", re.M)
INCLUDE = re.compile(r'^#include "([^"]+)"', re.M)


class House:
    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.text = {}
        for room in PRODUCT:
            for path in sorted((self.root / room).rglob("*")):
                if path.suffix in CODE | SCRIPTS and "__pycache__" not in path.parts:
                    self.text[str(path.relative_to(self.root))] = path.read_text(errors="replace")
        self.code = {name: text for name, text in self.text.items() if pathlib.Path(name).suffix in CODE}
        self.includes = {name: self.own_includes(name) for name in self.code}
        self.depths = {}

    def own_includes(self, name):
        """The headers of the product that a file names, each as its path."""
        beside = pathlib.PurePosixPath(name).parent
        found = []
        for written in INCLUDE.findall(self.code[name]):
            places = (f"src/{written}", written, str(beside / written), f"apps/{written}", f"python/src/{written}")
            found += [next(place for place in places if place in self.code)] if any(p in self.code for p in places) else []
        return found

    def pulled(self, name):
        """All headers that come with a file."""
        seen, open_files = set(), [name]
        while open_files:
            for header in self.includes[open_files.pop()]:
                if header not in seen:
                    seen.add(header)
                    open_files.append(header)
        return seen

    def depth(self, name, way=()):
        if name in way:
            return 0
        if name not in self.depths:
            self.depths[name] = 1 + max((self.depth(header, (*way, name)) for header in self.includes[name]), default=0)
        return self.depths[name]

    def lines(self):
        return sum(text.count("\n") for text in self.text.values())

    def comments(self):
        """Percent of the lines of C++ and CUDA that are comments alone."""
        lines = [line.strip() for text in self.code.values() for line in text.splitlines()]
        return 100 * sum(line.startswith(("//", "/*", "*")) for line in lines) / len(lines)

    def types(self):
        """Where each class or struct is defined, by its name."""
        found = collections.defaultdict(list)
        for name, text in self.code.items():
            for defined in TYPE.findall(text):
                found[defined].append(name)
        return found

    def figures(self):
        types = self.types()
        sources = sorted(len(self.pulled(name)) for name in self.code if name.endswith((".cpp", ".cu")))
        folders = collections.Counter(str(pathlib.PurePosixPath(name).parent) for name in self.text)
        pages = [path for path in (self.root / "docs").rglob("*.md") if "notes" not in path.relative_to(self.root).parts]
        yield "lines", self.lines()
        yield "comment_percent", round(self.comments(), 1)
        yield "types_per_1000_lines", round(1000 * sum(map(len, types.values())) / self.lines(), 1)
        yield "type_names_in_several_files", sum(len(set(files)) > 1 for files in types.values())
        yield "headers_a_source_pulls", sources[len(sources) // 2]
        yield "include_depth", max(map(self.depth, self.code))
        yield "files_of_largest_folder", max(folders.values())
        yield "lines_of_pages", sum(path.read_text().count("\n") for path in pages)


def options(program):
    """How many options `--help-all` of the verbs shows."""
    run = lambda *words: subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout  # noqa: E731
    verbs = re.findall(r"^  ([a-z]+)  ", run("--help"), re.M)
    return len({name for verb in verbs for name in re.findall(r"(?<![\w-])--[a-z][\w-]*", run(verb, "--help-all"))})


def main(arguments):
    parser = argparse.ArgumentParser()
    parser.add_argument("source_dir")
    parser.add_argument("--program")
    asked = parser.parse_args(arguments)
    house = House(asked.source_dir)
    figures = dict(house.figures())
    if asked.program:
        figures["options"] = options(asked.program)
    with open(pathlib.Path(__file__).with_name("house.csv"), newline="") as file:
        limits = {row["figure"]: row for row in csv.DictReader(file)}
    worse = []
    for name, value in figures.items():
        least, most = (limits.get(name, {}).get(key) for key in ("least", "most"))
        beyond = bool(least and value < float(least)) or bool(most and value > float(most))
        worse += [name] if beyond else []
        print(f"{name:30} {value:>10}   {least or '':>6} to {most or 'any':<6}{' BEYOND' if beyond else ''}")
    twice = sorted(name for name, files in house.types().items() if len(set(files)) > 1)
    print("types of one name:", " ".join(twice) or "none")
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
