"""What the command line accepts, and how it refuses the rest."""

import os
import re
import subprocess
import unittest

from program import (
    BAD_INPUT,
    LIMIT_HIT,
    NO_BACKEND,
    PROGRAM,
    SANITIZED,
    SOURCE_DIR,
    UBIQUITIN,
    ProgramTest,
    parse_json,
    run,
)

FIELDS = ("vdw", "blinn", "soft", "inverse-squared")


class Refusals(ProgramTest):
    def refused(self, *options, says=()):
        option = next(o for o in options if o.startswith("--"))
        self.assert_refused(BAD_INPUT, "report", UBIQUITIN, *options, says=(option, *says))

    def test_numbers_out_of_range(self):
        for option, values in {
            "--spacing": ("0", "-0.5", "nan", "inf", "abc", "", "0.5x"),
            "--padding": ("-1", "nan", "inf"),
            "--probe": ("nan", "inf", "wide"),
            "--subdivide": ("-1", "40", "1.5", "nan", "99999999999999999999"),
            "--samples": ("0", "-1", "nan", "many"),
            "--seed": ("-1", "1.5", "luck"),
            "--threads": ("0", "-2", "many"),
            "--memory-limit": ("0", "-1G", "8Q", "G", "nan", "1e300G", "1e-9", "lots"),
        }.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    self.refused(option, value, says=(value,))

    def test_sizes_that_no_machine_has(self):
        for spacing in ("1e-9", "1e-3", "1e-300"):
            arguments = ("report", UBIQUITIN, "--spacing", spacing)
            self.assert_refused(LIMIT_HIT, *arguments, says=("spacing",))
        for spacing in ("1e9", "1e300"):
            self.refused("--spacing", spacing, says=("coarse", "try --spacing"))
        for length in ("1e-9", "1e-3"):
            arguments = ("report", UBIQUITIN, "--mesher", "exact", "--edge-length", length)
            self.assert_refused(LIMIT_HIT, *arguments, says=("--edge-length",))
        self.assert_refused(LIMIT_HIT, "report", UBIQUITIN, "--subdivide", "10",
                            says=("--subdivide",))
        self.assert_refused(LIMIT_HIT, "report", UBIQUITIN, "--padding", "1e9", says=("spacing",))
        self.assert_refused(LIMIT_HIT, "report", UBIQUITIN, "--probe", "1e9", says=("spacing",))

    def test_radius_files(self):
        for text, says in {
            "C 1.7\nN x\n": ("radii.txt:2:", "'x'"),
            "C 1.7\n\n# none\nN -1\n": ("radii.txt:4:", "'-1'"),
            "C nan\n": ("radii.txt:1:", "'nan'"),
            "C 1e9\n": ("radii.txt:1:", "from 0 to"),
            "C 1.7 2 3\n": ("radii.txt:1:", "ELEMENT RADIUS"),
            "C\n": ("radii.txt:1:", "ELEMENT RADIUS"),
            "Qq 1.7\n": ("radii.txt:1:", "'Qq'"),
            "": ("radii.txt", "no radii"),
            "C 1.7\n": ("no radius", "N"),
        }.items():
            with self.subTest(text=text):
                path = self.file("radii.txt", text)
                self.refused_with(("--radii", str(path)), says)
        self.refused_with(("--radii", str(self.folder)), ("directory",))
        self.refused_with(("--radii", "nonsense"), ("bondi", "alvarez"))

    def refused_with(self, options, says):
        self.assert_refused(BAD_INPUT, "report", UBIQUITIN, *options, says=says)

    def test_selections_that_leave_nothing(self):
        for options in (("--select", "/1/Z"), ("--select", "(HOH)"), ("--model", "7"),
                        ("--assembly", "9"), ("--altloc", "Q")):
            with self.subTest(options=options):
                self.refused_with(options, ())
        self.refused_with(("--select", "((("), ("select",))

    def test_unknown_names_list_the_known_ones(self):
        for option, known in {
            "--field": FIELDS,
            "--preset": ("radius-aware", "thesis", "thesis-vdw"),
            "--project": ("vdw", "field", "none"),
            "--backend": ("auto", "cpu", "cuda"),
            "--method": ("cgal", "arcs", "both"),
            "--topology": ("on", "off"),
            "--distances": ("on", "off"),
            "--mesher": ("marching-cubes", "exact"),
            "--self-intersections": ("auto", "on", "off"),
            "--format": ("pdb", "mmcif", "pqr", "xyzr"),
        }.items():
            with self.subTest(option=option):
                self.refused(option, "nonsense", says=("nonsense", *known))

    def test_options_that_contradict_each_other(self):
        self.refused("--preset", "thesis", says=("--field",))
        self.refused("--isovalue", "2", says=("--field",))
        self.refused("--blobbiness", "2", "--field", "soft", says=("blinn",))
        self.refused("--topology", "on", "--method", "arcs", says=("cgal",))
        self.refused("--edge-length", "0.3", says=("--mesher exact", "--spacing"))
        for option in ("--spacing", "--padding"):
            self.refused(option, "0.5", "--mesher", "exact", says=("--edge-length",))
        self.refused("--mesher", "exact", "--field", "blinn", says=("vdw",))
        self.refused("--devices", "2", "--backend", "cpu", says=("--backend cpu",))
        for value in ("0", "-1", "nan", "inf"):
            self.refused("--edge-length", value, "--mesher", "exact", says=(value,))
        self.refused("--samples", "3", "--distances", "off")
        self.refused("--no-hetatm", "--hetatm")
        self.refused("--group", "residue", says=("--per-atom",))
        self.refused("--sample", "ubiquitin")

    def test_probe_that_leaves_no_radius(self):
        # The smallest radius in ubiquitin is oxygen's 1.52 Å.
        self.refused("--probe", "-1.6", says=("radius",))
        self.refused("--probe", "-5", says=("radius",))

    def test_unknown_option_and_superfluous_argument(self):
        self.assert_refused(BAD_INPUT, "report", UBIQUITIN, "--frobnicate", says=("--frobnicate",))
        self.assert_refused(BAD_INPUT, "report", UBIQUITIN, "more.pdb", says=("more.pdb",))

    def test_verbs(self):
        self.assert_refused(BAD_INPUT, says=("mesh", "report", "exact", "compare", "info"))
        self.assert_refused(BAD_INPUT, "frobnicate", says=("frobnicate", "report"))

    def test_missing_input(self):
        self.assert_refused(BAD_INPUT, "report", says=("INPUT", "--sample"))
        self.assert_refused(BAD_INPUT, "report", self.folder / "no.pdb", says=("no.pdb",))
        self.assert_refused(BAD_INPUT, "report", "--sample", "nonsense", says=("ubiquitin",))
        self.assert_refused(BAD_INPUT, "report", "-", says=("--format",), input="")

    def test_outputs_are_checked_before_work(self):
        missing = self.folder / "missing" / "a.json"
        self.refused("--json", str(missing), says=("folder",))
        self.refused("--json", str(self.folder), says=("folder",))
        mesh = ("mesh", self.folder / "not-read.pdb", "-o")
        self.assert_refused(BAD_INPUT, *mesh, self.folder / "a.docx", says=(".ply", ".glb"))
        self.assert_refused(BAD_INPUT, *mesh, missing.with_suffix(".ply"), says=("folder",))
        self.assertEqual(self.files(), [])

    def test_too_coarse_a_grid_is_not_an_empty_mesh(self):
        self.refused("--spacing", "60", says=("coarse",))


class Limits(ProgramTest):
    def test_memory_limit(self):
        output = self.folder / "a.ply"
        options = ("mesh", UBIQUITIN, "-o", output, "--spacing", "0.1", "--memory-limit", "1M")
        self.assert_refused(LIMIT_HIT, *options, says=("memory",))
        self.assertEqual(self.files(), [])

    def test_what_the_message_names_would_do(self):
        quick = ("--distances", "off", "--self-intersections", "off", "--cgal-check", "off")
        for surface in (("--spacing", "0.4", "--subdivide", "1"),
                        ("--mesher", "exact", "--edge-length", "0.4", "--subdivide", "1")):
            arguments = ["report", UBIQUITIN, *surface, "--memory-limit", "70M", *quick]
            refused = self.assert_refused(LIMIT_HIT, *arguments, says=("of memory",))
            named = re.findall(r"(--[a-z-]+) ([0-9.]+M?)", refused.stderr)
            step = surface[-4]
            self.assertEqual({option for option, _ in named}, {step, "--subdivide", "--memory-limit"})
            for option, value in named:
                with self.subTest(surface=surface, remedy=option):
                    mended = list(arguments)
                    mended[mended.index(option) + 1] = value
                    self.run_ok(*mended, "--quiet")

    @unittest.skipIf(SANITIZED, "the sanitizers take memory of their own")
    def test_estimates_hold(self):
        for arguments in (
            ("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--spacing", "0.25"),
            ("report", UBIQUITIN, "--spacing", "0.4"),
            ("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--mesher", "exact", "--edge-length", "0.3"),
            *(("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--spacing", "0.2", "--field", field)
              for field in ("blinn", "soft", "inverse-squared")),
            ("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--spacing", "0.2", "--preset", "thesis",
             "--field", "blinn"),
        ):
            with self.subTest(arguments=arguments):
                output = self.folder / "a.json"
                process = subprocess.Popen([PROGRAM, *map(str, arguments), "--quiet", "--threads", "2",
                                            "--json", str(output)])
                _, status, usage = os.wait4(process.pid, 0)
                process.returncode = os.waitstatus_to_exitcode(status)
                self.assertEqual(process.returncode, 0)
                estimate = parse_json(output.read_text())["parameters"]["memory_estimate"]
                self.assertLessEqual(usage.ru_maxrss * 1024, estimate)
                self.assertLess(estimate, 2 * usage.ru_maxrss * 1024)

    def test_blended_fields_are_refused_before_the_first_stage(self):
        mesh = ("mesh", UBIQUITIN, "-o", self.folder / "a.ply")
        for verb in (mesh, ("report", UBIQUITIN), ("render", UBIQUITIN, "-o", self.folder / "a.png")):
            with self.subTest(verb=verb[0]):
                self.assert_refused(LIMIT_HIT, *verb, "--field", "blinn", "--spacing", "0.1",
                                    "--subdivide", "1", "--memory-limit", "100M",
                                    says=["the stage", "--spacing", "0.0977 GiB are allowed"])

    def test_grid_that_no_index_can_number(self):
        self.assert_refused(LIMIT_HIT, "report", UBIQUITIN, "--spacing", "1e-9")


class Documentation(ProgramTest):
    def test_every_option_is_in_the_table(self):
        table = (SOURCE_DIR / "docs" / "options.md").read_text()
        verbs = ("mesh", "report", "exact", "compare", "study", "render", "bench thesis",
                 "bench pipeline", "info")
        helps = [run(*verb.split(), "--help").stdout for verb in verbs]
        told = {o for text in helps for o in re.findall(r"--[a-z-]+", text)}
        told -= {"--help"}
        self.assertGreater(len(told), 40)
        self.assertEqual({o for o in told if f"`{o}`" not in table}, set())
        self.assertEqual(set(re.findall(r"`(--[a-z-]+)`", table)) - told, set())


class Messages(ProgramTest):
    def test_stay_one_line_whatever_was_typed(self):
        for arguments in (("no\nverb",), ("mesh", "--no\nsuch\x1b[2J"), ("report", UBIQUITIN, "--mesher", "a\rb"),
                          ("report", UBIQUITIN, "--field", "no\nfield"), ("report", "no\nfile.pdb")):
            with self.subTest(arguments=arguments):
                result = self.assert_refused(BAD_INPUT, *arguments)
                self.assertIn("?", result.stderr)
                self.assertTrue(result.stderr[:-1].isprintable())


class Backends(ProgramTest):
    def test_cuda_without_a_device(self):
        info = parse_json(self.run_ok("info", "--json", "-").stdout)
        if info["cuda"]["devices"]:
            self.skipTest("this machine has a CUDA device")
        self.assertTrue(info["cuda"]["reason"])
        self.assert_refused(NO_BACKEND, "report", UBIQUITIN, "--backend", "cuda")
        self.assert_refused(
            NO_BACKEND, "mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--backend", "cuda"
        )
        self.assertEqual(self.files(), [])

    def test_help_and_version(self):
        for arguments in (["--help"], ["--version"], ["report", "--help"]):
            result = run(*arguments)
            self.assertEqual(result.returncode, 0)
            self.assertIn("vdwmesh", result.stdout)
            self.assertEqual(result.stderr, "")
