"""vdwmesh.batch: rows, shards, archives, and what cannot be measured. Numbers are those of exact."""

import pathlib
import tarfile
import tempfile
import unittest

import numpy as np
import vdwmesh

ATOM = "ATOM  {0:5}  CA  GLY A{0:4}    {1:8.3f}   0.000   0.000  1.00  0.00           C  \n"


def chain(atoms):
    return "".join(ATOM.format(i + 1, 1.5 * i) for i in range(atoms)) + "END\n"


class Batches(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name) / "structures"
        self.folder.mkdir()
        for atoms in range(1, 8):
            (self.folder / f"s{atoms}.pdb").write_text(chain(atoms))
        (self.folder / "s4b.pdb").write_text("no structure\n")
        self.names = sorted(str(path) for path in self.folder.iterdir())

    def test_rows_are_those_of_single_calls(self):
        rows = list(vdwmesh.batch(self.folder, probe=1.4, topology=True))
        self.assertEqual([row.name for row in rows], self.names)
        for row in rows:
            if row.name.endswith("s4b.pdb"):
                self.assertIn("s4b.pdb", row.error)
                self.assertIsNone(row.area)
                self.assertIsNone(row.method)
                continue
            self.assertIsNone(row.error)
            alone = vdwmesh.exact(vdwmesh.read(row.name), probe=1.4, topology=True)
            self.assertEqual((row.area, row.volume), (alone.area, alone.volume))
            self.assertEqual(row.components, alone.topology.components)
            self.assertEqual(row.tunnels, alone.topology.tunnels)
            self.assertEqual(row.euler_characteristic, alone.topology.euler_characteristic)
            self.assertEqual(row.atoms, len(vdwmesh.read(row.name)))

    def test_what_was_not_asked_for_is_none(self):
        row = next(vdwmesh.batch(self.folder / "s1.pdb"))
        self.assertEqual(row.method, "arcs")
        self.assertIsNone(row.components)
        self.assertIsNone(row.tunnels)

    def test_shards_follow_each_other(self):
        whole = list(vdwmesh.batch(self.folder, threads=2))
        for parts in (1, 3, 20):
            joined = [row for i in range(parts) for row in vdwmesh.batch(self.folder, shard=(i, parts))]
            self.assertEqual(joined, whole)

    def test_an_archive_and_several_inputs(self):
        archive = self.folder.parent / "all.tar.gz"
        with tarfile.open(archive, "w:gz") as tar:
            for name in self.names:
                tar.add(name, arcname=pathlib.Path(name).name)
        rows = list(vdwmesh.batch([archive, self.folder / "s3.pdb"]))
        self.assertEqual(len(rows), len(self.names) + 1)
        self.assertEqual(rows[-1].area, rows[2].area)
        self.assertEqual(rows[2].name, "s3.pdb")

    def test_wrong_arguments_are_named(self):
        for wrong, word in (
            ({"shard": (2, 2)}, "shard"),
            ({"shard": 1}, "shard"),
            ({"probe": float("nan")}, "probe"),
            ({"method": "guess"}, "method"),
            ({"topology": "some"}, "topology"),
            ({"format": "doc"}, "format"),
            ({"threads": 0}, "threads"),
        ):
            with self.subTest(wrong), self.assertRaisesRegex(ValueError, word):
                vdwmesh.batch(self.folder, **wrong)
        with self.assertRaisesRegex(ValueError, "not_there"):
            next(vdwmesh.batch(self.folder / "not_there"))


class Voids(unittest.TestCase):
    def test_the_table_adds_up(self):
        nodes = [(i, j, k) for i in range(3) for j in range(3) for k in range(3) if (i, j, k) != (1, 1, 1)]
        t = vdwmesh.exact(nodes, [0.9] * 26, topology=True).topology
        (void,) = t.void_table
        self.assertAlmostEqual(void.volume, t.void_volume, delta=1e-12)
        self.assertAlmostEqual(void.area, t.void_area, delta=1e-12)
        for coordinate in void.center:
            self.assertAlmostEqual(coordinate, 1, delta=1e-9)
        self.assertAlmostEqual(void.clearance, 0.1, delta=1e-9)  # six balls at a distance of 1
        faces = [nodes.index(n) for n in ((0, 1, 1), (1, 0, 1), (1, 1, 0), (2, 1, 1), (1, 2, 1), (1, 1, 2))]
        self.assertTrue(set(faces) <= set(void.lining))


class ManySets(unittest.TestCase):
    """vdwmesh.exact_many: each set has the bytes that it has alone."""

    def setUp(self):
        dice = np.random.default_rng(5)
        self.offsets = np.array([0, 1, 9, 40, 60])
        self.coords, self.radii = dice.uniform(-3, 3, (60, 3)), dice.uniform(1, 1.9, 60)
        self.coords[1:3], self.radii[1:3] = [[20, 0, 0], [22, 0, 0]], 1  # these touch
        self.weights = dice.normal(size=60), dice.normal(size=60)

    def parts(self):
        return [slice(first, end) for first, end in zip(self.offsets, self.offsets[1:])]

    def test_sets_are_those_of_single_calls(self):
        names = ("area_coords", "area_radii", "volume_coords", "volume_radii")
        for options in ({"probe": 0.3}, {"surface": "sas"}, {"gradient": True, "weights": self.weights}):
            found = vdwmesh.exact_many(self.coords, self.radii, self.offsets, **options)
            self.assertEqual(found.gradient is None, "gradient" not in options)
            kinks = 0
            for b, part in enumerate(self.parts()):
                if "weights" in options:
                    options["weights"] = tuple(w[part] for w in self.weights)
                alone = vdwmesh.exact(self.coords[part], self.radii[part], **options)
                self.assertEqual((found.area[b], found.volume[b]), (alone.area, alone.volume))
                self.assertEqual(found.atom_area[part].tobytes(), alone.atom_area.tobytes())
                self.assertEqual(found.atom_volume[part].tobytes(), alone.atom_volume.tobytes())
                for name in names if alone.gradient else ():
                    self.assertEqual(
                        getattr(found.gradient, name)[part].tobytes(), getattr(alone.gradient, name).tobytes()
                    )
                kinks += alone.gradient.kink_atoms if alone.gradient else 0
            if found.gradient:
                self.assertEqual((found.gradient.kink_atoms, kinks), (2, 2))

    def test_sets_in_a_list_and_any_number_of_threads(self):
        together = vdwmesh.exact_many(self.coords, self.radii, self.offsets, threads=1)
        parts = self.parts()
        listed = vdwmesh.exact_many([self.coords[p] for p in parts], [self.radii[p] for p in parts])
        np.testing.assert_array_equal(listed.offsets, self.offsets)
        self.assertEqual(listed.atom_area.tobytes(), together.atom_area.tobytes())
        molecule = vdwmesh.sample("bpti")
        twice = vdwmesh.exact_many([molecule, molecule], probe=1.4)
        self.assertEqual(twice.area.tolist(), [vdwmesh.exact(molecule, probe=1.4).area] * 2)

    def test_refusals(self):
        balls = (self.coords, self.radii)
        for wrong, why in (
            ([0, 61], r"offsets: go from 0 to 61; from 0 to 60"),
            ([1, 60], "offsets: go from 1 to 60"),
            ([0, 9, 9, 60], "offsets: set 1 has no atom"),
            ([0, 50, 40, 60], "offsets: set 1 has no atom"),
            ([0.0, 60.0], "offsets: has shape"),
            ([], "offsets: has shape"),
            ([[0, 60]], "offsets: has shape"),
        ):
            with self.assertRaisesRegex(vdwmesh.InvalidInput, why):
                vdwmesh.exact_many(*balls, wrong)
        with self.assertRaisesRegex(vdwmesh.InvalidInput, r"coords\[1\]: radii: are needed"):
            vdwmesh.exact_many([vdwmesh.sample("bpti"), self.coords])
        with self.assertRaisesRegex(vdwmesh.InvalidInput, r"coords\[0\]: has 60 atoms and 1 radii"):
            vdwmesh.exact_many([self.coords], [[1.0]])
        with self.assertRaisesRegex(vdwmesh.InvalidInput, "coords: is empty"):
            vdwmesh.exact_many([])
        with self.assertRaisesRegex(vdwmesh.InvalidInput, "weights: has 2 numbers for 60"):
            vdwmesh.exact_many(*balls, self.offsets, gradient=True, weights=[1, 1])
        self.coords[17, 1] = np.nan
        with self.assertRaisesRegex(vdwmesh.InvalidInput, r"coords\[17\]"):
            vdwmesh.exact_many(*balls, self.offsets)


if __name__ == "__main__":
    unittest.main()
