"""vdwmesh.interface: beside formulas, beside `exact`, and what it refuses."""

import math
import unittest

import numpy as np
import vdwmesh

SAME = 1e-12  # relative: the rounding of sums over some hundred atoms


class Interface(unittest.TestCase):
    def test_two_balls(self):
        d = 1.25
        found = vdwmesh.interface([[0, 0, 0], [0, d, 0]], [1.0, 1.0], sides=[7, 3], probe=0)
        (pair,) = found.pairs
        self.assertEqual((pair.a, pair.b), (7, 3))
        cap = 2 * math.pi * (1 - d / 2)
        np.testing.assert_allclose([pair.buried_a, pair.buried_b, pair.buried_area], [cap, cap, 2 * cap], rtol=SAME)
        np.testing.assert_allclose(pair.contact_areas, [math.pi * (1 - d * d / 4)], rtol=SAME)
        np.testing.assert_array_equal(pair.contacts, [[0, 1]])
        np.testing.assert_allclose(found.atom_area, 4 * math.pi, rtol=SAME)
        np.testing.assert_allclose(found.atom_area_in_whole, 4 * math.pi - cap, rtol=SAME)

    def test_halves_of_a_protein(self):
        molecule = vdwmesh.sample("ubiquitin")
        sides = np.where(molecule.residues < 40, "first", "second")
        sides[:5] = ""
        (pair,) = vdwmesh.interface(molecule, sides=sides).pairs
        areas = [vdwmesh.exact(molecule.coords[mask], molecule.radii[mask], probe=1.4).area
                 for mask in (sides == "first", sides == "second", sides != "")]  # fmt: skip
        self.assertAlmostEqual(pair.buried_area, areas[0] + areas[1] - areas[2], delta=SAME * areas[2])
        lost = pair.atom_area - pair.atom_area_in_pair
        self.assertAlmostEqual(math.fsum(lost), pair.buried_area, delta=SAME * areas[2])
        self.assertAlmostEqual(math.fsum(pair.contact_areas), pair.contact_area, delta=SAME * areas[2])
        self.assertTrue((sides[pair.contacts[:, 0]] == pair.a).all())
        self.assertTrue((sides[pair.contacts[:, 1]] == pair.b).all())

    def test_complementarity(self):
        """Two balls, beside the closed form: the fit falls from the axis to the rim, so its median is the value at half of
        the fitted cap's area."""
        r, d, probe = 6.0, 13.0, 1.4
        rim = math.acos(d / 2 / (r + probe)) - 2 * math.asin(1.5 / (2 * r))  # less the chord of 1.5 Å
        cosine = (1 + math.cos(rim)) / 2
        far = math.sqrt(d * d + r * r - 2 * d * r * cosine)
        expected = (d * cosine - r) / far * math.exp(-0.5 * (far - r) ** 2)
        balls = ([[0, 0, 0], [0, 0, d]], [r, r])
        (pair,) = vdwmesh.interface(*balls, sides=["A", "B"], complementarity=True).pairs
        self.assertAlmostEqual(pair.complementarity.sc, expected, delta=0.004)
        self.assertIsNone(vdwmesh.interface(*balls, sides=["A", "B"]).pairs[0].complementarity)

    def test_bad_sides(self):
        coords, radii = [[0, 0, 0], [1, 0, 0]], [1.0, 1.0]
        for sides in (None, ["A", "A"], ["A", ""], [0, -1], ["A"], [0.5, 1.5]):
            with self.subTest(sides=sides), self.assertRaisesRegex(vdwmesh.InvalidInput, "^sides: "):
                vdwmesh.interface(coords, radii, sides=sides)


if __name__ == "__main__":
    unittest.main()
