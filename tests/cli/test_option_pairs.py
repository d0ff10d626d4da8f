"""Options never vanish: each changes what its verb makes, is refused, or is named in a note.

option_pairs.csv says for each verb and option what becomes of it, and a command that shows it: `words` are given
`beside` others to the verb on a small structure. "changes": the files and figures are others than without `words`;
"refused": the program says why; "note": a line on standard error or in the report names the option. The structure is
in.pdb, or that of the column `input`: spheres without names, which have nothing to choose by.
"""

import csv
import json
import pathlib
import re
import shlex
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

import program
from program import NO_BACKEND, PROGRAM, UNSEEN, ProgramTest, missing, run

TABLE = pathlib.Path(__file__).with_name("option_pairs.csv")
VERBS = ("mesh", "report", "exact", "interface", "compare", "render", "study", "batch", "pockets", "view", "info")
BASE = {
    "mesh": "in.pdb -o out.ply",
    "report": "in.pdb --json figures.json",
    "exact": "in.pdb --json figures.json",
    "interface": "in.pdb --json figures.json",
    "compare": "sphere.off in.pdb --json figures.json",
    "render": "in.pdb -o out.png --size 240x180",
    "study": "in.pdb -o out --spacing 1 --field vdw --edge-length 1 --subdivide 0",
    "batch": "in.pdb",
    "pockets": "cage.pdb --json figures.json",
    "view": "cage.pdb -o page.html",
    "info": "",
}
# Of a report: the figures, without what echoes the command line and what a clock or a machine says.
FIGURES = ("mesh", "exact", "excluded", "interfaces", "comparison", "picture", "pockets", "structures", "inputs")
OF_THE_MACHINE = re.compile(r"seconds|time|path|bytes|memory|device|rss|wall|cpu|parameters|floor|copy")

MODEL = """\
ATOM      1  N   GLY A   1      {0:6.3f}   0.000   0.000  1.00  0.00           N
ATOM      2  CA  GLY A   1       1.450   0.000   0.000  1.00  0.00           C
ATOM      3  HA  GLY A   1       1.800   1.000   0.200  1.00  0.00           H
ATOM      4  C   GLY A   1       2.000   0.000   1.420  1.00  0.00           C
ATOM      5  O  AGLY A   1       1.300   0.300   2.390  0.60  0.00           O
ATOM      6  O  BGLY A   1       3.100   0.900   1.700  0.40  0.00           O
ATOM      7  S   CYS B   2       4.500  -0.800   3.000  1.00  0.00           S
HETATM    8  C1  LIG B   3      -2.800   1.700   1.000  1.00  0.00           C
HETATM    9  O   HOH B   4      -4.600  -2.000   2.000  1.00  0.00           O
"""
STRUCTURE = """\
REMARK 350 BIOMOLECULE: 1
REMARK 350 APPLY THE FOLLOWING TO CHAINS: A, B
REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000
REMARK 350   BIOMT1   2 -1.000000  0.000000  0.000000        2.00000
REMARK 350   BIOMT2   2  0.000000 -1.000000  0.000000       -4.00000
REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        0.00000
""" + "".join(f"MODEL        {k}\n{MODEL.format(x)}ENDMDL\n" for k, x in ((1, 0.0), (2, -0.4))) + "END\n"  # fmt: skip
# Corners of a cube, whose inside is a pocket; what an option leaves out or moves changes it.
CAGE_ATOMS = """\
ATOM      1  CA  ALA A   1      {0:6.3f}   0.000   0.000  1.00  0.00           C
ATOM      2  CB  ALA A   1       4.600   0.000   0.000  1.00  0.00           C
ATOM      3  O  AALA A   1       0.000   4.600   0.000  0.60  0.00           O
ATOM      4  O  BALA A   1       0.200   4.700   0.000  0.40  0.00           O
ATOM      5  C   ALA A   1       4.600   4.600   0.000  1.00  0.00           C
ATOM      6  N   ALA A   1       0.000   0.000   4.600  1.00  0.00           N
ATOM      7  HA  ALA A   1       4.600   0.000   4.600  1.00  0.00           H
ATOM      8  C   GLY B   2       0.000   4.600   4.600  1.00  0.00           C
HETATM    9  C1  LIG A   3       4.600   4.600   4.600  1.00  0.00           C
HETATM   10  O   HOH A   4       2.300   2.300   2.300  1.00  0.00           O
"""
CAGE = STRUCTURE[: STRUCTURE.index("MODEL ")] + "".join(
    f"MODEL        {k}\n{CAGE_ATOMS.format(x)}ENDMDL\n" for k, x in ((1, 0.0), (2, -0.2))) + "END\n"  # fmt: skip
OCTAHEDRON = "OFF\n6 8 0\n" + "".join(
    f"{x} {y} {z}\n" for x, y, z in ((5, 0, 0), (-5, 0, 0), (0, 5, 0), (0, -5, 0), (0, 0, 5), (0, 0, -5))
) + "".join(f"3 {a} {b} {c}\n" for a, b, c in ((0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4),
                                                (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)))  # fmt: skip

# Options that say how a structure is read and what is taken of it.
CHOICES = ("--format", "--units", "--radii", "--model", "--assembly", "--select", "--altloc", "--waters",
           "--no-hydrogens", "--no-hetatm", "--hetatm")  # fmt: skip


def rows():
    with TABLE.open(newline="") as file:
        for row in csv.DictReader(file):
            for verb in row["verbs"].split():
                yield verb, row["option"], row["beside"], row["words"], row["outcome"], row["input"] or "in.pdb"


def options_of(verb):
    """The long names that --help-all lists."""
    text = run(*verb.split("-"), "--help-all").stdout
    return set(re.findall(r"^  (?:-\w, )?(--[a-z-]+)", text, re.M))


def figures(value):
    """A JSON document without what differs from call to call."""
    if isinstance(value, dict):
        return {k: figures(v) for k, v in value.items() if not OF_THE_MACHINE.search(k)}
    return [figures(v) for v in value] if isinstance(value, list) else value


def content_of(path):
    if path.suffix != ".json":
        return path.read_bytes()
    document = json.loads(path.read_text())
    return figures({k: document[k] for k in FIGURES if k in document})


def arguments_of(verb, beside, words, structure):
    """The words of a command. What is said beside replaces what is always said, and `words` replace both."""
    given = shlex.split(beside), shlex.split(words)
    names = [{w.split("=")[0] for w in part if w.startswith("-")} for part in given]
    out = []
    base = BASE[verb] if structure == "in.pdb" else re.sub(r"(in|cage)\.pdb", structure, BASE[verb])
    for part, later in ((shlex.split(base), names[0] | names[1]), (given[0], names[1] - names[0]), (given[1], ())):
        drop = False
        for word in part:
            drop = word in later if word.startswith("-") else drop and out is not None
            if not drop:
                out.append(word)
    return [*verb.split("-"), *out]


class Made:
    """What one command made: exit status, notes, text, and the files of its folder."""

    def __init__(self, verb, beside, structure, words):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            self.fill(folder)
            before = {p.name for p in folder.iterdir()} - {"notes.jsonl"}
            result = subprocess.run([PROGRAM, *arguments_of(verb, beside, words, structure)], capture_output=True, text=True,
                                    cwd=folder, timeout=120, check=False,
                                    env={**program.os.environ, "CUDA_VISIBLE_DEVICES": ""})  # fmt: skip
            self.status, self.error = result.returncode, result.stderr
            self.rows = result.stdout if verb == "batch" else ""
            files = [p for p in sorted(folder.rglob("*")) if p.is_file() and p.relative_to(folder).parts[0] not in before]
            self.files = {str(p.relative_to(folder)): content_of(p) for p in files}
            self.notes = self.error + result.stdout

    @staticmethod
    def fill(folder):
        (folder / "nothing").mkdir()
        (folder / "in.pdb").write_text(STRUCTURE)
        (folder / "in.xyzr").write_text("0 0 0 1.5\n1.5 0 0 1.7\n2 1.4 0 1.2\n")
        (folder / "cage.pdb").write_text(CAGE)
        (folder / "sphere.off").write_text(OCTAHEDRON)
        (folder / "notes.jsonl").write_text("no row\n")
        (folder / "lengths.csv").write_text("edge_length\n" + "0.9\n" * 7)


class OptionPairs(ProgramTest):
    def test_every_pair_is_in_the_table(self):
        listed = {(verb, option) for verb, option, *_ in rows()}
        there = {(verb, option) for verb in VERBS for option in options_of(verb) - {"--help", "--help-all"}}
        self.assertEqual({(verb, option) for verb, option in listed - there if option not in UNSEEN}, set())
        self.assertEqual(there - listed, set())
        self.assertEqual({option for _, option in there} & UNSEEN, set())

    def test_every_choice_of_atoms_is_in_the_table_for_spheres(self):
        listed = {(verb, option) for verb, option, *_, structure in rows() if structure == "in.xyzr"}
        verbs = set(VERBS) - {"info", "interface", "pockets"}  # no structure; chains; a cage of its own
        self.assertEqual({(v, o) for v in verbs for o in CHOICES} - listed, set())

    def test_help_is_short_and_help_of_all_is_not_long(self):
        shown = set()
        for verb in VERBS:
            usual = re.findall(r"^  (?:-\w, )?(--[a-z-]+)", run(*verb.split("-"), "--help").stdout, re.M)
            self.assertLessEqual(len(usual), 20, verb)
            self.assertLessEqual(set(usual), options_of(verb))
            if not verb.startswith("bench"):
                shown |= options_of(verb)
        self.assertLessEqual(len(shown), 50)

    def test_none_vanishes(self):
        all_rows = list(rows())
        with ThreadPoolExecutor(4) as pool:
            keys = {(verb, beside, structure) for verb, _, beside, _, _, structure in all_rows}
            plain = {key: pool.submit(Made, *key, "") for key in keys}
            made = [pool.submit(Made, verb, beside, structure, words)
                    for verb, _, beside, words, _, structure in all_rows]  # fmt: skip
        for (verb, option, beside, words, outcome, structure), with_it in zip(all_rows, made, strict=True):
            with self.subTest(f"{verb} {structure} {beside} {words}"):
                without = plain[verb, beside, structure].result()
                if structure != "in.pdb" and NO_BACKEND not in (without.status, with_it.result().status):
                    self.assertEqual(without.status, 0, without.notes)
                self.check(option, outcome, without, with_it.result())

    def check(self, option, outcome, plain, found):
        if NO_BACKEND in (plain.status, found.status) and "EGL" in found.error + plain.error:
            missing("VDWMESH_REQUIRE_EGL", "nothing can draw here")
        if outcome == "refused":
            self.assertNotEqual(found.status, 0, found.notes)
            return
        self.assertEqual(found.status, 0, found.error)
        if outcome == "note":
            self.assertIn(option, found.notes)
            self.assertNotIn(option, plain.notes)
        else:
            self.assertNotEqual((plain.files, plain.rows), (found.files, found.rows), "without effect")


if __name__ == "__main__":
    program.unittest.main()
