"""Files in and out: formats, standard input, gzip, and nothing half-written."""

import gzip
import resource
import signal
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
        self.assertGreater(report["timing"]["build"], 0)
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
        self.assert_refused(BAD_INPUT, "mesh", UBIQUITIN, "-o", path, "--json", path, says=("--json",))
        both = ("--json", path, "--per-atom", path)
        self.assert_refused(BAD_INPUT, "exact", UBIQUITIN, *both, says=("--json", "--per-atom"))
        self.assertEqual(self.files(), [])

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
