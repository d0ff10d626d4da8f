"""Runs the program with the loops that the processor chooses and the one with plain loops alone.

    compare_hashes.py CHOSEN PLAIN SOURCE...

Each prints which loops it has, and then a line of hashes for every result. The lines must be equal.
SOURCE: the files compiled into PLAIN; every file of the project that has two versions of its loops
must be among them, whether it says so itself or by a header. Left out is what several processes make together:
it needs MPI, and cli.ranks compares their files with those of one process, byte by byte.
"""

import pathlib
import re
import subprocess
import sys

DONE, FAILED, SKIPPED = 0, 1, 77


SRC = pathlib.Path(__file__).resolve().parents[2] / "src"
MARK = SRC / "core" / "lanes" / "multiversion.hpp"


def has_two_versions(file):
    """Whether a file of the project includes the mark, however far down."""
    seen, open_files = set(), {file}
    while open_files:
        seen |= open_files
        names = {n for f in open_files for n in re.findall(r'^#include "(.+)"', f.read_text(), re.M)}
        open_files = {SRC / name for name in names if (SRC / name).exists()} - seen
    return MARK in seen


def forgotten(sources):
    given = {pathlib.Path(source).resolve() for source in sources}
    files = (file for file in SRC.rglob("*.cpp") if SRC / "distributed" not in file.parents)
    marked = (file for file in files if has_two_versions(file))
    return sorted(str(file.relative_to(SRC)) for file in marked if file not in given)


def main(chosen, plain, *sources):
    if not MARK.exists():
        print("no file", MARK)
        return FAILED
    if missing := forgotten(sources):
        print("not compiled in their plain version:", ", ".join(missing))
        return FAILED
    outputs = [
        subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()
        for program in (chosen, plain)
    ]
    loops, plain_loops = (lines[0] for lines in outputs)
    if plain_loops != "baseline":
        print("the plain program says that it has the loops of", plain_loops)
        return FAILED
    if loops == plain_loops:
        print("skipped: this processor or compiler has the plain loops only")
        return SKIPPED
    differing = [pair for pair in zip(*outputs) if pair[0] != pair[1]][1:]
    for line, plain_line in differing:
        print(f"{loops}: {line}\nbaseline: {plain_line}")
    print(f"{len(outputs[0]) - 1} results, {len(differing)} differ")
    same = len(outputs[0]) == len(outputs[1]) > 1 and not differing
    return DONE if same else FAILED


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
