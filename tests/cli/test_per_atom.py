"""--per-atom: rows, columns and sums."""

import csv
import math

from program import UBIQUITIN, ProgramTest, parse_json

SUM = 1e-12  # relative: the rounding of adding up to 602 numbers printed in full


class PerAtom(ProgramTest):
    def rows(self, *arguments, verb="report"):
        table, json_path = self.folder / "a.csv", self.folder / "a.json"
        self.run_ok(verb, UBIQUITIN, "--per-atom", table, "--json", json_path, *arguments)
        with table.open(newline="") as file:
            return list(csv.DictReader(file)), parse_json(json_path.read_text())

    def assert_sums(self, rows, report):
        total = {
            key: math.fsum(float(row[key]) for row in rows)
            for key in ("exact_area", "mesh_area", "exact_volume")
        }
        self.assert_close(total["exact_area"], report["exact"]["area"], SUM)
        self.assert_close(total["exact_volume"], report["exact"]["volume"], SUM)
        self.assert_close(total["mesh_area"], report["mesh"]["area"], SUM)

    def test_atoms(self):
        rows, report = self.rows()
        self.assertEqual(len(rows), 602)
        self.assert_sums(rows, report)
        first = rows[0]  # ATOM 1 N MET A 1
        self.assertEqual(
            [first[key] for key in ("chain", "residue_number", "residue_name", "atom_name")],
            ["A", "1", "MET", "N"],
        )
        self.assertEqual((first["element"], first["radius"]), ("N", "1.55"))  # Bondi 1964

    def test_residues_and_chains(self):
        rows, report = self.rows("--group", "residue")
        self.assertEqual(len(rows), 76)
        self.assertEqual(sum(int(row["atoms"]) for row in rows), 602)
        self.assert_sums(rows, report)
        rows, report = self.rows("--group", "chain")
        self.assertEqual(len(rows), 1)
        self.assert_sums(rows, report)

    def test_models_stay_apart(self):
        """Two models of the same chain and residues, all taken as one set: rows of their own."""
        atom = "ATOM  {0:5}  CA  {1} A{2:4}    {3:8.3f}   0.000   0.000  1.00  0.00           C  \n"
        models = ""
        for model in (3, 7):
            residues = (atom.format(i, name, i, 10.0 * i + 100 * model) for i, name in ((1, "ALA"), (2, "GLY")))
            models += f"MODEL {model:8}\n" + "".join(residues) + "ENDMDL\n"
        path, table = self.file("models.pdb", models + "END\n"), self.folder / "a.csv"
        expected = {"atom": [("3", "1"), ("3", "2"), ("7", "1"), ("7", "2")], "chain": [("3", ""), ("7", "")]}
        expected["residue"] = expected["atom"]
        area = 4 * math.pi * 1.7**2  # of a carbon atom by itself (Bondi 1964)
        for group, keys in expected.items():
            self.run_ok("exact", path, "--model", "all", "--per-atom", table, "--group", group)
            with table.open(newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual([(row["model"], row["residue_number"]) for row in rows], keys)
            for row in rows:
                self.assert_close(float(row["exact_area"]), int(row["atoms"]) * area, SUM)

    def test_without_a_mesh_the_column_is_empty(self):
        rows, report = self.rows(verb="exact")
        self.assertEqual({row["mesh_area"] for row in rows}, {""})
        total = math.fsum(float(row["exact_area"]) for row in rows)
        self.assert_close(total, report["exact"]["area"], SUM)
