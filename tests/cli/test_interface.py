"""vdwmesh interface: beside three runs of `exact`, beside formulas, its table, and what it refuses."""

import csv
import json
import math
from pathlib import Path

from program import BAD_INPUT, ProgramTest, need_shared, parse_json, run, schema_validator

SAME = 1e-12  # relative: the rounding of sums over some thousand atoms, printed in full
ATOM = "ATOM  {0:5}  CA  ALA {1}{2:4}    {3:8.3f}   0.000   0.000  1.00  0.00           C  \n"


class Interface(ProgramTest):
    def interfaces(self, *arguments):
        path = self.folder / "r.json"
        self.run_ok("interface", *arguments, "--json", path)
        report = parse_json(path.read_text())
        schema_validator().validate(report)
        return report["interfaces"], report

    def area(self, path, *arguments):
        """The accessible area by a run of its own."""
        out = self.folder / "e.json"
        self.run_ok("exact", path, "--surface", "sas", "--json", out, *arguments)
        return parse_json(out.read_text())["exact"]["area"]

    def chain_of_atoms(self, *atoms):
        """Carbon atoms on the x axis, as (chain, x)."""
        text = "".join(ATOM.format(i, chain, i, x) for i, (chain, x) in enumerate(atoms, 1))
        return self.file("atoms.pdb", text + "END\n")

    def test_chains_beside_three_runs(self):
        path = need_shared("molecules/thesis/4HHB.pdb")
        found, _ = self.interfaces(path)
        # B and D do not touch: together they have what each has alone.
        self.assertEqual({(i["a"], i["b"]) for i in found},
                         {("A", "B"), ("A", "C"), ("A", "D"), ("B", "C"), ("C", "D")})  # fmt: skip
        apart = [self.area(path, "--select", chain) for chain in ("B", "D", "B,D")]
        self.assertAlmostEqual(apart[0] + apart[1], apart[2], delta=SAME * apart[2])
        for pair in found[:2]:
            a, b = (self.area(path, "--select", pair[side]) for side in "ab")
            both = self.area(path, "--select", f"{pair['a']},{pair['b']}")
            self.assertAlmostEqual(pair["buried_area"], a + b - both, delta=SAME * both)
            self.assertAlmostEqual(pair["side_a"]["area"], a, delta=SAME * a)
            whole = self.area(path, "--measure", pair["a"], "--topology", "off")
            self.assertAlmostEqual(pair["side_a"]["area_in_whole"], whole, delta=SAME * whole)

    def test_selections_are_sides(self):
        path = need_shared("molecules/thesis/4HHB.pdb")
        by_chain = {(i["a"], i["b"]): i for i in self.interfaces(path)[0]}
        found, _ = self.interfaces(path, "A/*(!HEM)", "B/*(!HEM)", "(HEM)", "--probe", "1.4")
        self.assertEqual(len(found), 3)
        one, _ = self.interfaces(path, "B", "A")
        self.assertEqual(one[0]["buried_area"], by_chain["A", "B"]["buried_area"])
        self.assertEqual(one[0]["buried_a"], by_chain["A", "B"]["buried_b"])

    def test_complementarity_of_two_balls(self):
        """Carbon atoms (1.7 Å) at 6 Å: the fit falls from the axis to the rim, so the median of S is its value where
        half of the fitted cap's area lies within. Nothing is fitted here: the rim of 1.5 Å is wider than the buried cap,
        whose half-angle has the cosine d / 2 (r + p)."""
        path = self.chain_of_atoms(("A", 0), ("B", 6))
        (pair,), _ = self.interfaces(path, "--samples", "64")
        fit = pair["complementarity"]
        self.assertIsNone(fit["sc"])
        self.assertEqual(fit["fitted_a"], 0)
        cap = 2 * math.pi * 1.7**2 * (1 - 6 / (2 * 3.1))
        self.assertAlmostEqual(fit["excluded_buried_a"], cap, delta=2 / 64)  # a sample stands for 1/64 Å²
        self.assertIsNone(self.interfaces(path)[0][0]["complementarity"])

    def test_complementarity_of_chains(self):
        path = need_shared("molecules/thesis/4HHB.pdb")
        swapped, straight = (
            self.interfaces(path, *sides, "--samples", "16")[0][0]["complementarity"] for sides in (("B", "A"), ("A", "B"))
        )
        # By the facets of meshes with 10, 30 and 60 triangles per Å², instead of samples, and their normals, Sc is 0.5042, 0.5119
        # and 0.5139; their distances to the limit fall as the edges get shorter, to 0.517.
        self.assertAlmostEqual(straight["sc"], 0.517, delta=0.003)
        self.assertLessEqual(straight["error"], 0.004)
        self.assertAlmostEqual(swapped["sc"], straight["sc"], delta=2 * (swapped["error"] + straight["error"]))

    def test_excluded_surface_beside_three_runs(self):
        path = need_shared("molecules/thesis/4HHB.pdb")
        (pair,), _ = self.interfaces(path, "A", "B", "--surface", "ses")
        out = self.folder / "e.json"
        runs = []
        for chains in ("A", "B", "A,B"):
            self.run_ok("exact", path, "--surface", "ses", "--select", chains, "--topology", "off", "--json", out)
            runs.append(parse_json(out.read_text())["excluded"]["complete"])
        a, b, both = (run["area"] for run in runs)
        found = pair["excluded"]
        self.assertAlmostEqual(found["buried_area"], a + b - both, delta=1e-10 * both)
        self.assertAlmostEqual(found["area_in_pair"], both, delta=SAME * both)
        gap = runs[2]["volume"] - runs[0]["volume"] - runs[1]["volume"]
        self.assertAlmostEqual(found["gap_volume"], gap, delta=1e-10 * runs[2]["volume"])
        self.assert_refused(BAD_INPUT, "interface", path, "--surface", "vdw", says=["choose sas or ses"])

    def test_rows_of_a_batch(self):
        folder = self.folder / "many"
        folder.mkdir()
        for name, chains in (("a", "AB"), ("b", "ABA"), ("c", "AA")):
            source = self.chain_of_atoms(*((chain, 4.0 * i) for i, chain in enumerate(chains)))
            source.rename(folder / f"{name}.pdb")
        result = run("batch", folder, "--verb", "interface")
        rows = {Path(row["name"]).name: row for row in map(parse_json, result.stdout.splitlines())}
        for name in "ab":
            row = rows[f"{name}.pdb"]
            self.assertEqual(row["interfaces"], self.interfaces(folder / f"{name}.pdb")[0])
            self.assertEqual(row["buried_area"], row["interfaces"][0]["buried_area"])
        self.assertIn("side", rows["c.pdb"]["error"])

    def test_fit_in_rows(self):
        """Sc of the interface that buries most, and the contact surface of all; where asked for, behind the other figures."""
        path = need_shared("molecules/special/1F2N.pdb")  # of three interfaces the last one buries most
        fits = [(pair["buried_area"], pair["complementarity"]) for pair in self.interfaces(path, "--samples", "8")[0]]
        most = max(fits, key=lambda fit: fit[0])[1]
        surface = sum(fit["contact_surface_a"] + fit["contact_surface_b"] for _, fit in fits)
        call = ("batch", path, self.chain_of_atoms(("A", 0), ("A", 4)), "--verb", "interface")
        row, error = map(parse_json, run(*call, "--samples", "8").stdout.splitlines())
        for each in (row, error):
            schema_validator("batch").validate(each)
        self.assertEqual((row["sc"], row["sc_error"], row["contact_surface"]), (most["sc"], most["error"], surface))
        self.assertEqual((error["sc"], error["contact_surface"]), (None, None))
        names, *lines = csv.reader(run(*call, "--samples", "8", "--rows", "csv").stdout.splitlines())
        without, *_ = csv.reader(run(*call, "--rows", "csv").stdout.splitlines())
        self.assertEqual(names, [*without[:-2], "sc", "sc_error", "contact_surface", *without[-2:]])
        self.assertEqual([float(text) for text in lines[0][-5:-2]], [most["sc"], most["error"], surface])
        self.assertEqual(lines[1][-5:-2], [""] * 3)
        self.assertNotIn("sc", parse_json(run(*call).stdout.splitlines()[0]))

    def test_two_atoms(self):
        """Balls of radius r = 1.7 + 1.4 (Bondi 1964) at a distance d: caps and a disk."""
        r, d = 3.1, 4.0
        found, report = self.interfaces(self.chain_of_atoms(("A", 0), ("B", d)))
        cap, disk = 2 * math.pi * r * (r - d / 2), math.pi * (r * r - d * d / 4)
        self.assertAlmostEqual(found[0]["buried_a"], cap, delta=1e-12)
        self.assertAlmostEqual(found[0]["buried_area"], 2 * cap, delta=1e-12)
        self.assertAlmostEqual(found[0]["contact_area"], disk, delta=1e-12)
        self.assertEqual([(c["a"], c["b"]) for c in found[0]["contacts"]], [("A/1 ALA", "B/2 ALA")])
        self.assertEqual((found[0]["side_a"]["atoms"], found[0]["side_b"]["residues"]), (1, 1))
        self.assertEqual(report["warnings"], [])

    def test_sides_that_do_not_touch(self):
        path = self.chain_of_atoms(("A", 0), ("B", 50))
        found, report = self.interfaces(path)
        self.assertEqual((found, report["notes"]), ([], ["no two chains touch"]))
        found, _ = self.interfaces(path, "A", "B")
        self.assertEqual((found[0]["buried_area"], found[0]["contacts"]), (0, []))
        self.assertAlmostEqual(found[0]["side_b"]["area_in_whole"], 4 * math.pi * 3.1**2, delta=1e-12)

    def test_polarity_adds_up(self):
        path = need_shared("molecules/thesis/4INS.pdb")
        for pair in self.interfaces(path, "--radii", "protor")[0]:
            parts = pair["buried_polar"] + pair["buried_apolar"] + pair["buried_unclassified"]
            self.assertAlmostEqual(parts, pair["buried_area"], delta=1e-9)

    def test_clash_is_told(self):
        _, report = self.interfaces(self.chain_of_atoms(("A", 0), ("B", 1)))
        self.assertEqual(len(report["warnings"]), 1)
        self.assertRegex(report["warnings"][0], r"^1 interface with atoms that clash or are bonded: A/1 ALA CA and B/2 ALA CA overlap by 2\.40 Å$")

    def test_table_adds_up(self):
        path, table = need_shared("molecules/thesis/4INS.pdb"), self.folder / "t.csv"
        for group in ("atom", "residue", "chain"):
            found, _ = self.interfaces(path, "--per-atom", table, "--group", group)
            with table.open(newline="") as file:
                rows = list(csv.DictReader(file))
            for pair in found:
                for own, other in (("a", "b"), ("b", "a")):
                    mine = [r for r in rows if (r["side"], r["other_side"]) == (pair[own], pair[other])]
                    buried = math.fsum(float(r["buried_area"]) for r in mine)
                    contact = math.fsum(float(r["contact_area"]) for r in mine)
                    self.assertAlmostEqual(buried, pair["buried_" + own], delta=1e-9)
                    self.assertAlmostEqual(contact, pair["contact_area"], delta=1e-9)
                    for r in mine:
                        lost = float(r["area"]) - float(r["area_in_pair"])
                        self.assertAlmostEqual(lost, float(r["buried_area"]), delta=1e-9)
                    if group == "residue":
                        losing = sum(float(r["buried_area"]) > 1e-9 for r in mine)
                        self.assertEqual(losing, pair["side_" + own]["residues"])

    def atoms_of(self, name, *arguments):
        """The figures of atoms in the file that --write makes: those of PDB's B factors, or lists of mmCIF's last columns."""
        self.run_ok("interface", *arguments, "--write", self.folder / name)
        lines = [line for line in (self.folder / name).read_text().splitlines() if line.startswith("ATOM ")]
        return [line[60:66].strip() if name.endswith("pdb") else [line.split()[14], *line.split()[-3:]] for line in lines]

    def test_atoms_as_files(self):
        """Balls in a row, of which the middle one is in two interfaces: its figures are the sums, of caps and disks."""
        r, d = 3.1, 4.0
        path = self.chain_of_atoms(("A", 0), ("B", d), ("C", 2 * d))
        cap, disk, whole = 2 * math.pi * r * (r - d / 2), math.pi * (r * r - d * d / 4), 4 * math.pi * r * r
        for figure, value in (("buried", cap), ("contact", disk)):
            expected = [f"{value:.2f}", f"{2 * value:.2f}", f"{value:.2f}"]
            self.assertEqual(self.atoms_of("a.pdb", path, "--b-factor", figure), expected)
            self.assertEqual([b for b, *_ in self.atoms_of("a.cif", path, "--b-factor", figure)], expected)
        found = self.atoms_of("a.cif", path)
        text = (self.folder / "a.cif").read_text()
        names = [line.split("vdwmesh_")[1] for line in text.splitlines() if "vdwmesh_" in line and "_atom" in line]
        self.assertEqual(names, ["buried", "contact", "area"])
        for row, times in zip(found, (1, 2, 1), strict=True):
            for text, value in zip(row[1:], (times * cap, times * disk, whole), strict=True):
                self.assertAlmostEqual(float(text), value, delta=1e-12 * whole)
        self.assertEqual(self.atoms_of("a.pdb", path, "--b-factor", "area"), [f"{whole:.2f}"] * 3)
        # On no side: it neither buries nor loses, and has no area of a side.
        self.assertEqual(self.atoms_of("a.cif", path, "A", "B")[2], ["0.00", "0", "0", "?"])
        self.assertEqual(self.atoms_of("a.pdb", path, "A", "B", "--b-factor", "area")[2], "-1.00")

    def test_atoms_as_files_add_up(self):
        path = need_shared("molecules/thesis/4HHB.pdb")
        buried, contact = (math.fsum(pair[key] for pair in self.interfaces(path)[0]) for key in ("buried_area", "contact_area"))
        self.run_ok("interface", path, "--write", self.folder / "a.cif")
        text = (self.folder / "a.cif").read_text().splitlines()
        rows = [line.split()[-3:] for line in text if line.startswith(("ATOM ", "HETATM "))]
        self.assertAlmostEqual(math.fsum(float(row[0]) for row in rows), buried, delta=SAME * len(rows) * buried)
        self.assertAlmostEqual(math.fsum(float(row[1]) for row in rows), 2 * contact, delta=SAME * len(rows) * buried)

    def test_identical_chains_twice(self):
        """Equal balls count for the first: the second chain loses all that it has."""
        path = self.chain_of_atoms(("A", 0), ("A", 50), ("B", 0), ("B", 50))
        (pair,), report = self.interfaces(path)
        self.assertEqual((pair["buried_a"], pair["contact_area"]), (0, 0))
        self.assertAlmostEqual(pair["buried_b"], 8 * math.pi * 3.1**2, delta=1e-12)
        self.assertEqual(len(report["warnings"]), 2)
        self.assertIn("2 atoms lie where another one does", report["warnings"][0])
        self.assertIn("overlap by 3.40 Å", report["warnings"][1])

    def test_what_is_refused(self):
        one = self.chain_of_atoms(("A", 0), ("A", 4))
        self.assert_refused(BAD_INPUT, "interface", one, says=["one chain, A"])
        two = self.chain_of_atoms(("A", 0), ("B", 4))
        self.assert_refused(BAD_INPUT, "interface", two, "A", says=["two sides"])
        for sides in (("A", "A"), ("A", "B", "/1"), ("A/1", "(ALA)")):
            self.assert_refused(BAD_INPUT, "interface", two, *sides, says=["share atoms"])
        self.assert_refused(BAD_INPUT, "interface", two, "A", "C")
        self.assert_refused(BAD_INPUT, "interface", two, "--probe", "-2")
        for more in (("--samples", "8"), ("--surface", "ses")):
            self.assert_refused(BAD_INPUT, "interface", two, "--probe", "0", *more, says=["--probe 0", more[0], "above 0"])
        self.assert_refused(BAD_INPUT, "interface", two, "--b-factor", "contact", says=["add that"])
        self.assert_refused(BAD_INPUT, "interface", two, "--write", self.folder / "a.xyz", says=[".pdb .ent .cif .mmcif"])
        self.assert_refused(BAD_INPUT, "interface", two, "--write", self.folder / "a.pdb", "--b-factor", "depth", says=["buried"])

    def test_models_are_told_apart(self):
        model = ATOM.format(1, "A", 1, 0) + ATOM.format(2, "B", 2, 4)
        path = self.file("m.pdb", f"MODEL        1\n{model}ENDMDL\nMODEL        2\n{model}ENDMDL\nEND\n")
        found, _ = self.interfaces(path, "--model", "all")
        self.assertIn(("1/A", "2/A"), {(i["a"], i["b"]) for i in found})
        self.assertEqual(json.dumps(found), json.dumps(self.interfaces(path, "--model", "all")[0]))


if __name__ == "__main__":
    import unittest

    unittest.main()
