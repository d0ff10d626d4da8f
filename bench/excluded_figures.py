"""The exact measures of the excluded surface: every figure that is wanted of them, beside what was measured.

    python3 bench/excluded_figures.py PROGRAM [--reference DIR] [--tests DIR] [--runs 5] [--threads 2]

PROGRAM is the built vdwmesh, DIR of --reference has the table `excluded_surface.csv` and its sets, by default
../shared/reference. --tests is the folder of `excluded_measures_contract_test`: with it three balls, grid counting,
degenerate sets and the convex hull are judged too, whose references are in `tests/reference/`. Times are by the
program's own clock, the least of the runs; they mean something on quiet cores alone.
"""

import argparse
import csv
import gzip
import json
import math
import pathlib
import subprocess
import tempfile

from figures import Figures

# Rows in which the table has an angle of a concave patch wrong (docs/excluded_surface.md).
WRONG_IN_TABLE = {("1F2N", 0.7), ("1IZH", 0.7)}
AREAS = {"area_A2": "area", "volume_A3": "volume", "contact_area_A2": "contact_area", "toroidal_area_A2": "saddle_area",
         "concave_area_A2": "concave_area"}  # fmt: skip
COUNTS = {"arcs": "arcs", "full_tori": "whole_rings", "spindle_tori": "spindle_saddles", "probe_positions": "probes",
          "low_probes": "low_probes"}  # fmt: skip

# What the tests of the contract judge, by the references that they share no formula with.
TESTS = {
    "three balls, mirror probes, quadrature": "ExcludedAnalytic.Three*:ExcludedAnalytic.Mirror*",
    "cages with crowded probes, quadrature": "ExcludedAnalytic.Cages*:ExcludedAnalytic.TheOutsideOfCages",
    "grid counting, 12 molecules, to 1e-4": "*ExcludedMolecules.CountingFindsTheSame*",
    "27 symmetric sets": "*ExcludedDegenerate.EverythingAgrees*",
    "the same moved by 1e-7 … 1e-12 Å": "*ExcludedDegenerate.MovedByAHair*",
    "large probes: the convex hull": "ExcludedInvariants.ALargeProbeTendsToTheConvexHull",
}


class Program:
    def __init__(self, path, reference, threads):
        self.path, self.reference, self.threads = path, reference, threads
        self.folder = tempfile.TemporaryDirectory()

    def exact(self, atoms, *options):
        """The report of `vdwmesh exact` on a file."""
        document = pathlib.Path(self.folder.name) / "exact.json"
        command = [self.path, "exact", atoms, "--threads", str(self.threads), "--json", document, *options]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return json.loads(document.read_text())

    def excluded(self, atoms, probe, *options):
        return self.exact(atoms, "--surface", "excluded", "--probe", str(probe), *options)["excluded"]["complete"]

    def file(self, spheres):
        path = pathlib.Path(self.folder.name) / "atoms.xyzr"
        path.write_text("".join("{!r} {!r} {!r} {!r}\n".format(*sphere) for sphere in spheres))
        return path

    def molecule(self, name):
        plain = self.reference / f"{name}.xyzr"
        if plain.exists():
            return plain
        path = pathlib.Path(self.folder.name) / f"{name}.xyzr"
        path.write_bytes(gzip.decompress((self.reference / f"{name}.xyzr.gz").read_bytes()))
        return path


def relative(found, expected):
    return abs(found / expected - 1) if expected else abs(found)


def table_rows(program, figures):
    with (program.reference / "excluded_surface.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    worst, closure, wrong_counts, uncertified = {name: 0.0 for name in AREAS}, 0.0, 0, 0
    for row in rows:
        name, probe = row["set"], float(row["probe"])
        found = program.excluded(program.molecule(name), probe)
        closure = max(closure, found["closure"])
        uncertified += found["uncertified_patches"]
        counts = {**found, **found["counts"]}
        wrong_counts += any(counts[ours] != int(row[theirs]) for theirs, ours in COUNTS.items())
        if (name, probe) in WRONG_IN_TABLE:
            continue
        for theirs, ours in AREAS.items():
            # Of the whole, because the table has nine digits behind the point, and parts may be 0.
            rounding = 5e-10 / float(row["area_A2"])
            scale = float(row["volume_A3"] if "volume" in theirs else row["area_A2"])
            off = abs(found[ours] - float(row[theirs])) / scale
            worst[theirs] = max(worst[theirs], off - rounding)
    for theirs, ours in AREAS.items():
        figures.add(f"table, {len(rows)} rows, {ours}", worst[theirs], "of whole", at_most=1e-10)
    figures.add("table, rows with other counts", wrong_counts, "rows", at_most=0)
    figures.add("table, |∫ n dA| / area", closure, "", at_most=1e-12)
    figures.add("table, uncertified patches", uncertified, "", at_most=0)


def invariants(program, figures):
    moved = sums = 0.0
    for name in ("1CRN", "1UBQ", "4HHB"):
        path = program.molecule(name)
        table = pathlib.Path(program.folder.name) / "atoms.csv"
        found = program.excluded(path, 1.4, "--per-atom", table)
        spheres = [tuple(map(float, line.split()[:4])) for line in path.read_text().splitlines() if line.strip()]
        there = program.excluded(program.file([(x + 100, y - 100, z + 100, r) for x, y, z, r in spheres]), 1.4)
        moved = max(moved, relative(there["volume"], found["volume"]))
        with table.open(newline="") as file:
            shares = list(csv.DictReader(file))
        for column, name_of_total in (("excluded_area", "area"), ("excluded_volume", "volume"),
                                      ("contact_area", "contact_area"), ("saddle_area", "saddle_area"),
                                      ("concave_area", "concave_area")):  # fmt: skip
            sums = max(sums, relative(math.fsum(float(share[column]) for share in shares), found[name_of_total]))
    figures.add("origin moved by 100 Å along each axis, volume", moved, "relative", at_most=1e-12)
    figures.add("shares of atoms less totals", sums, "relative", at_most=1e-12)


def two_balls(radius, apart, probe):
    """Area and volume of the excluded surface of two equal balls, by Pappus' theorems: a ring, or two drops."""
    half = apart / 2
    ring = math.sqrt((radius + probe) ** 2 - half**2)
    end = math.atan2(half, ring)
    start = math.acos(ring / probe) if ring < probe else 0.0

    def volume_under(angle):  # between the axis and the probe, from the middle plane: ∫ π (ring - p cos)² p cos
        s, c = math.sin(angle), math.cos(angle)
        cos2, cos3 = (angle + s * c) / 2, s - s**3 / 3
        return math.pi * probe * (ring**2 * s - 2 * ring * probe * cos2 + probe**2 * cos3)

    saddle = 4 * math.pi * probe * (ring * (end - start) - probe * (math.sin(end) - math.sin(start)))
    contact = 4 * math.pi * radius**2 * (1 + half / (radius + probe))
    touch = radius * half / (radius + probe)  # of the atom's centre, towards the middle
    cap = math.pi * (2 * radius**3 / 3 + radius**2 * touch - touch**3 / 3)
    return contact + saddle, 2 * (cap + volume_under(end) - volume_under(start))


def closed_forms(program, figures):
    ball = program.excluded(program.file([(1, 2, 3, 1.7)]), 1.4)
    figures.add("one ball, area", relative(ball["area"], 4 * math.pi * 1.7**2), "relative", at_most=1e-12)
    for name, apart in (("two balls, ring", 3.5), ("two balls, spindle", 5.6)):
        found = program.excluded(program.file([(0, 0, 0, 1.7), (0, 0, apart, 1.7)]), 1.4)
        area, volume = two_balls(1.7, apart, 1.4)
        figures.add(f"{name}, area", relative(found["area"], area), "relative", at_most=1e-12)
        figures.add(f"{name}, volume", relative(found["volume"], volume), "relative", at_most=1e-12)


def small_probes(program, figures):
    """The difference from the union falls with the probe."""
    path = program.molecule("1CRN")
    union = program.exact(path)["exact"]
    off = []
    for probe in (1e-2, 1e-3, 1e-4):
        found = program.excluded(path, probe)
        off.append(max(relative(found[name], union[name]) for name in ("area", "volume")))
    figures.add("1CRN, probe 1e-4 Å less the union", off[-1], "relative", at_most=1e-4)
    figures.add("the same, of what a ten times larger probe has", off[-1] / off[-2], "", at_most=0.2)


def tests(folder, figures):
    program = pathlib.Path(folder) / "excluded_measures_contract_test"
    for name, chosen in TESTS.items():
        done = subprocess.run([program, f"--gtest_filter={chosen}"], capture_output=True, text=True, check=False)
        passed, failed = done.stdout.count("[       OK ]"), done.stdout.count("[  FAILED  ]")
        if passed == 0 and failed == 0:
            figures.left_out(name, "no test of this name ran")
            continue
        figures.add(name, failed, "failed", at_most=0, note=f"{passed} passed")


def speed(program, figures, runs):
    for name, wanted in (("4HHB", 0.15), ("6ZU5", 5.0)):
        path = program.molecule(name)
        options = ("--surface", "excluded", "--topology", "off")
        reports = [program.exact(path, *options) for _ in range(runs)]
        least = min(report["timing"]["exact"] for report in reports)
        figures.add(f"{name}, area and volume, {program.threads} threads", least, "s", at_most=wanted)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    shared = pathlib.Path(__file__).resolve().parents[2] / "shared" / "reference"
    parser.add_argument("--reference", type=pathlib.Path, default=shared)
    parser.add_argument("--tests")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    given = parser.parse_args()
    program = Program(given.program, given.reference, given.threads)
    figures = Figures("exact measures of the excluded surface")
    table_rows(program, figures)
    invariants(program, figures)
    closed_forms(program, figures)
    small_probes(program, figures)
    if given.tests:
        tests(given.tests, figures)
    speed(program, figures, given.runs)
    figures.summary()


if __name__ == "__main__":
    main()
