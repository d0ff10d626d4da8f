"""What people type who have not read a page, and what they are told: words of other programs are taken or answered by a
command, and a note about an odd structure names what to type. Tests type it."""

import csv
import os
import re
import shlex
import subprocess
import sys
import unittest

import program
from program import BAD_INPUT, SOURCE_DIR, UBIQUITIN, ProgramTest, need_package, need_shared, run

WRONG_CALLS = SOURCE_DIR / "tests" / "cli" / "wrong_calls.csv"


def record(serial, name, residue, number, place, element, kind="ATOM", chain="A"):
    x, y, z = place
    return (f"{kind:<6}{serial:5} {name:<4} {residue:>3} {chain}{number:4}    {x:8.3f}{y:8.3f}{z:8.3f}  1.00  0.00"
            f"          {element:>2}\n")  # fmt: skip


def scaled(path, factor):
    """A PDB file with other coordinates."""
    lines = []
    for line in path.read_text().splitlines(keepends=True):
        if line.startswith(("ATOM", "HETATM")):
            place = "".join(f"{factor * float(line[i : i + 8]):8.3f}" for i in (30, 38, 46))
            line = line[:30] + place + line[54:]
        lines.append(line)
    return "".join(lines)


class Words(ProgramTest):
    """Each row of wrong_calls.csv is a call that the program does not have, and what its answer must hold. A call with
    "type:" in the answer is typed as it stands there, and works."""

    def rows(self):
        with WRONG_CALLS.open(newline="") as file:
            yield from csv.DictReader(file)

    def test_each_is_taken_or_answered(self):
        self.file("1UBQ.pdb", UBIQUITIN.read_text())
        self.assertGreaterEqual(len(list(self.rows())), 60)
        for row in self.rows():
            with self.subTest(row["call"]):
                result = run(*shlex.split(row["call"]), cwd=self.folder)
                if row["answer"] == "taken":
                    self.assertEqual(result.returncode, 0, result.stderr)
                    continue
                self.assertEqual((result.returncode, result.stderr.count("\n")), (BAD_INPUT, 1), result.stderr)
                self.assertIn(row["answer"], result.stderr)
                typed = re.search(r"type: vdwmesh (.*)$", result.stderr.strip())
                if typed:
                    self.run_ok(*shlex.split(typed[1]), cwd=self.folder)

    def test_trajectories(self):
        """Python measures frames, by a command that is typed as it stands. Its tables have the figures of the structure."""
        need_package("python3-mdanalysis", module="MDAnalysis")
        if "PYTHONPATH" not in os.environ:
            self.skipTest("this build has no Python package")
        path = need_shared("molecules/special/1L2Y.xtc")
        for name in ("1L2Y.xtc", "1L2Y.pdb"):
            (self.folder / name).symlink_to(path.with_name(name))
        for call in (("exact", "1L2Y.pdb", "1L2Y.xtc"), ("trajectory", "1L2Y.pdb", "1L2Y.xtc"),
                     ("sasa", "-f", "1L2Y.xtc", "-s", "1L2Y.pdb")):  # fmt: skip
            result = run(*call, cwd=self.folder)
            self.assertEqual((result.returncode, result.stderr.count("\n")), (BAD_INPUT, 1), result.stderr)
            self.assertIn("type: python3 -c '", result.stderr)
        command = result.stderr.split("type: ")[1].replace("python3", sys.executable, 1)
        subprocess.run(command, shell=True, check=True, cwd=self.folder, capture_output=True)
        with (self.folder / "areas.csv").open(newline="") as file:
            areas = [float(row["area"]) for row in csv.DictReader(file)]
        with (self.folder / "residues.csv").open(newline="") as file:
            residues = list(csv.DictReader(file))
        self.assertEqual((len(areas), len(residues)), (38, 38 * 20))
        # A trajectory has places in nm with three decimals, of which an area changes by a few thousandths.
        self.assert_close(areas[0], self.report("exact", self.folder / "1L2Y.pdb", "--probe", "1.4")["exact"]["area"], 1e-3)
        self.run_ok("exact", self.folder / "1L2Y.pdb", "--radii", "protor", "--probe", "1.4", "--per-atom",
                    self.folder / "p.csv", "--group", "residue")  # fmt: skip
        with (self.folder / "p.csv").open(newline="") as file:
            for row, other in zip(residues, list(csv.DictReader(file)), strict=False):
                self.assertEqual((row["resid"], row["resname"]), (other["residue_number"], other["residue_name"]))
                self.assertAlmostEqual(float(row["relative"]), float(other["relative_area"]), delta=1e-4)
        for call in (("exact", "1L2Y.xtc"), ("mesh", "-f", "1L2Y.xtc")):
            self.assert_refused(BAD_INPUT, *call, says=("is a trajectory",), cwd=self.folder)

    def test_names_in_capitals(self):
        areas = {self.report("exact", UBIQUITIN, "--surface", name)["exact"]["area"]
                 for name in ("sas", "SAS", "sasa", "Accessible", "solvent-accessible")}  # fmt: skip
        self.assertEqual(len(areas), 1)


class Selections(ProgramTest):
    def count(self, path, selection):
        found = self.report("exact", path, "--select", selection, "--waters", "--altloc", "all")["input"]
        return found["atoms_used"]

    def test_beside_mdanalysis(self):
        """The numbers of atoms of the same selections, of a file with ligands, waters and several chains. Where "and" and
        "or" stand side by side they have brackets: MDAnalysis reads them from left to right."""
        MDAnalysis = need_package("python3-mdanalysis", module="MDAnalysis")
        path = need_shared("molecules/thesis/4HHB.pdb")
        universe = MDAnalysis.Universe(str(path), format="pdb")
        for selection in ("protein", "nucleic or protein", "name CA", "protein and name CA", "resname HEM",
                          "resname HEM PO4 and not name FE", "resid 10:40", "resid 10:40 60:70 and segid A",
                          "not protein", "(name CA or name CB) and resname ALA",
                          "segid A C and not (resid 1:50 or resname HOH)"):  # fmt: skip
            with self.subTest(selection):
                theirs = universe.select_atoms(selection).n_atoms
                self.assertGreater(theirs, 0 if "nucleic" not in selection else -1)
                self.assertEqual(self.count(path, selection.replace("segid", "chain")), theirs)

    def test_beside_gemmi(self):
        need_shared("molecules/thesis/4HHB.pdb")
        gemmi = need_package("python3-gemmi", module="gemmi")
        path = need_shared("molecules/thesis/4HHB.pdb")
        model = gemmi.read_structure(str(path))[0]
        for words, syntax in (("chain B", "/1/B"), ("resi 10-40 and chain A", "/1/A/10-40"), ("name CA", "/1/*/*/CA"),
                              ("element FE", "/1/*/*/*[FE]"), ("resn HEM", "/1/*/(HEM)")):  # fmt: skip
            with self.subTest(words):
                theirs = sum(1 for _ in gemmi.Selection(syntax).copy_model_selection(model).all())
                self.assertEqual(self.count(path, words), theirs)

    def test_what_there_is_is_listed(self):
        for option in ("--select", "--measure"):
            self.assert_refused(BAD_INPUT, "exact", UBIQUITIN, option, "chain B", says=("chains A (1-76)",))
        self.assert_refused(BAD_INPUT, "exact", UBIQUITIN, "--select", "water", says=("--waters",))


class Plausible(ProgramTest):
    """A note stands in the report, its remedy is typed, and the note is gone."""

    def told(self, *arguments):
        report = self.report(*arguments)
        return report["notes"] + report["warnings"]

    def mend(self, path, says, *options):
        """Finds the note, types the options that it names, and returns the report then."""
        notes = [note for note in self.told("exact", path, *options) if says in note]
        self.assertEqual(len(notes), 1, self.told("exact", path, *options))
        remedy = re.search(r"(--[a-z-]+(?: '[^']*'| [^\s;,]+)?)", notes[0])[1]
        words = [w for w in shlex.split(remedy) if w not in ("leaves", "has")]
        for name in [w for w in words if w in options]:
            options = options[: options.index(name)] + options[options.index(name) + 2 :]
        report = self.report("exact", path, *options, *words)
        self.assertFalse([note for note in report["notes"] + report["warnings"] if says in note])
        return report

    def test_units(self):
        whole = self.report("exact", UBIQUITIN)["exact"]["area"]
        nm = self.mend(self.file("nm.pdb", scaled(UBIQUITIN, 0.1)), "as if in nm")
        self.assert_close(nm["exact"]["area"], whole, 0.01)  # coordinates of three decimals
        pm = self.mend(self.file("pm.pdb", scaled(UBIQUITIN, 100)), "as if in pm")
        self.assert_close(pm["exact"]["area"], whole, 1e-9)
        cell = self.told("exact", self.file("cell.pdb", scaled(UBIQUITIN, 0.02)))
        self.assertTrue(any("fractions of a cell" in note for note in cell), cell)

    def test_hydrogens(self):
        report = self.mend(UBIQUITIN, "no hydrogens")
        self.assertEqual(report["input"]["radius_set"], "protor")
        with_one = self.file("h.pdb", record(1, " H", "ALA", 900, (90, 0, 0), "H") + UBIQUITIN.read_text())
        self.assertFalse([note for note in self.told("exact", with_one) if "no hydrogens" in note])

    def test_probes(self):
        for probe in ("0.14", "14", "0.3", "-0.1"):
            report = self.mend(UBIQUITIN, "is no solvent", "--probe", probe)
            self.assertEqual(report["input"]["probe"], 1.4)
        for probe in ("0", "0.5", "1.4", "5"):
            self.assertFalse([n for n in self.told("exact", UBIQUITIN, "--probe", probe) if "no solvent" in n])

    def test_a_trace(self):
        trace = "".join(line for line in UBIQUITIN.read_text().splitlines(keepends=True) if line[12:16] == " CA ")
        notes = [note for note in self.told("exact", self.file("ca.pdb", trace)) if "trace of the chain" in note]
        self.assertEqual(len(notes), 1)
        beads = self.file("beads.txt", "".join(f"{name} CA 2.5\n" for name in sorted({line[17:20] for line in trace.splitlines()})))
        self.assertIn("each of the 76 residues has its CA alone", notes[0])
        self.assertIn("--radii bondi,FILE", notes[0])
        areas = [self.report("exact", self.folder / "ca.pdb", *options)["exact"]["area"]
                 for options in ((), ("--radii", f"bondi,{beads}"))]  # fmt: skip
        self.assertGreater(areas[1], 1.5 * areas[0])

    def test_several_atoms_in_one_place(self):
        text = UBIQUITIN.read_text()
        atoms = "".join(line for line in text.splitlines(keepends=True) if line.startswith("ATOM"))
        twice = self.file("twice.pdb", atoms + "TER\n" + re.sub(r"(?m)^(.{21})A", r"\1B", atoms))
        report = self.mend(twice, "where another one does")
        self.assertEqual(report["input"]["atoms_used"], 602)

    def test_hetero_atoms_by_residue(self):
        path = need_shared("molecules/thesis/4HHB.pdb")
        report = self.mend(path, "hetero atoms are kept: 172 of HEM, 2 of PO4")
        self.assertEqual(report["input"]["skipped"]["hetatm"], 174)
        self.assertIn("4384 protein, 172 HEM, 2 PO4; left out: 221 waters", self.run_ok("exact", path).stdout)

    def test_models_and_assemblies(self):
        models = self.file("models.pdb", "".join(
            f"MODEL     {m:4}\n" + record(1, " C", "LIG", 1, (m, 0, 0), "C") + "ENDMDL\n" for m in (1, 2, 3)))
        self.assertEqual(self.mend(models, "the first of 3 models")["input"]["model"], "2")
        path = need_shared("molecules/special/1F2N.pdb")
        report = self.mend(path, "assembly 1 of the file has 271860 atoms", "--topology", "off")
        self.assertEqual(report["input"]["spheres"], 271860)


if __name__ == "__main__":
    unittest.main()
