"""The exact union beside programs that share nothing with it: gudhi for the topology, freesasa and
voronota for areas and volumes atom by atom."""

import csv
import json
import math
import random
import subprocess

from program import ProgramTest, need_package

PROBE = 1.4  # Å


def write_xyzr(path, balls):
    path.write_text("".join(" ".join(map(repr, ball)) + "\n" for ball in balls))


class UnionTest(ProgramTest):
    def exact(self, balls, *arguments):
        """The union's part of the report, and the rows of the table by atom."""
        structure, table, report = (self.folder / name for name in ("u.xyzr", "u.csv", "u.json"))
        write_xyzr(structure, balls)
        self.run_ok("exact", structure, "--per-atom", table, "--json", report, *arguments)
        with table.open(newline="") as file:
            return json.loads(report.read_text())["exact"], list(csv.DictReader(file))


# Coordinates are whole multiples of 1/1024 Å and radii of 1/64 Å, so that every square is exact and
# both programs see the same balls.
def dyadic(value, steps):
    return round(value * steps) / steps


def ball(point, radius):
    return (*(dyadic(x, 1024) for x in point), max(1, round(radius * 64)) / 64)


def gas(rng):
    half = rng.uniform(3, 12)
    return [ball([rng.uniform(-half, half) for _ in range(3)], rng.uniform(0.3, 3))
            for _ in range(rng.randint(1, 60))]


def heap(rng):
    return [ball([rng.uniform(-3, 3) for _ in range(3)], rng.uniform(0.5, 1.2))
            for _ in range(rng.randint(20, 120))]


def direction(rng):
    while True:
        v = [rng.gauss(0, 1) for _ in range(3)]
        length = math.hypot(*v)
        if length > 0.1:
            return [x / length for x in v]


def bubble(rng):
    """Balls on a sphere: one shell with a void where they close it, tunnels where they do not."""
    size = rng.uniform(3, 5)
    return [ball([size * x for x in direction(rng)], rng.uniform(1, 2))
            for _ in range(rng.randint(60, 200))]


def ring(rng):
    """A necklace of pearls, two of them at times."""
    balls = []
    for tilt in range(rng.randint(1, 2)):
        size, count = rng.uniform(3, 6), rng.randint(8, 30)
        for i in range(count):
            turn = 2 * math.pi * (i + rng.uniform(-0.1, 0.1)) / count
            x, y = size * math.cos(turn), size * math.sin(turn)
            point = [x, y, 0] if tilt == 0 else [x + size, 0, y]
            balls.append(ball(point, rng.uniform(0.6, 1.4)))
    return balls


class Topology(UnionTest):
    SETS_PER_FAMILY = 30

    def betti(self, gudhi, balls):
        """Betti numbers of the weighted alpha complex at 0, which is homotopic to the union."""
        complex_ = gudhi.AlphaComplex(
            points=[b[:3] for b in balls], weights=[b[3] ** 2 for b in balls], precision="exact"
        ).create_simplex_tree()
        complex_.prune_above_filtration(0)
        complex_.compute_persistence(homology_coeff_field=2, persistence_dim_max=True)
        numbers = complex_.betti_numbers()
        return tuple((numbers + [0, 0, 0])[:3])

    def test_betti_numbers(self):
        gudhi = need_package("python3-gudhi", module="gudhi")
        seen = [0, 0, 0]
        for family in (gas, heap, bubble, ring):
            for seed in range(self.SETS_PER_FAMILY):
                balls = family(random.Random(seed))
                union, _ = self.exact(balls)
                betti = self.betti(gudhi, balls)
                with self.subTest(family=family.__name__, seed=seed):
                    self.assertEqual(
                        (union["components"], union["tunnels"], union["voids"]), betti
                    )
                seen = [a + b for a, b in zip(seen, betti)]
        for number in seen:  # else there was little to compare
            self.assertGreater(number, self.SETS_PER_FAMILY / 2)


class PerAtom(UnionTest):
    def cluster(self):
        """Coordinates of three decimals, as PDB files hold them; radii that a float holds."""
        rng = random.Random(21)
        return [(*(rng.randint(0, 14000) / 1000 for _ in range(3)), rng.choice((1.25, 1.5, 1.75)))
                for _ in range(300)]

    def test_areas_by_freesasa(self):
        freesasa = need_package("freesasa", program="freesasa")
        balls = self.cluster()
        pdb = self.folder / "u.pdb"
        pdb.write_text("".join(
            f"ATOM  {i:5}  CA  ALA A{i:4}    {x:8.3f}{y:8.3f}{z:8.3f}{r:6.2f}  0.00           C\n"
            for i, (x, y, z, r) in enumerate(balls, 1)
        ))
        output = subprocess.run(
            [freesasa, "--lee-richards", "--resolution=2000", "--radius-from-occupancy",
             f"--probe-radius={PROBE}", "--format=json", "--depth=atom", pdb],
            capture_output=True, text=True, check=True,
        ).stdout
        chain = json.loads(output)["results"][0]["structure"][0]["chains"][0]
        theirs = [atom["area"] for residue in chain["residues"] for atom in residue["atoms"]]
        _, rows = self.exact(balls, "--probe", PROBE)
        self.assertEqual(len(theirs), len(rows))
        # Å². 2000 slices of a ball of up to 3.15 Å are 0.003 Å thick. A circle that begins between
        # two of them costs at most one slice's share of a belt, 2 π r · 0.003 Å / 2, and arcs that
        # open between slices cost far less.
        slice_error = math.pi * (1.75 + PROBE) * (2 * (1.75 + PROBE) / 2000)
        for row, area in zip(rows, theirs):
            self.assertLessEqual(abs(float(row["exact_area"]) - area), slice_error)

    def test_areas_and_volumes_by_voronota(self):
        voronota = need_package("voronota", program="voronota")
        # Of one radius, because voronota divides space by distance to the spheres and not by power.
        balls = [(x, y, z, 1.5) for x, y, z, _ in self.cluster()]
        volumes = self.folder / "volumes"
        contacts = subprocess.run(
            [voronota, "calculate-contacts", "--probe", str(PROBE), "--sih-depth", "5",
             "--projections", "8", "--step", "0.1", "--volumes-output", volumes],
            input="".join(f"{x} {y} {z} {r}\n" for x, y, z, r in balls),
            capture_output=True, text=True, check=True,
        ).stdout
        area, volume = [0.0] * len(balls), [0.0] * len(balls)
        for line in contacts.splitlines():
            a, b, value = line.split()
            if a == b:  # the contact with the solvent
                area[int(a)] = float(value)
        for line in volumes.read_text().splitlines():
            index, value = line.split()
            volume[int(index)] = float(value)
        _, rows = self.exact(balls, "--probe", PROBE)
        # Voronota measures polyhedra: of a sphere after five subdivisions of an icosahedron, whose
        # edges are 2.9 Å · 1.1 / 32 = 0.1 Å, and of contacts with edges of 0.1 Å. Their sagitta is
        # 0.1² / (8 · 2.9) Å, a share of 1.5e-4 of the radius; areas and volumes lose two and three
        # times that share.
        radius, share = 1.5 + PROBE, 1.5e-4
        ball_area, ball_volume = 4 * math.pi * radius**2, 4 / 3 * math.pi * radius**3
        for row, a, v in zip(rows, area, volume):
            self.assertLessEqual(abs(float(row["exact_area"]) - a), 2 * share * ball_area)
            self.assertLessEqual(abs(float(row["exact_volume"]) - v), 3 * share * ball_volume)
