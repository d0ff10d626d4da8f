"""Files in and out: formats, standard input, gzip, and nothing half-written."""

import gzip
import os
import resource
import signal
import stat
import subprocess

from program import BAD_INPUT, PROGRAM, UBIQUITIN, ProgramTest, parse_json

MESH_FORMATS = ("ply", "obj", "off", "stl", "glb")


def limit_file_size():
    """Writing beyond 4 KiB fails, as on a full disk."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


class Inputs(ProgramTest):
    def setUp(self):
        super().setUp()
        self.plain = self.report("exact", UBIQUITIN)["exact"]

    def test_standard_input(self):
        with UBIQUITIN.open() as file:
            report = self.report("exact", "-", "--format", "pdb", stdin=file)
        self.assertEqual(report["exact"], self.plain)

    def test_gzip(self):
        path = self.folder / "a.pdb.gz"
        path.write_bytes(gzip.compress(UBIQUITIN.read_bytes()))
        self.assertEqual(self.report("exact", path)["exact"], self.plain)

    def test_sample_is_the_file(self):
        self.assertEqual(self.report("exact", "--sample", "ubiquitin")["exact"], self.plain)

    def test_truncated_gzip_is_refused(self):
        path = self.folder / "a.pdb.gz"
        path.write_bytes(gzip.compress(UBIQUITIN.read_bytes())[:2000])
        self.assert_refused(BAD_INPUT, "exact", path, says=("a.pdb.gz",))


    def test_models_without_a_number_go_by_their_place(self):
        names = ("group_PDB", "id", "type_symbol", "label_atom_id", "label_comp_id", "label_asym_id",
                 "label_seq_id", "Cartn_x", "Cartn_y", "Cartn_z", "pdbx_PDB_model_num")  # fmt: skip
        header = "data_x\nloop_\n" + "".join(f"_atom_site.{name}\n" for name in names)
        path = self.file("a.cif", header + "ATOM 1 C CA ALA A 1 0 0 0 ?\nATOM 2 O O ALA A 1 5 0 0 ?\n")
        for model in ("first", "1"):
            found = self.report("exact", path, "--model", model)["input"]
            self.assertEqual((found["atoms_used"], found["model"]), (2, "1"))
        self.assert_refused(BAD_INPUT, "exact", path, "--model", "2", says=("no model 2; it has 1",))

    def test_an_assembly_counts_its_atoms_once_and_its_spheres_all(self):
        remark = "".join(f"REMARK 350   BIOMT{row}   {copy}  " + "".join(
            f"{float(row == column):10.6f}" for column in (1, 2, 3)) + f"     {30 * (copy - 1) * (row == 1):10.5f}\n"
                         for copy in (1, 2) for row in (1, 2, 3))
        atom = "ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00  0.00           C\n"
        path = self.file("a.pdb", "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
                         + remark + atom)
        found = self.report("exact", path, "--assembly", "1")["input"]
        self.assertEqual((found["atoms_read"], found["atoms_used"], found["spheres"]), (1, 1, 2))
        text = self.run_ok("exact", path, "--assembly", "1").stdout
        self.assertIn("1 protein; left out: none; copied to 2 spheres", text)


class Outputs(ProgramTest):
    def test_every_mesh_format(self):
        for extension in MESH_FORMATS:
            with self.subTest(extension=extension):
                path = self.folder / f"a.{extension}"
                self.run_ok("mesh", UBIQUITIN, "-o", path)
                self.assertGreater(path.stat().st_size, 100_000)
        self.assertEqual(self.files(), sorted(f"a.{e}" for e in MESH_FORMATS))

    def test_mesh_writes_the_report_too(self):
        json_path = self.folder / "a.json"
        self.run_ok("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--json", json_path)
        report = parse_json(json_path.read_text())
        self.assertIsNone(report["exact"])
        self.assertIsNone(report["comparison"])
        self.assertIsNone(report["timing"]["build"])
        self.assertEqual(report["mesh"]["newton"], None)

    def test_an_existing_file_is_replaced_whole(self):
        path = self.file("a.json", "x" * 1_000_000)
        self.run_ok("exact", UBIQUITIN, "--json", path)
        parse_json(path.read_text())

    def test_full_disk_leaves_nothing(self):
        for extension in MESH_FORMATS:
            with self.subTest(extension=extension):
                path = self.folder / f"a.{extension}"
                arguments = ("mesh", UBIQUITIN, "-o", path)
                self.assert_refused(
                    BAD_INPUT, *arguments, says=(path.name,), preexec_fn=limit_file_size
                )
                self.assertEqual(self.files(), [])

    def test_full_disk_leaves_no_table(self):
        path = self.folder / "a.csv"
        arguments = ("exact", UBIQUITIN, "--per-atom", path)
        self.assert_refused(BAD_INPUT, *arguments, says=("a.csv",), preexec_fn=limit_file_size)
        self.assertEqual(self.files(), [])

    def test_one_file_for_two_outputs(self):
        path = self.folder / "a.ply"
        (self.folder / "link.json").symlink_to("a.ply")
        for same in (path, f"{self.folder}/./a.ply", self.folder / "link.json"):
            with self.subTest(same=same):
                mesh = ("mesh", UBIQUITIN, "-o", path, "--json", same)
                self.assert_refused(BAD_INPUT, *mesh, says=("-o", "--json"))
                both = ("--json", path, "--per-atom", same)
                self.assert_refused(BAD_INPUT, "exact", UBIQUITIN, *both, says=("--json", "--per-atom"))
        both = ("--json", "-", "--per-atom", "-")
        self.assert_refused(BAD_INPUT, "exact", UBIQUITIN, *both, says=("--json", "--per-atom"))
        self.assertEqual(self.files(), ["link.json"])

    def test_an_output_that_is_an_input(self):
        """Whatever name it goes by: the same, a link to it, another name of it."""
        structure, mesh = self.file("in.xyzr", "0 0 0 1\n"), self.folder / "in.ply"
        self.run_ok("mesh", structure, "-o", mesh)
        radii = self.file("radii.txt", "C 1.7\n")
        (self.folder / "soft").symlink_to("in.xyzr")
        (self.folder / "hard").hardlink_to(structure)
        before = {path: path.read_bytes() for path in self.folder.iterdir()}
        for arguments, says in (
            (("exact", structure, "--json", structure), ("--json", "INPUT")),
            (("exact", structure, "--json", self.folder / "soft"), ("--json", "INPUT")),
            (("exact", structure, "--per-atom", self.folder / "hard"), ("--per-atom", "INPUT")),
            (("exact", UBIQUITIN, "--radii", radii, "--json", radii), ("--json", "--radii")),
            (("compare", mesh, structure, "--json", mesh), ("--json", "MESH")),
            (("compare", mesh, structure, "--json", structure), ("--json", "INPUT")),
            (("render", self.link("a.png", "in.ply"), "--format", "xyzr", "-o", self.folder / "a.png"),
             ("-o", "INPUT")),
            (("study", self.folder / "out" / "study.csv", "--format", "xyzr", "-o", self.folder / "out"),
             ("-o", "INPUT")),
        ):  # fmt: skip
            with self.subTest(arguments=arguments):
                self.assert_refused(BAD_INPUT, *arguments, says=says)
        self.assertEqual({path: path.read_bytes() for path in before}, before)

    def link(self, name, target):
        (self.folder / name).symlink_to(target)
        return self.folder / name

    def test_a_table_on_standard_output(self):
        written = self.folder / "a.csv"
        self.run_ok("exact", UBIQUITIN, "--per-atom", written)
        shown = self.run_ok("exact", UBIQUITIN, "--per-atom", "-", cwd=self.folder)
        self.assertEqual(shown.stdout, written.read_text())
        self.assertEqual(self.files(), ["a.csv"])

    def test_a_private_file_stays_private(self):
        for name, arguments in (("a.json", ("exact", "--json")), ("a.csv", ("exact", "--per-atom")),
                                ("a.ply", ("mesh", "-o"))):
            verb, option = arguments
            path = self.file(name, "old")
            path.chmod(0o600)
            self.run_ok(verb, UBIQUITIN, option, path)
            self.assertEqual(stat.S_IMODE(path.stat().st_mode), 0o600)
            self.assertNotEqual(path.read_bytes(), b"old")

    def test_a_link_stays_a_link(self):
        for name, arguments in (("a.json", ("exact", "--json")), ("a.csv", ("exact", "--per-atom")),
                                ("a.ply", ("mesh", "-o"))):
            verb, option = arguments
            link = self.link(name, "target-of-" + name)
            self.run_ok(verb, UBIQUITIN, option, link)
            self.assertTrue(link.is_symlink())
            self.assertGreater((self.folder / f"target-of-{name}").stat().st_size, 0)

    def test_a_name_as_long_as_names_may_be(self):
        longest = os.pathconf(self.folder, "PC_NAME_MAX")
        for verb, option, extension in (("exact", "--json", ".json"), ("mesh", "-o", ".ply")):
            path = self.folder / ("x" * (longest - len(extension)) + extension)
            self.run_ok(verb, UBIQUITIN, option, path)
            self.assertGreater(path.stat().st_size, 0)
            too_long = path.with_name("x" + path.name)
            self.assert_refused(BAD_INPUT, verb, UBIQUITIN, option, too_long, says=(option, "too long"))
        self.assertEqual(len(self.files()), 2)

    def test_a_pipe_that_nobody_reads_can_be_interrupted(self):
        pipe = self.folder / "a.json"
        os.mkfifo(pipe)
        for arguments in (("exact", UBIQUITIN, "--json", pipe), ("mesh", UBIQUITIN, "-o", self.link("a.ply", pipe))):
            process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=subprocess.DEVNULL)
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(1)  # it waits for the pipe's other end
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(60), 130)

    def test_full_disk_keeps_the_old_file(self):
        path = self.file("a.ply", "old")
        self.assert_refused(BAD_INPUT, "mesh", UBIQUITIN, "-o", path, preexec_fn=limit_file_size)
        self.assertEqual(path.read_text(), "old")
        self.assertEqual(self.files(), ["a.ply"])

    def test_full_standard_output_is_an_error(self):
        with open("/dev/full", "w") as full:
            result = subprocess.run(
                [PROGRAM, "info"], stdout=full, stderr=subprocess.PIPE, text=True
            )
        self.assertEqual(result.returncode, BAD_INPUT)
        self.assertIn("standard output", result.stderr)
