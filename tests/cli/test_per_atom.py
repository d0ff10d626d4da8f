"""--per-atom: rows, columns and sums."""

import csv
import math
import subprocess

from program import BAD_INPUT, UBIQUITIN, ProgramTest, need_package, parse_json

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

    def test_a_guess_about_column_21_is_said(self):
        """HIS of a chain AA, or HISA of GROMOS; beside an ALA of the chain AA nothing is guessed."""
        atom = "ATOM  {:>5}  CA  {}A   1    {:8.3f}   0.000   0.000  1.00  0.00           C\n"
        his, ala = atom.format(1, "HISA", 0.0), atom.format(2, "ALAA", 9.0)
        for name, text, count in (("his.pdb", his, 1), ("both.pdb", his + ala, 0)):
            warnings = self.report("exact", self.file(name, text))["warnings"]
            self.assertEqual(sum("column 21" in warning for warning in warnings), count, warnings)

    def test_segments_stay_apart(self):
        """Residues of two segments with one number: rows of their own, also without chain ids."""
        atom = "ATOM  {0:5}  CA  ALA {1}{2:4}    {3:8.3f}   0.000   0.000  1.00  0.00      {4}   C  \n"
        for chain in "A ":
            text = "".join(atom.format(i, chain, 1, 20.0 * i, name) for i, name in ((1, "P1  "), (2, "P2  ")))
            path, table = self.file("segments.pdb", text + "END\n"), self.folder / "a.csv"
            self.run_ok("exact", path, "--per-atom", table, "--group", "residue")
            with table.open(newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual([(row["segment"], row["atoms"]) for row in rows], [("P1", "1"), ("P2", "1")])
            self.run_ok("exact", path, "--per-atom", table, "--select", ";segment=P2")
            with table.open(newline="") as file:
                self.assertEqual([row["serial"] for row in csv.DictReader(file)], ["2"])

    def test_neighbours_of_one_number_stay_apart(self):
        """Two waters that both are HOH A 1: rows of their own, each with the area of a ball by itself."""
        atom = "HETATM{0:5}  O   HOH A   1    {1:8.3f}   0.000   0.000  1.00  0.00           O  \n"
        path, table = self.file("waters.pdb", atom.format(1, 0.0) + atom.format(2, 9.0)), self.folder / "a.csv"
        self.run_ok("exact", path, "--waters", "--per-atom", table, "--group", "residue")
        with table.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["atoms"] for row in rows], ["1", "1"])
        for row in rows:
            self.assert_close(float(row["exact_area"]), 4 * math.pi * 1.52**2, SUM)  # Bondi 1964

    def test_without_a_mesh_the_column_is_empty(self):
        rows, report = self.rows(verb="exact")
        self.assertEqual({row["mesh_area"] for row in rows}, {""})
        total = math.fsum(float(row["exact_area"]) for row in rows)
        self.assert_close(total, report["exact"]["area"], SUM)


class Measure(ProgramTest):
    """--measure: the figures of some atoms among all."""

    SELECTION = "A/10-12"
    MEASURES = ("exact_area", "mesh_area", "exact_volume")

    def rows(self, *arguments, verb="exact", input=UBIQUITIN):
        table, json_path = self.folder / "a.csv", self.folder / "a.json"
        self.run_ok(verb, input, "--per-atom", table, "--json", json_path, *arguments)
        with table.open(newline="") as file:
            return list(csv.DictReader(file)), parse_json(json_path.read_text())

    def test_two_balls(self):
        """A carbon and an oxygen that overlap: the cap that the oxygen covers is missing (Bondi 1964)."""
        atom = "HETATM{0:5} {1:>2}   UNL A{0:4}    {2:8.3f}   0.000   0.000  1.00  0.00          {1:>2}\n"
        path = self.file("two.pdb", atom.format(1, "C", 0.0) + atom.format(2, "O", 1.2))
        rows, report = self.rows("--measure", "A/1", input=path)
        r, s, d = 1.70, 1.52, 1.2
        height = r - (d * d + r * r - s * s) / (2 * d)  # of the cap
        area = 4 * math.pi * r * r - 2 * math.pi * r * height
        volume = 4 / 3 * math.pi * r**3 - math.pi * height**2 * (3 * r - height) / 3
        self.assert_close(report["exact"]["area"], area, SUM)
        self.assert_close(report["exact"]["volume"], volume, SUM)
        self.assert_close(float(rows[0]["exact_area"]), area, SUM)
        self.assertEqual([rows[1][key] for key in self.MEASURES], ["", "", ""])
        self.assertEqual([row["measured"] for row in rows], ["1", "0"])

    def test_equals_the_whole_by_every_method(self):
        whole, _ = self.rows("--method", "cgal", "--probe", "1.4")
        for method in ("cgal", "arcs", "both"):
            some, report = self.rows("--method", method, "--probe", "1.4", "--measure", self.SELECTION)
            chosen = 0
            for a, b in zip(whole, some, strict=True):
                if a["residue_number"] in ("10", "11", "12"):
                    chosen += 1
                    for key, unit in (("exact_area", 4 * math.pi * 3.2**2), ("exact_volume", 4 / 3 * math.pi * 3.2**3)):
                        # The methods promise 1e-12 of a ball; 3.2 Å is sulphur's and the probe's.
                        self.assertLessEqual(abs(float(a[key]) - float(b[key])), 1e-12 * unit)
                else:
                    self.assertEqual([b[key] for key in self.MEASURES], ["", "", ""])
            self.assertEqual(report["input"]["spheres_measured"], chosen)
            self.assertEqual(report["input"]["measure"], self.SELECTION)
            total = math.fsum(float(row["exact_area"] or 0) for row in some)
            self.assert_close(total, report["exact"]["area"], SUM)

    def test_rows_of_groups_sum_what_is_measured(self):
        atoms, _ = self.rows("--measure", "A/10-12/CA,CB")
        for group, filled in (("residue", 3), ("chain", 1)):
            rows, report = self.rows("--measure", "A/10-12/CA,CB", "--group", group)
            self.assertEqual(sum(int(row["measured"]) for row in rows), report["input"]["spheres_measured"])
            self.assertEqual(sum(row["exact_area"] != "" for row in rows), filled)
            for row in rows:
                self.assertEqual(row["exact_area"] == "", row["measured"] == "0")
            self.assert_close(math.fsum(float(row["exact_area"] or 0) for row in rows),
                              math.fsum(float(row["exact_area"] or 0) for row in atoms), SUM)

    def test_report_compares_nothing_of_a_part(self):
        rows, report = self.rows("--measure", self.SELECTION, "--distances", "off", verb="report")
        comparison = report["comparison"]
        self.assertIsNone(comparison["area_relative_error"])
        self.assertIsNone(comparison["volume_relative_error"])
        self.assertIsNotNone(comparison["euler_characteristic_difference"])
        for row in rows:
            self.assertEqual(row["mesh_area"] == "", row["measured"] == "0")
        text = self.run_ok("report", UBIQUITIN, "--measure", self.SELECTION, "--distances", "off").stdout
        self.assertIn(self.SELECTION, text)
        self.assertNotIn("nan", text)


class Voids(ProgramTest):
    """--voids: the table of voids."""

    def cage(self, shift=0.0):
        """26 balls of a cubic lattice around a void at (1 + shift, 1, 1)."""
        nodes = [(i, j, k) for i in range(3) for j in range(3) for k in range(3) if (i, j, k) != (1, 1, 1)]
        return "".join(f"{i + shift} {j} {k} 0.9\n" for i, j, k in nodes)

    def table(self, text, *arguments):
        path, table, report = self.file("a.xyzr", text), self.folder / "v.csv", self.folder / "v.json"
        self.run_ok("exact", path, "--voids", table, "--json", report, *arguments)
        with table.open(newline="") as file:
            return list(csv.DictReader(file)), parse_json(report.read_text())["exact"]

    def test_two_cages(self):
        rows, exact = self.table(self.cage() + self.cage(10.0))
        self.assertEqual([row["void"] for row in rows], ["1", "2"])
        self.assertEqual(sorted(round(float(row["center_x"]), 9) for row in rows), [1, 11])
        for row in rows:
            self.assert_close(float(row["volume"]), exact["void_volume"] / 2, 1e-9)
            self.assert_close(float(row["area"]), exact["void_area"] / 2, 1e-9)
            self.assert_close(float(row["clearance"]), 0.1, 1e-9)  # six balls at a distance of 1
            self.assertEqual(int(row["lining_atoms"]), len(row["lining"].split()))
        # XYZR has no names: atoms are numbered, from 1, in the order of the file.
        numbers = {int(name) for row in rows for name in row["lining"].split()}
        self.assertTrue({5, 11, 13} <= numbers <= set(range(1, 53)))

    def test_atoms_have_names(self):
        """Voids of a protein: what their rows add up to stands in the report."""
        table, report = self.folder / "v.csv", self.folder / "v.json"
        self.run_ok("report", UBIQUITIN, "--probe", "1.4", "--voids", table, "--json", report)
        with table.open(newline="") as file:
            rows = list(csv.DictReader(file))
        exact = parse_json(report.read_text())["exact"]
        self.assertEqual(len(rows), exact["voids"])
        self.assertGreater(len(rows), 0)
        self.assert_close(math.fsum(float(row["volume"]) for row in rows), exact["void_volume"], 1e-9)
        volumes = [float(row["volume"]) for row in rows]
        self.assertEqual(volumes, sorted(volumes, reverse=True))
        for row in rows:
            self.assertGreater(float(row["clearance"]), 0)
            for name in row["lining"].split():
                self.assertRegex(name, r"^A/\d+/\w+$")

    def test_spheres_for_viewers(self):
        """In the middle of a cage is room for a probe of 0.1 Å, whatever part of it is the probe already."""
        path = self.file("a.xyzr", self.cage() + self.cage(10.0))
        for probe in (0, 0.05):
            for name in ("v.pdb", "v.pml", "v.bild"):
                self.run_ok("exact", path, "--probe", probe, "--voids", self.folder / name, "--quiet")
            records = [line for line in (self.folder / "v.pdb").read_text().splitlines() if line.startswith("HETATM")]
            self.assertEqual(sorted(int(line[22:26]) for line in records), [1, 2])
            self.assertEqual(sorted(float(line[30:38]) for line in records), [1, 11])
            self.assertEqual([[float(line[k : k + w]) for k, w in ((38, 8), (46, 8), (60, 6))] for line in records],
                             [[1, 1, 0.1]] * 2)  # fmt: skip
            script = (self.folder / "v.pml").read_text()
            self.assertIn("\n".join(records), script)
            self.assertIn("select void_2, voids and resi 2", script)
            balls = [line.split() for line in (self.folder / "v.bild").read_text().splitlines() if line.startswith(".sphere")]
            self.assertEqual(len(balls), 2)
            for ball in balls:
                self.assertAlmostEqual(float(ball[4]), 0.1, delta=1e-12)

    def test_no_void(self):
        rows, _ = self.table("0 0 0 1\n")
        self.assertEqual(rows, [])

    def test_topology_is_needed(self):
        path = self.file("a.xyzr", self.cage())
        self.assert_refused(
            BAD_INPUT, "exact", path, "--voids", self.folder / "v.csv", "--topology", "counts", says=["--voids"]
        )
        self.assertFalse((self.folder / "v.csv").exists())


class AtomFiles(ProgramTest):
    """--write and --rsa: what is measured, in files that other programs open."""

    SAS = ("--surface", "sas", "--radii", "protor")

    def figures(self, column, *arguments, input=UBIQUITIN):
        table = self.folder / "t.csv"
        self.run_ok("exact", input, "--per-atom", table, *arguments)
        with table.open(newline="") as file:
            return [float(row[column] or "nan") for row in csv.DictReader(file)]

    def written(self, name, *arguments, input=UBIQUITIN):
        self.run_ok("exact", input, "--write", self.folder / name, *arguments)
        return (self.folder / name).read_text()

    def test_figures_are_those_of_the_table(self):
        for surface, columns in (("sas", ("exact_area", "exact_volume")), ("ses", ("excluded_area", "excluded_volume"))):
            for figure, column in zip(("area", "volume"), columns):
                expected = self.figures(column, "--surface", surface)
                for name, at in (("a.pdb", lambda line: line[60:66]), ("a.cif", lambda line: line.split()[-1])):
                    lines = self.written(name, "--surface", surface, "--b-factor", figure).splitlines()
                    found = [float(at(line)) for line in lines if line.startswith("ATOM ")]
                    self.assertEqual(len(found), 602)
                    if name == "a.cif":
                        self.assertEqual(found, expected)
                    for b, value in zip(found, expected):
                        self.assertLessEqual(abs(b - value), 0.005001)

    def test_depth(self):
        depth = self.folder / "d.csv"
        for surface, column in (("sas", "depth_accessible"), ("ses", "depth_excluded")):
            text = self.written("a.cif", "--surface", surface, "--b-factor", "depth", "--depth", depth)
            found = [line.split()[-1] for line in text.splitlines() if line.startswith("ATOM ")]
            with depth.open(newline="") as file:
                self.assertEqual(found, [row[column] for row in csv.DictReader(file)])

    def test_the_same_comes_back(self):
        """Atoms of all names, chains and residues: read again they have the same table."""
        text = (
            "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n"
            "ATOM      2  CA  ALA A   1B     10.000   0.000   0.000  1.00  0.00           C\n"
            "HETATM    3 CA    CA B  -3      20.000   0.000   0.000  1.00  0.00          CA\n"
            "ATOM      4 HG11 VAL b9999      30.000   0.000   0.000  1.00  0.00           H\n"
            "HETATM    5  O5' GLC 9   7      40.000   0.000   0.000  1.00  0.00           O\n"
            "ATOM      6  N   LYSN    8      50.000   0.000   0.000  1.00  0.00      SEG1 N\n"
        )
        path, table, tables = self.file("in.pdb", text + "END\n"), self.folder / "t.csv", []
        for name in ("a.pdb", "a.cif"):
            self.written(name, input=path)
        for name in (path, self.folder / "a.pdb", self.folder / "a.cif"):
            self.run_ok("exact", name, "--per-atom", table)
            with table.open(newline="") as file:
                tables.append(list(csv.DictReader(file)))
        self.assertEqual(tables[0], tables[1])
        self.assertEqual(tables[0][5]["segment"], "SEG1")
        for row in tables[0]:
            row["segment"] = ""  # which mmCIF does not have
        self.assertEqual(tables[0], tables[2])
        self.assertEqual([row["residue_number"] for row in tables[0]], ["1", "1B", "-3", "9999", "7", "8"])

    def test_models_and_atoms_without_a_figure(self):
        atom = "ATOM      1  CA  ALA A   1    {:8.3f}   0.000   0.000  1.00  0.00           C  \n"
        text = "".join(f"MODEL {k:8}\n{atom.format(10.0 * k)}ENDMDL\n" for k in (3, 7))
        path = self.file("models.pdb", text + "END\n")
        lines = self.written("a.pdb", "--model", "all", input=path).splitlines()
        self.assertEqual([line[:14].split() for line in lines if "MDL" in line or "MODEL" in line],
                         [["MODEL", "3"], ["ENDMDL"], ["MODEL", "7"], ["ENDMDL"]])  # fmt: skip
        process = self.run_ok("exact", UBIQUITIN, "--measure", "A/1-3", "--write", self.folder / "a.pdb")
        lines = [line for line in (self.folder / "a.pdb").read_text().splitlines() if line.startswith("ATOM")]
        self.assertEqual([line[60:66] == " -1.00" for line in lines], [int(line[22:26]) > 3 for line in lines])
        self.assertIn("atoms have no area", process.stdout)

    def test_other_programs_open_them(self):
        gemmi = need_package("python3-gemmi", module="gemmi")
        exposure = self.figures("relative_area", *self.SAS, "--group", "residue")
        for name in ("a.pdb", "a.cif"):
            self.written(name, *self.SAS, "--b-factor", "exposure")
            chain = gemmi.read_structure(str(self.folder / name))[0]["A"]
            self.assertEqual([residue.seqid.num for residue in chain], list(range(1, 77)))
            for residue, expected in zip(chain, exposure):
                for atom in residue:
                    self.assertAlmostEqual(atom.b_iso, 100 * expected, delta=0.00501)
        MDAnalysis = need_package("python3-mdanalysis", module="MDAnalysis")
        self.written("a.pdb", *self.SAS)
        atoms = MDAnalysis.Universe(str(self.folder / "a.pdb")).atoms
        for atom, area in zip(atoms, self.figures("exact_area", *self.SAS)):
            self.assertAlmostEqual(atom.tempfactor, area, delta=0.00501)

    def test_residues_beside_freesasa(self):
        """The same columns; each figure is that of its table, and near FreeSASA's by slices."""
        freesasa = need_package("freesasa", program="freesasa")
        self.written("a.pdb", *self.SAS, "--rsa", self.folder / "a.rsa")
        ours = (self.folder / "a.rsa").read_text().splitlines()
        theirs = subprocess.run([freesasa, "--format=rsa", "--resolution=1000", self.folder / "a.pdb"],
                                capture_output=True, text=True, check=True).stdout.splitlines()  # fmt: skip
        for kind, count in (("RES", 76), ("CHAIN", 1), ("TOTAL", 1)):
            pair = [[line for line in lines if line.startswith(kind)] for lines in (ours, theirs)]
            self.assertEqual([len(lines) for lines in pair], [count, count])
            for a, b in zip(*pair):
                self.assertEqual(len(a), len(b))
                self.assertEqual(a[:14], b[:14])
                for x, y in zip(a[14:].split(), b[14:].split()):
                    self.assertEqual(x == "N/A", y == "N/A")
                    if x != "N/A":
                        self.assertAlmostEqual(float(x), float(y), delta=0.25 + 1e-3 * float(y))
        areas = self.figures("exact_area", *self.SAS, "--group", "residue")
        self.assertEqual([line[14:22] for line in ours if line.startswith("RES")], [f"{x:8.2f}" for x in areas])

    def test_what_does_not_go(self):
        out, unknown = self.folder / "a.pdb", self.folder / "a.xyz"
        far = self.file("far.xyzr", "20000 0 0 1\n")
        for arguments, line in (
            ((UBIQUITIN, "--write", unknown), "atoms are written as .pdb .ent .cif .mmcif"),
            ((UBIQUITIN, "--b-factor", "area"), "add that"),
            ((UBIQUITIN, "--write", out, "--b-factor", "depth"), "needs a probe; add --surface sas"),
            ((UBIQUITIN, "--write", out, "--b-factor", "exposure"), "add --surface sas --radii protor"),
            ((UBIQUITIN, "--rsa", out), "add --surface sas --radii protor"),
            ((UBIQUITIN, "--surface", "ses", "--rsa", out), "does not go with --surface ses"),
            ((UBIQUITIN, "--surface", "ses", "--write", out, "--b-factor", "exposure"), "add --surface sas"),
            ((far, "--write", out), "a PDB file has no room for atom"),
        ):
            self.assert_refused(BAD_INPUT, "exact", *arguments, says=[line])
            self.assertFalse(out.exists())
        self.written("a.cif", input=far)
