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

    def test_margins(self):
        for row in self.table(UBIQUITIN):
            bottleneck, fits, margin = (float(row[k]) for k in ("bottleneck_radius", "depth_probe", "margin"))
            self.assert_near(margin, min(abs(bottleneck - 1.4), fits - 1.4), 1e-12)
            if row["kind"] != "void" or 1.4 - bottleneck > fits - 1.4:
                continue
            # A little less than the margin leaves the void, a little more opens it.
            for change, voids in ((-1e-6, 1), (1e-6, 0)):
                found = self.table(UBIQUITIN, "--probe", f"{1.4 - margin - change:.9f}")
                kinds = [r["kind"] for r in found if math.dist(self.place(r), self.place(row)) < 1e-6]
                self.assertEqual(kinds.count("void"), voids)

    @staticmethod
    def place(row):
        return [float(row[f"depth_{axis}"]) for axis in "xyz"]

    def test_scan_has_the_voids_of_each_probe(self):
        path = self.folder / "places.csv"
        scan = self.report("pockets", UBIQUITIN, "--scan", "1.2:2.5", "-o", path)["scan"]
        self.assertTrue(scan["is_complete"])
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(scan["places"]))
        for probe in ("1.3", "1.4"):
            alive = [r for r in rows if float(r["radius"]) > float(probe) and float(r["joins_at"] or 0) <= float(probe)]
            voids = [r for r in self.table(UBIQUITIN, "--probe", probe) if r["kind"] == "void"]
            self.assertEqual(len(alive), len(voids))
            for row in voids:
                nearest = min(alive, key=lambda r, row=row: math.dist([float(r[a]) for a in "xyz"], self.place(row)))
                self.assert_near(float(nearest["opens_at"] or row["bottleneck_radius"]), float(row["bottleneck_radius"]), 1e-9)
        self.assert_refused(BAD_INPUT, "pockets", UBIQUITIN, "--scan", "2", says=("--scan", "LO:HI"))
        self.assert_refused(BAD_INPUT, "pockets", UBIQUITIN, "--scan", "2:1", says=("smaller",))

    def test_shell_is_the_difference_of_two_surfaces(self):
        with need_shared("reference/pockets_shell.csv").open(newline="") as file:
            expected = [row for row in csv.DictReader(file) if row["set"] in ("1CRN", "1UBQ")]
        for row in expected:
            path = self.folder / "shell.csv"
            self.run_ok("pockets", need_shared(f"reference/{row['set']}.xyzr"), "--shell", row["large_probe"],
                        "-o", path, "--quiet")  # fmt: skip
            with path.open(newline="") as file:
                (found,) = csv.DictReader(file)
            self.assertEqual(list(found), list(row))
            for name in row:
                if name != "set":
                    self.assert_near(float(found[name]), float(row[name]), TWELVE_DIGITS * max(1, float(row[name])))

    def test_way_out(self):
        path = self.folder / "way.csv"
        way = self.report("pockets", UBIQUITIN, "--from", "pocket:1", "-o", path)["way"]
        first = self.table(UBIQUITIN)[0]
        self.assert_near(way["bottleneck"], float(first["bottleneck_radius"]), 1e-9)
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(way["points"]))
        self.assert_near(math.dist([float(rows[0][a]) for a in "xyz"], self.place(first)), 0, 1e-6)
        for place in ("A/LEU 50/CD1", "A/50/CD1", "30,28,14"):
            self.assertGreater(self.report("pockets", UBIQUITIN, "--from", place)["way"]["length"], 0)
        self.assert_refused(BAD_INPUT, "pockets", UBIQUITIN, "--from", "A/1/XX", says=("--from", "pocket:1"))

    def test_few_atoms_have_none(self):
        path = self.file("two.xyzr", "0 0 0 1\n2.5 0 0 1\n")
        self.assertEqual(self.table(path), [])
        self.assert_refused(BAD_INPUT, "pockets", path, "--probe", "-2", says=("--probe",))


if __name__ == "__main__":
    program.unittest.main()
