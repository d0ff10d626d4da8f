"""Counts the instructions of the hot loops and compares them with those recorded.

    compare_counts.py HOT_LOOPS RECORDED.json [--record]

Instruction counts repeat where times do not. They are those of one compiler, C++ library and
version of the loops (core/multiversion.hpp): where these differ from the recorded ones nothing can
be compared, and the test is skipped with that reason. A loop that takes over 5 % more than recorded
is a failure; one that takes less is named, so that its gain can be recorded. --record writes the
counts found.
"""

import json
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

MARGIN = 0.05
DONE, FAILED, SKIPPED = 0, 1, 77


def compiler_of(program):
    """As the compiler notes it in the program: 'GCC: (Debian 12.2.0-14) 12.2.0'."""
    dump = subprocess.run(
        ["readelf", "-p", ".comment", program], capture_output=True, text=True, check=True
    )
    notes = re.findall(r"\]\s+(.+)", dump.stdout)
    return "; ".join(sorted(set(notes)))


def count(program):
    """What was measured, and on what."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--quiet", "--tool=callgrind", "--collect-atstart=no",
                   f"--callgrind-out-file={folder}/out", program]  # fmt: skip
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(f"the loops failed under valgrind:\n{run.stdout}{run.stderr}")
        counts = {}
        for path in pathlib.Path(folder).iterdir():
            text = path.read_text()
            name = re.search(r"^desc: Trigger: Client Request: (\S+)", text, re.M)
            # The totals of a dump; "summary" is left out where a dump is one of several.
            total = re.search(r"^(?:totals|summary): (\d+)", text, re.M)
            if name and total:
                counts[name[1]] = int(total[1])
    machine = {
        "compiler": compiler_of(program),
        "libc": " ".join(platform.libc_ver()),
        "loops": run.stdout.strip(),
    }
    return {"machine": machine, "instructions": dict(sorted(counts.items()))}


def compare(found, recorded):
    """Prints a table; the names of loops that grew, and of those that are new or missing."""
    grown, strange = [], sorted(set(found) ^ set(recorded))
    print(f"{'loop':24} {'recorded':>14} {'now':>14} {'ratio':>8}")
    for name in sorted(set(found) & set(recorded)):
        ratio = found[name] / recorded[name]
        verdict = ""
        if ratio > 1 + MARGIN:
            verdict = "  more than allowed"
            grown.append(name)
        elif ratio < 1 - MARGIN:
            verdict = "  less: record it"
        print(f"{name:24} {recorded[name]:14} {found[name]:14} {ratio:8.3f}{verdict}")
    return grown, strange


def main(program, path, *flags):
    if not shutil.which("valgrind") or not shutil.which("readelf"):
        print("skipped: valgrind or readelf is not on this machine")
        return SKIPPED
    path = pathlib.Path(path)
    found = count(program)
    if not found["instructions"]:
        print("no loop was counted")
        return FAILED
    if "--record" in flags:
        path.write_text(json.dumps(found, indent=2) + "\n")
        return DONE
    recorded = json.loads(path.read_text())
    if found["machine"] != recorded["machine"]:
        print(f"skipped: recorded with {recorded['machine']}, this is {found['machine']}")
        return SKIPPED
    grown, strange = compare(found["instructions"], recorded["instructions"])
    if strange:
        print("recorded or counted, but not both:", ", ".join(strange))
    if grown:
        print("more than 5 % over the recorded count:", ", ".join(grown))
    if grown or strange:
        print(f"if that is meant: compare_counts.py {program} {path} --record")
    return FAILED if grown or strange else DONE


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
