"""Exact measures of the excluded surface of symmetric sets, in place and with atoms moved by a hair, as a table.

    python3 bench/excluded_moved_sets.py PROGRAM [--moves 1e-12,1e-9] [--sets BEGIN] [--threads 1]

PROGRAM is the built vdwmesh. 17 sets, three probes, seven moves: 357 in all, ten CPU seconds. A row for each move:
how many sets were measured, refused, not certified or had a tie, and the largest change of area and volume,
relative to the set in place. The moves are seeded, so every run measures the same sets (docs/excluded_surface.md).
"""

import argparse
import collections
import dataclasses
import itertools
import json
import math
import pathlib
import random
import subprocess
import tempfile

PROBES = (0.7, 1.4, 3.0)  # Å
MOVES = (0, 1e-12, 1e-11, 3e-11, 1e-10, 1e-9, 1e-7)  # Å


def fullerene(bond):
    """Buckminsterfullerene: ± and cyclic orders of three points, for bonds of 2."""
    phi = (1 + math.sqrt(5)) / 2
    corners = set()
    for point in ((0, 1, 3 * phi), (1, 2 + phi, 2 * phi), (phi, 2, 2 * phi + 1)):
        for signs in itertools.product((1, -1), repeat=3):
            x, y, z = (round(sign * value, 12) + 0.0 for sign, value in zip(signs, point))
            corners.update(((x, y, z), (y, z, x), (z, x, y)))
    return [tuple(value * bond / 2 for value in corner) for corner in sorted(corners)]


def cubic(side, edge):
    return [tuple(edge * i for i in place) for place in itertools.product(range(side), repeat=3)]


def cubic_cage(side, edge):
    return [tuple(edge * i for i in place) for place in itertools.product(range(side), repeat=3)
            if min(place) == 0 or max(place) == side - 1]  # fmt: skip


def face_centred(side, edge):
    middles = ((0, 0, 0), (0, 0.5, 0.5), (0.5, 0, 0.5), (0.5, 0.5, 0))
    return [tuple(edge * (i + half) for i, half in zip(place, middle))
            for place in itertools.product(range(side), repeat=3) for middle in middles]  # fmt: skip


def rings(count, apart):
    """Carbon atoms of benzene above each other."""
    turns = [math.pi * i / 3 for i in range(6)]
    return [(1.39 * math.cos(turn), 1.39 * math.sin(turn), apart * k) for k in range(count) for turn in turns]


SETS = {
    "fullerene, bonds of 1.4": (fullerene(1.4), (1.7, 1.5, 1.0, 0.8)),
    "fullerene, bonds of 1.45": (fullerene(1.45), (1.7, 1.2, 0.75)),
    "cubic lattice": (cubic(4, 3.0), (1.7, 1.4)),
    "cubic cage": (cubic_cage(5, 2.5), (1.7, 1.3)),
    "face-centred lattice": (face_centred(3, 4.0), (1.6, 1.35)),
    "rings 3.4 apart": (rings(5, 3.4), (1.7, 1.5)),
    "rings 2.8 apart": (rings(5, 2.8), (1.7, 1.4)),
}


@dataclasses.dataclass
class Row:
    sets: int = 0
    refused: int = 0
    uncertified: int = 0
    ties: int = 0
    area: float = 0.0  # largest relative change
    volume: float = 0.0


class Survey:
    def __init__(self, given, folder):
        self.given, self.folder = given, pathlib.Path(folder)
        self.rows = collections.defaultdict(Row)
        self.random = random.Random(5)

    def measured(self, centers, radius, probe):
        """The complete surface by the program, or None if it refuses the set."""
        atoms, report = self.folder / "atoms.xyzr", self.folder / "report.json"
        atoms.write_text("".join("{!r} {!r} {!r} {!r}\n".format(*center, radius) for center in centers))
        command = [self.given.program, "exact", atoms, "--surface", "excluded", "--probe", str(probe), "--json", report,
                   "--threads", str(self.given.threads)]  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            print(done.stderr.strip())
            return None
        return json.loads(report.read_text())["excluded"]["complete"]

    def moved(self, centers, move):
        return [tuple(x + move * self.random.uniform(-1, 1) for x in center) for center in centers]

    def add(self, move, found, in_place):
        row = self.rows[move]
        row.sets += 1
        if found is None:
            row.refused += 1
            return
        row.uncertified += found["uncertified_patches"] > 0
        row.ties += found["ties"] > 0
        if in_place is not None:
            row.area = max(row.area, abs(found["area"] / in_place["area"] - 1))
            row.volume = max(row.volume, abs(found["volume"] / in_place["volume"] - 1))

    def run(self):
        for name, (centers, radii) in SETS.items():
            for radius, probe in itertools.product(radii, PROBES):
                # Moves are drawn for all, so that a set has the same ones whatever is chosen.
                places = {move: self.moved(centers, move) for move in MOVES}
                if not name.startswith(self.given.sets):
                    continue
                in_place = self.measured(places[0], radius, probe)
                for move in self.given.moves:
                    self.add(move, self.measured(places[move], radius, probe) if move else in_place, in_place)

    def print_table(self):
        print("| moved by, Å | sets | refused | not certified | with ties | area | volume |\n|---|---|---|---|---|---|---|")
        for move, row in self.rows.items():
            print(f"| {move:g} | {row.sets} | {row.refused} | {row.uncertified} | {row.ties} | {row.area:.1e} "
                  f"| {row.volume:.1e} |")  # fmt: skip
        print(f"{sum(row.sets for row in self.rows.values())} in all")


def moves(text):
    chosen = [float(one) for one in text.split(",")]
    unknown = [one for one in chosen if one not in MOVES]
    if unknown:
        raise argparse.ArgumentTypeError(f"{unknown[0]:g} is none of {', '.join(f'{one:g}' for one in MOVES)}")
    return chosen


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--moves", type=moves, default=MOVES)
    parser.add_argument("--sets", default="", help=f"those whose names begin so: {', '.join(SETS)}")
    parser.add_argument("--threads", type=int, default=1)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        survey = Survey(given, folder)
        survey.run()
    survey.print_table()


if __name__ == "__main__":
    main()
