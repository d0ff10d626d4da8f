"""vdwmesh pockets: its table beside another program's, its JSON, and refusals."""

import csv
import math

import program
from program import BAD_INPUT, UBIQUITIN, ProgramTest, need_shared, parse_json

TWELVE_DIGITS = 1e-9  # the other program's table has twelve digits, its largest figure is 4296
LISTS = {"lining_areas", "mouth_table"}


class Pockets(ProgramTest):
    def table(self, *arguments):
        path = self.folder / "pockets.csv"
        self.run_ok("pockets", *arguments, "--csv", path, "--quiet")
        with path.open(newline="") as file:
            return list(csv.DictReader(file))

    def test_beside_another_program(self):
        with need_shared("reference/pockets.csv").open(newline="") as file:
            expected = [row for row in csv.DictReader(file) if row["set"] == "1CRN"]
        rows = self.table(need_shared("reference/1CRN.xyzr"))
        self.assertEqual(len(rows), len(expected))
        for row, other in zip(rows, expected, strict=True):
            self.assertLessEqual(set(other), set(row))
            for name in other:
                if name in ("ms_volume", "ms_area"):
                    self.assertEqual(row[name], "")
                elif name == "kind":
                    self.assertEqual(row[name] == "void", other[name] == "void")
                elif name == "set":
                    self.assertEqual(row[name], other[name])
                else:
                    value = float(other[name])
                    self.assert_near(float(row[name]), value, TWELVE_DIGITS * max(1, abs(value)))

    def assert_near(self, value, expected, error):
        self.assertTrue(abs(value - expected) <= error, f"{value} is not {expected}")

    def test_json_has_the_columns_of_the_table(self):
        rows = self.table(UBIQUITIN)
        report = self.report("pockets", UBIQUITIN)
        pockets = report["pockets"]["pockets"]
        self.assertEqual(report["pockets"]["face_ties"], 0)
        self.assertEqual(len(rows), len(pockets))
        for row, pocket in zip(rows, pockets, strict=True):
            self.assertEqual(set(row), set(pocket) - LISTS)
            self.assertEqual(len(row["lining"].split()), len(pocket["lining_areas"]))
            self.assert_near(math.fsum(pocket["lining_areas"]), pocket["area"], 1e-10)
            self.assertEqual(len(pocket["mouth_table"]), int(row["mouths"]))
            self.assert_near(float(row["volume"]), pocket["volume"], 0)

    def test_voids_are_those_of_exact(self):
        voids = self.folder / "voids.csv"
        self.run_ok("exact", UBIQUITIN, "--probe", "1.4", "--voids", voids)
        with voids.open(newline="") as file:
            expected = list(csv.DictReader(file))
        found = [row for row in self.table(UBIQUITIN) if row["kind"] == "void"]
        self.assertEqual([row["lining"] for row in found], [row["lining"] for row in expected])
        for row, other in zip(found, expected, strict=True):
            self.assert_near(float(row["volume"]), float(other["volume"]), 1e-11)

    def test_text_names_the_largest(self):
        text = self.run_ok("pockets", UBIQUITIN).stdout
        self.assertRegex(text, r"Pockets +\d+: with one mouth: \d+, channels: \d+, voids: 2; ties: 0")
        self.assertRegex(text, r"(?m)^ +1  pocket +\d+\.\d+ ")

    def test_few_atoms_have_none(self):
        path = self.file("two.xyzr", "0 0 0 1\n2.5 0 0 1\n")
        self.assertEqual(self.table(path), [])
        self.assert_refused(BAD_INPUT, "pockets", path, "--probe", "-2", says=("--probe",))


if __name__ == "__main__":
    program.unittest.main()
