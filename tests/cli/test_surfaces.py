"""Fields, presets and refinement as the command line sets them."""

import math

from program import BAD_INPUT, SOURCE_DIR, UBIQUITIN, ProgramTest, need_shared

PADDING = {"thesis": 5.0, "thesis-vdw": 1.2}  # Å
# Voxels of Tables 4.1 and 4.4 of the thesis, of 1HH0; the tests of
# extraction and of the thesis's own programs look at every entry.
THESIS_VOXELS = {"thesis": 1_632_000, "thesis-vdw": 914_085}


def atom_columns(path):
    """x, y and z of the ATOM records, as columns."""
    lines = [line for line in path.read_text().splitlines() if line.startswith("ATOM")]
    return [[float(line[a : a + 8]) for line in lines] for a in (30, 38, 46)]


class Presets(ProgramTest):
    def thesis_report(self, preset, *arguments):
        options = ("--preset", preset, "--field", "inverse-squared", "--subdivide", "0",
                   "--distances", "off", "--topology", "off")  # fmt: skip
        return self.report("report", *arguments, *options)

    def test_thesis_grids_are_as_the_tables_imply(self):
        columns = atom_columns(SOURCE_DIR / "data" / "bpti.pdb")
        for preset, padding in PADDING.items():
            report = self.thesis_report(preset, "--sample", "bpti")
            parameters = report["parameters"]
            self.assertEqual((parameters["spacing"], parameters["padding"]), (0.4, padding))
            cells = [math.floor((max(c) - min(c) + 2 * padding) / 0.4) for c in columns]
            self.assertEqual(parameters["grid"]["cells"], cells)
            self.assertEqual(report["input"]["atoms_used"], len(columns[0]))

    def test_voxel_counts_of_the_thesis(self):
        path = need_shared("molecules/thesis/1HH0.cif")
        for preset, count in THESIS_VOXELS.items():
            with self.subTest(preset=preset):
                report = self.thesis_report(preset, path)
                self.assertEqual(report["parameters"]["grid"]["cell_count"], count)

    def test_presets_yield_to_options(self):
        options = ("--preset", "thesis", "--field", "soft", "--spacing", "0.8", "--padding", "4")
        report = self.report("report", "--sample", "bpti", *options, "--subdivide", "0")
        self.assertEqual(report["parameters"]["spacing"], 0.8)
        self.assertEqual(report["parameters"]["padding"], 4)

    def test_defaults(self):
        parameters = self.report("report", UBIQUITIN)["parameters"]
        self.assertEqual(parameters["mesher"], "exact")
        self.assertEqual(parameters["edge_length"], 0.35)
        self.assertEqual(parameters["field"], "vdw")
        self.assertEqual(parameters["subdivide"], 0)
        for absent in ("spacing", "padding", "isovalue", "grid", "crossings"):
            self.assertIsNone(parameters[absent], absent)

    def test_defaults_of_marching_cubes(self):
        parameters = self.report("report", UBIQUITIN, "--mesher", "marching-cubes")["parameters"]
        self.assertEqual(parameters["field"], "vdw")
        self.assertEqual(parameters["spacing"], 0.5)
        self.assertEqual(parameters["padding"], 1.5)
        self.assertEqual(parameters["subdivide"], 1)
        self.assertEqual(parameters["project"], "vdw")
        self.assertIsNone(parameters["isovalue"])

    def test_what_decides_the_mesher(self):
        quick = ("--distances", "off", "--topology", "off", "--self-intersections", "off", "--cgal-check", "off")
        for options, mesher, reason in (
            ((), "exact", "default"),
            (("--field", "vdw", "--edge-length", "0.6"), "exact", "default"),
            (("--mesher", "exact"), "exact", "--mesher"),
            (("--mesher", "marching-cubes"), "marching-cubes", "--mesher"),
            (("--mesher", "marching-cubes", "--spacing", "0.6"), "marching-cubes", "--mesher"),
            (("--spacing", "0.6"), "marching-cubes", "--spacing"),
            (("--padding", "2"), "marching-cubes", "--padding"),
            (("--field", "soft"), "marching-cubes", "--field"),
            (("--preset", "thesis", "--field", "blinn"), "marching-cubes", "--field"),
            (("--preset", "radius-aware"), "marching-cubes", "--preset"),
        ):  # fmt: skip
            with self.subTest(options=options):
                parameters = self.report("report", "--sample", "bpti", *quick, *options)["parameters"]
                self.assertEqual((parameters["mesher"], parameters["mesher_reason"]), (mesher, reason))
        excluded = self.report("report", "--sample", "bpti", *quick[:2], "--surface", "excluded")["parameters"]
        self.assertEqual((excluded["mesher"], excluded["mesher_reason"]), ("exact", "--surface"))
        text = self.run_ok("report", "--sample", "bpti", *quick, "--spacing", "0.6", "--verbose").stdout
        self.assertIn("marching cubes (of --spacing)", text)

    def test_every_field_closes(self):
        for field in ("blinn", "soft", "inverse-squared"):
            report = self.report("report", UBIQUITIN, "--field", field, "--subdivide", "0")
            self.assertEqual(report["parameters"]["isovalue"], 1)
            mesh = report["mesh"]
            self.assertTrue(mesh["closed"] and mesh["manifold"] and mesh["oriented"], field)
            self.assertGreater(mesh["volume"], 0)


class Refinement(ProgramTest):
    def test_each_subdivision_makes_four_triangles_of_one(self):
        coarse, fine = (self.report("report", UBIQUITIN, "--spacing", "0.5", "--subdivide", level)["mesh"]
                        for level in ("0", "1"))  # fmt: skip
        self.assertEqual(fine["triangles"], 4 * coarse["triangles"])
        self.assertEqual(fine["vertices"], coarse["vertices"] + coarse["edges"])
        self.assertEqual(fine["genus"], coarse["genus"])
        self.assertIsNone(coarse["newton"])
        self.assertLessEqual(fine["newton"]["residual_max"], 1e-9)  # Å, the tolerance promised
        self.assertEqual(len(fine["newton"]["levels"]), 2)

    def test_projection_of_a_blended_field(self):
        report = self.report("report", UBIQUITIN, "--field", "blinn", "--subdivide", "1")
        self.assertEqual(report["parameters"]["project"], "field")
        self.assertLessEqual(report["mesh"]["newton"]["residual_max"], 1e-9)


    def test_projection_without_subdivision_is_said_to_have_no_effect(self):
        report = self.report("report", UBIQUITIN, "--spacing", "0.5", "--subdivide", "0", "--project", "vdw")
        self.assertEqual(report["parameters"]["project"], "none")
        self.assertTrue(any("--project vdw" in note for note in report["notes"]))


    def test_crossings_are_taken_back_or_stay(self):
        # bpti has some before anything is taken back, as the exact predicates count.
        found = {}
        for crossings in ("undo", "allow"):
            report = self.report("report", "--sample", "bpti", "--spacing", "0.5", "--crossings", crossings,
                                 "--self-intersections", "on", "--distances", "off")  # fmt: skip
            self.assertEqual(report["parameters"]["crossings"], crossings)
            found[crossings] = report["mesh"]["self_intersections"]
        self.assertEqual(found["undo"], 0)
        self.assertGreater(found["allow"], 0)

    def test_crossings_that_nobody_looks_for(self):
        cubes = ("--spacing", "0.6")
        for options in (("--subdivide", "0", *cubes), ("--project", "none", *cubes), ("--mesher", "exact")):
            with self.subTest(options=options):
                report = self.report("report", "--sample", "bpti", "--crossings", "allow", "--distances", "off",
                                     "--cgal-check", "off", "--self-intersections", "off", *options)  # fmt: skip
                self.assertIsNone(report["parameters"]["crossings"])
                self.assertTrue(any("--crossings allow" in note and options[0] in note for note in report["notes"]))


class OddInput(ProgramTest):
    def test_no_atoms_is_an_error(self):
        empty = self.file("empty.pdb", "END\n")
        self.assert_refused(BAD_INPUT, "report", empty, says=("empty.pdb",))
        self.assert_refused(BAD_INPUT, "report", UBIQUITIN, "--select", "/9")

    def test_a_file_that_is_no_structure(self):
        self.assert_refused(BAD_INPUT, "report", self.file("a.xtc", "x"), says=("a.xtc",))
