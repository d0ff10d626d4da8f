"""Radii and the choice of atoms, against packages of others that know them: ASE and Biopython."""

import collections
import csv
import inspect
import re
import warnings

from program import ProgramTest, need_package, need_shared

# The paper gives platinum a range, 1.7-1.8: ASE takes its middle, we what the Cambridge database
# and most programs take, 1.72.
BONDI_DIFFERS = {"Pt"}


def record(serial, name, residue, chain, number, x, altloc=" ", occupancy=1.0, element="",
           kind="ATOM"):
    """`number` is five columns wide: four of the number, one of the insertion code."""
    return (f"{kind:<6}{serial:5} {name:<4}{altloc}{residue:>3} {chain}{number:>5}   "
            f"{x:8.3f}{0:8.3f}{0:8.3f}{occupancy:6.2f}{10:6.2f}          {element:>2}\n")


class PerAtomTest(ProgramTest):
    def rows(self, path, *options):
        """What the program made of the file, atom by atom."""
        table = self.folder / "atoms.csv"
        self.run_ok("exact", path, "--topology", "off", "--per-atom", table, *options)
        with open(table, newline="") as file:
            return list(csv.DictReader(file))


class Radii(PerAtomTest):
    def radii(self, elements, radius_set):
        atoms = self.file("elements.pdb", "".join(
            record(i, "X", "UNL", "A", f"{i} ", 20 * i, element=element.upper())
            for i, element in enumerate(elements)))
        rows = self.rows(atoms, "--radii", radius_set)
        self.assertEqual([row["element"] for row in rows], list(elements))
        return {row["element"]: float(row["radius"]) for row in rows}

    def test_alvarez_lists_what_ase_lists(self):
        need_package("python3-ase", module="ase.data")
        from ase.data import chemical_symbols
        from ase.data.vdw_alvarez import vdw_radii
        witness = {chemical_symbols[number]: float(radius)
                   for number, radius in enumerate(vdw_radii) if radius == radius}
        self.assertEqual(len(witness), 93)  # the abstract of the paper: "93 elements"
        self.assertEqual(self.radii(witness, "alvarez"), witness)

    def test_bondi_is_what_ase_takes_from_bondi(self):
        need_package("python3-ase", module="ase.data")
        import ase.data.vdw
        # Reference 1 of its list is Bondi's paper; hydrogen bears no number.
        lines = re.findall(r"([\d.]+),\s*# (\w+) \[1\]", inspect.getsource(ase.data.vdw))
        witness = {element: float(radius) for radius, element in lines} | {"H": 1.20}
        self.assertEqual(len(witness), 38)
        ours = self.radii(witness, "bondi")
        self.assertEqual({e for e in witness if ours[e] != witness[e]}, BONDI_DIFFERS)
        report = self.report("exact", self.folder / "elements.pdb", "--topology", "off")
        self.assertEqual(report["input"]["radii_assumed"], [])


class Choice(PerAtomTest):
    """Which atoms stand in a structure: residues with insertion codes, alternate locations."""

    @classmethod
    def setUpClass(cls):
        need_package("python3-biopython", module="Bio.PDB")

    def by_biopython(self, path):
        """Its atoms of the first model, each name of a residue once; and the places at which it sees
        residues of several names, between which it decides otherwise."""
        from Bio.PDB import PDBParser
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model = next(iter(PDBParser(QUIET=True).get_structure("x", str(path))))
        atoms, mixed = collections.Counter(), set()
        for residue in model.get_residues():
            _, number, code = residue.id
            place = residue.get_parent().id.strip(), f"{number}{code.strip()}"
            if residue.is_disordered() == 2:
                mixed.add(place)
            for atom in residue:
                atoms[(*place, residue.resname.strip(), atom.get_name())] += 1
        return atoms, mixed

    def assert_same_atoms(self, path, twice=()):
        """`twice`: atoms that the file has more than once, of which Biopython takes the first."""
        witness, mixed = self.by_biopython(path)
        ours = collections.Counter(
            (row["chain"], row["residue_number"], row["residue_name"], row["atom_name"])
            for row in self.rows(path, "--waters"))
        self.assertGreater(len(ours), 0)
        for atom in twice:
            self.assertGreater(ours[atom], 1)
            ours[atom] = 1
        for place in mixed:
            witness = collections.Counter({k: n for k, n in witness.items() if k[:2] != place})
            ours = collections.Counter({k: n for k, n in ours.items() if k[:2] != place})
        self.assertEqual(ours, witness)

    def test_of_small_files(self):
        files = {
            "insertion codes": [("CA", "ALA", "52 ", " ", 1), ("CA", "GLY", "52A", " ", 1),
                                ("CA", "SER", "52B", " ", 1), ("CA", "ALA", "-3 ", " ", 1),
                                ("CA", "ALA", "0 ", " ", 1), ("CA", "ALA", "0Z", " ", 1)],
            "digits for letters": [("CA", "ALA", "1 ", "1", 0.4), ("CA", "ALA", "1 ", "2", 0.6),
                                   ("CB", "ALA", "1 ", "1", 0.4), ("CB", "ALA", "1 ", "2", 0.6)],
            "one label alone": [("N", "ALA", "1 ", " ", 1), ("CA", "ALA", "1 ", "C", 0.3)],
            "atoms of one label": [("HA", "SER", "1 ", "A", 1), ("CB", "SER", "1 ", "A", 0.44),
                                   ("CB", "SER", "1 ", "B", 0.96), ("OG", "SER", "1 ", "B", 0.96),
                                   ("HG", "SER", "1 ", "a", 0.1), ("N", "SER", "1 ", " ", 1)],
            "three labels": [(name, "LEU", "1 ", label, occupancy) for name in ("CA", "CB", "CG")
                             for label, occupancy in (("A", 0.2), ("B", 0.5), ("C", 0.3))],
            "of two residues with one number": [("CA", "ALA", "1 ", "A", 0.5),
                                                ("CA", "ALA", "1A", "B", 0.5)],
        }
        for name, atoms in files.items():
            with self.subTest(name):
                self.assert_same_atoms(self.file("a.pdb", "".join(
                    record(i, f" {atom}", residue, "A", number, 3 * i, label, occupancy, atom[0])
                    for i, (atom, residue, number, label, occupancy) in enumerate(atoms))))

    def test_of_deposited_and_odd_files(self):
        twice = {"odd/pdbtbx_insertion_codes.pdb": [("A", "465A", "HIS", "C"),
                                                    ("A", "465B", "HIS", "CD2")]}
        for name in ("special/1EJG.pdb", "special/19HC.pdb", "thesis/1IZH.pdb", "thesis/4HHB.pdb",
                     "odd/pdbtbx_insertion_codes.pdb", "odd/biopython_disordered.pdb",
                     "odd/openmm_altlocs2.pdb", "odd/pdbtools_anisou_altloc.pdb",
                     "odd/pdbtools_dummy_altloc3.pdb", "odd/pdbtools_dummy_nohead.pdb"):
            with self.subTest(name):
                self.assert_same_atoms(need_shared(f"molecules/{name}"), twice.get(name, ()))
