"""--certify: intervals around the exact area and volume."""

import math

from program import BAD_INPUT, UBIQUITIN, ProgramTest

WIDTH = 1e-9  # relative, as promised


class Certify(ProgramTest):
    def certificate(self, *arguments):
        return self.report(*arguments, "--certify")["exact"]["certificate"]

    def assert_contains(self, interval, value):
        self.assertLessEqual(interval["lower"], value)
        self.assertGreaterEqual(interval["upper"], value)
        self.assertLessEqual(interval["upper"] - interval["lower"], WIDTH * value)

    def test_two_balls_that_touch(self):
        """Doubles are at most one unit in the last place from these multiples of π."""
        path = self.file("pair.xyzr", "0 0 0 1\n3 0 0 2\n")
        certificate = self.certificate("exact", path)
        area, volume = 20 * math.pi, 12 * math.pi
        for interval, value in ((certificate["area"], area), (certificate["volume"], volume)):
            self.assertLessEqual(interval["lower"], math.nextafter(value, math.inf))
            self.assertGreaterEqual(interval["upper"], math.nextafter(value, 0))
            self.assertLessEqual(interval["upper"] - interval["lower"], WIDTH * value)
        self.assertEqual(certificate["bits"], 53)
        self.assertEqual(certificate["wide_spheres"], 0)

    def test_every_method_and_verb_has_the_same(self):
        expected = self.certificate("exact", UBIQUITIN)
        exact = self.report("exact", UBIQUITIN)["exact"]
        self.assertIsNone(exact["certificate"])
        for name in ("area", "volume"):
            self.assert_contains(expected[name], exact[name])
        small = ("--spacing", "1", "--subdivide", "0", "--distances", "off")
        for arguments in (("exact", UBIQUITIN, "--method", "arcs"), ("exact", UBIQUITIN, "--topology", "off"),
                          ("exact", UBIQUITIN, "--threads", "1"), ("report", UBIQUITIN, *small)):  # fmt: skip
            with self.subTest(arguments=arguments):
                self.assertEqual(self.certificate(*arguments), expected)

    def test_of_chosen_atoms(self):
        whole = self.certificate("exact", UBIQUITIN)
        part = self.report("exact", UBIQUITIN, "--certify", "--measure", "A/10")["exact"]
        for name in ("area", "volume"):
            self.assert_contains(part["certificate"][name], part[name])
            self.assertLess(part["certificate"][name]["upper"], whole[name]["lower"])

    def test_is_refused(self):
        self.assert_refused(BAD_INPUT, "compare", "a.stl", UBIQUITIN, "--certify", says=("--certify",))
