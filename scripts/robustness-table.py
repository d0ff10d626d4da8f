#!/usr/bin/env python3
"""Writes the tables of docs/notes/robustness.md anew: what the program makes of every damaged file of
tests/cli/bad, and of the odd files of ../shared where they are.

    scripts/robustness-table.py [PROGRAM]     default: build/release/apps/vdwmesh
"""

import collections
import os
import pathlib
import re
import sys
import tempfile

SOURCE_DIR = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else SOURCE_DIR / "build/release/apps/vdwmesh"
os.environ["VDWMESH_PROGRAM"] = str(pathlib.Path(PROGRAM).resolve())
os.environ["VDWMESH_SOURCE_DIR"] = str(SOURCE_DIR)
sys.path.insert(0, str(SOURCE_DIR / "tests" / "cli"))

import program  # noqa: E402
from bad import binary, meshes, outcome, structures  # noqa: E402

DOCUMENT = SOURCE_DIR / "docs" / "notes" / "robustness.md"
LONGEST = 170  # letters of a message


def run(case, arguments, folder):
    path = folder / case.name
    path.write_bytes(case.data)
    result = outcome.run_bounded(arguments(path), folder, path)
    path.unlink()
    return result.code, result.described(path), result.problems


def grouped(cases, arguments, folder):
    """(damage, code, message) -> formats, in the order of first appearance."""
    rows, problems = collections.OrderedDict(), 0
    for case in cases:
        code, message, found = run(case, arguments, folder)
        problems += len(found)
        # Positions in the file differ with its format; one of them stands for all.
        blurred = re.sub(r"\d+", "0", message)
        formats, shown = rows.setdefault((case.damage, code, blurred), ([], message))
        if case.format not in formats:
            formats.append(case.format)
    return rows, problems


def table(rows):
    lines = ["| damage | of | exit | what is said |", "|---|---|---|---|"]
    for (damage, code, _), (formats, message) in sorted(rows.items(), key=lambda row: row[0][0]):
        if len(message) > LONGEST:
            message = message[:LONGEST] + " …"
        message = message.replace("|", "\\|").replace("<", "&lt;")
        lines.append(f"| {damage} | {' '.join(formats)} | {code} | {message} |")
    return lines


def odd_table(folder):
    odd = program.SHARED_DIR / "molecules" / "odd"
    lines = ["| file | exit | atoms used of read | what is said |", "|---|---|---|---|"]
    problems = count = 0
    for path in sorted(odd.iterdir()) if odd.is_dir() else []:
        result = outcome.run_bounded(("report", path, "--subdivide", "0"), folder, path)
        problems += len(result.problems)
        count += 1
        atoms = ""
        if result.report:
            account = result.report["input"]
            skipped = ", ".join(f"{n} {why}".replace("_", " ") for why, n in account["skipped"].items())
            atoms = f"{account['atoms_used']} of {account['atoms_read']}"
            atoms += f" ({skipped})" if skipped else ""
        lines.append(f"| {path.name} | {result.code} | {atoms} | {result.described(path)} |")
    return lines, problems, count


def main():
    sample = structures.Sample((SOURCE_DIR / "data" / "bpti.pdb").read_text())
    plain = [c for e in structures.FORMATS for c in structures.damages(e, sample)]
    plain += binary.damages(sample)
    packed = [c for e in structures.FORMATS for c in structures.packed_damages(e, sample)]
    packed += binary.packed_damages(sample)
    mesh_cases = [c for e in meshes.KINDS for c in meshes.damages(e)]
    report = ("--subdivide", "0", "--spacing", "0.8", "--distances", "off")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        ball = folder / "ball.xyzr"
        ball.write_text("0 0 0 1\n")
        parts, problems = [], 0
        for title, cases, arguments in (
            ("Structure files", plain, lambda path: ("report", path, *report)),
            ("Packed structure files", packed, lambda path: ("report", path, *report)),
            ("Mesh files", mesh_cases, lambda path: ("compare", path, ball, "--samples", "1")),
        ):
            rows, found = grouped(cases, arguments, folder)
            problems += found
            parts += [f"### {title}: {len(cases)}", "", *table(rows), ""]
        lines, found, count = odd_table(folder)
        problems += found
        if count:
            parts += [f"### Odd files of other projects: {count}", "", *lines, ""]
    total = len(plain) + len(packed) + len(mesh_cases)
    summary = f"{total} generated files and {count} odd ones; {problems} broke a rule."
    text = DOCUMENT.read_text()
    head, rest = text.split("<!-- begin of the tables -->")
    tail = rest.split("<!-- end of the tables -->")[1]
    DOCUMENT.write_text(head + "<!-- begin of the tables -->\n" + summary + "\n\n" +
                        "\n".join(parts) + "<!-- end of the tables -->" + tail)
    print(summary)


main()
