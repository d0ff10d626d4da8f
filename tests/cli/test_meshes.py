"""compare: meshes from elsewhere against the exact union."""

import math

from program import BAD_INPUT, UBIQUITIN, ProgramTest

# The octahedron inscribed in the unit ball: area 4 √3, volume 4/3.
VERTICES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
FACES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


def off(faces):
    lines = ["OFF", f"{len(VERTICES)} {len(faces)} 0"]
    lines += [" ".join(map(str, vertex)) for vertex in VERTICES]
    lines += ["3 " + " ".join(map(str, face)) for face in faces]
    return "\n".join(lines) + "\n"


class Octahedron(ProgramTest):
    def compare(self, faces):
        mesh = self.file("octahedron.off", off(faces))
        return self.report("compare", mesh, self.file("ball.xyzr", "0 0 0 1\n"))

    def test_closed(self):
        report = self.compare(FACES)
        self.assert_close(report["mesh"]["area"], 4 * math.sqrt(3), 1e-14)
        self.assert_close(report["mesh"]["volume"], 4 / 3, 1e-14)
        area_error = 4 * math.sqrt(3) / (4 * math.pi) - 1
        self.assert_close(report["comparison"]["area_relative_error"], area_error, 1e-12)
        volume_error = (4 / 3) / (4 / 3 * math.pi) - 1
        self.assert_close(report["comparison"]["volume_relative_error"], volume_error, 1e-12)
        self.assertEqual(report["comparison"]["euler_characteristic_difference"], 0)
        self.assertEqual(report["mesh"]["self_intersections"], 0)
        self.assertEqual(report["warnings"], [])
        self.assertIsNone(report["parameters"])
        self.assertIsNone(report["backend"])

    def test_distances(self):
        comparison = self.compare(FACES)["comparison"]
        farthest = 1 - 1 / math.sqrt(3)  # between the centre of a face and the sphere
        # 10^4 samples lie within 0.03 of any point of the unit sphere; the distance is flat there.
        # The centres of the faces are looked at too, so the bound is met but for some roundings.
        farthest += 1e-15
        self.assertTrue(0.998 * farthest <= comparison["hausdorff_lower_bound"] <= farthest)
        for direction in ("mesh_to_surface", "surface_to_mesh"):
            distance = comparison[direction]
            self.assertTrue(0 < distance["mean"] < distance["rms"] < distance["max"] <= farthest)

    def test_distances_off(self):
        mesh = self.file("octahedron.off", off(FACES))
        ball = self.file("ball.xyzr", "0 0 0 1\n")
        comparison = self.report("compare", mesh, ball, "--distances", "off")["comparison"]
        for key in ("mesh_to_surface", "surface_to_mesh", "hausdorff_lower_bound", "samples"):
            self.assertIsNone(comparison[key], key)

    def test_the_wrong_molecule_is_far_away(self):
        mesh = self.file("octahedron.off", off(FACES))
        ball = self.file("elsewhere.xyzr", "100 0 0 1\n")
        comparison = self.report("compare", mesh, ball)["comparison"]
        self.assertGreater(comparison["mesh_to_surface"]["mean"], 98)
        self.assertGreater(comparison["surface_to_mesh"]["mean"], 98)

    def test_open_mesh_has_an_area_and_no_volume(self):
        report = self.compare(FACES[1:])
        self.assert_close(report["mesh"]["area"], 7 / 8 * 4 * math.sqrt(3), 1e-14)
        self.assertIsNone(report["mesh"]["volume"])
        self.assertIsNone(report["comparison"]["volume_relative_error"])
        self.assertFalse(report["mesh"]["closed"])
        self.assertTrue(any("not closed" in warning for warning in report["warnings"]))

    def test_inside_out_mesh_has_negative_volume(self):
        report = self.compare([face[::-1] for face in FACES])
        self.assert_close(report["mesh"]["volume"], -4 / 3, 1e-14)
        self.assertTrue(any("inside out" in warning for warning in report["warnings"]))

    def compare_with_vertices(self, vertices, faces):
        lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
        lines += [" ".join(map(str, vertex)) for vertex in vertices]
        lines += [f"{len(face)} " + " ".join(map(str, face)) for face in faces]
        mesh = self.file("mesh.off", "\n".join(lines) + "\n")
        return self.report("compare", mesh, self.file("ball.xyzr", "0 0 0 1\n"))

    def test_inside_out_mesh_misses_no_components(self):
        report = self.compare([face[::-1] for face in FACES])
        self.assertEqual(len(report["warnings"]), 1, report["warnings"])
        self.assertEqual(report["comparison"]["euler_characteristic_difference"], 0)

    def test_a_vertex_for_every_corner_is_merged_and_said(self):
        corners = [VERTICES[v] for face in FACES for v in face]
        faces = [(3 * t, 3 * t + 1, 3 * t + 2) for t in range(len(FACES))]
        report = self.compare_with_vertices(corners, faces)
        self.assertTrue(report["mesh"]["closed"])
        self.assertEqual(report["mesh"]["vertices"], 6)
        self.assert_close(report["mesh"]["volume"], 4 / 3, 1e-14)
        self.assertEqual(report["warnings"], [])
        self.assertTrue(any("18 of the mesh's 24" in note for note in report["mesh"]["notes"]))
        # Without one triangle it stays as it is, and the warning says what would not help.
        report = self.compare_with_vertices(corners, faces[1:])
        self.assertFalse(report["mesh"]["closed"])
        self.assertEqual(report["mesh"]["vertices"], 24)
        self.assertTrue(any("not close" in warning for warning in report["warnings"]))

    def test_other_units_and_places_are_hinted_at(self):
        for scale, shift, hint in (
            (0.1, 0, "nm"),
            (100, 0, "pm"),
            (30, 0, "in Å"),
            (1, 4, "moved"),
            (1, 0.5, None),
            (1.3, 0, None),
            (1.5, 0, None),
            (1.6, 0, "1.3 times the exact volume"),
        ):
            vertices = [(scale * x + shift, scale * y, scale * z) for x, y, z in VERTICES]
            warnings = self.compare_with_vertices(vertices, FACES)["warnings"]
            self.assertEqual(len(warnings), 0 if hint is None else 1, (scale, shift, warnings))
            if hint is not None:
                self.assertIn(hint, warnings[0])

    def test_a_mesh_of_another_surface_is_hinted_at(self):
        mesh = self.folder / "excluded.ply"
        self.run_ok("mesh", UBIQUITIN, "--surface", "excluded", "-o", mesh, "--quiet")
        (warning,) = self.report("compare", mesh, UBIQUITIN)["warnings"]
        self.assertIn("--surface ses", warning)
        self.assertEqual(self.report("compare", mesh, UBIQUITIN, "--surface", "excluded")["warnings"], [])

    def test_concave_polygons_are_not_fanned(self):
        # A prism over the arrow (0 0, 4 0, 4 4, 3 1), of area 4 and outline 8 + 2 √10, 2 high.
        outline = [(0, 0), (4, 0), (4, 4), (3, 1)]
        vertices = [(x, y, z) for z in (0, 2) for x, y in outline]
        sides = [(k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)]
        for faces in ([(3, 2, 1, 0), (4, 5, 6, 7)], [(0, 3, 2, 1), (7, 4, 5, 6)]):
            mesh = self.compare_with_vertices(vertices, faces + sides)["mesh"]
            self.assert_close(mesh["area"], 2 * 4 + 2 * (8 + 2 * math.sqrt(10)), 1e-14)
            self.assert_close(mesh["volume"], 8, 1e-14)

    def test_files_that_are_no_mesh(self):
        ball = self.file("ball.xyzr", "0 0 0 1\n")
        broken = self.file("broken.off", "OFF\n3 1 0\n0 0 0\n")
        self.assert_refused(BAD_INPUT, "compare", broken, ball, says=("broken.off",))
        self.assert_refused(BAD_INPUT, "compare", self.folder / "no.ply", ball, says=("no.ply",))
        self.assert_refused(BAD_INPUT, "compare", self.file("a.txt", ""), ball, says=(".ply",))
        empty = self.file("empty.off", "OFF\n0 0 0\n")
        self.assert_refused(BAD_INPUT, "compare", empty, ball, says=("empty.off",))
        self.assert_refused(BAD_INPUT, "compare", broken, says=("INPUT",))


class OwnMeshes(ProgramTest):
    def test_doubles_survive(self):
        made = self.report("report", UBIQUITIN, "--subdivide", "0")["mesh"]
        for extension in ("ply", "obj", "off"):
            path = self.folder / f"a.{extension}"
            self.run_ok("mesh", UBIQUITIN, "-o", path)
            read = self.report("compare", path, UBIQUITIN)["mesh"]
            for key in ("vertices", "triangles", "area", "volume", "shells", "genus"):
                self.assertEqual(read[key], made[key], f"{extension} {key}")

    def test_single_precision_formats_come_close(self):
        made = self.report("report", UBIQUITIN, "--subdivide", "0")["mesh"]
        for extension in ("stl", "glb"):
            path = self.folder / f"a.{extension}"
            self.run_ok("mesh", UBIQUITIN, "-o", path)
            read = self.report("compare", path, UBIQUITIN)["mesh"]
            # Coordinates up to 50 Å rounded to float32: 4e-6 Å on edges of 0.3 Å.
            for key in ("area", "volume"):
                self.assert_close(read[key], made[key], 1e-5)
