"""The tables of vdwmesh-bench: the thesis's rerun, and the pipeline stage by stage."""

import csv
import io
import itertools
import math
import os
import subprocess
import sys

from program import (BAD_INPUT, DONE, PROGRAM, SHARED_DIR, SOURCE_DIR, UBIQUITIN, ProgramTest, need_package, need_shared,
                     parse_json)  # fmt: skip

STRUCTURES = SHARED_DIR / "molecules" / "thesis"
STAND_INS = {"1QL1": "1QL2_chainA", "2INS": "4INS", "1BIJ": "4HHB", "1GT0": "1F4K", "200D": "133D"}
ORIGINALS = ("110D", "4PTI", "1BK2", "1HH0", "1QL2", "1IZH")
COLUMNS = {"4.1": 3, "4.2": 3, "4.3": 3, "4.4": 2, "4.5": 2}
# docs/thesis.md: what the fitted parameters leave open on entries that they were not fitted to.
TRIANGLES_TOLERANCE = 0.03
VDW_TRIANGLES_TOLERANCE = 0.04


def printed_tables():
    """(table, entry, column) -> (triangles, seconds, voxels), read from the project's own copy."""
    cells = {}
    for table, columns in COLUMNS.items():
        path = SOURCE_DIR / "data" / "thesis" / f"table_{table.replace('.', '_')}.csv"
        with path.open(newline="") as file:
            for row in list(csv.reader(file))[1:]:
                for c in range(columns):
                    triangles, seconds = row[2 + 2 * c : 4 + 2 * c]
                    cells[table, row[0], c] = int(triangles), float(seconds), int(row[-1])
    return cells


class BenchTest(ProgramTest):
    def run_bench(self, *arguments, status=DONE):
        command = [os.environ["VDWMESH_BENCH_PROGRAM"], *map(str, arguments)]
        result = subprocess.run(command, capture_output=True, text=True, timeout=300)
        self.assertEqual(result.returncode, status, result.stderr)
        return result

    def assert_bench_refused(self, *arguments, says=()):
        result = self.run_bench(*arguments, status=BAD_INPUT)
        self.assertEqual(result.stdout, "")
        for word in says:
            self.assertIn(word, result.stderr)


class Options(BenchTest):
    def test_bad_options(self):
        self.assert_bench_refused()
        self.assert_bench_refused("speed")
        self.assert_bench_refused("thesis", says=("--structures",))
        self.assert_bench_refused("thesis", "--structures", self.folder / "no", says=("no",))
        self.assert_bench_refused("thesis", "--structures", self.folder, "--table", "4.6", says=("4.6", "4.5"))
        self.assert_bench_refused("pipeline", says=("INPUT",))
        for option, value in (("--spacing", "0"), ("--repeat", "0"), ("--distances", "maybe")):
            self.assert_bench_refused("pipeline", "--sample", "bpti", option, value, says=(option,))

    def test_the_old_verb_names_the_program(self):
        self.assert_refused(BAD_INPUT, "bench", "thesis", says=("vdwmesh-bench",))

    def test_several_structures(self):
        both = ("pipeline", "--spacing", "2", "--repeat", "1", "--csv", "-")
        rows = self.run_bench(*both, "--sample", "bpti,ubiquitin", UBIQUITIN).stdout.splitlines()
        self.assertEqual({row.split(",")[0] for row in rows[1:]}, {"bpti", "ubiquitin", "ubiquitin.pdb"})

    def test_warnings_stand_on_standard_error(self):
        result = self.run_bench("pipeline", self.cut_file(), "--spacing", "1", "--repeat", "1")
        self.assertEqual(result.stderr.count("may have been cut off"), 1, result.stderr)

    def test_without_files_everything_is_missing(self):
        output = self.run_bench("thesis", "--structures", self.folder, "--json", "-").stdout
        rows = parse_json(output)["rows"]
        self.assertEqual(len(rows), len(printed_tables()))
        for row in rows:
            self.assertTrue(row["missing"])
            self.assertIsNone(row["structure"])
            self.assertIsNone(row["triangles"])
            self.assertEqual(set(row["seconds"].values()), {None})
        text = self.run_bench("thesis", "--structures", self.folder).stdout
        self.assertRegex(text, r"Missing, no structure file: 110D, 1BIJ, .*, 4PTI\.")


class Complexes(ProgramTest):
    def test_folders_of_complexes_keep_chains(self):
        """bench/make_structures.py --complexes: the whole residues nearest to one of them, each of its chain, turned as one."""
        record = "ATOM  {0:5} {1:>4} ALA {2}{3:4}    {4:8.3f}{5:8.3f}{6:8.3f}  1.00  0.00           C\n"
        text, places, serial = "", {}, 0
        for chain, number in itertools.product("AB", range(1, 151)):
            for atom in range(4):
                serial += 1
                place = (number % 7 * 4 + 0.3 * atom, number // 7 * 4, 9 * "AB".index(chain) + 0.2 * number)
                places[chain, number, atom] = place
                text += record.format(serial, f"C{atom}", chain, number, *place)
        maker = SOURCE_DIR / "bench" / "make_structures.py"
        folder = self.folder / "made"
        command = [sys.executable, maker, "--complexes", "80", folder, "6", self.file("a.pdb", text + "END\n")]
        subprocess.run(command, check=True)
        self.assertEqual(len(list(folder.iterdir())), 6)
        chains = set()
        for path in folder.iterdir():
            lines = path.read_text().splitlines()[:-1]
            keys = [(line[21], int(line[22:26]), int(line[15])) for line in lines]
            self.assertEqual([line[:30] for line in lines], [line[:30] for line in text.splitlines() if line[:30] in
                                                             {line[:30] for line in lines}])
            residues = {key[:2] for key in keys}
            self.assertEqual((len(residues), len(keys)), (80, 320))
            chains.add("".join(sorted({chain for chain, _ in residues})))
            first = {residue: places[*residue, 0] for residue in {key[:2] for key in places}}
            self.assertTrue(any(residues == set(sorted(first, key=lambda r: math.dist(first[r], centre))[:80])
                                for centre in first.values()))  # fmt: skip
            moved = [tuple(float(line[at : at + 8]) for at in (30, 38, 46)) for line in lines]
            for i, j in ((0, 100), (50, 319), (7, 200)):
                apart = math.dist(places[keys[i]], places[keys[j]])
                self.assertAlmostEqual(math.dist(moved[i], moved[j]), apart, delta=2e-3)  # three decimals
        self.assertIn("AB", chains)


class Tables(BenchTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        need_shared("molecules/thesis")
        cls.printed = printed_tables()

    def bench(self, *arguments):
        command = ("thesis", "--structures", STRUCTURES, "--repeat", "1", *arguments)
        return parse_json(self.run_bench(*command, "--json", "-").stdout)

    def test_tables_on_the_same_grids(self):
        rows = self.bench("--entry", "110D,4PTI,2INS,2QZF", "--table", "4.2,4.4")["rows"]
        self.assertEqual(len(rows), 4 * (3 + 2))
        columns = {}
        for row in rows:
            entry, table = row["thesis"]["entry"], row["table"]
            column = columns[table, entry] = columns.get((table, entry), -1) + 1
            figures = (row["thesis"][k] for k in ("triangles", "seconds", "voxels"))
            self.assertEqual(tuple(figures), self.printed[table, entry, column])
            if entry == "2QZF":
                self.assertTrue(row["missing"])
                continue
            self.assertFalse(row["missing"])
            self.assertGreater(row["triangles"], 0)
            self.assertGreater(row["seconds"]["as_it_runs"], 0)
            self.assertEqual(row["seconds"]["kernels"], None)
            self.assertEqual(row["voxels"], math.prod(row["grid"]))
            self.assertEqual(row["program_triangles"] is not None, table == "4.2")
            if entry in ORIGINALS:
                self.assert_original(row)
            else:
                self.assert_stand_in(row, entry)

    def assert_original(self, row):
        self.assertFalse(row["stand_in"])
        self.assertEqual(row["structure"], row["thesis"]["entry"])
        self.assertEqual(row["voxels"], row["thesis"]["voxels"])
        tolerance = VDW_TRIANGLES_TOLERANCE if row["table"] == "4.4" else TRIANGLES_TOLERANCE
        self.assert_close(row["triangles_ratio"], 1, tolerance)
        if row["program_triangles"] is not None:
            self.assert_close(row["program_triangles"] / row["thesis"]["triangles"], 1, tolerance)
        ratio = row["thesis"]["seconds"] / row["seconds"]["as_it_runs"]
        self.assert_close(row["seconds_ratio"], ratio, 1e-12)

    def assert_stand_in(self, row, entry):
        self.assertTrue(row["stand_in"])
        self.assertEqual(row["structure"], STAND_INS[entry])
        self.assertIsNone(row["seconds_ratio"])
        self.assertIsNone(row["triangles_ratio"])
        self.assertIsNotNone(row["seconds_per_triangle_ratio"])

    def test_every_entry_is_there_once_per_column(self):
        names = [e for t, e, c in self.printed if t == "4.1" and c == 0]
        self.assertEqual(len(names), 16)
        rows = self.bench("--table", "4.3,4.5")["rows"]
        self.assertEqual(len(rows), 16 * 3 + 15 * 2)

    def test_gpu_tables_say_whether_there_is_a_device(self):
        bench = self.bench("--entry", "110D,4PTI", "--table", "4.3,4.5")
        for row in bench["rows"]:
            nx, ny, nz = row["grid"]
            # The thesis's GPU grids: (nx + 1) ny nz voxels, rounded up by up to two blocks of 128.
            excess = row["thesis"]["voxels"] - (nx + 1) * ny * nz
            self.assertTrue(0 <= excess <= 256, excess)
            if bench["device"] is None:
                self.assertIsNone(row["triangles"])
                self.assertEqual(set(row["seconds"].values()), {None})
            else:
                self.assertGreater(row["seconds"]["kernels"], 0)
                self.assertGreater(row["seconds"]["as_it_runs"], row["seconds"]["kernels"])
        if bench["device"] is None:
            self.assertIn("CUDA", bench["no_device"])

    def test_text_and_csv(self):
        arguments = ("thesis", "--structures", STRUCTURES, "--repeat", "1", "--entry",
                     "110D,200D,2OT5", "--table", "4.2")  # fmt: skip
        text = self.run_bench(*arguments).stdout
        self.assertRegex(text, r"110D +blinn +\| +346580 +346580 +\| +14632 +\d+ +\d\.\d{3} +\| +0.54")
        self.assertRegex(text, r"\n133D for 200D +soft")
        self.assertNotRegex(text, r"\n200D ")
        self.assertIn("Missing, no structure file: 2OT5.", text)
        rows = list(csv.DictReader(io.StringIO(self.run_bench(*arguments, "--csv", "-").stdout)))
        self.assertEqual(len(rows), 9)
        self.assertEqual(rows[0]["thesis_seconds"], "0.54")
        self.assertEqual(rows[0]["voxels"], "346580")
        self.assertEqual(rows[-1]["missing"], "true")
        self.assertEqual(rows[-1]["triangles"], "")


class Pipeline(BenchTest):
    STAGES = ["read", "spheres", "mesh", "measure", "write PLY"]
    MACHINE = ("--backend", "cpu", "--threads", "1")

    def bench(self, *arguments):
        command = ("pipeline", "--sample", "ubiquitin", "--repeat", "1", *self.MACHINE)
        return parse_json(self.run_bench(*command, *arguments, "--json", "-").stdout)

    def test_stages(self):
        bench = self.bench("--spacing", "1,0.5", "--distances", "on")
        self.assertEqual([case["spacing"] for case in bench["cases"]], [1, 0.5])
        self.assertEqual(bench["backend"]["threads"], 1)
        rate = bench["copy_bytes_per_second"]["warm"]
        for case in bench["cases"]:
            stages = case["stages"]
            of_kind = lambda kind: [s for s in stages if s["kind"] == kind]
            self.assertEqual([s["name"] for s in of_kind("stage")], self.STAGES)
            self.assertEqual([s["name"] for s in of_kind("part")], ["search", "field", "extract"])
            self.assertEqual(
                {s["name"] for s in of_kind("beside")},
                {"exact, arcs", "exact, topology", "distances"})  # fmt: skip
            for kind in ("cpu_seconds", "wall_seconds"):
                total = sum(s[kind] for s in of_kind("stage"))
                self.assert_close(case["total"][kind], total, 1e-9)
                # The parts are within their stage.
                mesh = next(s for s in stages if s["name"] == "mesh")
                self.assertLessEqual(sum(s[kind] for s in of_kind("part")), mesh[kind])
            for stage in stages:
                moved = [stage[k] for k in ("bytes_read", "bytes_written") if stage[k] is not None]
                if not moved:
                    self.assertIsNone(stage["floor_seconds"])
                    self.assertIsNone(stage["floor_ratio"])
                    continue
                self.assert_close(stage["floor_seconds"], sum(moved) / rate, 1e-9)
                ratio = stage["cpu_seconds"] / stage["floor_seconds"]
                self.assert_close(stage["floor_ratio"], ratio, 1e-9)

    def test_bytes_are_those_of_the_files(self):
        case = self.bench("--spacing", "1")["cases"][0]
        mesh = self.folder / "mesh.ply"
        self.run_ok("mesh", "--sample", "ubiquitin", "--spacing", "1", "-o", mesh, "--quiet")
        stages = {s["name"]: s for s in case["stages"]}
        self.assertEqual(stages["write PLY"]["bytes_written"], mesh.stat().st_size)
        spheres = self.report("exact", "--sample", "ubiquitin", "--topology", "off")["input"]["atoms_used"]
        self.assertEqual(stages["spheres"]["bytes_written"], 32 * spheres)  # a centre and a radius
        # A position takes 24, a normal 12, an atom 4, and the corners of a triangle 12.
        mesh = 40 * case["vertices"] + 12 * case["triangles"]
        self.assertEqual(stages["write PLY"]["bytes_read"], mesh)

    def test_text_and_csv(self):
        command = ("pipeline", "--sample", "ubiquitin", "--spacing", "1", "--repeat", "1",
                   *self.MACHINE)  # fmt: skip
        text = self.run_bench(*command).stdout
        self.assertRegex(text, r"\nubiquitin at 1 Å: \d+ spheres, \d+ vertices, \d+ triangles\n")
        self.assertRegex(text, r"\nwrite PLY +\d+\.\d{4} ")
        self.assertRegex(text, r"\nfile to file +\d+\.\d{4} ")
        rows = list(csv.DictReader(io.StringIO(self.run_bench(*command, "--csv", "-").stdout)))
        self.assertEqual([r["stage"] for r in rows if r["kind"] == "stage"], self.STAGES)
        self.assertEqual({r["input"] for r in rows}, {"ubiquitin"})


class Scripts(ProgramTest):
    """Scripts of bench/ that print tables of docs/, on little."""

    def script(self, name, *arguments):
        command = [sys.executable, "-B", SOURCE_DIR / "bench" / name, *arguments]
        return subprocess.run(command, check=True, capture_output=True, text=True, timeout=300).stdout

    @staticmethod
    def rows(text):
        """Cells of all lines of tables but the rules."""
        lines = [line for line in text.splitlines() if line.startswith("| ")]
        return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]

    def test_moved_sets(self):
        table = self.rows(self.script("excluded_moved_sets.py", PROGRAM, "--sets", "rings 3.4", "--moves", "0,1e-9"))
        self.assertEqual(table[0][:3], ["moved by, Å", "sets", "refused"])
        self.assertEqual([row[:4] for row in table[1:]], [["0", "6", "0", "0"], ["1e-09", "6", "0", "0"]])
        self.assertEqual(table[1][5:], ["0.0e+00", "0.0e+00"])
        self.assertTrue(0 < float(table[2][5]) < 1e-8, table)

    def test_lists_with_a_skin(self):
        need_package("python3-numpy", module="numpy")
        # Balls of radius 1 at 0, 2.5 and 6: gaps of 0.5, 1.5 and 4. Lists for 2 S = 0.2 … 4.
        spheres = self.file("a.xyzr", "0 0 0 1\n2.5 0 0 1\n6 0 0 1\n")
        table = self.rows(self.script("skin_lists.py", spheres, "0"))
        self.assertEqual(table[1][2:], ["0.0", "0.0", "0.7", "1.3", "1.3", "1.3"])
        self.assertEqual(table[1][0], "0")
        # Cells of 1 Å from 0, queries of 2 Å to both sides: cells 0-2 have two balls, 0-4 two, and 4-6 one.
        self.assertEqual(table[1][1], "1.7")

    def test_tables_of_a_study(self):
        self.run_ok("study", "--sample", "bpti", "-o", self.folder / "s", "--mesher", "exact", "--edge-length", "1,2",
                    "--subdivide", "0", "--self-intersections", "off", "--distances", "off", "--quiet")  # fmt: skip
        table = self.rows(self.script("study_table.py", self.folder / "s" / "study.json"))
        names = ["mesh", "crease-exact", "mesh", "crease-exact, 1 Å", "crease-exact, 2 Å"]
        self.assertEqual([row[0] for row in table], names)
        with (self.folder / "s" / "study.csv").open(newline="") as file:
            triangles = [f"{int(row['triangles']):,}" for row in csv.DictReader(file)]
        self.assertEqual([row[2] for row in table[3:]], triangles)
        self.assertEqual([row[5] for row in table[3:]], ["0", "0"])
