"""--mesher exact: the crease-exact mesh on the command line."""

import csv
import math

import text_report
from program import ProgramTest


def angles_of(path):
    """All angles of the triangles of an OFF file, in degrees."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    vertices, triangles = map(int, lines[1].split()[:2])
    at = [tuple(map(float, line.split()[:3])) for line in lines[2:2 + vertices]]
    angles = []
    for line in lines[2 + vertices:2 + vertices + triangles]:
        _, *corners = map(int, line.split()[:4])
        for k in range(3):
            p, q, r = (at[corners[(k + i) % 3]] for i in range(3))
            a, b = ([x - y for x, y in zip(end, p)] for end in (q, r))
            dot = sum(x * y for x, y in zip(a, b))
            cross = math.hypot(*(a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)))
            angles.append(math.degrees(math.atan2(cross, dot)))
    return angles


class ExactMesher(ProgramTest):
    def exact_report(self, *options):
        return self.report("report", "--sample", "ubiquitin", "--mesher", "exact", *options)

    def test_has_the_topology_of_the_union(self):
        document = self.exact_report("--edge-length", "0.5", "--distances", "off")
        mesh, exact = document["mesh"], document["exact"]
        self.assertTrue(mesh["closed"] and mesh["manifold"] and mesh["oriented"])
        self.assertEqual(mesh["euler_characteristic"], exact["euler_characteristic"])
        self.assertEqual(mesh["components"], exact["components"])
        self.assertEqual(mesh["voids"], exact["voids"])
        self.assertEqual(mesh["self_intersections"], 0)
        self.assertEqual(mesh["degenerate_triangles"], 0)
        self.assertEqual(document["comparison"]["euler_characteristic_difference"], 0)
        self.assertEqual(document["parameters"]["mesher"], "exact")
        self.assertIsNone(document["parameters"]["grid"])
        self.assertGreater(mesh["arrangement"]["corners"], 0)

    def xyzr(self, name, rows):
        path = self.folder / name
        path.write_text("".join("%.17g %.17g %.17g %.17g\n" % row for row in rows))
        return path

    def test_large_balls_do_not_count_as_many_atoms(self):
        # A chain of 24 balls of 1,700 Å: some thousand triangles, a few megabytes.
        path = self.xyzr("beads.xyzr", [(1500.0 * i, 0, 0, 1700.0) for i in range(24)])
        document = self.report("mesh", path, "-o", self.folder / "beads.ply", "--mesher", "exact",
                               "--edge-length", "350", "--memory-limit", "200M")
        self.assertEqual(document["parameters"]["mesher"], "exact")

    def test_an_overlap_of_next_to_nothing_is_one_component(self):
        path = self.xyzr("touch.xyzr", [(0, 0, 0, 1), (1.9999999999999001, 0, 0, 1)])
        document = self.report("report", path, "--mesher", "exact")
        self.assertEqual(document["mesh"]["components"], document["exact"]["components"])
        self.assertEqual(document["mesh"]["arrangement"]["euler_difference"], 0)

    def test_says_where_the_topology_is_another(self):
        # Six balls that pass through one point, to 2e-16.
        rows = [(0.99999999999999922, 6.9486747387446544e-16, 5.275492379532281e-16, 1),
                (0.49999999999999961, 0.8660254037844386, -1.0101787042252375e-16, 1),
                (-0.4999999999999995, 0.86602540378443926, -8.122808264515303e-16, 1),
                (-1.0000000000000009, 7.9399488775447481e-16, -1.3446586418989327e-16, 1),
                (-0.49999999999999994, -0.86602540378443937, -1.0922561189039715e-16, 1),
                (0.50000000000000056, -0.86602540378443915, 8.9054139110784472e-16, 1)]
        document = self.report("report", self.xyzr("ring.xyzr", rows), "--mesher", "exact",
                               "--distances", "off")
        announced = document["mesh"]["arrangement"]["euler_difference"]
        found = document["mesh"]["euler_characteristic"] - document["exact"]["euler_characteristic"]
        self.assertEqual(announced, found)
        told = [n for n in document["notes"] if "not the topology of the union" in n]
        self.assertEqual(len(told), 1 if announced else 0)
        self.assertIs(document["comparison"]["proof"]["topology_is_exact"], not announced)

    def test_says_that_surfaces_touch_in_points(self):
        """Two balls with one common point."""
        path = self.file("touching.xyzr", "0 0 0 1\n2 0 0 1\n")
        notes = self.report("report", path)["notes"]
        self.assertTrue(any("touch" in note and "self-intersections" in note for note in notes), notes)
        apart = self.file("apart.xyzr", "0 0 0 1\n3 0 0 1\n")
        self.assertEqual(self.report("report", apart)["notes"], [])

    def test_says_which_files_lose_the_spheres_of_triangles(self):
        for name in ("a.ply", "a.obj", "a.off", "a.stl", "a.glb"):
            for mesher in ("exact", "marching-cubes"):
                with self.subTest(name=name, mesher=mesher):
                    document = self.report("mesh", "--sample", "bpti", "-o", self.folder / name,
                                           "--mesher", mesher)
                    told = [note for note in document["notes"] if "which sphere" in note]
                    lost = mesher == "exact" and name != "a.ply"
                    self.assertEqual(len(told), 1 if lost else 0)

    def test_extrapolates_to_the_exact_area_and_volume(self):
        document = self.exact_report("--edge-length", "0.5", "--subdivide", "2", "--distances", "off")
        mesh, exact = document["mesh"], document["exact"]
        # Second order leaves h⁴ terms: at 0.125 Å on radii of 1.5 Å below 1e-4 of the whole.
        for name in ("area", "volume"):
            extrapolated = mesh["extrapolated_" + name]
            self.assertLess(abs(extrapolated - exact[name]) / exact[name], 1e-4)
            found = document["comparison"]["proof"][f"extrapolated_{name}_error"]
            self.assert_close(1 + found, extrapolated / exact[name], 1e-15)
        errors = [1 - level["area"] / exact["area"] for level in mesh["levels"]]
        self.assertGreater(errors[1] / errors[2], 3.8)
        self.assertLess(errors[1] / errors[2], 4.2)

    def test_area_of_every_atom_is_near_the_exact_one(self):
        path = self.folder / "atoms.csv"
        document = self.exact_report("--edge-length", "0.2", "--subdivide", "0", "--distances", "off",
                                     "--per-atom", str(path))
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 602)  # the atoms of ubiquitin
        areas = [(float(row["exact_area"]), float(row["mesh_area"])) for row in rows]
        exposed = [(exact, mesh) for exact, mesh in areas if exact > 1]
        self.assertGreater(len(exposed), 400)
        errors = [abs(mesh - exact) / exact for exact, mesh in exposed]
        self.assertLess(max(errors), 0.01)
        # The block of the report says the same as the table.
        proof = document["comparison"]["proof"]
        found = proof["atom_area_error"]
        self.assertEqual(found["atoms"], len(exposed))
        self.assert_close(found["max"], max(errors), 1e-9)
        self.assert_close(found["rms"], math.sqrt(sum(e * e for e in errors) / len(errors)), 1e-9)
        row = next(r for r, (exact, mesh) in zip(rows, areas)
                   if exact > 1 and abs(mesh - exact) / exact == max(errors))
        self.assertEqual(found["worst"], "{chain}/{residue_number} {residue_name} {atom_name}".format(**row))
        self.assertIs(proof["topology_is_exact"], True)
        self.assertIsNone(proof["extrapolated_area_error"])

    def test_an_atom_without_a_name_is_called_by_its_number(self):
        path = self.xyzr("small.xyzr", ((0, 0, 0, 2), (2.2, 0, 0, 0.7)))
        proof = self.report("report", path, "--distances", "off")["comparison"]["proof"]
        self.assertEqual(proof["atom_area_error"]["worst"], "atom 2")  # the smaller one, with longer edges for its size

    def test_proof_is_of_crease_exact_meshes(self):
        document = self.report("report", "--sample", "bpti", "--spacing", "0.5", "--distances", "off")
        self.assertIsNone(document["comparison"]["proof"])
        some = self.exact_report("--measure", "A/10-20", "--distances", "off", "--topology", "off")
        proof = some["comparison"]["proof"]
        self.assertIsNone(proof["topology_is_exact"])
        self.assertIsNone(proof["extrapolated_area_error"])  # of all atoms, beside the area of some
        self.assertLess(proof["atom_area_error"]["atoms"], 120)

    def triangles_of(self, *options):
        """Triangles of the mesh, and whether it has the topology of the union."""
        document = self.exact_report("--subdivide", "0", "--distances", "off", *options)
        mesh, exact = document["mesh"], document["exact"]
        for name in ("euler_characteristic", "components", "voids"):
            self.assertEqual(mesh[name], exact[name])
        self.assertEqual(mesh["self_intersections"], 0)
        return mesh["triangles"], document["parameters"]

    def test_edge_lengths_that_differ_from_atom_to_atom(self):
        coarse, _ = self.triangles_of()
        fine, _ = self.triangles_of("--edge-length", "0.2")
        some, parameters = self.triangles_of("--edge-length-of", "A/1-20=0.2")
        self.assertLess(coarse, some)
        self.assertLess(some, fine)
        self.assertEqual(parameters["edge_length_of"], ["A/1-20=0.2"])
        # Every atom named: the same as one length for all. The last selection holds.
        self.assertEqual(self.triangles_of("--edge-length-of", "A=0.2")[0], fine)
        self.assertEqual(
            self.triangles_of("--edge-length-of", "A/1-20=0.1", "--edge-length-of", "A=0.2")[0], fine)

    def test_a_bound_on_the_angles(self):
        plain = self.exact_report("--subdivide", "0", "--distances", "off")
        self.assertIsNone(plain["parameters"]["min_angle"])
        self.assertEqual(plain["mesh"]["arrangement"]["below_min_angle_at_corners"], 0)
        self.assertEqual(plain["mesh"]["arrangement"]["below_floor"], 0)
        self.assertEqual(plain["comparison"]["proof"]["below_floor"], 0)
        bounded, parameters = self.triangles_of("--min-angle", "20")
        self.assertEqual(parameters["min_angle"], 20)
        self.assertLess(plain["mesh"]["triangles"], bounded)
        self.assertLess(bounded, 1.4 * plain["mesh"]["triangles"])
        document = self.exact_report("--distances", "off", "--min-angle", "20")
        self.assertEqual(document["mesh"]["arrangement"]["below_min_angle"], 0)
        self.assertIsNone(document["mesh"]["arrangement"]["below_floor"])
        self.assertIsNone(document["comparison"]["proof"]["below_floor"])
        self.assertFalse([note for note in document["notes"] if "--min-angle" in note])
        ubiquitin = ("report", "--sample", "ubiquitin")
        self.assert_refused(1, *ubiquitin, "--min-angle", "26", says=("--min-angle 26", "at most 25"))
        self.assert_refused(1, *ubiquitin, "--min-angle", "0", says=("--min-angle",))
        self.assert_refused(1, *ubiquitin, "--min-angle", "20", "--spacing", "1", says=("--mesher exact", "--spacing"))
        self.assert_refused(1, *ubiquitin, "--min-angle", "20", "--surface", "excluded", says=("--surface ses",))

    def test_says_how_many_angles_stay_below_their_floors(self):
        # Balls whose spheres all but share a circle, and one that cuts them there: near_pencil() of
        # tests/support/floor_sets.hpp.
        rows = [(1.712963801033452, -0.0001075490012266559, 3.9792331649028919e-05, 1.2332815593305173 + 1.4),
                (1.4586702314585918, -0.00013637510369390242, 2.0929798046333744e-05, 1.0754531742001814 + 1.4),
                (-1.5064185260992617, 1.8210918241811882e-05, -0.00020408943538244287, 1.1038249653889807 + 1.4),
                (0.64532273866465806, -8.291980603418556e-05, -5.6685318412767985e-05, 0.70154866015749695 + 1.4),
                (-0.094010268838367939, 2.3694579400701921, 0.3, 0.6 + 1.4)]
        path, mesh = self.xyzr("pencil.xyzr", rows), self.folder / "pencil.off"
        document = self.report("mesh", path, "-o", mesh, "--mesher", "exact", "--edge-length", "0.5")
        below = document["mesh"]["arrangement"]["below_floor"]
        self.assertGreater(below, 1)
        self.assertLessEqual(below, sum(angle < 5 for angle in angles_of(mesh)))
        told = [note for note in document["notes"] if "below 5°" in note]
        self.assertEqual(len(told), 1)
        self.assertIn(f" {below} angles are below 5°, ", told[0])
        # The report has the same in the text and in the proof.
        text, document = self.text_and_document("report", path, "--mesher", "exact", "--edge-length", "0.5", "--verbose")
        self.assertEqual(document["mesh"]["arrangement"]["below_floor"], below)
        self.assertEqual(document["comparison"]["proof"]["below_floor"], below)
        self.assertEqual([note for note in document["notes"] if "below 5°" in note], told)
        self.assertIn(f" {below} angles below their floors, before subdivision", text)
        self.assertEqual(text_report.TextReport(text, document).problems, [])

    def test_edge_lengths_as_shares_of_the_radius(self):
        alone, parameters = self.triangles_of("--relative-edge", "0.25")
        self.assertIsNone(parameters["edge_length"])
        self.assertEqual(parameters["relative_edge"], 0.25)
        # Bondi's radii are above 1.4 Å here, so 0.25 of them is above 0.35 Å.
        both, parameters = self.triangles_of("--relative-edge", "0.25", "--edge-length", "0.35")
        self.assertEqual(both, self.triangles_of()[0])
        self.assertLess(alone, both)

    def test_edge_lengths_in_a_table_of_atoms(self):
        table = self.folder / "atoms.csv"
        self.exact_report("--subdivide", "0", "--distances", "off", "--per-atom", str(table))
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))

        def written(rows, of_row):
            with open(table, "w", newline="") as file:
                writer = csv.DictWriter(file, [*rows[0], "edge_length"])
                writer.writeheader()
                writer.writerows({**row, "edge_length": of_row(row)} for row in rows)
            return str(table)

        by_selection, _ = self.triangles_of("--edge-length-of", "A/40=0.1")
        of_residue = lambda row: "0.1" if row["residue_number"] == "40" else ""
        by_table, parameters = self.triangles_of("--edge-lengths", written(rows, of_residue))
        self.assertEqual(by_table, by_selection)
        self.assertEqual(parameters["edge_lengths"], str(table))

        options = ("report", "--sample", "ubiquitin", "--mesher", "exact", "--edge-lengths", str(table))
        for bad, message in (
            (lambda: written(rows[1:], of_residue), "has 601 rows for 602 atoms"),
            (lambda: written(rows[::-1], of_residue), "row 1 is of the atom with serial"),
            (lambda: written(rows, lambda row: "-1"), "edge_length of row 1"),
            (lambda: table.write_text("edge_length\n0.1,2\n"), "line 2: has 2 fields, the header 1"),
            (lambda: table.write_text("length\n0.1\n"), "has no column edge_length"),
            (lambda: table.unlink(), "cannot be read"),
        ):
            with self.subTest(message=message):
                bad()
                self.assert_refused(1, *options, says=(message,))

    def test_edge_lengths_that_do_not_fit(self):
        sample = ("report", "--sample", "ubiquitin")
        exact = (*sample, "--mesher", "exact")
        self.assert_refused(1, *exact, "--edge-length-of", "Z=1", says=("selection 'Z' matches none of the 602 atoms",))
        self.assert_refused(1, *exact, "--edge-length-of", "A", says=("needs a selection and a length",))
        self.assert_refused(1, *exact, "--edge-length-of", "A=0", says=("--edge-length-of",))
        self.assert_refused(1, *sample, "--relative-edge", "0.2", "--spacing", "1",
                            says=("--relative-edge: is of --mesher exact",))
