"""The radius sets of united atoms beside freesasa: its classifiers' files atom by atom, and its program
on structures."""

import collections
import csv
import json
import math
import pathlib
import subprocess

from program import UBIQUITIN, ProgramTest, need_package, need_shared

SETS = ("protor", "naccess", "oons")
# Elements for which freesasa guesses another radius than Bondi and Alvarez have.
OTHER_GUESS = {"Mg", "Ca", "Fe", "Br"}
SUM = 1e-12  # relative: the rounding of adding up to 4558 numbers printed in full
SLICES = 1000
PARTS = {"relative_area": "total", "relative_main_chain": "main-chain", "relative_side_chain": "side-chain",
         "relative_polar": "polar", "relative_apolar": "apolar"}


def classifier(name):
    """The file of a classifier: (residue, atom) -> (radius, class)."""
    types, atoms, section = {}, {}, None
    for line in classifier_path(name).read_text().splitlines():
        words = line.split("#")[0].split()
        if len(words) == 1 and words[0] in ("types:", "atoms:"):
            section = words[0]
        elif len(words) == 3 and section == "types:":
            types[words[0]] = float(words[1]), words[2]
        elif len(words) == 3 and section == "atoms:":
            atoms[words[0], words[1]] = types[words[2]]
    return atoms


def classifier_path(name):
    return pathlib.Path(need_package("freesasa", program="freesasa")).parents[1] / f"share/freesasa/{name}.config"


def element_of(atom):
    return {"SE": "SE"}.get(atom, {"X": "N", "A": "N"}.get(atom[0], atom[0]))


def record(serial, atom, residue, number, element, x, y):
    name = atom if len(element) == 2 or len(atom) == 4 else " " + atom
    return (f"ATOM  {serial % 100000:5} {name:<4} {residue:>3} A{number:4}    {x:8.3f}{y:8.3f}{0:8.3f}"
            f"  1.00  0.00          {element:>2}\n")


class UnitedAtoms(ProgramTest):
    def rows(self, path, *options):
        table, report = self.folder / "a.csv", self.folder / "a.json"
        self.run_ok("exact", path, "--topology", "off", "--per-atom", table, "--json", report, *options)
        with table.open(newline="") as file:
            return list(csv.DictReader(file)), json.loads(report.read_text())

    def lone_atoms(self, atoms, radius_set, *options):
        """Each atom in a residue of its own, far from the others."""
        lines = [record(i, atom, residue, i, element, 20.0 * (i % 100), 20.0 * (i // 100)) for i, (residue, atom, element) in enumerate(atoms, 1)]
        return self.rows(self.file("lone.pdb", "".join(lines)), "--radii", radius_set, "--waters", *options)

    def test_every_atom_of_the_classifiers(self):
        for radius_set in SETS:
            with self.subTest(radius_set):
                known = classifier(radius_set)
                self.assertGreater(len(known), 120)
                # Names for any residue hold for one that the classifier does not know.
                atoms = [("UNL" if residue == "ANY" else residue, atom, element_of(atom)) for residue, atom in known]
                rows, report = self.lone_atoms(atoms, radius_set)
                self.assertEqual(report["input"]["radii_assumed"], [])
                self.assertEqual(report["input"]["radius_set"], radius_set)
                ours = [(float(row["radius"]), row["polarity"]) for row in rows]
                self.assertEqual(dict(zip(known, ours, strict=True)), known)

    def test_entries_of_a_residue_take_precedence(self):
        for radius_set in ("naccess", "oons"):
            known = classifier(radius_set)
            pairs = [(residue, atom) for residue, _ in known for any_, atom in known
                     if any_ == "ANY" and residue not in ("ANY", "HOH")]
            pairs = list(dict.fromkeys(pairs))
            expected = [known.get(pair, known["ANY", pair[1]]) for pair in pairs]
            rows, _ = self.lone_atoms([(*pair, element_of(pair[1])) for pair in pairs], radius_set)
            ours = [(float(row["radius"]), row["polarity"]) for row in rows]
            self.assertEqual(dict(zip(pairs, ours, strict=True)), dict(zip(pairs, expected, strict=True)))

    def by_freesasa(self, path, radius_set):
        """(residue, atom, radius) of the program's atoms, in the order of the file; without hydrogens."""
        choice = f"--config-file={classifier_path('oons')}" if radius_set == "oons" else f"--radii={radius_set}"
        output = subprocess.run(
            [need_package("freesasa", program="freesasa"), choice, "--hetatm", "--format=json", "--depth=atom",
             "--shrake-rupley", "--resolution=1", "--no-warnings", path],
            capture_output=True, text=True, check=True).stdout
        structure = json.loads(output)["results"][0]["structure"][0]
        return [(residue["name"].strip(), atom["name"].strip(), atom["radius"])
                for chain in structure["chains"] for residue in chain["residues"] for atom in residue["atoms"]]

    def test_structures(self):
        # Proteins, haems, waters, a ligand; DNA, whose atoms have old names in these files.
        for name in ("special/1CRN.pdb", "special/1UBQ.pdb", "special/1L2Y.pdb", "thesis/4HHB.pdb", "thesis/4PTI.pdb",
                     "thesis/1ORC.pdb", "thesis/110D.pdb", "thesis/133D.pdb", "thesis/1BK2.pdb", "thesis/1CKB.pdb"):
            path = self.in_new_names(need_shared(f"molecules/{name}"))
            for radius_set in SETS:
                with self.subTest(name=name, radius_set=radius_set):
                    theirs = self.by_freesasa(path, radius_set)
                    rows, report = self.rows(path, "--radii", radius_set, "--waters")
                    self.assert_same_radii(rows, theirs)
                    self.assert_account(rows, report, radius_set)

    def in_new_names(self, path):
        """A copy of the first model, its atoms named as the PDB has named them since 2007."""
        lines = []
        for line in path.read_text().split("ENDMDL")[0].splitlines(keepends=True):
            if line.startswith(("ATOM", "HETATM")):
                name = line[12:16].replace("*", "'")
                line = line[:12] + {" O1P": " OP1", " O2P": " OP2", " C5M": " C7 "}.get(name, name) + line[16:]
            lines.append(line)
        return self.file("new_names.pdb", "".join(lines))

    def assert_same_radii(self, rows, theirs):
        """Of structures without alternate locations, atom by atom."""
        ours = [(row["residue_name"], row["atom_name"], float(row["radius"])) for row in rows]
        self.assertEqual([atom[:2] for atom in ours], [atom[:2] for atom in theirs])
        elements = [row["element"] for row in rows]
        compared = [pair for pair in zip(ours, theirs, elements) if pair[2] not in OTHER_GUESS]
        self.assertGreater(len(compared), 0.98 * len(rows))
        for our, their, _ in compared:
            self.assertEqual(our[:2], their[:2])
            self.assertAlmostEqual(our[2], their[2], delta=1e-12)  # Å; freesasa prints every digit

    def assert_account(self, rows, report, radius_set):
        """What the classifier lacks is listed with its number, and nothing else; it has no class."""
        known = classifier(radius_set)
        lacking = collections.Counter()
        for row in rows:
            residue, atom = row["residue_name"], row["atom_name"]
            # CA of calcium is not the carbon that the classifier means.
            element = element_of(atom) in (row["element"].upper(), "N")
            if ((residue, atom) in known or ("ANY", atom) in known) and element:
                self.assertIn(row["polarity"], ("polar", "apolar"))
            else:
                self.assertEqual(row["polarity"], "")
                lacking[residue, atom, row["element"]] += 1
        listed = {(a["residue"], a["atom"], a["element"]): a["count"] for a in report["input"]["radii_assumed"]}
        self.assertEqual(listed, dict(lacking))

    def test_polar_and_apolar_totals(self):
        """freesasa's classes over our areas, summed apart."""
        path = need_shared("molecules/thesis/4HHB.pdb")
        for radius_set in SETS:
            known = classifier(radius_set)
            rows, report = self.rows(path, "--radii", radius_set, "--probe", "1.4")
            sums = collections.defaultdict(list)
            for row in rows:
                residue, atom = row["residue_name"], row["atom_name"]
                _, polarity = known.get((residue, atom), known.get(("ANY", atom), (0, "unclassified")))
                sums[polarity].append(float(row["exact_area"]))
            self.assertEqual(set(sums), {"polar", "apolar", "unclassified"})  # haems and phosphates
            for polarity, areas in sums.items():
                self.assert_close(report["exact"][polarity + "_area"], math.fsum(areas), SUM)
            residues, _ = self.rows(path, "--radii", radius_set, "--probe", "1.4", "--group", "residue")
            for polarity, areas in sums.items():
                self.assert_close(math.fsum(float(row[polarity + "_area"]) for row in residues), math.fsum(areas), SUM)

    def test_sets_by_element_have_no_polarity(self):
        for radius_set in ("bondi", "alvarez"):
            rows, report = self.rows(UBIQUITIN, "--radii", radius_set, "--probe", "1.4", "--group", "residue")
            for key in ("polar_area", "apolar_area", "unclassified_area"):
                self.assertIsNone(report["exact"][key])
                self.assertEqual({row[key] for row in rows}, {""})
            self.assertEqual({row["relative_area"] for row in rows}, {""})

    def test_of_measured_atoms(self):
        rows, report = self.rows(UBIQUITIN, "--radii", "protor", "--measure", "A/10", "--probe", "1.4")
        chosen = [row for row in rows if row["residue_number"] == "10"]
        for polarity in ("polar", "apolar"):
            areas = [float(row["exact_area"]) for row in chosen if row["polarity"] == polarity]
            self.assert_close(report["exact"][polarity + "_area"], math.fsum(areas), SUM)
        self.assertEqual({row["polar_area"] for row in rows if row not in chosen}, {""})
        part = self.rows(UBIQUITIN, "--radii", "protor", "--measure", "A/10-11/CB", "--probe", "1.4", "--group", "residue")
        self.assertEqual({row["relative_area"] for row in part[0]}, {""})  # a share of a part would mislead

    def exposures(self, path, radius_set):
        """freesasa's areas and relative areas of residues by many slices, in Å² and percent."""
        output = subprocess.run(
            [need_package("freesasa", program="freesasa"), f"--radii={radius_set}", "--lee-richards",
             f"--resolution={SLICES}", "--format=json", "--depth=residue", path],
            capture_output=True, text=True, check=True).stdout
        chains = json.loads(output)["results"][0]["structure"][0]["chains"]
        return {(chain["label"], residue["number"].strip()): residue for chain in chains for residue in chain["residues"]}

    def test_relative_areas_of_residues(self):
        for name in ("special/1CRN.pdb", "special/1UBQ.pdb", "thesis/1BK2.pdb"):
            path = need_shared(f"molecules/{name}")
            for radius_set in ("protor", "naccess"):
                with self.subTest(name=name, radius_set=radius_set):
                    theirs = self.exposures(path, radius_set)
                    rows, _ = self.rows(path, "--radii", radius_set, "--probe", "1.4", "--group", "residue", "--no-hetatm")
                    self.assertEqual(len(rows), len(theirs))
                    for row in rows:
                        self.assert_same_exposure(row, theirs[row["chain"], row["residue_number"]])

    def assert_same_exposure(self, row, theirs):
        # 1000 slices of a ball of up to 3.3 Å are 0.0066 Å thick. A circle that begins between two of
        # them costs an atom at most half a slice's belt, 2 π r · 0.0066 Å / 2; 14 atoms at most.
        slack = 14 * math.pi * 3.3 * (2 * 3.3 / SLICES)
        self.assertLessEqual(abs(float(row["exact_area"]) - theirs["area"]["total"]), slack)
        for ours, key in PARTS.items():
            area, relative = theirs["area"][key], theirs["relative-area"].get(key)
            if relative is None:
                self.assertEqual(row[ours], "")  # the side chain of glycine
            elif area > 0:
                reference = area / relative * 100
                self.assertLessEqual(abs(float(row[ours]) - relative / 100), slack / reference)
                if ours == "relative_area" and float(row[ours]) > 0:
                    # The references have two decimals, of which none may differ.
                    self.assertEqual(round(float(row["exact_area"]) / float(row[ours]), 6), round(reference, 6))

    def test_no_reference_no_exposure(self):
        """Neither for another probe, nor for what is no amino acid of the table."""
        rows, _ = self.rows(UBIQUITIN, "--radii", "protor", "--probe", "1.5", "--group", "residue")
        self.assertEqual({row["relative_area"] for row in rows}, {""})
        rows, _ = self.rows(UBIQUITIN, "--radii", "protor", "--probe", "1.4")
        self.assertEqual({row["relative_area"] for row in rows}, {""})  # atoms are no residues
        rows, _ = self.lone_atoms([("UNL", "C", "C"), ("A", "P", "P"), ("HID", "CB", "C")], "protor", "--probe", "1.4", "--group", "residue")
        self.assertEqual([row["relative_area"] == "" for row in rows], [True, True, False])

    def test_hydrogens_are_part_of_the_atoms(self):
        path = need_shared("molecules/special/1L2Y.pdb")  # an NMR structure
        all_atoms = self.report("exact", path, "--topology", "off")["input"]
        rows, report = self.rows(path, "--radii", "protor")
        hydrogens = all_atoms["atoms_used"] - len(rows)
        self.assertGreater(hydrogens, 100)
        self.assertNotIn("H", {row["element"] for row in rows})
        self.assertEqual(report["input"]["skipped"]["hydrogens"], hydrogens)
        self.assertTrue(any(f"{hydrogens} hydrogens" in note for note in report["notes"]))
        asked, report = self.rows(path, "--radii", "protor", "--no-hydrogens")
        self.assertEqual(asked, rows)
        self.assertFalse(any("hydrogens" in note for note in report["notes"]))

    def test_other_names_of_standard_residues(self):
        """Protonation states, ends of chains and old names: what the standard residue has."""
        names = {
            "HIS": ("HID", "HIE", "HIP", "HSD", "HSE", "HSP"), "CYS": ("CYX", "CYM"), "ASP": ("ASH",),
            "GLU": ("GLH",), "LYS": ("LYN",), "DA": ("DA5", "DA3", "DAN"), "U": ("RU", "RU5", "U3"),
        }  # fmt: skip
        for radius_set in SETS:
            known = classifier(radius_set)
            for standard, others in names.items():
                for other in others:
                    atoms = {atom: value for (residue, atom), value in known.items() if residue == standard}
                    if not atoms:
                        continue
                    rows, report = self.lone_atoms([(other, a, element_of(a)) for a in atoms], radius_set)
                    ours = {row["atom_name"]: (float(row["radius"]), row["polarity"]) for row in rows}
                    self.assertEqual(ours, atoms, (radius_set, other))
                    own = {a for (residue, a) in known if residue == "ANY"}
                    if not set(atoms) <= own:
                        self.assertTrue(any(f"{other} (" in note for note in report["notes"]), (radius_set, other))

    def test_old_names_of_atoms(self):
        known = classifier("protor")
        pairs = {("ILE", "CD"): ("ILE", "CD1"), ("ALA", "OT1"): ("ALA", "O"), ("ALA", "OT2"): ("ALA", "OXT"),
                 ("DA", "O1P"): ("DA", "OP1"), ("DA", "C1*"): ("DA", "C1'"), ("DT", "C5M"): ("DT", "C7")}
        rows, _ = self.lone_atoms([(*pair, pair[1][0]) for pair in pairs], "protor")
        ours = [(float(row["radius"]), row["polarity"]) for row in rows]
        self.assertEqual(ours, [known[pair] for pair in pairs.values()])

    def test_an_ion_is_no_carbon(self):
        for radius_set in SETS:
            rows, report = self.lone_atoms([("CA", "CA", "CA")], radius_set)
            self.assertEqual((rows[0]["element"], rows[0]["radius"]), ("Ca", "2.62"))  # Alvarez 2013
            self.assertEqual(rows[0]["polarity"], "")
            self.assertEqual(report["input"]["radii_assumed"], [
                {"element": "Ca", "radius": 2.62, "count": 1, "residue": "CA", "atom": "CA"}])
