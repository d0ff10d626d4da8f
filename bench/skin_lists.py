"""How many balls a search looks at: the cell list beside lists that are kept while atoms move, as a table.

    /usr/bin/python3 bench/skin_lists.py SPHERES.xyzr [PROBE...]

A list that is kept until an atom has moved by S names all pairs whose balls are nearer than 2 S to each other. Means
over the balls, by the definition; the cells are chosen as in src/spheres/cell_list.cpp, for radii within a factor of two.
"""

import sys

import numpy as np

MOVES = (0.1, 0.2, 0.5, 1, 1.5, 2)  # Å


def in_cells(centers, radii):
    """Balls in the cells that a query for one ball looks into, itself included."""
    lower, reach = centers.min(0), radii.max()
    extent, most, width = centers.max(0) - lower, max(4096, 8 * len(radii)), reach
    while (cells := np.floor(extent / width) + 1).prod() > most:
        width *= max(1.01, np.cbrt(cells.prod() / most))
    cells = cells.astype(int)
    counts = np.zeros(cells, int)
    np.add.at(counts, tuple(np.minimum((centers - lower) // width, cells - 1).astype(int).T), 1)
    far = radii[:, None] + reach
    first = np.clip(np.floor((centers - far - lower) / width), 0, cells - 1).astype(int)
    last = np.clip(np.floor((centers + far - lower) / width), 0, cells - 1).astype(int)
    boxes = (tuple(slice(a, b + 1) for a, b in zip(low, high)) for low, high in zip(first, last))
    return sum(counts[box].sum() for box in boxes) / len(radii)


def in_lists(centers, radii):
    """Other balls nearer than each 2 S."""
    found = np.zeros(len(MOVES))
    for center, radius in zip(centers, radii):
        gap = np.sqrt(((centers - center) ** 2).sum(1)) - radii - radius
        found += [np.count_nonzero(gap < 2 * move) - 1 for move in MOVES]
    return found / len(radii)


def main(path, *probes):
    rows = np.loadtxt(path, usecols=(0, 1, 2, 3))
    if rows[:, 3].max() >= 2 * rows[:, 3].min():
        sys.exit("skin_lists: radii within a factor of two are needed")
    print("| probe, Å | cell list | " + " | ".join(f"moved by up to {move:g} Å" for move in MOVES) + " |")
    print("|---" * (len(MOVES) + 2) + "|")
    for probe in map(float, probes or ("0", "1.4")):
        radii = rows[:, 3] + probe
        means = [in_cells(rows[:, :3], radii), *in_lists(rows[:, :3], radii)]
        print(f"| {probe:g} | " + " | ".join(f"{mean:.1f}" for mean in means) + " |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
