"""vdwmesh.read, sample and radii_of, beside the text of the files and the tables of the papers."""

import gzip
import io
import os
import pathlib
import tempfile
import unittest

import binary_cif
import numpy as np
import vdwmesh
from program import UBIQUITIN, ProgramTest, need_package, need_shared, run
from vdwmesh.errors import in_terms_of_python

# A. Bondi, J. Phys. Chem. 68 (1964) 441; S. Alvarez, Dalton Trans. 42 (2013) 8617. Å.
BONDI = {"C": 1.70, "N": 1.55, "O": 1.52, "S": 1.80}


def atom_lines():
    """The lines of the sample that are atoms and no waters, as the PDB format places their fields."""
    return [line for line in UBIQUITIN.read_text().splitlines()
            if line.startswith(("ATOM", "HETATM")) and line[17:20] != "HOH"]  # fmt: skip


class ReadTest(unittest.TestCase):
    def test_columns_are_those_of_the_file(self):
        lines, molecule = atom_lines(), vdwmesh.read(UBIQUITIN)
        self.assertEqual(len(molecule), len(lines))
        expected = [[float(line[begin : begin + 8]) for begin in (30, 38, 46)] for line in lines]
        np.testing.assert_array_equal(molecule.coords, expected)
        self.assertEqual(molecule.names.tolist(), [line[12:16].strip() for line in lines])
        self.assertEqual(molecule.elements.tolist(), [line[76:78].strip() for line in lines])
        self.assertEqual(molecule.resnames.tolist(), [line[17:20] for line in lines])
        self.assertEqual(molecule.resids.tolist(), [line[22:27].strip() for line in lines])
        self.assertEqual(molecule.chains.tolist(), [line[21] for line in lines])
        self.assertEqual(molecule.radii.tolist(), [BONDI[line[76:78].strip()] for line in lines])
        self.assertEqual(molecule.left_out, {"waters": 58})

    def test_residues_of_segments_stay_apart(self):
        atom = "ATOM      1  CA  ALA A  -1    {0:8.3f}   0.000   0.000  1.00  0.00      {1}   C  \n"
        text = "".join(atom.format(20.0 * i, name) for i, name in ((1, "P1  "), (2, "P2  "), (3, "P1  ")))
        molecule = vdwmesh.read(text.encode(), format="pdb")
        self.assertEqual(molecule.segments.tolist(), ["P1", "P2", "P1"])
        self.assertEqual(molecule.residues.tolist(), [0, 1, 2])
        self.assertEqual(vdwmesh.sasa(molecule, mode="residue").shape, (3,))
        for select in ("A/-1", "A;segment=P1,P2"):
            self.assertEqual(len(vdwmesh.read(text.encode(), format="pdb", select=select)), 3)

    def test_empty_arguments_and_radii_beside_those_of_the_file_are_refused(self):
        for name in ("select", "radii"):
            with self.assertRaisesRegex(ValueError, f"{name}: is empty"):
                vdwmesh.read(UBIQUITIN, **{name: ""})
        with self.assertRaisesRegex(ValueError, "leave out radii='bondi'"):
            vdwmesh.read(b"0 0 0 1\n", format="xyzr", radii="bondi")

    def test_a_radius_file_adds_to_a_set(self):
        with tempfile.TemporaryDirectory() as folder:
            mine = pathlib.Path(folder, "mine.txt")
            mine.write_text("C 2\n")
            self.assertEqual(vdwmesh.radii_of(["C", "N"], set=f"bondi,{mine}").tolist(), [2.0, 1.55])
            molecule = vdwmesh.read(UBIQUITIN, radii=f"bondi,{mine}")
            self.assertEqual(set(molecule.radii[molecule.elements == "C"]), {2.0})

    def test_atoms_of_mmcif_are_those_of_gemmi(self):
        gemmi = need_package("python3-gemmi", module="gemmi")
        for name in ("special/1EJG.cif", "thesis/1HH0.cif", "thesis/1QL2.cif",
                     "odd/biopython_a_structure.cif", "large/6ZU5.cif.gz"):  # fmt: skip
            with self.subTest(name):
                path = need_shared(f"molecules/{name}")
                witness = [
                    (chain.name, str(residue.seqid), residue.name, atom.name, atom.element.name,
                     *atom.pos.tolist())
                    for chain in gemmi.read_structure(str(path))[0]
                    for residue in chain for atom in residue]  # fmt: skip
                found = vdwmesh.read(path, waters=True, altloc="all")
                ours = zip(found.chains.tolist(), found.resids.tolist(), found.resnames.tolist(),
                           found.names.tolist(), found.elements.tolist(), *found.coords.T.tolist())  # fmt: skip
                # gemmi brings the atoms of a residue together.
                self.assertEqual(sorted(ours), sorted(witness))

    def test_all_ways_to_name_a_source_are_one(self):
        expected = vdwmesh.read(UBIQUITIN)
        content = UBIQUITIN.read_bytes()
        named = io.BytesIO(content)
        named.name = "x.pdb"
        with UBIQUITIN.open("rb") as file:
            found = [vdwmesh.read(str(UBIQUITIN)), vdwmesh.read(content, format="pdb"),
                     vdwmesh.read(gzip.compress(content), format="pdb"), vdwmesh.read(named),
                     vdwmesh.read(file), vdwmesh.read(io.BytesIO(content), format="pdb"),
                     vdwmesh.sample("ubiquitin")]  # fmt: skip
        for molecule in found:
            np.testing.assert_array_equal(molecule.coords, expected.coords)
            self.assertEqual(molecule.names.tolist(), expected.names.tolist())

    def test_options_reach_the_reader(self):
        lines = UBIQUITIN.read_text().splitlines()
        every = sum(line.startswith(("ATOM", "HETATM")) for line in lines)
        self.assertEqual(len(vdwmesh.read(UBIQUITIN, waters=True)), every)
        self.assertEqual(set(vdwmesh.read(UBIQUITIN, select="A/10-40/CA").names), {"CA"})
        self.assertEqual(len(vdwmesh.read(UBIQUITIN, select="A/10-40/CA")), 31)
        self.assertEqual(vdwmesh.read(UBIQUITIN, radii="alvarez").radii[0], 1.66)  # nitrogen
        molecule = vdwmesh.read(UBIQUITIN, waters=True, hetatm=False)
        self.assertEqual(molecule.left_out, {"hetatm": 58})

    def test_models_assemblies_and_altlocs(self):
        models = need_shared("molecules/special/1D3Z.pdb")
        first, every = vdwmesh.read(models), vdwmesh.read(models, model="all")
        self.assertEqual(len(every), 10 * len(first))  # 10 models of one protein
        np.testing.assert_array_equal(vdwmesh.read(models, model=2).coords,
                                      every.coords[len(first) : 2 * len(first)])  # fmt: skip
        self.assertLess(len(vdwmesh.read(models, hydrogens=False)), len(first))
        crystal = need_shared("molecules/special/1EJG.pdb")
        self.assertGreater(len(vdwmesh.read(crystal, altloc="all")), len(vdwmesh.read(crystal)))
        virus = need_shared("molecules/special/1F2N.pdb")
        copies = vdwmesh.read(virus, assembly=1)
        self.assertEqual(len(copies), 60 * len(vdwmesh.read(virus)))  # icosahedral: 60 operators

    def test_masks_choose_atoms(self):
        molecule = vdwmesh.sample("ubiquitin")
        carbons = molecule[molecule.elements == "C"]
        self.assertEqual(set(carbons.radii), {1.70})
        self.assertEqual(len(carbons), sum(line[77] == "C" for line in atom_lines()))
        self.assertEqual(molecule[5].names.tolist(), [molecule.names[5]])
        self.assertEqual(len(molecule[10:20]), 10)

    def test_faults_of_files_are_told_in_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "empty.pdb"
            path.write_text("")
            cases = [(OSError, "cannot be opened", "/not/there.pdb", {}),
                     (OSError, "empty.pdb", path, {}),
                     (ValueError, "model", UBIQUITIN, {"model": 7}),
                     (ValueError, "format", b"ATOM", {}),
                     (ValueError, "format", UBIQUITIN, {"format": "xtc"}),
                     (ValueError, "source", 5, {}),
                     (ValueError, "radii", UBIQUITIN, {"radii": "/not/there.txt"})]  # fmt: skip
            for cause, word, source, options in cases:
                with self.subTest(source=source, **options):
                    with self.assertRaises(cause) as caught:
                        vdwmesh.read(source, **options)
                    self.assertIsInstance(caught.exception, vdwmesh.Error)
                    self.assertIn(word, str(caught.exception))
                    self.assertNotIn("\n", str(caught.exception))


    def test_a_missing_file_is_what_python_calls_so(self):
        for kind in (FileNotFoundError, vdwmesh.FileFormatError, vdwmesh.FileMissing):
            with self.subTest(kind), self.assertRaisesRegex(kind, "^/not/there.pdb: cannot be opened: No such file"):
                vdwmesh.read("/not/there.pdb")
        with self.assertRaises(FileNotFoundError) as caught:
            vdwmesh.quality("/not/there.ply")
        self.assertEqual(caught.exception.errno, 2)
        with self.assertRaises(FileNotFoundError):
            vdwmesh.read(UBIQUITIN, radii=pathlib.Path("/not/there.txt"))

    def test_molecules_are_compared_by_their_atoms(self):
        molecule = vdwmesh.read(UBIQUITIN)
        self.assertEqual(molecule, vdwmesh.sample("ubiquitin"))
        self.assertNotEqual(molecule, molecule[:5])
        self.assertNotEqual(molecule, 5)

    def test_radius_sets_in_any_case_and_paths(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "radii.txt"
            path.write_text("H 1\nC 2\nN 2\nO 2\nS 2\n")
            molecule = vdwmesh.read(UBIQUITIN)
            self.assertEqual(vdwmesh.exact(molecule, path).area,
                             vdwmesh.exact(vdwmesh.read(UBIQUITIN, radii=path)).area)  # fmt: skip
            self.assertEqual(next(vdwmesh.frames(molecule, radii=path)).area, vdwmesh.exact(molecule, path).area)
            self.assertTrue(vdwmesh.mesh_many([molecule[:3]], path, spacing=1)[0].is_closed)
        self.assertEqual(vdwmesh.exact(molecule, "Bondi").area, vdwmesh.exact(molecule).area)
        self.assertEqual(vdwmesh.radii_of(["C"], set="ALVAREZ").tolist(), [1.77])

    def test_messages_name_arguments(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "q--radii.pdb"
            path.write_text("HETATM    1 Q1   LIG A   1       0.000   0.000   0.000  1.00  0.00\n")
            with self.assertRaises(ValueError) as caught:
                vdwmesh.read(path)
        self.assertIn("q--radii.pdb", str(caught.exception))
        self.assertNotIn(" --", str(caught.exception))
        self.assertIn("radii=", str(caught.exception))
        self.assertEqual(
            in_terms_of_python("say --format pdb, --radii FILE, --select '[!X]', --waters or --no-hydrogens; a--radii --tables"),
            "say format='pdb', radii=FILE, select='[!X]', waters=True or hydrogens=False; a--radii --tables")


class BinaryCifTest(unittest.TestCase):
    """Columns as writers of BinaryCIF encode them, by the encoder of the tests."""

    NUMBERS = [5, 9, 2, 7, 1, 0, 3, 3]

    def resids(self, data, mask=None):
        need_package("python3-msgpack", module="msgpack")
        rows = len(self.NUMBERS)
        texts = {"label_asym_id": ["A"] * rows, "label_comp_id": ["UNL"] * rows, "type_symbol": ["C"] * rows,
                 "label_atom_id": [f"C{i}" for i in range(rows)], "Cartn_x": [f"{9 * i}.0" for i in range(rows)],
                 "Cartn_y": ["0.0"] * rows, "Cartn_z": ["0.0"] * rows}  # fmt: skip
        table = [binary_cif.column(name, values) for name, values in texts.items()]
        table.append({"name": "auth_seq_id", "data": binary_cif.packed_data(data), "mask": mask})
        packed = binary_cif.pack(binary_cif.document(("x", [binary_cif.category("_atom_site", table, rows)])))
        return [int(number) for number in vdwmesh.read(packed, format="bcif").resids]

    def test_differences_of_unsigned_types_go_round(self):
        for source, letter in ((4, "B"), (5, "H"), (6, "I")):
            size = 1 << 8 * (1, 2, 4)[source - 4]
            steps = [(b - a) % size for a, b in zip([0, *self.NUMBERS], self.NUMBERS)]
            encodings, data = binary_cif.byte_array(steps, letter)
            delta = {"kind": "Delta", "origin": 0, "srcType": source}
            with self.subTest(source):
                self.assertEqual(self.resids(([delta, *encodings], data)), self.NUMBERS)

    def test_differences_of_signed_types_go_round(self):
        for source, letter in ((1, "b"), (2, "h"), (3, "i")):
            half = 1 << (8 * (1, 2, 4)[source - 1] - 1)
            least = -half + (source == 3)  # the least int is no residue number: gemmi keeps it for "none"
            numbers = [half - 1, least, 7, half - 1, 0, -1, least, half - 2]
            steps = [(b - a + half) % (2 * half) - half for a, b in zip([0, *numbers], numbers)]
            encodings, data = binary_cif.byte_array(steps, letter)
            delta = {"kind": "Delta", "origin": 0, "srcType": source}
            with self.subTest(source):
                self.assertEqual(self.resids(([delta, *encodings], data)), numbers)

    def test_an_empty_mask_is_none(self):
        self.assertEqual(self.resids(binary_cif.int32(self.NUMBERS), {}), self.NUMBERS)


class ForeignLettersTest(unittest.TestCase):
    """Names that are no ASCII, and names that are no UTF-8."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.path = os.path.join(folder.name, os.fsdecode(b"l\xe4t.pdb"))  # Latin-1

    def line(self, residue):
        return b"HETATM    1  C1  " + residue + b" A   1       0.000   0.000   0.000  1.00  0.00           C\n"

    def test_names_of_files_come_back(self):
        with open(self.path, "wb") as file:
            file.write(self.line(b"LIG"))
        molecule = vdwmesh.read(self.path)
        self.assertEqual(molecule.path, self.path)
        self.assertEqual([row.name for row in vdwmesh.batch(self.folder)], [self.path])
        with open(self.path, "rb") as file:
            self.assertEqual(vdwmesh.read(file).path, self.path)
        mesh = vdwmesh.mesh(molecule, edge_length=1.0)
        mesh.save(self.path + ".ply")
        self.assertEqual(vdwmesh.quality(self.path + ".ply").triangles, len(mesh.faces))

    def test_texts_are_utf8_or_come_back_as_they_were(self):
        for residue, expected in ((b"\xc3\xa4L", "äL"), (b"\xe4L", "\udce4L")):
            with self.subTest(residue):
                molecule = vdwmesh.read(self.line(residue.ljust(3)), format="pdb")
                self.assertEqual(molecule.resnames.tolist(), [expected])
                self.assertEqual(vdwmesh.exact(molecule, "bondi").area, vdwmesh.exact(molecule).area)
                chosen = vdwmesh.read(self.line(residue.ljust(3)), format="pdb", select=f"({expected})")
                self.assertEqual(len(chosen), 1)

    def test_faults_are_rows_and_messages_that_print(self):
        with open(self.path, "wb") as file:
            file.write(b"HETATM    1  Q1  L\xe4G A   1       0.000   0.000   0.000  1.00  0.00           Q\n")
        (self.folder / "z.xyzr").write_text("0 0 0 1\n")
        rows = list(vdwmesh.batch(self.folder))
        self.assertEqual([row.name for row in rows], [self.path, str(self.folder / "z.xyzr")])
        self.assertIn("l\\xe4t.pdb", rows[0].error)
        rows[0].error.encode()
        self.assertGreater(rows[1].area, 12)
        with self.assertRaises(ValueError) as caught:
            vdwmesh.read(self.path)
        self.assertEqual(str(caught.exception), rows[0].error)
        with self.assertRaisesRegex(FileNotFoundError, r"n\\xe4ne"):
            vdwmesh.read(os.fsdecode(b"n\xe4ne.pdb"))


class SameAsProgramTest(ProgramTest):
    def test_odd_files_are_read_or_refused_alike(self):
        for path in sorted(need_shared("molecules/odd").iterdir()):
            if path.suffix not in (".pdb", ".cif"):
                continue
            with self.subTest(path=path.name):
                table = self.folder / "atoms.csv"
                result = run("exact", path, "--per-atom", table, "--topology", "off")
                try:
                    molecule = vdwmesh.read(path)
                except vdwmesh.Error as error:
                    self.assertEqual(in_terms_of_python(result.stderr), f"vdwmesh: {error}\n")
                    continue
                self.assertEqual(result.returncode, 0, result.stderr)
                rows = [line.split(",") for line in table.read_text().splitlines()[1:]]
                self.assertEqual(molecule.radii.tolist(), [float(row[8]) for row in rows])
                self.assertEqual(molecule.elements.tolist(), [row[5] for row in rows])
                self.assertEqual(molecule.resids.tolist(), [row[2] for row in rows])


class RadiiTest(unittest.TestCase):
    def test_elements_in_any_spelling(self):
        found = vdwmesh.radii_of(["C", "n", "ZN", "Zn2+", " O"])
        self.assertEqual(found.tolist(), [1.70, 1.55, 1.39, 1.39, 1.52])
        self.assertEqual(vdwmesh.radii_of(np.array(["Ca"]), set="alvarez").tolist(), [2.62])

    def test_united_atoms(self):
        # J. Tsai et al., J. Mol. Biol. 290 (1999) 253: aliphatic C4H1 1.88 Å, carbonyl C3H0 1.61 Å.
        found = vdwmesh.radii_of(["C", "C"], set="protor", resnames=["ALA", "ALA"], names=["CA", "C"])
        self.assertEqual(found.tolist(), [1.88, 1.61])

    def test_unknown_elements(self):
        with self.assertRaisesRegex(ValueError, r"elements\[1\].*'Q'"):
            vdwmesh.radii_of(["C", "Q"])
        self.assertEqual(vdwmesh.radii_of(["C", "Q"], unknown=2.5).tolist(), [1.70, 2.5])

    def test_files_by_residue_and_atom(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "radii.txt"
            path.write_text("C 1.7\nALA CA 2.25\n")
            found = vdwmesh.radii_of(["C", "C"], set=path, resnames=["ALA", "GLY"], names=["CA", "CA"])
        self.assertEqual(found.tolist(), [2.25, 1.7])

    def test_wrong_arguments_are_named(self):
        with self.assertRaisesRegex(ValueError, "names: has 1 entries for 2"):
            vdwmesh.radii_of(["C", "C"], names=["CA"])
        with self.assertRaisesRegex(ValueError, "elements"):
            vdwmesh.radii_of([6, 7])
        with self.assertRaisesRegex(ValueError, "'unheard-of': neither a set"):
            vdwmesh.radii_of(["C"], set="unheard-of")


if __name__ == "__main__":
    unittest.main()
