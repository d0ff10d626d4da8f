"""Pockets of molecules that are turned at random, beside those of the molecules as they lie in the file.

    PYTHONPATH=build/release/python /usr/bin/python3 bench/pocket_rotations.py FILE... [--rotations 20]

Coordinates are not rounded. A line for each file: atoms; pockets, channels and voids; rotations with the
same pockets: as many, in one order by volume (of equal ones, by atoms), each with its kind, number of mouths and
lining atoms; of these the ones with the same tetrahedra, which symmetry may cut in several ways. A spread
is the greatest less the least figure of a pocket over all rotations, as a share of the figure, or of 1 Å³
(Å², Å) where that is more; the greatest of all pockets is shown. "alone": of volumes, as shares of them.
"""

import argparse
import time

import numpy
import vdwmesh

SEED = 53


def random_rotation(dice):
    axes = numpy.linalg.qr(dice.normal(size=(3, 3)))[0]
    return axes * numpy.linalg.det(axes)


def combinatorics(pocket):
    return pocket.lining, pocket.kind, len(pocket.mouths)


def cells(pocket):
    return pocket.tetrahedra, pocket.sinks, pocket.atoms, sorted(mouth.faces for mouth in pocket.mouths)


def ordered(pockets):
    """By falling volume, where volumes that are equal by symmetry are not told apart by rounding."""
    return sorted(pockets, key=lambda p: (-round(p.volume, 9), p.lining))


def figures(pocket):
    mouths = sum(mouth.area for mouth in pocket.mouths)
    ways = (pocket.depth_probe, pocket.bottleneck_radius)
    return [pocket.volume, pocket.area, mouths, *(0 if radius is None else radius for radius in ways)]


def measure(path, rotations, dice):
    begun = time.process_time()
    molecule = vdwmesh.read(path)
    coords = molecule.coords - molecule.coords.mean(axis=0)
    first = ordered(vdwmesh.pockets(coords, molecule.radii))
    table, cut_alike = [list(map(figures, first))], 0
    for _ in range(rotations):
        turned = ordered(vdwmesh.pockets(coords @ random_rotation(dice).T, molecule.radii))
        if list(map(combinatorics, turned)) == list(map(combinatorics, first)):
            table.append(list(map(figures, turned)))
            cut_alike += list(map(cells, turned)) == list(map(cells, first))
    values = numpy.array(table).reshape(len(table), len(first), 5)
    spread, least = numpy.ptp(values, axis=0), abs(values[0])
    volume, area, mouths, fits, leaves = (spread / numpy.maximum(1, least)).max(axis=0, initial=0)
    alone = (spread[:, 0] / least[:, 0]).max(initial=0)
    kinds = [sum(p.kind == kind for p in first) for kind in ("pocket", "channel", "void")]
    name, seconds = path.split("/")[-1], time.process_time() - begun
    print(
        f"{name:22} {len(coords):5} {kinds[0]:4} {kinds[1]:3} {kinds[2]:3} {len(table) - 1:5}/{rotations} {cut_alike:5}"
        f" {volume:9.1e} {area:9.1e} {mouths:9.1e} {max(fits, leaves):9.1e} {alone:9.1e} {seconds:7.1f}",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("--rotations", type=int, default=20)
    asked = parser.parse_args()
    print(f"{'file':22} atoms  one  2+  no   same   cells    volume      area    mouths     radii     alone   CPU s")
    for path in asked.files:
        measure(path, asked.rotations, numpy.random.default_rng(SEED))


if __name__ == "__main__":
    main()
