"""Counts the instructions of the hot loops and compares them with those recorded.

    compare_counts.py HOT_LOOPS RECORDED.json [--record]

Instruction counts repeat where times do not. They are those of one compiler, C library and version
of the loops (core/lanes/multiversion.hpp), so RECORDED.json is a list with an entry for each of these. With a
compiler that has no entry nothing can be compared: the test is skipped and says so, which is a failure
where skips are checked (tests/check_skips.py), until --record has added an entry. A loop that takes over
5 % more than recorded is a failure; one that takes less is named, so that its gain can be recorded.
--record writes the counts found in place of those of the same compiler, or beside those of others.
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


def replaced(entries, found):
    """The entries with `found` in place of the one of the same machine, or behind the others."""
    others = [entry for entry in entries if entry["machine"] != found["machine"]]
    return sorted([*others, found], key=lambda entry: sorted(entry["machine"].items()))


def main(program, path, *flags):
    if not shutil.which("valgrind") or not shutil.which("readelf"):
        print("skipped: valgrind or readelf is not on this machine")
        return SKIPPED
    path = pathlib.Path(path)
    found = count(program)
    if not found["instructions"]:
        print("no loop was counted")
        return FAILED
    entries = json.loads(path.read_text()) if path.exists() else []
    if "--record" in flags:
        path.write_text(json.dumps(replaced(entries, found), indent=2) + "\n")
        return DONE
    recorded = [entry for entry in entries if entry["machine"] == found["machine"]]
    if not recorded:
        known = "; ".join(", ".join(entry["machine"].values()) for entry in entries)
        print(f"skipped: no counts of {', '.join(found['machine'].values())} are recorded, but of {known}")
        print(f"record them: compare_counts.py {program} {path} --record")
        return SKIPPED
    grown, strange = compare(found["instructions"], recorded[0]["instructions"])
    if strange:
        print("recorded or counted, but not both:", ", ".join(strange))
    if grown:
        print("more than 5 % over the recorded count:", ", ".join(grown))
    if grown or strange:
        print(f"if that is meant: compare_counts.py {program} {path} --record")
    return FAILED if grown or strange else DONE


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
