#!/usr/bin/env python3
"""Breaks lines of the mesh and union code one at a time and sees whether a test fails.

    mutate.py list  [--seed S] [--count N]             the mutants of a seed, as CSV
    mutate.py run   BUILD [--seed S] [--count N] [--first I] [--log FILE]

`run` changes sources of the checkout that this file is in and puts them back: use a checkout of its
own. BUILD is a configured build tree of that checkout. Only the tests of the mutant's room are built
and run, and they stop at the first failure. A mutant that does not compile is none; the next one of
the seed takes its place.
"""

import argparse
import csv
import pathlib
import random
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = ("extract", "refine", "arrangement")

# Test programs by room, the quick ones first.
TESTS = {
    "extract": ["tests/unit/extract/unit_extract", "tests/contract/extractor_contract_test",
                "tests/contract/properties_test", "tests/contract/refiner_contract_test"],
    "refine": ["tests/unit/refine/refine_test", "tests/contract/refiner_contract_test"],
    "arrangement": ["tests/unit/arrangement/arrangement_union_test",
                    "tests/unit/arrangement/arrangement_arcs_test",
                    "tests/contract/exact_mesher_contract_test"],
}

# What is looked for, and what takes its place.
CHANGES = [
    (r" <= ", " < "), (r" >= ", " > "), (r" < ", " <= "), (r" > ", " >= "),
    (r" == ", " != "), (r" != ", " == "), (r" && ", " || "), (r" \|\| ", " && "),
    (r" \+ ", " - "), (r" - ", " + "), (r" \* ", " / "), (r" / ", " * "),
    (r" \+= ", " -= "), (r" -= ", " += "), (r" << ", " >> "), (r" >> ", " << "),
    (r"(?<=[( ])!(?=[a-z(])", ""), (r"(?<=[( ,=])-(?=[a-z(0-9])", ""),
    (r"\bstd::min\b", "std::max"), (r"\bstd::max\b", "std::min"),
    (r"\bstd::sin\b", "std::cos"), (r"\bstd::cos\b", "std::sin"),
    (r"\btrue\b", "false"), (r"\bfalse\b", "true"),
    (r"(?<![\w.])0(?![\w.])", "1"), (r"(?<![\w.])1(?![\w.])", "2"),
    (r"(?<![\w.])2(?![\w.])", "3"), (r"(?<![\w.])3(?![\w.])", "2"),
    (r"\bcontinue;", "{}"), (r"\bbreak;", "{}"), (r"\.x\b", ".y"), (r"\.z\b", ".x"),
    (r"\.lower\b", ".upper"), (r"\.upper\b", ".lower"),
]


def is_code(line):
    text = line.strip()
    skipped = ("//", "#", "template", "namespace", "using", "throw", "static_assert", "}", "public",
               "private", "class", "struct", "virtual", "advance(", "begin_stage(")
    return bool(text) and not text.startswith(skipped) and "fmt::" not in text


def changes_of(line):
    code = line.split("//")[0]
    for pattern, new in CHANGES:
        for found in re.finditer(pattern, code):
            yield line[:found.start()] + new + line[found.end():]


def mutants(seed):
    """All lines that can be broken, in random order, each with one change at random."""
    lines = []
    for room in ROOMS:
        for path in sorted((ROOT / "src" / room).glob("*.[ch]pp")):
            for number, line in enumerate(path.read_text().split("\n"), 1):
                if is_code(line) and any(True for _ in changes_of(line)):
                    lines.append((room, path, number, line))
    dice = random.Random(seed)
    dice.shuffle(lines)
    for room, path, number, line in lines:
        yield room, path, number, line, dice.choice(sorted(set(changes_of(line))))


def outcome(room, build):
    targets = [pathlib.Path(test).name for test in TESTS[room]]
    for test, target in zip(TESTS[room], targets):
        made = subprocess.run(["ninja", "-C", build, target], capture_output=True, text=True)
        if made.returncode != 0:
            return "no mutant", "does not compile"
        try:
            ran = subprocess.run([build / test, "--gtest_fail_fast", "--gtest_brief=1"],
                                 capture_output=True, text=True, timeout=600)
        except subprocess.TimeoutExpired:
            return "killed", f"{target}: no end in 600 s"
        if ran.returncode != 0:
            failed = re.search(r"\[  FAILED  \] (\S+?),? ", ran.stdout)
            return "killed", failed.group(1) if failed else f"{target}: {ran.returncode}"
    return "survived", ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("action", choices=("list", "run"))
    parser.add_argument("build", nargs="?", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=8)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--first", type=int, default=0, help="mutants of the seed to pass over")
    parser.add_argument("--log", type=argparse.FileType("a"), default=sys.stdout)
    options = parser.parse_args()
    if options.action == "run" and options.build is None:
        parser.error("run needs BUILD")
    table = csv.writer(options.log)
    left = options.count
    for index, (room, path, number, line, broken) in enumerate(mutants(options.seed)):
        if index < options.first or left == 0:
            continue
        row = [index, path.relative_to(ROOT), number, line.strip(), broken.strip()]
        if options.action == "run":
            original = path.read_text()
            text = original.split("\n")
            text[number - 1] = broken
            try:
                path.write_text("\n".join(text))
                row += outcome(room, options.build.resolve())
            finally:
                path.write_text(original)
        table.writerow(row)
        options.log.flush()
        left -= row[-2] != "no mutant"


if __name__ == "__main__":
    main()
