"""GRO, MOL2, SDF, XYZ and PDBQT: the same molecule through each of them, beside readers and writers of others."""

import gzip
import pathlib
import random
import tempfile
import unittest
import warnings

import numpy as np
import vdwmesh
from program import UBIQUITIN, need_package

# Where a format has all digits of the PDB file, coordinates differ by the rounding of nm to Å alone.
EQUAL = 1e-9
# Half a unit of the last digit of GROMACS's own .gro, 0.001 nm, and of single precision at 60 Å, in Å.
GRO_DIGITS, FLOAT32 = 0.0051, 4e-6


def write_gro(molecule, decimals=4):
    """Coordinates in nm with that many decimals, velocities behind every second precision."""
    width = decimals + 5
    lines = ["made for a test", f"{len(molecule):5}"]
    for i, (name, residue, number, place) in enumerate(rows_of(molecule), 1):
        numbers = "".join(f"{x / 10:{width}.{decimals}f}" for x in place)
        velocity = f"{0.1:{width}.{decimals + 1}f}" * 3 if decimals % 2 else ""
        lines.append(f"{int(number):5}{residue:<5}{name:>5}{i % 100000:5}{numbers}{velocity}")
    return "\n".join([*lines, " 20.0 20.0 20.0", ""])


def rows_of(molecule):
    return zip(molecule.names, molecule.resnames, molecule.resids, molecule.coords)


def write_mol2(molecule):
    forms = {"C": "C.3", "N": "N.am", "O": "O.2", "S": "S.3", "H": "H"}
    atoms = [f"{i} {name} {x:.4f} {y:.4f} {z:.4f} {forms[element]} {number} {residue}{number} 0.0"
             for i, (element, (name, residue, number, (x, y, z)))
             in enumerate(zip(molecule.elements, rows_of(molecule)), 1)]  # fmt: skip
    chains = dict(zip(molecule.resids, zip(molecule.resnames, molecule.chains)))
    parts = [f"{i} {name}{i} 1 RESIDUE 1 {chain} {name} 0" for i, (name, chain) in chains.items()]
    return "\n".join(["@<TRIPOS>MOLECULE", "made for a test", f"{len(atoms)} 0 {len(parts)} 0 0", "PROTEIN",
                      "USER_CHARGES", "", "@<TRIPOS>ATOM", *atoms, "@<TRIPOS>SUBSTRUCTURE", *parts, ""])  # fmt: skip


def write_v2000(molecule):
    atoms = [f"{x:10.4f}{y:10.4f}{z:10.4f} {element:<3} 0  0  0  0  0  0  0  0  0  0  0  0"
             for element, (x, y, z) in zip(molecule.elements, molecule.coords)]  # fmt: skip
    counts = f"{len(atoms):3}  0  0  0  0  0  0  0  0  0999 V2000"
    return "\n".join(["", "  made for a test 3D", "", counts, *atoms, "M  END", "$$$$", ""])


def write_v3000(molecule):
    atoms = [f"M  V30 {i} {element} {x:.4f} {y:.4f} {z:.4f} 0"
             for i, (element, (x, y, z)) in enumerate(zip(molecule.elements, molecule.coords), 1)]  # fmt: skip
    return "\n".join(["", "  made for a test 3D", "", "  0  0  0     0  0            999 V3000", "M  V30 BEGIN CTAB",
                      f"M  V30 COUNTS {len(atoms)} 0 0 0 0", "M  V30 BEGIN ATOM", *atoms, "M  V30 END ATOM",
                      "M  V30 END CTAB", "M  END", "$$$$", ""])  # fmt: skip


def write_xyz(molecule):
    atoms = [f"{element} {x} {y} {z}" for element, (x, y, z) in zip(molecule.elements, molecule.coords)]
    return "\n".join([str(len(atoms)), "made for a test", *atoms, ""])


def write_pdbqt(molecule):
    types = {"C": "A", "N": "NA", "O": "OA", "S": "SA", "H": "HD"}
    atoms = [f"ATOM  {i:5}  {name:<3} {residue:>3} {'A'}{int(number):4}    {x:8.3f}{y:8.3f}{z:8.3f}"
             f"  1.00  0.00    {0.1:6.3f} {types[element]:<2}"
             for i, (element, (name, residue, number, (x, y, z)))
             in enumerate(zip(molecule.elements, rows_of(molecule)), 1)]  # fmt: skip
    return "\n".join(["ROOT", *atoms[:9], "ENDROOT", "BRANCH   2  10", *atoms[9:], "ENDBRANCH   2  10", "TORSDOF 1", ""])


WRITERS = {"a.gro": write_gro, "b.gro": lambda molecule: write_gro(molecule, 7), "a.mol2": write_mol2, "a.sdf": write_v2000,
           "a.mol": write_v3000, "a.xyz": write_xyz, "a.pdbqt": write_pdbqt}  # fmt: skip


class FormatsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.molecule = vdwmesh.read(UBIQUITIN)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, molecule=None):
        path = self.folder / name
        path.write_text(WRITERS[name](self.molecule if molecule is None else molecule))
        return path

    def sparse_atoms(self, seed):
        """Atoms of the sample in an order by chance, at places of four decimals by chance."""
        rng = random.Random(seed)
        chosen = self.molecule[sorted(rng.sample(range(len(self.molecule)), 200))]
        coords = [[round(rng.uniform(-99, 999), 4) for _ in "xyz"] for _ in range(len(chosen))]
        chosen.coords.flags.writeable = True
        chosen.coords[:] = coords
        return chosen


class SameMolecule(FormatsTest):
    def test_areas_are_those_of_the_pdb_file(self):
        expected = vdwmesh.exact(self.molecule)
        for name in WRITERS:
            with self.subTest(name):
                found = vdwmesh.read(self.write(name))
                self.assertEqual(found.elements.tolist(), self.molecule.elements.tolist())
                np.testing.assert_allclose(found.coords, self.molecule.coords, rtol=0, atol=1e-12)
                measures = vdwmesh.exact(found)
                self.assertAlmostEqual(measures.area / expected.area, 1, delta=EQUAL)
                self.assertAlmostEqual(measures.volume / expected.volume, 1, delta=EQUAL)
                np.testing.assert_allclose(measures.atom_area, expected.atom_area, rtol=0, atol=1e-7)

    def test_residues_are_those_of_the_pdb_file(self):
        expected = vdwmesh.sasa(vdwmesh.read(UBIQUITIN, radii="protor"), mode="residue")
        for name in ("a.gro", "a.mol2", "a.pdbqt"):
            with self.subTest(name):
                found = vdwmesh.read(self.write(name), radii="protor")
                self.assertEqual(found.resnames.tolist(), self.molecule.resnames.tolist())
                self.assertEqual(found.resids.tolist(), self.molecule.resids.tolist())
                np.testing.assert_allclose(vdwmesh.sasa(found, mode="residue"), expected, rtol=EQUAL)
                part = vdwmesh.read(self.write(name), select="resi 10-20 and backbone")
                self.assertEqual(len(part), 44)

    def test_every_door(self):
        for name in WRITERS:
            with self.subTest(name):
                path = self.write(name)
                packed = self.folder / (name + ".gz")
                packed.write_bytes(gzip.compress(path.read_bytes()))
                plain = vdwmesh.read(path)
                self.assertEqual(vdwmesh.read(packed), plain)
                form = {"pdbqt": "pdb", "mol": "sdf"}.get(path.suffix[1:], path.suffix[1:])
                self.assertEqual(vdwmesh.read(path.read_bytes(), format=form), plain)

    def test_batch_takes_all_of_a_folder(self):
        for name in WRITERS:
            self.write(name)
        areas = [row.area for row in vdwmesh.batch(self.folder)]
        self.assertEqual(len(areas), len(WRITERS))
        np.testing.assert_allclose(areas, vdwmesh.exact(self.molecule).area, rtol=EQUAL)


class Witnesses(FormatsTest):
    """What others read of the same files, and what we read of theirs."""

    def setUp(self):
        super().setUp()
        warnings.simplefilter("ignore")

    def assert_same_atoms(self, path, elements, coords, digits=FLOAT32):
        found = vdwmesh.read(path)
        self.assertEqual(found.elements.tolist(), list(elements))
        np.testing.assert_allclose(found.coords, coords, rtol=0, atol=digits)

    def test_mdanalysis_reads_the_same(self):
        package = need_package("python3-mdanalysis", module="MDAnalysis")
        for seed, name in enumerate(("a.gro", "b.gro", "a.mol2", "a.xyz", "a.pdbqt")):
            with self.subTest(name):
                path = self.write(name, None if name == "a.pdbqt" else self.sparse_atoms(seed))
                atoms = package.Universe(str(path)).atoms
                found = vdwmesh.read(path)
                np.testing.assert_allclose(found.coords, atoms.positions, rtol=1e-6, atol=FLOAT32)
                if name != "a.xyz":
                    self.assertEqual(found.names.tolist(), atoms.names.tolist())
                if name not in ("a.mol2", "a.xyz"):
                    self.assertEqual(found.resnames.tolist(), atoms.resnames.tolist())
                    self.assertEqual(found.resids.tolist(), [str(number) for number in atoms.resids])

    def test_ase_reads_the_same(self):
        read = need_package("python3-ase", module="ase.io").read
        for seed, name in enumerate(("a.sdf", "a.xyz")):
            with self.subTest(name):
                path = self.write(name, self.sparse_atoms(seed))
                atoms = read(path)
                self.assert_same_atoms(path, atoms.get_chemical_symbols(), atoms.positions, digits=1e-12)

    def test_mdtraj_reads_the_same(self):
        mdtraj = need_package("python3-mdtraj", module="mdtraj")
        path = self.write("a.gro")
        frame = mdtraj.load(str(path))
        elements = [atom.element.symbol for atom in frame.topology.atoms]
        self.assert_same_atoms(path, elements, 10 * frame.xyz[0], digits=1e-5)

    def test_files_that_others_write(self):
        package = need_package("python3-mdanalysis", module="MDAnalysis")
        write = need_package("python3-ase", module="ase.io").write
        symbols, coords = self.molecule.elements, self.molecule.coords
        group = package.Universe(str(UBIQUITIN)).select_atoms("not resname HOH")
        for name, digits in (("u.gro", GRO_DIGITS), ("u.xyz", 1e-4)):
            with self.subTest(name):
                group.write(str(self.folder / name))
                self.assert_same_atoms(self.folder / name, symbols, coords, digits)
        import ase
        atoms = ase.Atoms(list(symbols), coords, cell=[90, 90, 90], pbc=True)
        for name, form, digits in (("p.xyz", "xyz", 1e-12), ("e.xyz", "extxyz", 1e-7), ("s.gro", "gromacs", GRO_DIGITS)):
            with self.subTest(name):
                write(self.folder / name, atoms, format=form)
                self.assert_same_atoms(self.folder / name, symbols, coords, digits)
        self.assertTrue(any("lattice" in note for note in vdwmesh.read(self.folder / "e.xyz").notes))


if __name__ == "__main__":
    unittest.main()
