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
    UNSEEN,
    ProgramTest,
    parse_json,
    run,
)

FIELDS = ("vdw", "blinn", "soft", "inverse-squared")


class Refusals(ProgramTest):
    def refused(self, *options, says=()):
        option = next(o for o in options if o.startswith("--"))
        self.assert_refused(BAD_INPUT, "report", UBIQUITIN, *options, says=(option.rstrip("="), *says))

    def test_numbers_out_of_range(self):
        for option, values in {
            "--spacing": ("0", "-0.5", "nan", "inf", "abc", "", "0.5x"),
            "--padding": ("-1", "nan", "inf"),
            "--probe": ("nan", "inf", "wide"),
            "--subdivide": ("-1", "40", "1.5", "nan", "99999999999999999999"),
            "--samples": ("0", "-1", "nan", "many", "1e9", "1e300"),
            "--seed": ("-1", "1.5", "luck"),
            "--threads": ("0", "-2", "many"),
            "--memory-limit": ("0", "-1G", "8Q", "G", "nan", "1e300G", "1e-9", "lots"),
        }.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    self.refused(option, value, says=(value,))

    def test_empty_values(self):
        """A variable of a script that was not set must not measure everything."""
        for option in ("--select", "--measure", "--json", "--radii", "--altloc", "--model", "--per-atom",
                       "--edge-length-of", "--group", "--picture", "--assembly", "--voids"):  # fmt: skip
            with self.subTest(option=option):
                self.refused(option, "", says=("empty",))
                self.refused(f"{option}=", "--topology=off", says=("empty",))
        self.assert_refused(BAD_INPUT, "exact", "", says=("INPUT", "empty"))

    def test_options_that_lists_of_spheres_cannot_have(self):
        path = self.file("a.xyzr", "0 0 0 1.7\n")
        for options in (("--radii", "bondi"), ("--waters",), ("--no-hydrogens",)):
            self.assert_refused(BAD_INPUT, "exact", path, *options, says=(options[0],))
        path = self.file("a.pqr", "ATOM 1 N MET 1 -6.4 5.5 -3.3 -0.3 1.85\n")
        self.assert_refused(BAD_INPUT, "exact", path, "--radii", "alvarez", says=("--radii",))

    def test_a_sample_has_its_own_format(self):
        for verb in ("exact", "report"):
            self.assert_refused(BAD_INPUT, verb, "--sample", "bpti", "--format", "xyzr", says=("--format", "--sample"))
            self.assert_refused(BAD_INPUT, verb, "--sample", "bpti", "--units", "nm", says=("--units", "--sample"))

    def test_a_radius_file_adds_to_a_set(self):
        mine, table = self.file("mine.txt", "ZN 2.5\nMET CA 3\nmet CA 4\n"), self.folder / "r.json"
        self.run_ok("exact", UBIQUITIN, "--radii", f"Bondi,{mine}", "--json", table)
        notes = " ".join(parse_json(table.read_text())["notes"])
        for line in ("mine.txt:1 (Zn)", "mine.txt:3 (met CA)"):
            self.assertIn(line, notes)
        self.assertNotIn("(MET CA)", notes)

    def test_sizes_that_no_machine_has(self):
        for spacing in ("1e-9", "1e-3", "1e-300"):
            arguments = ("report", UBIQUITIN, "--spacing", spacing)
            self.assert_refused(LIMIT_HIT, *arguments, says=("spacing",))
        for spacing in ("1e9", "1e17", "1e20", "1e25", "1e100", "1e300"):
            self.refused("--spacing", spacing, says=("coarse", "try --spacing"))
        for length in ("1e-9", "1e-3"):
            arguments = ("report", UBIQUITIN, "--mesher", "exact", "--edge-length", length)
            self.assert_refused(LIMIT_HIT, *arguments, says=("--edge-length",))
        self.assert_refused(LIMIT_HIT, "report", UBIQUITIN, "--subdivide", "10",
                            says=("--subdivide",))
        self.assert_refused(LIMIT_HIT, "report", UBIQUITIN, "--padding", "1e9", says=("spacing",))
        self.assert_refused(LIMIT_HIT, "report", UBIQUITIN, "--probe", "1e9", says=("--edge-length",))
        self.assert_refused(LIMIT_HIT, "report", UBIQUITIN, "--probe", "1e9", "--field", "soft", says=("spacing",))

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
        self.refused_with(("--measure", "((("), ("select",))
        self.refused_with(("--measure", "(HOH)"), ("(HOH)", "measure", "602"))

    def test_unknown_names_list_the_known_ones(self):
        for option, known in {
            "--field": FIELDS,
            "--preset": ("radius-aware", "thesis", "thesis-vdw"),
            "--project": ("vdw", "field", "none"),
            "--crossings": ("undo", "allow"),
            "--backend": ("auto", "cpu", "cuda"),
            "--method": ("cgal", "arcs", "both"),
            "--topology": ("on", "counts", "off"),
            "--distances": ("on", "off"),
            "--mesher": ("marching-cubes", "exact"),
            "--self-intersections": ("auto", "on", "off"),
            "--format": ("pdb", "mmcif", "pqr", "xyzr", "gro", "mol2", "sdf", "xyz"),
        }.items():
            with self.subTest(option=option):
                self.refused(option, "nonsense", says=("nonsense", *known))

    def test_options_that_contradict_each_other(self):
        self.refused("--preset", "thesis", says=("--field",))
        self.refused("--isovalue", "2", says=("--field",))
        self.refused("--blobbiness", "2", "--field", "soft", says=("blinn",))
        self.refused("--topology", "on", "--method", "arcs", says=("cgal",))
        self.refused("--edge-length", "0.3", "--spacing", "1", says=("--mesher exact", "--spacing"))
        self.refused("--edge-length", "0.3", "--field", "soft", says=("--mesher exact", "--field", "--spacing"))
        for option in ("--spacing", "--padding"):
            self.refused(option, "0.5", "--mesher", "exact", says=("--edge-length",))
        self.refused("--mesher", "exact", "--field", "blinn", says=("vdw",))
        self.refused("--devices", "2", "--backend", "cpu", says=("--backend cpu",))
        for value in ("0", "-1", "nan", "inf"):
            self.refused("--edge-length", value, "--mesher", "exact", says=(value,))
        self.refused("--samples", "3", "--distances", "off")
        self.refused("--no-hetatm", "--hetatm")
        self.refused("--quiet", "--progress", says=("--progress",))
        self.refused("--group", "residue", says=("--per-atom",))
        self.refused("--sample", "ubiquitin")

    def test_an_isovalue_that_no_field_reaches(self):
        """The grid is fine enough for every ball: a coarser one, or a finer one, would not help."""
        for field in ("blinn", "soft", "inverse-squared"):
            result = self.assert_refused(BAD_INPUT, "report", UBIQUITIN, "--field", field, "--spacing", "1",
                                         "--isovalue", "1e9", says=("--isovalue 1000000000", "lower"))  # fmt: skip
            self.assertNotIn("--spacing", result.stderr)

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

    def test_the_spacing_that_would_do_is_the_finest(self):
        def mesh(spacing):
            return run("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--spacing", spacing, "--memory-limit", "150M")

        refused = mesh("0.05")
        self.assertEqual(refused.returncode, LIMIT_HIT)
        spacing = float(re.search(r"--spacing ([\d.]+)", refused.stderr)[1])
        self.assertEqual(mesh(str(spacing)).returncode, 0)
        self.assertEqual(mesh(str(0.9 * spacing)).returncode, LIMIT_HIT)

    def test_at_most_sixteen_subdivisions(self):
        options = ("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--subdivide")
        self.assert_refused(LIMIT_HIT, *options, "16")
        self.assert_refused(BAD_INPUT, *options, "17", says=("16",))

    def test_the_limit_stands_in_the_report(self):
        report = self.report("report", "--sample", "bpti", "--spacing", "1", "--memory-limit", "3G")
        self.assertEqual(report["parameters"]["memory_limit"], 3 << 30)

    def test_amounts_are_readable(self):
        for limit, says in (("1K", "1024 bytes are allowed"), ("1M", "1 MiB are allowed"),
                            ("20M", "0.0195 GiB are allowed")):  # fmt: skip
            self.assert_refused(LIMIT_HIT, "report", "--sample", "bpti", "--memory-limit", limit, says=(says,))

    @unittest.skipIf(SANITIZED, "the sanitizers take memory of their own")
    def test_a_verb_is_charged_for_its_own_stages_alone(self):
        """`mesh` has no check by CGAL; `report` has what it is asked for. Self-intersections take less than measures."""
        grid = ("--spacing", "0.2")
        self.run_ok("mesh", UBIQUITIN, "-o", self.folder / "a.ply", *grid, "--memory-limit", "120M")
        report = ("report", UBIQUITIN, "--subdivide", "0", "--distances", "off", *grid, "--memory-limit", "80M")
        self.run_ok(*report, "--self-intersections", "off", "--cgal-check", "off", "--quiet")
        self.assert_refused(LIMIT_HIT, *report, "--self-intersections", "off", says=("check by CGAL", "--cgal-check off"))
        self.run_ok(*report, "--cgal-check", "off", "--quiet")

    def test_what_the_message_names_would_do(self):
        quick = ("--distances", "off", "--self-intersections", "off", "--cgal-check", "off")
        surfaces = (("--spacing", "0.4", "--subdivide", "1"),
                    ("--mesher", "exact", "--edge-length", "0.4", "--subdivide", "1"))  # fmt: skip
        for surface in surfaces[:1] if SANITIZED else surfaces:
            arguments = ["report", UBIQUITIN, *surface, "--memory-limit", "55M", *quick]
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
            ("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--surface", "excluded", "--edge-length", "0.5"),
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
        verbs = ("mesh", "report", "exact", "interface", "compare", "study", "render", "batch", "pockets", "view", "info")
        helps = [run(*verb.split(), "--help-all").stdout for verb in verbs]
        told = {o for text in helps for o in re.findall(r"--[a-z-]+", text)}
        told = told - {"--help"} | {"--help-all"} | UNSEEN
        self.assertGreater(len(told), 40)
        self.assertEqual({o for o in told if f"`{o}`" not in table}, set())
        self.assertEqual(set(re.findall(r"`(--[a-z-]+)`", table)) - told, set())


class Help(ProgramTest):
    """Options by group, what stands for their values, what is required, what holds without them."""

    def help(self, *verb):
        result = self.run_ok(*verb, "--help-all")
        self.assertEqual(result.stderr, "")
        return result.stdout

    def entry(self, text, option):
        """An option's lines joined to one: names and value, then the meaning."""
        found = re.search(rf"^  ({option}.*(?:\n {{20,}}.*)*)", text, re.M)
        self.assertIsNotNone(found, option)
        return re.sub(r"\s+", " ", found[1])

    def test_groups_in_order(self):
        for verb, groups in {
            "report": ["Input", "Surface", "Measures", "Picture", "Output", "Machine"],
            "exact": ["Input", "Surface", "Measures", "Output", "Machine"],
            "batch": ["Input", "Surface", "Measures", "Output", "Machine"],
            "study": ["Input", "Surface", "Sweep", "Measures", "Output", "Machine"],
            "info": ["Output"],
        }.items():
            with self.subTest(verb=verb):
                self.assertEqual(re.findall(r"^(\w+):$", self.help(*verb.split()), re.M), groups)

    def test_values_have_names_and_units(self):
        text = self.help("report")
        for option, value in {"--spacing": "Å", "--probe": "Å", "--subdivide": "N", "--json": "FILE",
                              "--field": "NAME", "--memory-limit": "BYTES", "--size": "WIDTHxHEIGHT"}.items():  # fmt: skip
            self.assertRegex(text, rf"(?m)^  {option} {value} ", option)
        self.assertRegex(text, r"(?m)^  --waters  ")
        self.assertRegex(self.help("study"), r"(?m)^  --spacing Å,\.\.\. ")
        self.assertNotIn("TEXT", text)

    def test_columns_are_even_on_the_screen(self):
        """Å takes two bytes and one column."""
        lines = [l for l in self.help("report").splitlines() if re.match(r"  --\S+(?: \S+)?  +\S", l)]
        self.assertGreater(len(lines), 30)
        self.assertEqual({re.match(r"  --\S+(?: \S+)?  +", l).end() for l in lines}, {32})
        self.assertLessEqual(max(map(len, self.help("report").splitlines())), 100)

    def test_what_is_required_is_marked(self):
        for verb, option in {"mesh": "-o, --output FILE", "render": "-o, --output FILE", "compare": "MESH",
                             "study": "-o, --output FOLDER"}.items():  # fmt: skip
            self.assertIn("(required) ", self.entry(self.help(*verb.split()), option))
        report = self.help("report")
        self.assertIn("(required, or --sample) ", self.entry(report, "INPUT"))
        self.assertEqual(report.count("(required"), 1)

    def test_names_and_defaults(self):
        text = self.help("report")
        self.assertIn(": vdw, blinn, soft or inverse-squared [vdw]", self.entry(text, "--field"))
        self.assertTrue(self.entry(text, "--spacing").endswith("[0.5; thesis presets 0.4]"))
        of_meshers = "0; 1 with marching cubes"
        for verb, levels in (("mesh", 0), ("report", of_meshers), ("render", of_meshers), ("study", "0,1")):
            self.assertTrue(self.entry(self.help(verb), "--subdivide").endswith(f"[{levels}]"), verb)

    def test_defaults_are_those_of_the_help(self):
        """What --help says in brackets is what the report says was taken."""
        told = self.help("report")
        usual, gridded = (self.report("report", "--sample", "bpti", *options, "--distances", "off")["parameters"]
                          for options in ((), ("--spacing", "1")))  # fmt: skip
        for option, key in (("--field", "field"),):
            self.assertTrue(self.entry(told, option).endswith(f"[{gridded[key]}]"), option)
        for option, key in (("--mesher", "mesher"), ("--subdivide", "subdivide")):
            first, second = self.entry(told, option).rsplit("[", 1)[1].split("; ")
            self.assertEqual(first, str(usual[key]))
            self.assertTrue(second.startswith(f"{gridded[key]} with "), option)

    def test_verbs(self):
        self.assertRegex(self.help(), r"(?m)^  report +\S")
        self.assertEqual(self.help("exact", "no-file.pdb"), self.help("exact"))
        self.assertEqual(run("mesh", "-h").stdout, self.run_ok("mesh", "--help").stdout)


class FirstMistakes(ProgramTest):
    """What people type on their first day; each line of refusal names what to do next."""

    def says(self, *arguments, next_step):
        self.assert_refused(BAD_INPUT, *arguments, says=(next_step,))

    def test_verbs(self):
        self.says(next_step="vdwmesh --help says what each does")
        self.says("helps", next_step="vdwmesh --help says what each does")
        self.says("repot", UBIQUITIN, next_step="did you mean report?")
        self.says("bench", next_step="vdwmesh-bench")
        self.says("1UBQ.pdb", next_step=", for example vdwmesh exact 1UBQ.pdb;")

    def test_inputs(self):
        self.says("exact", next_step="--sample ubiquitin")
        self.says("exact", "1UBQ", next_step="there is no such file; name a structure file (read are .pdb")
        self.says("exact", "ubiquitin", next_step="--sample ubiquitin")
        self.says("exact", self.file("1UBQ", "ATOM"), next_step="or say --format")
        self.says("exact", "--sample", "ubiquitn", next_step="there are ubiquitin and bpti")
        self.says("exact", self.folder / "none.pdb", next_step="No such file")
        self.says("exact", self.file("a.xtc", "x"), next_step="give the structure file")
        self.says("exact", self.file("a.pdb", "<!doctype html>"), next_step="get the file itself")
        self.says("exact", "-", next_step="needs --format")
        self.says("exact", self.folder, next_step="give the directory to vdwmesh batch")
        self.says("exact", UBIQUITIN, "more.pdb", next_step="; type: vdwmesh batch ")
        self.says("exact", "--sample", "bpti", UBIQUITIN, next_step="give only one of them")
        self.says("batch", self.folder / "none", next_step="name a structure file, a folder, a tar archive or a list")
        (self.folder / "empty").mkdir()
        self.says("batch", self.folder / "empty", next_step="their names end in .pdb")

    def test_outputs(self):
        self.says("mesh", UBIQUITIN, next_step="name the mesh file to write")
        self.says("mesh", UBIQUITIN, "a.stl", next_step="; an output is named by -o FILE")
        self.says("exact", UBIQUITIN, "a.stl", next_step="; vdwmesh exact --help")
        self.says("report", UBIQUITIN, "-o", "a.stl", next_step="; it writes no mesh, vdwmesh mesh does;")
        self.says("mesh", UBIQUITIN, "-o", "a.xyz", next_step=".ply .obj .off .stl .glb .msh .msh4 .vtp .vtu or .3mf")
        self.says("mesh", UBIQUITIN, "-o", self.folder / "no" / "a.ply", next_step="make it first")
        self.says("render", UBIQUITIN, "-o", "a.jpg", next_step="name a .png file")

    def test_values(self):
        self.says("exact", UBIQUITIN, "--probe", "1,4", next_step="for example --probe 1.4")
        self.says("exact", UBIQUITIN, "--prob", "1.4", next_step="did you mean --probe?")
        self.says("exact", UBIQUITIN, "--radii", "none", next_step="bondi, alvarez, protor, naccess, oons")
        self.says("exact", UBIQUITIN, "--select", "chain A resi 1", next_step="chain A and resi 10-40")
        self.says("exact", UBIQUITIN, "--surface", "grid", next_step="choose vdw, sas or ses")
        self.says("mesh", UBIQUITIN, "-o", "a.ply", "--edge-length", "1", "--spacing", "1",
                  next_step="takes --spacing instead")
        self.says("mesh", UBIQUITIN, "-o", "a.ply", "--surface", "excluded", "--spacing", "1",
                  next_step="--surface ses has no grid; --edge-length sets the size")
        self.says("exact", UBIQUITIN, "--surface", "excluded", "--certify", next_step="leave one of them out")
        self.says("mesh", UBIQUITIN, "-o", "a.ply", "--spacing", "1000", next_step="try --spacing")

    def test_help_says_how_to_begin(self):
        shown = run("--help").stdout
        begin = re.search(r"To begin, without a file: vdwmesh (.*)\n", shown)
        self.assertIn("Topology", self.run_ok(*begin[1].split()).stdout)

    def test_the_mesh_comes_first(self):
        mesh = self.file("a.off", "OFF\n0 0 0\n")
        self.says("compare", UBIQUITIN, mesh, next_step="the mesh comes first: vdwmesh compare MESH INPUT")


class DidYouMean(ProgramTest):
    """A slip of the fingers is named; where nothing is close, or two are as close, nothing is guessed."""

    def suggests(self, name, *arguments):
        self.assert_refused(BAD_INPUT, *arguments, says=(f"; did you mean {name}?",))

    def suggests_nothing(self, *arguments):
        result = self.assert_refused(BAD_INPUT, *arguments)
        self.assertNotIn("did you mean", result.stderr)

    def test_options(self):
        for typed, meant in {"--spcing": "--spacing", "--spacing1": "--spacing", "--spaicng": "--spacing",
                             "--colour-map": "--color-map", "--sead": "--seed",
                             "--self-intersection": "--self-intersections",
                             "--spcing=0.5": "--spacing", "--ouput": None, "--frobnicate": None, "--x": None,
                             "--csv": None}.items():  # fmt: skip
            with self.subTest(typed=typed):
                arguments = ("report", UBIQUITIN, typed, "1")
                if meant:
                    self.suggests(meant, *arguments)
                else:
                    self.suggests_nothing(*arguments)
        for typed, meant in (("-spacing", "--spacing 1"), ("--memory_limit", "--memory-limit 1")):  # all but its dashes
            self.assert_refused(BAD_INPUT, "report", UBIQUITIN, typed, "1", says=("; type: vdwmesh report ", f" {meant}"))

    def test_options_of_the_verb_alone(self):
        self.suggests("--field", "mesh", UBIQUITIN, "--feild", "vdw")
        self.suggests_nothing("exact", UBIQUITIN, "--feild", "vdw")
        self.suggests("--output", "mesh", UBIQUITIN, "--ouput", "a.ply")

    def test_verbs(self):
        for typed, meant in (("repport", "report"), ("mehs", "mesh"), ("inof", "info")):
            self.suggests(meant, typed)
        for typed in ("frobnicate", "x", "--frobnicate", ""):
            self.suggests_nothing(typed)

    def test_values(self):
        for option, typed, meant in (("--field", "vwd", "vdw"), ("--field", "inverse-square", "inverse-squared"),
                                     ("--mesher", "exakt", "exact"), ("--distances", "of", None),
                                     ("--field", "nonsense", None), ("--backend", "gpu", "cuda"),
                                     ("--surface", "msms", "ses"), ("--backend", "npu", None),
                                     ("--mesher", "ses", None)):  # fmt: skip
            with self.subTest(option=option, typed=typed):
                arguments = ("report", UBIQUITIN, option, typed)
                if meant:
                    self.suggests(meant, *arguments)
                else:
                    self.suggests_nothing(*arguments)
        self.suggests("blinn", "study", UBIQUITIN, "-o", self.folder / "out", "--field", "vdw,blin")


class Words(ProgramTest):
    """How options and values are told apart, in the program's own words."""

    def test_values(self):
        options = ("exact", UBIQUITIN, "--quiet")
        for arguments in (("--probe", "-0.5"), ("--probe=-0.5",)):
            self.run_ok(*options, *arguments)
        result = self.run_ok("mesh", UBIQUITIN, "--spacing", "2", f"-o{self.folder}/a.ply", "--quiet")
        self.assertEqual((result.stdout, self.files()), ("", ["a.ply"]))
        self.run_ok("exact", "--quiet", "--", UBIQUITIN)

    def test_refusals(self):
        for arguments, says in {
            ("--spacing",): ("--spacing", "value is missing", "--help"),
            ("--spacing", "1", "--spacing", "2"): ("--spacing", "more than once"),
            ("--waters=3",): ("--waters", "takes no value"),
            ("more.pdb",): ("more.pdb", "too many"),
            ("--sample", "bpti"): ("INPUT and --sample", "only one"),
            ("--hetatm", "--no-hetatm"): ("--hetatm", "--no-hetatm", "only one"),
            ("--frobnicate",): ("--frobnicate", "not an option of vdwmesh report", "--help"),
        }.items():
            with self.subTest(arguments=arguments):
                self.assert_refused(BAD_INPUT, "report", UBIQUITIN, *arguments, says=says)

    def test_several_structures(self):
        self.assert_refused(BAD_INPUT, "exact", "--sample", "bpti,ubiquitin", says=("--sample", "one structure"))


class LostBalls(ProgramTest):
    """A ball between the grid's nodes is no part of the mesh; `mesh` and `report` say so."""

    def test_mesh_and_report_warn_alike(self):
        # Nodes at multiples of 1 Å from the lower corner of the box: one of radius 0.2 is between them.
        spheres = self.file("a.xyzr", "0 0 0 2\n5.5 5.5 5.5 0.2\n8 8 8 2\n")
        meshed = self.run_ok("mesh", spheres, "-o", self.folder / "a.ply", "--spacing", "1").stdout
        reported = self.run_ok("report", spheres, "--spacing", "1", "--subdivide", "0").stdout
        arcs = self.run_ok("report", spheres, "--spacing", "1", "--subdivide", "0", "--topology", "off").stdout
        for text in (meshed, reported, arcs):
            self.assertRegex(text, r"WARNING +components: 2 in the mesh, 3 in the union of the spheres")
        field = self.run_ok("report", spheres, "--spacing", "1", "--subdivide", "0", "--field", "blinn").stdout
        self.assertNotIn("components: ", field)  # a smaller spacing would not bring it back
        fine = self.run_ok("mesh", spheres, "-o", self.folder / "a.ply", "--spacing", "0.1").stdout
        self.assertNotIn("WARNING", fine)

    def test_balls_that_overlap_are_one_piece(self):
        """One large ball and a chain that starts on it; a ball inside another; a pair far away."""
        chain = "".join(f"{10 + 1.9 * i} 0 0 1\n" for i in range(1, 8))
        spheres = self.file("a.xyzr", "0 0 0 11\n" + chain + "1 1 1 0.5\n9e5 0 0 3\n9e5 5 0 3\n")
        report = self.report("exact", spheres)
        self.assertEqual(report["exact"]["components"], 2)
        mesh = self.report("mesh", spheres, "-o", self.folder / "a.ply", "--mesher", "exact", "--edge-length", "2")
        self.assertEqual(mesh["mesh"]["components"], 2)
        self.assertEqual(mesh["warnings"], [])


class Messages(ProgramTest):
    def test_stay_one_line_whatever_was_typed(self):
        for arguments in (("no\nverb",), ("mesh", "--no\nsuch\x1b[2J"), ("report", UBIQUITIN, "--mesher", "a\rb"),
                          ("report", UBIQUITIN, "--field", "no\nfield"), ("report", "no\nfile.pdb")):
            with self.subTest(arguments=arguments):
                result = self.assert_refused(BAD_INPUT, *arguments)
                self.assertIn("?", result.stderr)
                self.assertTrue(result.stderr[:-1].isprintable())


    def test_text_shows_no_control_characters_of_files(self):
        """A title of the terminal's window as a file's name, a residue's and an atom's."""
        escape = "\x1b]0;x\x07"
        atom = f"ATOM      1  C  {escape[:4]:4}A   1       0.000   0.000   0.000  1.00  0.00           C  \n"
        path = self.file(f"{escape}a.pdb", atom + "END")
        for arguments in (("exact", path), ("mesh", path, "-o", self.folder / f"{escape}.ply"),
                          ("study", path, "-o", self.folder / "out", "--spacing", "1", "--progress")):  # fmt: skip
            with self.subTest(arguments=arguments):
                result = self.run_ok(*arguments)
                shown = result.stdout + result.stderr.replace("\x1b[K", "")  # the bar's own
                self.assertNotIn("\x1b", shown)
                self.assertNotIn("\x07", shown)


class Warnings(ProgramTest):
    """A file that may have been cut off: every verb that reads it says so."""

    def setUp(self):
        super().setUp()
        self.cut = self.cut_file()
        self.says = "may have been cut off"

    def test_on_standard_error_where_the_text_goes_elsewhere(self):
        out, page = self.folder / "a.ply", self.folder / "out"
        for arguments in (("exact", self.cut, "--json", "-"), ("exact", self.cut, "--quiet"),
                          ("exact", self.cut, "--per-atom", "-"), ("mesh", self.cut, "-o", out, "--quiet"),
                          ("study", self.cut, "-o", page, "--spacing", "1", "--field", "vdw")):  # fmt: skip
            with self.subTest(arguments=arguments):
                result = self.run_ok(*arguments)
                self.assertEqual(result.stderr.count(self.says), 1, result.stderr)
        study = parse_json((page / "study.json").read_text())
        self.assertIn(self.says, study["inputs"][0]["warnings"][0])

    def test_in_the_text(self):
        for arguments in (("exact", self.cut), ("report", self.cut, "--spacing", "1"),
                          ("mesh", self.cut, "-o", self.folder / "a.ply")):  # fmt: skip
            with self.subTest(arguments=arguments):
                result = self.run_ok(*arguments)
                self.assertRegex(result.stdout, f"WARNING .*{self.says}")
                self.assertEqual(result.stderr, "")


class Backends(ProgramTest):
    def test_devices_where_there_is_none(self):
        info = parse_json(self.run_ok("info", "--json", "-").stdout)
        if info["cuda"]["devices"]:
            self.skipTest("this machine has a CUDA device")
        report = self.report("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--devices", "64")
        self.assertEqual(report["backend"]["devices"], 0)
        self.assertTrue(any("--devices 64" in note for note in report["notes"]), report["notes"])
        report = self.report("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--devices", "1")
        self.assertFalse([note for note in report["notes"] if "device" in note], report["notes"])

    def test_who_measures(self):
        """A device, where there is one, gives the measures of the CPU, to rounding."""
        info = parse_json(self.run_ok("info", "--json", "-").stdout)
        options = ("exact", UBIQUITIN, "--probe", "1.4", "--method", "arcs")
        cpu = self.report(*options, "--backend", "cpu")["exact"]
        self.assertEqual(cpu["backend"], "cpu")
        self.assertEqual(self.report(*options)["exact"], cpu)  # too small to be worth a device
        if not info["cuda"]["devices"]:
            return
        cuda = self.report(*options, "--backend", "cuda")["exact"]
        self.assertEqual(cuda["backend"], "cuda")
        self.assert_close(cuda["area"], cpu["area"], 1e-12)
        self.assert_close(cuda["volume"], cpu["volume"], 1e-12)

    def test_which_program_it_is(self):
        """The sources, by git or by their hash, are named alike everywhere."""
        info = parse_json(self.run_ok("info", "--json", "-").stdout)
        self.assertRegex(info["revision"], r"\A[\w.-]+\Z")
        version = self.run_ok("--version").stdout
        self.assertEqual(version, f"vdwmesh {info['version']} ({info['revision']})\nbuild {info['build']}\n")
        report = self.report("exact", "--sample", "bpti")
        self.assertEqual(report["revision"], info["revision"])
    def test_cuda_without_a_device(self):
        info = parse_json(self.run_ok("info", "--json", "-").stdout)
        if info["cuda"]["devices"]:
            self.skipTest("this machine has a CUDA device")
        self.assertTrue(info["cuda"]["reason"])
        self.assert_refused(NO_BACKEND, "report", UBIQUITIN, "--backend", "cuda")
        self.assert_refused(NO_BACKEND, "exact", UBIQUITIN, "--backend", "cuda")
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
        self.assertEqual(run("help", "report").stdout, run("report", "--help").stdout)
        self.assertEqual(run("help").stdout, run("--help").stdout)

    def test_radius_sets_in_letters_of_either_case(self):
        text = run("exact", UBIQUITIN, "--radii", "ProtOr", "--threads", "1").stdout
        self.assertIn("protor, probe", text)
