"""What the command line accepts, and how it refuses the rest."""

from program import BAD_INPUT, LIMIT_HIT, NO_BACKEND, UBIQUITIN, ProgramTest, parse_json, run

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
            "--memory-limit": ("0", "-1G", "8Q", "G", "nan", "1e300G"),
        }.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    self.refused(option, value, says=(value,))

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

    def test_grid_that_no_index_can_number(self):
        self.assert_refused(LIMIT_HIT, "report", UBIQUITIN, "--spacing", "1e-9")


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
