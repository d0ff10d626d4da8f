"""Pockets of frames: those of single calls, followed through time, in a table."""

import csv
import itertools
import math
import pathlib
import tempfile
import unittest

import numpy as np
import vdwmesh

CAGE = 4.6 * np.array(list(itertools.product((0, 1), repeat=3)))
RADII = [1.5] * 8
R = 2.9  # with a probe of 1.4 Å


def cage_volume(edge):
    """A corner of the cube has an eighth of a ball, an edge a quarter of a lens."""
    top = R - edge / 2
    lens = 2 * math.pi * top**2 * (3 * R - top) / 3
    return edge**3 - 4 * math.pi * R**3 / 3 + 3 * lens


class PocketFrames(unittest.TestCase):
    def test_cage_that_grows_closes_and_comes_back(self):
        scales = (1, 1.02, 0.5, 1.01)  # with half the edge there is no room
        found = list(vdwmesh.pocket_frames([CAGE * s for s in scales], radii=RADII))
        self.assertEqual([list(f.pockets) for f in found], [[1], [1], [], [1]])
        self.assertEqual([f.overlaps.get(1) for f in found], [0, 1, None, 1])
        for frame, scale in zip(found, scales):
            for pocket in frame.pockets.values():
                self.assertAlmostEqual(pocket.volume, cage_volume(4.6 * scale), delta=1e-11)

    def test_two_cages_keep_their_numbers(self):
        both = np.concatenate([CAGE, CAGE * 1.05 + 30])
        path = np.stack([both, np.concatenate([CAGE * 1.05, CAGE + 30])])  # the larger is the smaller now
        first, second = vdwmesh.pocket_frames(path, radii=2 * RADII)
        self.assertEqual(list(first.pockets), [1, 2])
        self.assertEqual(list(second.pockets), [2, 1])
        self.assertEqual(second.pockets[1].lining, first.pockets[1].lining)
        self.assertEqual(first.pockets[1].lining, tuple(range(8, 16)))

    def test_frames_are_those_of_single_calls(self):
        molecule = vdwmesh.sample("bpti")
        steps = np.random.default_rng(5).normal(0, 0.05, (5, *molecule.coords.shape))
        path = molecule.coords + np.cumsum(steps, axis=0)
        for measures in ("exact", "sums"):
            found = list(vdwmesh.pocket_frames(path, radii=molecule.radii, measures=measures, chunk=2, threads=2))
            self.assertEqual([f.frame for f in found], list(range(5)))
            for frame, coords in zip(found, path):
                single = vdwmesh.pockets(coords, molecule.radii, measures=measures)
                self.assertEqual(tuple(frame.pockets.values()), single)
        self.assertTrue(set(found[0].pockets) & set(found[4].pockets), "nothing is followed")

    def test_sums_have_no_exact_figures(self):
        (pocket,) = vdwmesh.pockets(CAGE, RADII, measures="sums")
        self.assertIsNone(pocket.volume)
        self.assertIsNone(pocket.mouths[0].area)
        self.assertAlmostEqual(pocket.volume_sum, cage_volume(4.6), delta=1e-11)

    def test_table(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "pockets.csv"
            self.assertEqual(vdwmesh.pocket_table([CAGE, CAGE * 0.5, CAGE * 1.02], path, radii=RADII), 3)
            rows = list(csv.DictReader(path.open(newline="")))
        self.assertEqual([(row["frame"], row["track"]) for row in rows], [("0", "1"), ("2", "1")])
        self.assertAlmostEqual(float(rows[1]["volume"]), cage_volume(4.6 * 1.02), delta=1e-11)
        self.assertEqual(rows[0]["time"], "")

    def test_bad_frame_ends_with_its_number(self):
        broken = CAGE.copy()
        broken[3, 1] = math.nan
        run = vdwmesh.pocket_frames([CAGE, broken, CAGE], radii=RADII)
        self.assertEqual(next(run).frame, 0)
        with self.assertRaisesRegex(vdwmesh.InvalidInput, "^traj: frame 1: "):
            next(run)
        for wrong in ({"patience": -1}, {"overlap": 0}, {"overlap": math.nan}, {"measures": "all"}):
            with self.assertRaisesRegex(vdwmesh.InvalidInput, next(iter(wrong))):
                vdwmesh.pocket_frames([CAGE], radii=RADII, **wrong)


if __name__ == "__main__":
    unittest.main()
