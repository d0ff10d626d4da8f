"""The report: its JSON contract, its text and its figures."""

import json
import math
import re

import text_report
from program import UBIQUITIN, ProgramTest, parse_json, run, schema_validator

# Ubiquitin (1UBQ, 602 atoms without waters), Bondi radii: the union of its spheres, by a regular
# triangulation with two formula sets and by exposed arcs, made outside this project.
EXACT = {"area": 7915.58241751, "volume": 6558.60702915}  # Å², Å³
EXACT_TOPOLOGY = {
    "components": 1,
    "tunnels": 54,
    "voids": 0,
    "shells": 1,
    "euler_characteristic": -106,
}
PROBED = {"area": 4871.17476728, "volume": 15413.5346061, "outer_area": 4869.80375467}
PROBED_TOPOLOGY = {
    "components": 1,
    "tunnels": 1,
    "voids": 2,
    "shells": 3,
    "euler_characteristic": 4,
}
TWELVE_DIGITS = 1e-11  # relative: the reference is given to twelve digits
BLOCKS = ("input", "parameters", "backend", "mesh", "exact", "comparison", "timing")


def significant_digits(token):
    mantissa = re.split("[eE]", token)[0].lstrip("-").replace(".", "")
    return len(mantissa.strip("0"))


class JsonReport(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.text = run("report", "--sample", "ubiquitin", "--spacing", "0.5", "--json", "-").stdout
        cls.json = parse_json(cls.text)

    def test_schema(self):
        schema_validator().validate(self.json)
        self.assertEqual(self.json["schema"], "vdwmesh-report/1")
        # The validator itself must refuse what the contract refuses.
        broken = self.json | {"mesh": self.json["mesh"] | {"closed": None}}
        self.assertFalse(schema_validator().is_valid(broken))
        del broken["mesh"]["genus"]
        self.assertFalse(schema_validator().is_valid(broken))

    def test_every_block_is_there(self):
        for block in BLOCKS:
            self.assertIsInstance(self.json[block], dict, block)

    def test_numbers_have_the_fewest_digits_that_read_back_the_same(self):
        tokens = []
        json.loads(self.text, parse_float=tokens.append)
        self.assertGreater(len(tokens), 20)
        for token in tokens:
            self.assertLessEqual(
                significant_digits(token), significant_digits(repr(float(token))), token
            )

    def test_every_atom_is_accounted_for(self):
        atoms = self.json["input"]
        self.assertEqual(atoms["atoms_read"], 660)
        self.assertEqual(atoms["atoms_used"], 602)
        self.assertEqual(atoms["skipped"]["waters"], 58)
        self.assertEqual(atoms["atoms_used"] + sum(atoms["skipped"].values()), 660)

    def assert_exact(self, exact, figures, topology):
        for key, value in figures.items():
            self.assert_close(exact[key], value, TWELVE_DIGITS)
        self.assertEqual({key: exact[key] for key in topology}, topology)

    def test_exact_values(self):
        self.assert_exact(self.json["exact"], EXACT, EXACT_TOPOLOGY)

    def test_exact_values_with_a_probe(self):
        exact = self.report("exact", UBIQUITIN, "--probe", "1.4")["exact"]
        self.assert_exact(exact, PROBED, PROBED_TOPOLOGY)

    def test_mesh_is_a_closed_oriented_manifold(self):
        mesh = self.json["mesh"]
        self.assertTrue(mesh["closed"] and mesh["manifold"] and mesh["oriented"])
        self.assertEqual(mesh["degenerate_triangles"], 0)
        self.assertEqual(mesh["grid_clipped"], 0)
        chi = mesh["vertices"] - mesh["edges"] + mesh["triangles"]
        self.assertEqual(mesh["euler_characteristic"], chi)
        self.assertEqual(mesh["genus"], mesh["shells"] - chi // 2)

    def test_levels_and_cgal_stand_beside_the_mesh(self):
        mesh = self.json["mesh"]
        self.assertEqual([level["level"] for level in mesh["levels"]], [0, 1])
        self.assertEqual(mesh["levels"][1]["triangles"], 4 * mesh["levels"][0]["triangles"])
        for figure in ("triangles", "area", "volume"):
            self.assertEqual(mesh["levels"][1][figure], mesh[figure])
        # Projection blows the inscribed mesh up.
        self.assertLess(mesh["levels"][0]["volume"], mesh["volume"])
        # Marching cubes cuts the creases: no order to extrapolate with.
        self.assertIsNone(mesh["extrapolated_area"])
        self.assertIsNone(mesh["extrapolated_volume"])
        # 10^5 terms summed in plain doubles by CGAL: at most 1e-16 each, and as many again.
        self.assertLess(abs(mesh["cgal"]["area"] / mesh["area"] - 1), 1e-10)
        self.assertLess(abs(mesh["cgal"]["volume"] / mesh["volume"] - 1), 1e-10)
        off = parse_json(
            run("report", "--sample", "bpti", "--cgal-check", "off", "--json", "-").stdout
        )
        self.assertIsNone(off["mesh"]["cgal"])

    def test_comparison_follows_from_mesh_and_exact(self):
        mesh, exact, comparison = (self.json[b] for b in ("mesh", "exact", "comparison"))
        for figure in ("area", "volume"):
            expected = (mesh[figure] - exact[figure]) / exact[figure]
            self.assert_close(comparison[f"{figure}_relative_error"], expected, 1e-9)

    def test_unknown_numbers_are_null(self):
        exact = self.report("exact", UBIQUITIN, "--topology", "off")
        for block in ("parameters", "backend", "mesh", "comparison"):
            self.assertIsNone(exact[block], block)
        self.assertEqual(exact["exact"]["method"], "arcs")
        for key in ("components", "tunnels", "voids", "euler_characteristic", "hidden_atoms"):
            self.assertIsNone(exact["exact"][key], key)
        self.assertIsNone(exact["timing"]["extract"])
        self.assert_exact(exact["exact"], EXACT, {})

    def test_topology_counts(self):
        whole = self.report("exact", UBIQUITIN, "--probe", "1.4")["exact"]
        quick = self.report("exact", UBIQUITIN, "--probe", "1.4", "--topology", "counts")["exact"]
        self.assertEqual(quick["method"], "arcs")
        for key in ("components", "euler_characteristic", "hidden_atoms"):
            self.assertEqual(quick[key], whole[key], key)
        for key in ("tunnels", "voids", "point_contacts", "shells"):
            self.assertIsNone(quick[key], key)
        self.assertEqual(quick["doubtful_spheres"], 0)

    def test_topology_counts_are_not_guessed(self):
        touching = self.folder / "touching.xyzr"
        touching.write_text("0 0 0 1\n2 0 0 1\n")
        text = self.run_ok("exact", touching, "--topology", "counts").stdout
        self.assertIn("not counted, because rounding might decide about 2 atoms", text)
        exact = self.report("exact", touching, "--topology", "counts")["exact"]
        self.assertIsNone(exact["components"])
        self.assertEqual(exact["doubtful_spheres"], 2)

    def test_topology_off(self):
        exact = self.report("report", UBIQUITIN, "--topology", "off")
        self.assertIsNone(exact["comparison"]["euler_characteristic_difference"])
        both = self.report("exact", UBIQUITIN, "--method", "both")["exact"]
        self.assert_close(both["check_area"], both["area"], TWELVE_DIGITS)

    def test_same_result_for_any_number_of_threads(self):
        for mesher in ("exact", "marching-cubes"):
            with self.subTest(mesher=mesher):
                one = self.report("report", UBIQUITIN, "--mesher", mesher, "--threads", "1")
                three = self.report("report", UBIQUITIN, "--mesher", mesher, "--threads", "3")
                self.assertEqual(one["backend"]["threads"], 1)
                for made in (one, three):
                    if mesher == "exact":
                        made["mesh"]["arrangement"].pop("seconds")
                self.assertEqual(one["mesh"], three["mesh"])
                self.assertEqual(one["exact"], three["exact"])


class OneSphere(ProgramTest):
    def test_closed_form(self):
        radius = 2.0
        ball = self.file("ball.xyzr", f"0.1 0.2 0.3 {radius}\n")
        report = self.report("report", ball, "--spacing", "0.25", "--subdivide", "0")
        area, volume = 4 * math.pi * radius**2, 4 / 3 * math.pi * radius**3
        self.assert_close(report["exact"]["area"], area, 1e-12)
        self.assert_close(report["exact"]["volume"], volume, 1e-12)
        # A mesh inscribed in the sphere falls short by O(h²/R²) = 1.6 %.
        for figure in ("area", "volume"):
            error = report["comparison"][f"{figure}_relative_error"]
            self.assertTrue(-0.016 < error < 0, error)
        self.assertEqual(report["mesh"]["euler_characteristic"], 2)
        self.assertEqual(report["comparison"]["euler_characteristic_difference"], 0)

    def test_probe_grows_the_sphere(self):
        ball = self.file("ball.xyzr", "0 0 0 1\n")
        report = self.report("exact", ball, "--probe", "1.4")
        self.assert_close(report["exact"]["area"], 4 * math.pi * 2.4**2, 1e-12)
        self.assertEqual(report["input"]["probe"], 1.4)


class TextReport(ProgramTest):
    def test_figures_stand_side_by_side(self):
        text = self.run_ok("report", "--sample", "ubiquitin", "--verbose").stdout
        self.assertRegex(text, r"Area +\d+\.\d+ +7915\.582 +[-+]\d+\.\d+ % +Å²")
        self.assertRegex(text, r"Volume +\d+\.\d+ +6558\.607 +[-+]\d+\.\d+ % +Å³")
        self.assertIn("602 protein; left out: 58 waters", text)
        self.assertIn("asymmetric unit", text)
        self.assertIn("closed, 2-manifold, oriented", text)
        self.assertNotIn("NOT", text)
        for line in text.splitlines():
            self.assertEqual(line, line.rstrip())

    def test_the_answer_stands_first_and_is_short(self):
        for arguments in (("exact", UBIQUITIN), ("report", UBIQUITIN, "--radii", "protor", "--probe", "1.4"),
                          ("exact", UBIQUITIN, "--surface", "ses")):  # fmt: skip
            with self.subTest(arguments=arguments):
                lines = self.run_ok(*arguments).stdout.splitlines()
                labels = [line[:12].strip() for line in lines]
                self.assertLessEqual(len(lines), 11)
                self.assertEqual(labels[:6], ["Structure", "Atoms", "Radii", "Area", "Volume", "Topology"])
                for line in lines:
                    self.assertNotRegex(line, " –|- -|  -")

    def assert_text_is_json(self, arguments, kinds):
        report = text_report.TextReport(*self.text_and_document(*arguments, "--verbose"))
        self.assertEqual(report.problems, [])
        self.assertLessEqual(set(kinds), report.seen)
        brief = text_report.TextReport(*self.text_and_document(*arguments))
        self.assertEqual(brief.problems, [])
        self.assertLess(len(brief.seen), len(report.seen))

    def test_every_number_is_the_documents(self):
        always = {"Structure", "Atoms", "Radii", "Area", "Volume", "Voids", "Time (s)", "CPU (s)"}
        mesh = always | {"Mesh", "Smallest angle", "Aspect ratio", "Edge length"}
        whole = mesh | {"Exact union", "Euler characteristic", "mesh to surface", "surface to mesh", "Hausdorff"}
        out = self.folder / "a.ply"
        # Two pieces, one hollow (12 balls on a sphere), and a pair that touches.
        hollow = [(0, s * 2, t * 3.3) for s in (1, -1) for t in (1, -1)]
        hollow = [(*p[k:], *p[:k]) for p in hollow for k in range(3)]
        spheres = self.file("a.xyzr", "".join(f"{x} {y} {z} 2.3\n" for x, y, z in (*hollow,))
                            + "20 0 0 1\n22 0 0 1\n")  # fmt: skip
        cut = self.cut_file()
        open_mesh = self.file("open.off", "OFF\n4 3 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n3 0 2 1\n3 0 1 3\n3 0 3 2\n")
        ball = self.file("ball.xyzr", "0.3 0.3 0.3 1\n")
        ligands = self.file("ligands.pdb", "".join(
            f"HETATM{i:5}  {atom:<3} {residue} A{i:4}    {5.0 * i:8.3f}   0.000   0.000  1.00  0.00           C\n"
            for i, (residue, atom) in enumerate((("HEM", "CHA"), ("HEM", "CHB"), ("017", "C1")), 1)))
        for arguments, kinds in (
            (("report", "--sample", "ubiquitin"), whole | {"Backend", "Proof"}),
            (("report", "--sample", "ubiquitin", "--spacing", "0.5"),
             whole | {"Grid", "Backend", "Projection", "Level"}),
            (("report", spheres, "--spacing", "0.4", "--subdivide", "2"), whole | {"Level"}),
            (("report", "--sample", "bpti", "--mesher", "exact", "--subdivide", "1", "--edge-length", "0.7"),
             whole | {"Proof"}),
            (("report", "--sample", "bpti", "--field", "blinn", "--isovalue", "1.25", "--blobbiness", "3",
              "--subdivide", "0", "--topology", "off", "--no-hydrogens", "--probe", "0.125"), whole),
            (("report", cut, "--distances", "off", "--self-intersections", "off", "--cgal-check", "off",
              "--project", "none"), mesh | {"WARNING"}),
            (("exact", spheres, "--method", "both"), always | {"Exact union"}),
            (("report", UBIQUITIN, "--measure", "A/10-12", "--radii", "protor", "--distances", "off"),
             mesh | {"Measured", "polar area", "apolar area", "unclassified area"}),
            (("exact", ligands, "--radii", "naccess"), always | {"unclassified area"}),
            (("exact", spheres, "--certify"), always | {"Exact union", "Certified"}),
            (("mesh", cut, "-o", out, "--devices", "2"), mesh),
            (("compare", open_mesh, ball), whole | {"WARNING"}),
        ):  # fmt: skip
            with self.subTest(arguments=arguments):
                self.assert_text_is_json(arguments, kinds)

    def test_stages_add_up_to_the_total(self):
        """By the clock and in processor time, whichever stages run."""
        mesh, out = self.folder / "add_up.obj", self.folder / "add_up.csv"
        for arguments, stages in (
            (("report", UBIQUITIN, "--spacing", "0.5", "--per-atom", out),
             {"refine", "levels", "cgal_check", "compare", "write"}),
            (("report", UBIQUITIN, "--mesher", "exact", "--edge-length", "0.5"), {"extract", "measure", "compare"}),
            (("mesh", UBIQUITIN, "-o", mesh, "--spacing", "0.3"), {"plan", "setup", "write"}),
            (("compare", mesh, UBIQUITIN), {"read", "self_intersections", "compare"}),
            (("exact", UBIQUITIN), {"read", "plan", "exact"}),
        ):  # fmt: skip
            with self.subTest(arguments=arguments):
                wall = self.report(*arguments)["timing"]
                self.assertLessEqual(stages, {key for key, seconds in wall.items() if seconds is not None})
                for times in (wall.pop("cpu"), wall):
                    total = times.pop("total")
                    named = sum(seconds for seconds in times.values() if seconds is not None)
                    self.assertAlmostEqual(named, total, delta=0.03 * total)

    def test_quiet_prints_nothing(self):
        output = self.folder / "a.json"
        result = self.run_ok("exact", UBIQUITIN, "--quiet", "--json", output)
        self.assertEqual(result.stdout + result.stderr, "")
        self.assertEqual(parse_json(output.read_text())["schema"], "vdwmesh-report/1")

    def test_no_progress_where_standard_error_is_no_terminal(self):
        self.assertEqual(self.run_ok("report", UBIQUITIN).stderr, "")
        self.assertIn("sample arcs", self.run_ok("report", UBIQUITIN, "--progress").stderr)
