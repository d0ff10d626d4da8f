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

    def test_without_a_mesh_the_column_is_empty(self):
        rows, report = self.rows(verb="exact")
        self.assertEqual({row["mesh_area"] for row in rows}, {""})
        total = math.fsum(float(row["exact_area"]) for row in rows)
        self.assert_close(total, report["exact"]["area"], SUM)
