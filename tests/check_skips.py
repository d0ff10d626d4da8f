#!/usr/bin/env python3
"""Fails where tests vanished: a skip that nobody allowed, a program without tests, a disabled test.

    check_skips.py RESULTS.xml [ALLOWED.csv]

RESULTS.xml is what `ctest --output-junit` wrote, with the whole output of every test
(`--test-output-size-passed`, `--test-output-size-failed`), because a test of ctest is a whole
program here and its skips stand in its output. ALLOWED.csv, tests/allowed_skips.csv unless named,
has three columns: the test as `ctest name/test name`, the message of the skip, both patterns of
Python's fnmatch, and the reason why the skip is allowed.
"""

import collections
import csv
import fnmatch
import pathlib
import re
import sys
import xml.etree.ElementTree

ALLOWED = pathlib.Path(__file__).resolve().with_name("allowed_skips.csv")

Skip = collections.namedtuple("Skip", "test message")

# GoogleTest writes the message after the place of the skip, and the name once the test has ended.
GOOGLE_MESSAGE = re.compile(r"^[^\n]+:\d+: Skipped\n(.*?)\n\n?(?=\[|[^\n]+:\d+: )", re.M | re.S)
GOOGLE_TEST = re.compile(r"^\[ RUN      \] (\S+)\n(.*?)^\[  SKIPPED \] \1 \(", re.M | re.S)
# Python's unittest -v: "test_x (module.Class.test_x) ... skipped 'why'". A line of documentation may
# stand between the name and the dots. A whole class that skips is "setUpClass (module.Class)".
# A part of a test (subTest) is indented and names its parameters.
PYTHON_TEST = re.compile(
    r"^ *(\w+) \(([\w.]+)\)(?: [\[(][^\n]*?)?(?:\n[^\n]*?)? \.\.\. skipped (['\"])(.*)\3$", re.M)
# What the two say at the end, against which the number of skips found is checked.
COUNTS = re.compile(r"^\[  SKIPPED \] (\d+) tests?, listed below|^(?:OK|FAILED) \(.*skipped=(\d+)", re.M)
EMPTY = re.compile(r"^\[==========\] Running 0 tests|^Ran 0 tests in", re.M)
DISABLED = re.compile(r"^  YOU HAVE \d+ DISABLED TESTS?$", re.M)


def named_skips(output):
    for name, text in GOOGLE_TEST.findall(output):
        message = GOOGLE_MESSAGE.search(text + "[")
        yield Skip(name, message[1] if message else "")
    for name, place, _, message in PYTHON_TEST.findall(output):
        # Python 3.11 repeats the name of the test behind its class.
        yield Skip(place if place.endswith("." + name) else f"{place}.{name}", message)


def skips_in(output):
    """Every skip that the output of GoogleTest or of unittest tells of."""
    named = list(named_skips(output))
    yield from named
    told = sum(int(a or b) for a, b in COUNTS.findall(output))
    if told != len(named):
        yield Skip("", f"its output counts {told} skips and names {len(named)}")
    if EMPTY.search(output):
        yield Skip("", "no tests in it")
    if DISABLED.search(output):
        yield Skip("", "tests in it are disabled")


def skips_of(results):
    """Every skip of a run, over the tests that ran and those that did not."""
    for case in xml.etree.ElementTree.parse(results).getroot().iter("testcase"):
        name, output = case.get("name"), case.findtext("system-out") or ""
        if case.get("status") in ("notrun", "disabled"):
            skipped = case.find("skipped")
            message = skipped.get("message", "") if skipped is not None else ""
            yield Skip(name, " ".join([message, *output.split()]).strip() or case.get("status"))
        for skip in skips_in(output):
            yield Skip(f"{name}/{skip.test}" if skip.test else name, skip.message)


def read_allowed(path):
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        if not all(row.get(column) for column in ("test", "message", "reason")):
            sys.exit(f"{path}: a row without test, message or reason: {row}")
    return rows


def is_allowed(skip, allowed):
    return any(fnmatch.fnmatchcase(skip.test, row["test"])
               and fnmatch.fnmatchcase(skip.message, row["message"]) for row in allowed)


def main(results, allowed=ALLOWED):
    allowed = pathlib.Path(allowed)
    rows = read_allowed(allowed)
    skips = list(skips_of(results))
    wrong = [skip for skip in skips if not is_allowed(skip, rows)]
    for skip in wrong:
        message = " ".join(skip.message.split())
        print(f"check_skips: {skip.test} skipped, which {allowed.name} does not allow: {message}")
    print(f"check_skips: {len(skips)} skips, {len(wrong)} of them not allowed")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
