#!/usr/bin/env python3
"""Breaks lines of the program one at a time and sees whether a test fails.

    mutate.py list [--seed S] [--count N]                     the mutants of a seed, as CSV
    mutate.py run BUILD [--seed S] [--count N] [--first I]    breaks, builds and tests them
    mutate.py run BUILD --lines FILE.csv                      the same with the lines of a file

The lines are drawn from src/ and apps/, every line that can be broken with the same chance, so that a
room counts by its size. FILE.csv has the columns file, line, was, became; `was` is a part of the line,
looked for nearest to the number given, and `became` takes its place.

`run` changes sources of the checkout that this file is in and puts them back: use a checkout of its
own. BUILD is a configured build tree of that checkout. The tests of the mutant's room are built and
run, the quick programs first, and they stop at the first failure. A program whose bytes did not change
is not run, and a mutant that changes no program is equivalent. A mutant that does not compile is
none; the next one of the seed takes its place. Every test must pass on the unbroken sources first.
"""

import argparse
import csv
import hashlib
import json
import os
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
MEMORY = 6 << 30  # bytes that a broken program may take; Chromium reserves more addresses
COLUMNS = ["index", "file", "line", "was", "became", "outcome", "by", "seconds"]

# Tests in Python run vdwmesh but for these: their targets, and the variable that names the program.
OTHER_PROGRAMS = {"cli.ranks": (("vdwmesh", "vdwmesh_mpi", "ranks_after_failure", "fail_allocation", "grant_no_threads",
                                 "rank_without_vertices"),
                                "VDWMESH_RANKS_PROGRAM"),
                  "cli.bench": (("vdwmesh_bench",), "VDWMESH_BENCH_PROGRAM")}  # fmt: skip

# ctest's names of the tests that can notice a broken line of a room, the quick ones first.
PROGRAM = ["cli.options", "cli.option_pairs", "cli.manual", "cli.per_atom", "cli.report", "cli.surfaces",
           "cli.meshes", "cli.files", "cli.render", "cli.words", "cli.exact_mesher", "cli.excluded",
           "cli.interface", "cli.pockets", "cli.batch", "cli.foreign", "cli.study", "cli.page", "cli.view",
           "cli.bench", "cli.memory", "cli.signals", "cli.bad_places", "cli.repeatable", "cli.bad_files"]
TESTS = {
    "core": ["core_test", "spheres_test", "unit_extract", "test_mesh_measures", "refine_test", "arrangement_union_test",
             "extractor_contract_test", "cli.options", "cli.signals", "cli.files"],
    "spheres": ["spheres_test", "unit_extract", "arrangement_arcs_test", "union_measurer_contract_test",
                "extractor_contract_test", "cli.options"],
    "surface": ["unit_extract", "refine_test", "extractor_contract_test", "refiner_contract_test",
                "surface_remesher_contract_test"],
    "structure": ["unit_structure", "unit_reference_areas", *(f"fuzz.{name}" for name in (
                      "pdb", "mmcif", "bcif", "pqr", "xyzr", "gro", "mol2", "sdf", "xyz", "gzip", "radii", "selection")),
                  "cli.report", "cli.files", "cli.options", "cli.words", "cli.bad_files", "cli.binary_cif", "cli.united_atoms",
                  "cli.structure_witnesses"],
    "extract": ["unit_extract", "fuzz.extractor", "extractor_contract_test", "properties_test", "refiner_contract_test",
                "cli.surfaces", "cli.options"],
    "refine": ["refine_test", "refine_bytes_test", "refiner_contract_test", "excluded_mesher_contract_test",
               "exact_mesher_contract_test", "cli.options"],
    "measures": ["arrangement_arcs_test", "arrangement_certificate_test", "arrangement_gradients_test",
                 "arrangement_bounded_patch_test", "union_measurer_contract_test", "arrangement_union_test",
                 "arrangement_growth_test", "cli.certify", "cli.union_witnesses"],
    "complex": ["arrangement_triangulation_test", "arrangement_parts_test", "pockets_test", "arrangement_union_test",
                "exact_mesher_contract_test", "cli.union_witnesses"],
    "creases": ["arrangement_triangulation_test", "arrangement_bounded_patch_test", "arrangement_union_test",
                "arrangement_parts_test", "exact_mesher_contract_test", "arrangement_growth_test", "cli.exact_mesher"],
    "excluded": ["excluded_test", "excluded_measures_contract_test", "excluded_measurer_contract_test",
                 "excluded_mesher_contract_test", "excluded_distances_contract_test", "excluded_bounds_contract_test",
                 "arrangement_gradients_test", "excluded_growth_test", "cli.excluded"],
    "pockets": ["pockets_test", "cli.pockets"],
    "interface": ["interface_test", "cli.interface"],
    "remesh": ["remesh_test", "surface_remesher_contract_test", "cli.excluded", "cli.meshes"],
    "mesh": ["test_surface_mesh", "test_mesh_io", "unit_distributed", "cli.meshes", "cli.foreign", "cli.viewers", "cli.files"],
    "analysis": ["test_cell_pairs", "test_mesh_measures", "test_study", "test_distances",
                 "distance_measurer_contract_test", "properties_test", "cli.report", "cli.meshes", "cli.study"],
    "render": ["render_test", "picture_test", "cli.render"],
    "batch": ["batch_growth_test", "cli.batch"],
    "request": ["test_apps", "cli.options", "cli.report", "cli.surfaces", "cli.meshes", "cli.ranks"],
    "distributed": ["unit_distributed", "cli.ranks"],
    "apps": ["test_apps", *PROGRAM],
}


def same(text):
    return lambda _: text


def doubled(found):
    return f"(2 * {found[0]})"


def one_more(found):
    return str(int(found[0]) + 1)


# What is looked for, and what takes its place.
CHANGES = [(re.compile(pattern), new if callable(new) else same(new)) for pattern, new in [
    (r" <= ", " < "), (r" >= ", " > "), (r" < ", " <= "), (r" > ", " >= "),
    (r" == ", " != "), (r" != ", " == "), (r" && ", " || "), (r" \|\| ", " && "),
    (r" \+ ", " - "), (r" - ", " + "), (r" \* ", " / "), (r" / ", " * "), (r" % ", " / "),
    (r" \+= ", " -= "), (r" -= ", " += "), (r" << ", " >> "), (r" >> ", " << "),
    (r"\+\+(?=[\w.]+;)", "--"),
    (r"(?<=[( ])!(?=[a-z(])", ""), (r"(?<=[( ,=])-(?=[a-z(0-9])", ""),
    (r"\bstd::min\b", "std::max"), (r"\bstd::max\b", "std::min"),
    (r"\bstd::sin\b", "std::cos"), (r"\bstd::cos\b", "std::sin"),
    (r"\bstd::floor\b", "std::ceil"), (r"\bstd::ceil\b", "std::floor"), (r"\bstd::abs\b", ""),
    (r"\btrue\b", "false"), (r"\bfalse\b", "true"),
    (r"(?<![\w.'])0(?![\w.'])", "1"), (r"(?<![\w.'])1(?![\w.'])", "2"),
    (r"(?<![\w.'])2(?![\w.'])", "3"), (r"(?<![\w.'])3(?![\w.'])", "2"),
    (r"(?<![\w.'])([4-9]|[1-9]\d+)(?![\w.'])", one_more),
    (r"(?<![\w.'])\d+\.\d*(e-?\d+)?(?![\w.'])", doubled), (r"(?<![\w.'])\d+e-\d+(?![\w.'])", doubled),
    (r"\bcontinue;", "{}"), (r"\bbreak;", "{}"),
    (r"\.x\b", ".y"), (r"\.y\b", ".z"), (r"\.z\b", ".x"),
    (r"\.lower\b", ".upper"), (r"\.upper\b", ".lower"), (r"\.front\(\)", ".back()"), (r"\.back\(\)", ".front()"),
    (r"\.begin\(\)", ".end()"), (r"\barea\b", "volume"), (r"\bvolume\b", "area"), (r"\bfirst\b", "last"),
    (r"\.value_or\(", ".value() + ("), (r"^ +[a-z][\w.:>-]*\(.*\);$", ";"), (r"^ +[a-z][\w.>\[\]-]* [+]?= .*;$", ";"),
]]
SKIPPED = ("//", "#", "template", "namespace", "using", "throw", "static_assert", "}", "public", "private", "class",
           "struct", "enum", "virtual", "friend", "advance(", "begin_stage(", "refuse(", "warn(")


def without_text(line):
    """The line with its strings and comment blanked, its length kept."""
    line = re.sub(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])\'', lambda found: '"' + "~" * (len(found[0]) - 2) + '"', line)
    return re.sub(r"//.*", lambda found: "~" * len(found[0]), line)


def is_code(line):
    text = line.strip()
    return bool(text) and not text.startswith(SKIPPED)


def changes_of(line):
    code = without_text(line)
    for pattern, new in CHANGES:
        for found in pattern.finditer(code):
            yield line[: found.start()] + new(found) + line[found.end() :]


def room_of(path):
    parts = path.relative_to(ROOT).parts
    return "apps" if parts[0] == "apps" else parts[1]


def sources():
    for folder in ("src", "apps"):
        yield from sorted(path for path in (ROOT / folder).rglob("*.[ch]pp"))


def drawn(seed):
    """All lines that can be broken, in random order, each with one change at random."""
    lines = [(path, number, line) for path in sources()
             for number, line in enumerate(path.read_text().split("\n"), 1)
             if is_code(line) and any(True for _ in changes_of(line))]
    dice = random.Random(seed)
    dice.shuffle(lines)
    for path, number, line in lines:
        yield path, number, line, dice.choice(sorted(set(changes_of(line))))


def listed(path):
    """The lines of a file; the line is None where the text is not there any more."""
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            source = ROOT / row["file"]
            lines = source.read_text().split("\n") if source.exists() else []
            places = [i for i, line in enumerate(lines, 1) if row["was"] in line]
            if not places:
                yield source, int(row["line"]), None, row["was"]
                continue
            number = min(places, key=lambda i: abs(i - int(row["line"])))
            line = lines[number - 1]
            yield source, number, line, line.replace(row["was"], row["became"], 1)


class Limits:
    """Of time and memory, for the process that is about to start."""

    def __init__(self, seconds):
        self.seconds = int(seconds)

    def __call__(self):
        resource.setrlimit(resource.RLIMIT_CPU, (self.seconds, self.seconds))
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class Tests:
    """The tests of a build tree: what they run, how long they take on the unbroken program."""

    def __init__(self, build):
        self.build = build
        self.known = build / "mutation.json"
        self.passed = json.loads(self.known.read_text()) if self.known.exists() else {}
        self.commands = {}

    @staticmethod
    def targets(test):
        if test in OTHER_PROGRAMS:
            return OTHER_PROGRAMS[test][0]
        return ("vdwmesh" if test.startswith("cli.") else test.replace("fuzz.", "fuzz_"),)

    def make(self, tests):
        targets = sorted({target for test in tests for target in self.targets(test)})
        return subprocess.run(["ninja", "-C", self.build, *targets], capture_output=True, text=True).returncode == 0

    def read_commands(self):
        """From ctest, which knows a command only once its program is built."""
        text = subprocess.run(["ctest", "--test-dir", self.build, "--show-only=json-v1"],
                              capture_output=True, text=True, check=True).stdout
        for test in json.loads(text)["tests"]:
            properties = {p["name"]: p["value"] for p in test.get("properties", [])}
            environment = dict(v.split("=", 1) for v in properties.get("ENVIRONMENT", []))
            self.commands[test["name"]] = (test.get("command"), environment, properties.get("WORKING_DIRECTORY"))

    def digest(self, test):
        command, environment, _ = self.commands[test]
        variable = OTHER_PROGRAMS[test][1] if test in OTHER_PROGRAMS else "VDWMESH_PROGRAM"
        return hashlib.sha256(pathlib.Path(environment.get(variable, command[0])).read_bytes()).hexdigest()

    def run(self, test, cpu_seconds):
        """(what failed, or nothing; seconds of CPU time)"""
        command, environment, folder = self.commands[test]
        fast = ["-f"] if test.startswith("cli.") else ["--gtest_fail_fast", "--gtest_brief=1"]
        fast = [] if test.startswith("fuzz.") else fast
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        process = subprocess.Popen(command + fast, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                   errors="replace", env=os.environ | environment, cwd=folder,
                                   start_new_session=True, preexec_fn=Limits(cpu_seconds))
        try:
            output, _ = process.communicate(timeout=30 * cpu_seconds)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return f"{test}: no end", 0
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        if process.returncode == 0:
            return "", spent
        failed = re.search(r"\[  FAILED  \] (\S+?),? |^(?:FAIL|ERROR): (\w+)", output, re.M)
        name = next(filter(None, failed.groups()), "") if failed else process.returncode
        return f"{test}: {name}", spent

    def prepare(self, tests):
        """Builds and runs what is not known to pass."""
        if not self.make(tests):
            sys.exit("mutate: the unbroken sources do not build")
        self.read_commands()
        for test in tests:
            digest = self.digest(test)
            if self.passed.get(test, {}).get("digest") == digest:
                continue
            failed, seconds = self.run(test, 1200)
            if failed:
                sys.exit(f"mutate: fails on the unbroken sources: {failed}")
            self.passed[test] = {"digest": digest, "seconds": seconds}
            self.known.write_text(json.dumps(self.passed, indent=1))

    def outcome(self, tests):
        changed = False
        for test in tests:
            if not self.make([test]):
                return "no mutant", "does not compile"
            if self.digest(test) == self.passed[test]["digest"]:
                continue
            changed = True
            failed, _ = self.run(test, 10 + 3 * self.passed[test]["seconds"])
            if failed:
                return "killed", failed
        return ("survived", "") if changed else ("equivalent", "no program changed")


def tests_for(path, options):
    names = TESTS[room_of(path)]
    return [name for name in names if name in options.tests.split(",")] if options.tests else names


def judge(tests, names, path, number, line, broken):
    if line is None:
        return "gone", ""
    original = path.read_text()
    text = original.split("\n")
    text[number - 1] = broken
    try:
        path.write_text("\n".join(text))
        return tests.outcome(names)
    finally:
        path.write_text(original)


def chosen(options):
    mutants = listed(options.lines) if options.lines else drawn(options.seed)
    for index, mutant in enumerate(mutants):
        in_room = not options.rooms or room_of(mutant[0]) in options.rooms.split(",")
        if index >= options.first and in_room and tests_for(mutant[0], options):
            yield index, *mutant


def end(number, _):
    """The broken file is put back where the program is asked to end, too."""
    sys.exit(128 + number)


def main():
    signal.signal(signal.SIGTERM, end)
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("action", choices=("list", "run"))
    parser.add_argument("build", nargs="?", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=17)
    parser.add_argument("--count", type=int, default=120)
    parser.add_argument("--first", type=int, default=0, help="mutants to pass over")
    parser.add_argument("--rooms", help="of these rooms alone: core,apps,…")
    parser.add_argument("--tests", help="these tests alone: core_test,cli.options,…")
    parser.add_argument("--lines", help="a CSV of lines in place of drawn ones")
    parser.add_argument("--log", type=argparse.FileType("a"), default=sys.stdout)
    options = parser.parse_args()
    if options.action == "run" and options.build is None:
        parser.error("run needs BUILD")
    table = csv.writer(options.log)
    table.writerow(COLUMNS)
    tests = Tests(options.build.resolve()) if options.action == "run" else None
    left = options.count
    for index, path, number, line, broken in chosen(options):
        if left == 0:
            break
        row = [index, path.relative_to(ROOT), number, (line or "").strip(), broken.strip()]
        if tests:
            names = tests_for(path, options)
            tests.prepare(names)
            start = time.monotonic()
            row += [*judge(tests, names, path, number, line, broken), round(time.monotonic() - start)]
        table.writerow(row)
        options.log.flush()
        left -= "no mutant" not in row


if __name__ == "__main__":
    main()
