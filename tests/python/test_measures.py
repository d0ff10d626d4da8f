"""vdwmesh.exact and sasa: beside formulas, beside others' references, and beside the program."""

import csv
import json
import math
import unittest

import numpy as np
import vdwmesh
from program import ProgramTest, need_package, need_shared

ROUNDING = 1e-12  # relative: sums of a few terms in double


def close(value, expected, relative=ROUNDING):
    """Fails on NaN."""
    assert abs(value - expected) <= relative * abs(expected), f"{value} is not {expected}"


def two_balls(distance):
    """Area and volume of two unit balls: each loses a cap of height 1 - d/2."""
    height = 1 - distance / 2
    area = 2 * (4 * math.pi - 2 * math.pi * height)
    volume = 2 * (4 / 3 * math.pi - math.pi * height**2 * (3 - height) / 3)
    return area, volume


class ExcludedTest(ProgramTest):
    def test_two_balls_in_a_whole_ring(self):
        """Two equal balls and a torus between them, by Pappus' theorems."""
        radius, probe, distance = 1.6, 1.4, 3.0
        rho = math.sqrt((radius + probe) ** 2 - distance**2 / 4)
        end = math.atan2(distance / 2, rho)
        saddle = 4 * math.pi * probe * (rho * end - probe * math.sin(end))
        contact = 4 * math.pi * radius**2 * (1 + math.sin(end))
        found = vdwmesh.exact([[0, 0, 0], [0, 0, distance]], [radius] * 2, surface="excluded", topology=True)
        close(found.saddle_area, saddle)
        close(found.contact_area, contact)
        close(found.area, saddle + contact)
        close(found.atom_area[0], found.area / 2)
        self.assertEqual(found.probe, probe)
        self.assertEqual(found.topology.euler_characteristic, 2)
        self.assertEqual(len(found.topology.shells), 1)

    def test_beside_the_program(self):
        molecule = vdwmesh.sample("ubiquitin")
        found = vdwmesh.exact(molecule, surface="excluded", probe=1.2, topology=True)
        report = self.report("exact", "--sample", "ubiquitin", "--surface", "excluded", "--probe", "1.2")
        for ours, theirs in ((found, "complete"), (found.exterior, "exterior")):
            block = report["excluded"][theirs]
            for name in ("area", "volume", "contact_area", "saddle_area", "concave_area", "closure"):
                self.assertEqual(getattr(ours, name), block[name])
            self.assertEqual(ours.topology.cavities, block["cavities"])
            self.assertEqual([s.genus for s in ours.topology.shells], [s["genus"] for s in block["shells"]])
            self.assertEqual(ours.euler_characteristic, ours.topology.euler_characteristic)
        close(found.atom_area.sum(), found.area)
        close(found.atom_volume.sum(), found.volume)
        self.assertIsNone(vdwmesh.exact(molecule, surface="excluded").euler_characteristic)

    def test_refusals(self):
        for options in ({"atoms": [0]}, {"method": "arcs"}, {"probe": 0}, {"topology": "counts"}):
            with self.assertRaises(vdwmesh.InvalidInput):
                vdwmesh.exact([[0, 0, 0]], [1.5], surface="excluded", **options)
        with self.assertRaises(vdwmesh.InvalidInput):
            vdwmesh.exact([[0, 0, 0]], [1.5], surface="vdv")
        with self.assertRaises(vdwmesh.InvalidInput):
            vdwmesh.exact([[0, 0, 0]], [1.5], surface="excluded", device="gpu")
        # A device makes no shells; without one there is nothing to ask.
        with self.assertRaises(vdwmesh.BackendUnavailable):
            vdwmesh.exact([[0, 0, 0]], [1.5], surface="excluded", device="cuda", topology=True)


class FormulaTest(unittest.TestCase):
    def test_two_balls(self):
        for distance in (0.25, 1.0, 1.75):
            area, volume = two_balls(distance)
            found = vdwmesh.exact([[0, 0, 0], [distance, 0, 0]], [1, 1])
            close(found.area, area)
            close(found.volume, volume)
            close(found.atom_area[0], area / 2)
            close(found.atom_volume[1], volume / 2)

    def test_the_probe_grows_every_ball(self):
        close(vdwmesh.exact([[1, 2, 3]], [1.6], probe=1.4).area, 36 * math.pi)
        close(vdwmesh.exact([[1, 2, 3]], [1.6], probe=-0.6).volume, 4 / 3 * math.pi)

    def test_a_hollow_shell_has_a_void(self):
        points = np.array([[math.sqrt(1 - z * z) * math.cos(a), math.sqrt(1 - z * z) * math.sin(a), z]
                           for z in np.linspace(-1, 1, 15) for a in np.arange(0, 6.28, 0.45)])  # fmt: skip
        found = vdwmesh.exact(5 * points, np.full(len(points), 1.7), topology=True)
        shape = found.topology
        self.assertEqual((shape.components, shape.tunnels, shape.voids), (1, 0, 1))
        self.assertEqual(shape.euler_characteristic, 4)
        self.assertEqual(shape.shells.shape, (2, 2))
        close(shape.shells[:, 0].sum(), found.area)
        close(shape.shells[:, 1].sum(), found.volume)
        close(-shape.shells[1, 1], shape.void_volume)
        self.assertEqual(found.method, "cgal")
        self.assertIsNone(found.check_area)

    def test_what_was_not_computed_is_not_a_number(self):
        found = vdwmesh.exact([[0, 0, 0], [1, 0, 0], [9, 0, 0]], [1, 1, 1], atoms=[0, -1])
        self.assertTrue(math.isnan(found.atom_area[1]) and math.isnan(found.atom_volume[1]))
        close(found.area, two_balls(1)[0] / 2 + 4 * math.pi)  # the second ball still buries the first
        self.assertIsNone(found.topology)
        self.assertIsNone(found.check_area)
        mask = vdwmesh.exact([[0, 0, 0], [1, 0, 0], [9, 0, 0]], [1, 1, 1], atoms=[True, False, True])
        self.assertEqual(mask.area, found.area)

    def test_methods_agree_and_say_what_they_are(self):
        molecule = vdwmesh.sample("bpti")
        by_arcs, by_cgal, both = (vdwmesh.exact(molecule, method=m) for m in ("arcs", "cgal", "both"))
        close(by_arcs.area, by_cgal.area, 1e-10)
        self.assertEqual([m.method for m in (by_arcs, by_cgal, both)], ["arcs", "cgal", "both"])
        self.assertEqual(both.check_area, by_arcs.area)


class SasaTest(unittest.TestCase):
    coords = np.array([[0, 0, 0], [1, 0, 0], [9, 0, 0]], float)
    radii = np.ones(3)

    def test_modes(self):
        total = vdwmesh.sasa(self.coords, self.radii, probe=0)
        atoms = vdwmesh.sasa(self.coords, self.radii, probe=0, mode="atom")
        residues = vdwmesh.sasa(self.coords, self.radii, probe=0, mode="residue", groups=["B", "B", "A"])
        pair = two_balls(1)[0]
        close(float(total), pair + 4 * math.pi)
        self.assertEqual((total.shape, atoms.shape, residues.shape), ((), (3,), (2,)))
        close(residues[0], pair)  # the label that appears first
        close(residues[1], 4 * math.pi)
        np.testing.assert_array_equal(atoms, vdwmesh.exact(self.coords, self.radii).atom_area)

    def test_frames_come_first(self):
        frames = np.stack([self.coords, self.coords * 2, self.coords * 0.5])
        for mode, shape in (("total", (3,)), ("atom", (3, 3)), ("residue", (3, 2))):
            options = {"mode": mode, "groups": [7, 8, 7] if mode == "residue" else None}
            found = vdwmesh.sasa(frames, self.radii, **options)
            self.assertEqual(found.shape, shape)
            for frame, row in zip(frames, found):
                np.testing.assert_array_equal(row, vdwmesh.sasa(frame, self.radii, **options))

    def test_the_default_probe_is_water(self):
        close(float(vdwmesh.sasa([[0, 0, 0]], [1.6])), 36 * math.pi)

    def test_groups_of_a_molecule_are_its_residues(self):
        molecule = vdwmesh.sample("ubiquitin")
        areas = vdwmesh.sasa(molecule, mode="residue")
        self.assertEqual(areas.shape, (76,))  # UniProt P0CG48: 76 residues
        close(areas.sum(), float(vdwmesh.sasa(molecule)))

    def test_groups_without_a_measured_atom_have_no_area(self):
        found = vdwmesh.sasa(self.coords, self.radii, mode="residue", groups=[0, 0, 1], atoms=[0])
        self.assertTrue(found[0] > 0 and math.isnan(found[1]))


class ReferenceTest(unittest.TestCase):
    def test_the_reference_of_others(self):
        with need_shared("reference/union_of_balls.csv").open(newline="") as file:
            rows = [row for row in csv.DictReader(file) if int(row["balls"]) < 5000]
        self.assertGreater(len(rows), 20)
        for row in rows:
            with self.subTest(set=row["set"], probe=row["probe_A"]):
                molecule = vdwmesh.read(need_shared(f"reference/{row['set']}.xyzr"))
                found = vdwmesh.exact(molecule, probe=float(row["probe_A"]), topology=True)
                close(found.area, float(row["area_A2"]), 1e-9)  # of its printed digits
                close(found.volume, float(row["volume_A3"]), 1e-9)
                shape = found.topology
                self.assertEqual([shape.components, shape.tunnels, shape.voids],
                                 [int(row[k]) for k in ("components_b0", "tunnels_b1", "voids_b2")])


class SameAsProgramTest(ProgramTest):
    """To the last digit: the program prints doubles with all their digits."""

    def compare(self, path, *arguments, probe=0.0, **options):
        report, table = self.folder / "r.json", self.folder / "a.csv"
        self.run_ok("exact", path, "--probe", probe, "--json", report, "--per-atom", table, *arguments)
        block = json.loads(report.read_text())["exact"]
        found = vdwmesh.exact(vdwmesh.read(path), probe=probe, **options)
        for key in ("area", "volume", "check_area", "check_volume", "method"):
            self.assertEqual(getattr(found, key), block[key], key)
        with table.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(found.atom_area.tolist(), [float(row["exact_area"]) for row in rows])
        self.assertEqual(found.atom_volume.tolist(), [float(row["exact_volume"]) for row in rows])
        if not options.get("topology"):
            return
        for key in ("components", "tunnels", "voids", "euler_characteristic", "point_contacts",
                    "hidden_atoms", "outer_area", "void_area", "void_volume"):  # fmt: skip
            self.assertEqual(getattr(found.topology, key), block[key], key)
        shells = [[shell["area"], shell["volume"]] for shell in block["shell_measures"]]
        self.assertEqual(found.topology.shells.tolist(), shells)

    def test_proteins(self):
        for name in ("4PTI", "4HHB"):
            path = need_shared(f"molecules/thesis/{name}.pdb")
            self.compare(path, topology=True)
            self.compare(path, "--topology", "off", probe=1.4)
            self.compare(path, "--method", "both", method="both", topology=True)

    def test_a_ribosome(self):
        self.compare(need_shared("molecules/large/6ZU5.cif.gz"), "--topology", "off")

    def test_sparse_and_degenerate_sets(self):
        paths = [*need_shared("molecules/sparse").glob("*.xyzr"),
                 *need_shared("molecules/traps").glob("*.xyzr")]  # fmt: skip
        self.assertGreater(len(paths), 10)
        for path in sorted(paths):
            with self.subTest(path=path.name):
                self.compare(path, topology=True)
                self.compare(path, "--topology", "off")

    def test_residues_are_summed_alike(self):
        path, table = need_shared("molecules/thesis/4PTI.pdb"), self.folder / "r.csv"
        self.run_ok("exact", path, "--probe", 1.4, "--topology", "off", "--per-atom", table,
                    "--group", "residue")  # fmt: skip
        with table.open(newline="") as file:
            expected = [float(row["exact_area"]) for row in csv.DictReader(file)]
        self.assertEqual(vdwmesh.sasa(vdwmesh.read(path), mode="residue").tolist(), expected)

    def test_the_table_of_residues(self):
        path, table = need_shared("molecules/thesis/4HHB.pdb"), self.folder / "r.csv"
        for radii in ("protor", "bondi"):
            self.run_ok("exact", path, "--radii", radii, "--probe", 1.4, "--topology", "off", "--per-atom", table,
                        "--group", "residue")  # fmt: skip
            with table.open(newline="") as file:
                rows = list(csv.DictReader(file))
            found = vdwmesh.residue_areas(vdwmesh.read(path, radii=radii))
            for name, column in (("chains", "chain"), ("resids", "residue_number"), ("resnames", "residue_name")):
                self.assertEqual(getattr(found, name).tolist(), [row[column] for row in rows])
            self.assertEqual(found.area.tolist(), [float(row["exact_area"]) for row in rows])
            self.assertEqual(found.atoms.tolist(), [int(row["atoms"]) for row in rows])
            relative = [float(row["relative_area"] or "nan") for row in rows]
            np.testing.assert_allclose(found.relative, relative, rtol=1e-12)
            self.assertEqual(radii == "bondi", bool(np.isnan(found.relative).all()))
        self.assertEqual(list(found.to_dict()), ["chains", "resids", "resnames", "atoms", "area", "relative"])
        pandas = need_package("python3-pandas", module="pandas")
        frame = found.to_pandas()
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual(len(frame), len(rows))

    def test_texts_are_short(self):
        molecule = vdwmesh.sample("ubiquitin")
        union = vdwmesh.exact(molecule, topology=True)
        self.assertIn("area=7915.582, ", repr(union))
        self.assertIn("atom_area=array(602,)", repr(union))
        for thing in (union, vdwmesh.exact(molecule, surface="ses"), vdwmesh.residue_areas(molecule), union.topology,
                      vdwmesh.trajectory(molecule.coords[None], radii=molecule.radii), *vdwmesh.pockets(molecule, probe=1.4)[:1],
                      vdwmesh.compare(vdwmesh.mesh(molecule, edge_length=1), molecule)):
            with self.subTest(type(thing).__name__):
                self.assertTrue(repr(thing).startswith(f"<vdwmesh.{type(thing).__name__} "))
                self.assertLess(len(repr(thing)), 1200)
                self.assertNotIn("\n", repr(thing))


if __name__ == "__main__":
    unittest.main()
