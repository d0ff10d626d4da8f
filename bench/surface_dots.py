"""Shape complementarity by dots, plainly: the definition of Lawrence and Colman (1993) on dots of a given density.

    python3 bench/surface_dots.py ATOMS_A.xyzr ATOMS_B.xyzr [--density 15] [--probe 1.4] [--rim 1.5] [--weight 0.5]

Shares no code with the library. A probe is allowed where it overlaps no atom of its side; its centres are sampled over the
spheres, circles and corners of the grown atoms. A dot is where an allowed probe touches the solid. It is on the surface if no
allowed centre that was found is nearer to it than the probe's radius, which needs to know nothing of cusps and creases.
"""

import argparse
import itertools
import math

import numpy as np
from scipy.spatial import cKDTree

GOLDEN = math.pi * (3 - math.sqrt(5))
HAIR = 1e-7  # Å


def cross(u, v):
    """np.cross() takes longer for few vectors."""
    (a, b, c), (x, y, z) = u.T, v.T
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x]).T


def lattice(count):
    k = np.arange(count) + 0.5
    z, turn = 1 - 2 * k / count, GOLDEN * k
    return np.column_stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z])


class Side:
    def __init__(self, atoms, others, probe, density):
        self.probe, self.density = probe, density
        reach = atoms[:, 3].max() + others[:, 3].max() + 4 * probe + 1.5  # nothing farther shows in the buried part or its rim
        near = cKDTree(others[:, :3]).query(atoms[:, :3])[0] < reach
        self.centers, self.radii = atoms[near, :3], atoms[near, 3] + probe
        self.others, self.reach = cKDTree(others[:, :3]), others[:, 3].max() + 3 * probe + 1.5  # of probes whose dots count
        tree = cKDTree(self.centers)
        most = self.radii.max()
        self.near = []
        for i, around in enumerate(tree.query_ball_point(self.centers, self.radii + most)):
            others_of = np.array([j for j in around if j != i], int)
            apart = np.linalg.norm(self.centers[others_of] - self.centers[i], axis=1)
            self.near.append(others_of[apart < self.radii[i] + self.radii[others_of]])
        self.allowed, self.dots, self.weights, self.probes = [], [], [], []
        for i in range(len(self.radii)):
            self.add_contact(i)
            for j in self.near[i][self.near[i] > i]:
                self.add_circle(i, j)
        self.corners()
        self.finish()

    def is_free(self, places, among):
        if not len(among):
            return np.ones(len(places), bool)
        squares = ((places[:, None] - self.centers[among]) ** 2).sum(axis=2)
        return (squares > (self.radii[among] ** 2 - HAIR)).all(axis=1)

    def add(self, dots, weights, probes):
        self.dots.append(dots)
        self.weights.append(np.broadcast_to(weights, len(dots)))
        self.probes.append(probes)

    def add_contact(self, i):
        radius = self.radii[i] - self.probe
        area = 4 * math.pi * radius**2
        count = math.ceil(area * self.density)
        ways = lattice(count)
        probes = self.centers[i] + self.radii[i] * ways
        free = self.is_free(probes, self.near[i])
        self.allowed.append(probes[free])
        self.add((self.centers[i] + radius * ways)[free], area / count, probes[free])

    def add_circle(self, i, j):
        """Probes that roll around two atoms, and the dots of the saddle between them."""
        p, step = self.probe, 1 / math.sqrt(self.density)
        to = self.centers[j] - self.centers[i]
        far = np.linalg.norm(to)
        axis = to / far
        height = (far**2 + self.radii[i] ** 2 - self.radii[j] ** 2) / (2 * far)
        if self.radii[i] <= abs(height):
            return
        rho = math.sqrt(self.radii[i] ** 2 - height**2)
        if self.others.query(self.centers[i] + height * axis)[0] > self.reach + rho:
            return
        first = cross(axis, np.eye(3)[np.abs(axis).argmin()])
        first /= np.linalg.norm(first)
        count = max(8, math.ceil(2 * math.pi * rho / step))
        turn = (np.arange(count) + 0.5) * 2 * math.pi / count
        radial = np.outer(np.cos(turn), first) + np.outer(np.sin(turn), cross(axis, first))
        probes = self.centers[i] + height * axis + rho * radial
        free = self.is_free(probes, np.intersect1d(self.near[i], self.near[j], assume_unique=True))
        if not free.any():
            return
        self.allowed.append(probes[free])
        low, high = math.atan2(-height, rho), math.atan2(far - height, rho)
        steps = max(1, math.ceil((high - low) * p / step))
        for k in range(steps):
            angle = low + (k + 0.5) * (high - low) / steps
            across = rho - p * math.cos(angle)
            if across <= 0:
                continue
            weight = p * across * (high - low) / steps * 2 * math.pi / count
            at = probes[free]
            self.add(at - p * math.cos(angle) * radial[free] + p * math.sin(angle) * axis, weight, at)

    def corners(self):
        """Probes that touch three atoms, and dots on the triangle between these."""
        found = []
        for i, around in enumerate(self.near):
            later = around[around > i]
            known = {j: set(self.near[j]) for j in later}
            triples = [(j, k) for j, k in itertools.combinations(later, 2) if k in known[j]]
            if triples:
                found += self.touching(i, np.array(triples))
        ways = lattice(math.ceil(4 * math.pi * self.probe**2 * self.density))
        for place, atoms in found:
            if self.others.query(place)[0] > self.reach:
                continue
            to = self.centers[list(atoms)] - place
            normals = cross(to, np.roll(to, -1, axis=0))
            normals *= np.sign((normals * to.sum(axis=0)).sum(axis=1))[:, None]
            inside = ways[(ways @ normals.T > 0).all(axis=1)]
            self.add(place + self.probe * inside, 1 / self.density, np.broadcast_to(place, inside.shape))
        self.allowed.append(np.array([place for place, _ in found]).reshape(-1, 3))

    def touching(self, i, triples):
        base, r = self.centers[i], self.radii
        j, k = triples.T
        u, v = self.centers[j] - base, self.centers[k] - base
        normal = cross(u, v)
        size = (normal**2).sum(axis=1)
        a = ((u**2).sum(axis=1) + r[i] ** 2 - r[j] ** 2) / 2
        b = ((v**2).sum(axis=1) + r[i] ** 2 - r[k] ** 2) / 2
        foot = (cross(v, normal) * a[:, None] + cross(normal, u) * b[:, None]) / size[:, None]
        left = r[i] ** 2 - (foot**2).sum(axis=1)
        good = left > 0
        rise = normal * np.sqrt(np.where(good, left, 0) / size)[:, None]
        found = []
        for sign in (1, -1):
            places = base + foot + sign * rise
            squares = ((places[:, None] - self.centers[self.near[i]]) ** 2).sum(axis=2) - r[self.near[i]] ** 2
            # The two others touch; nobody else is nearer.
            free = good & ((squares < -HAIR).sum(axis=1) == 0)
            found += [(places[n], (i, j[n], k[n])) for n in np.flatnonzero(free)]
        return found

    def finish(self):
        self.dots, self.weights, self.probes = map(np.concatenate, (self.dots, self.weights, self.probes))
        least = cKDTree(np.concatenate(self.allowed)).query(self.dots, distance_upper_bound=self.probe)[0]
        shown = least > self.probe - 1e-5
        self.dots, self.weights, self.probes = self.dots[shown], self.weights[shown], self.probes[shown]
        self.normals = (self.probes - self.dots) / self.probe

    def choose(self, others, rim):
        """Keeps the dots that the grown others bury and that are farther than the rim from all that they don't."""
        buried = np.zeros(len(self.dots), bool)
        for center, radius in zip(others[:, :3], others[:, 3] + self.probe, strict=True):
            buried |= ((self.probes - center) ** 2).sum(axis=1) < radius**2
        self.buried_area = self.weights[buried].sum()
        far = cKDTree(self.dots[~buried]).query(self.dots[buried])[0] > rim
        keep = np.flatnonzero(buried)[far]
        self.dots, self.weights, self.normals = self.dots[keep], self.weights[keep], self.normals[keep]


def median(values, weights):
    order = np.argsort(values)
    below = np.cumsum(weights[order]) - weights[order] / 2
    return float(np.interp(weights.sum() / 2, below, values[order]))


def complementarity(a, b, density=15.0, probe=1.4, rim=1.5, weight=0.5):
    """Of arrays of x, y, z, radius: Sc and the buried excluded area of both sides, Å²."""
    sides = [Side(a, b, probe, density), Side(b, a, probe, density)]
    for side, others in zip(sides, (b, a), strict=True):
        near = cKDTree(side.centers).query(others[:, :3])[0] < side.radii.max() + others[:, 3].max() + 2 * probe
        side.choose(others[near], rim)
    medians = []
    for own, other in (sides, sides[::-1]):
        far, nearest = cKDTree(other.dots).query(own.dots)
        fit = -(own.normals * other.normals[nearest]).sum(axis=1) * np.exp(-weight * far**2)
        medians.append(median(fit, own.weights))
    return sum(medians) / 2, sides[0].buried_area + sides[1].buried_area


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("atoms", nargs=2)
    for name, default in (("density", 15), ("probe", 1.4), ("rim", 1.5), ("weight", 0.5)):
        parser.add_argument(f"--{name}", type=float, default=default)
    options = vars(parser.parse_args())
    a, b = (np.loadtxt(path, ndmin=2) for path in options.pop("atoms"))
    print("Sc {:.5f}, buried {:.2f} Å²".format(*complementarity(a, b, **options)))


if __name__ == "__main__":
    main()
