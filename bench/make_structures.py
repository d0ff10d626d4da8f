#!/usr/bin/env python3
"""Makes a folder of structures for `vdwmesh batch`, always the same: runs of whole residues of the given
PDB files, turned at random, with 1,000 to 5,000 atoms each.

    bench/make_structures.py FOLDER COUNT FILE.pdb...
    bench/make_structures.py --complexes RESIDUES FOLDER COUNT FILE.pdb...

With --complexes each is the RESIDUES residues nearest to a random one of a file with several chains, which
keep their chains.
"""

import itertools
import math
import pathlib
import random
import sys

LEAST, MOST = 1000, 5000  # atoms


def residues_of(path):
    """The ATOM records of the first model, grouped by residue."""
    lines = itertools.takewhile(lambda line: not line.startswith("ENDMDL"),
                                path.read_text().splitlines())
    atoms = (line for line in lines if line.startswith("ATOM"))
    return [list(group) for _, group in itertools.groupby(atoms, lambda line: line[17:27])]


def random_rotation(dice):
    """Rows of the matrix of a random unit quaternion."""
    w, x, y, z = (dice.gauss(0, 1) for _ in range(4))
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))


def place_of(line):
    return [float(line[begin : begin + 8]) for begin in (30, 38, 46)]


def turned(line, rotation):
    place = place_of(line)
    moved = (sum(a * b for a, b in zip(row, place)) for row in rotation)
    return line[:30] + "".join(f"{coordinate:8.3f}" for coordinate in moved) + line[54:]


def run_of(residues, dice):
    """Lines of a run of residues that may begin anywhere and goes on at the first behind the last."""
    wanted = dice.randint(LEAST, min(MOST, sum(map(len, residues))))
    first = dice.randrange(len(residues))
    lines = []
    for residue in residues[first:] + residues[:first]:
        if len(lines) + len(residue) > wanted and len(lines) >= LEAST:
            break
        lines += residue
    return lines


def nearest_to_one(residues, count, dice):
    """Lines of the residues whose first atoms are nearest to that of a random one, in the order of the file."""
    places = [place_of(residue[0]) for residue in residues]
    centre = dice.choice(places)
    near = sorted(range(len(residues)), key=lambda i: math.dist(places[i], centre))[:count]
    return [line for i in sorted(near) for line in residues[i]]


def main():
    arguments = sys.argv[1:]
    complexes = 0
    if arguments[0] == "--complexes":
        complexes, arguments = int(arguments[1]), arguments[2:]
    folder, count = pathlib.Path(arguments[0]), int(arguments[1])
    dice = random.Random("structures")
    sources = [residues_of(pathlib.Path(name)) for name in arguments[2:]]
    sources = [s for s in sources if len(s) >= complexes and sum(map(len, s)) >= LEAST]
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(count):
        residues = dice.choice(sources)
        lines = nearest_to_one(residues, complexes, dice) if complexes else run_of(residues, dice)
        rotation = random_rotation(dice)
        text = "\n".join([*(turned(line, rotation) for line in lines), "END", ""])
        (folder / f"s{number:05}.pdb").write_text(text)


main()
