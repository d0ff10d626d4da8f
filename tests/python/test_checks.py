"""vdwmesh.quality, compare and signed_distance: beside formulas and beside the program."""

import math
import pathlib
import tempfile
import unittest
from dataclasses import asdict

import numpy as np
import vdwmesh
from program import UBIQUITIN, ProgramTest, need_package

TETRAHEDRON = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
               [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])  # fmt: skip


class QualityTest(unittest.TestCase):
    def test_a_tetrahedron(self):
        found = vdwmesh.quality(TETRAHEDRON, self_intersections=True)
        self.assertAlmostEqual(found.area, 1.5 + math.sqrt(3) / 2, delta=1e-14)
        self.assertAlmostEqual(found.volume, 1 / 6, delta=1e-15)
        self.assertEqual((found.vertices, found.edges, found.triangles), (4, 6, 4))
        self.assertEqual((found.closed, found.manifold, found.oriented), (True, True, True))
        self.assertEqual((found.genus, found.components, found.self_intersections), (0, 1, 0))
        self.assertAlmostEqual(found.min_angle_deg.min, 45, delta=1e-12)
        self.assertAlmostEqual(found.edge_length.max, math.sqrt(2), delta=1e-15)

    def test_numbers_too_close_to_zero_are_zero(self):
        corners, faces = ["1e-400 -1E-330 0", "1 0 0", "0 1 0", "0 0 1"], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
        off = "OFF\n4 4 0\n" + "\n".join(corners + [f"3 {a} {b} {c}" for a, b, c in faces]) + "\n"
        obj = "\n".join([f"v {corner}" for corner in corners] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces])
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("a.off", off), ("a.obj", obj + "\n")):
                path = pathlib.Path(folder) / name
                path.write_text(text)
                with self.subTest(name):
                    self.assertAlmostEqual(vdwmesh.quality(path).volume, 1 / 6, delta=1e-15)
                path.write_text(text.replace("1e-400", "1e400"))
                with self.subTest(name), self.assertRaises(vdwmesh.FileFormatError):
                    vdwmesh.quality(path)

    def test_what_an_open_mesh_lacks_is_none(self):
        found = vdwmesh.quality((TETRAHEDRON[0], TETRAHEDRON[1][:3]))
        self.assertEqual((found.closed, found.volume, found.genus, found.self_intersections),
                         (False, None, None, None))  # fmt: skip

    def test_meshes_of_all_kinds(self):
        meshio = need_package("python3-meshio", module="meshio")
        vertices, faces = (np.array(a) for a in TETRAHEDRON)
        expected = vdwmesh.quality(TETRAHEDRON)
        for mesh in ((vertices.astype(np.float32), faces.astype(np.uint8)), (vertices, faces[:, ::1]),
                     meshio.Mesh(vertices.astype(float), [("triangle", faces)])):  # fmt: skip
            self.assertEqual(vdwmesh.quality(mesh), expected)

    def test_self_intersections_with_the_grid_known_and_without(self):
        rng = np.random.default_rng(4)
        mesh = vdwmesh.mesh(rng.uniform(0, 40, (3000, 3)), rng.uniform(0.8, 1.6, 3000),
                            mesher="marching-cubes", spacing=0.8)  # fmt: skip
        found = vdwmesh.quality(mesh, self_intersections=True)
        self.assertGreater(found.self_intersections, 0)
        self.assertEqual(vdwmesh.quality((mesh.vertices, mesh.faces), self_intersections=True), found)

    def test_wrong_meshes_are_named(self):
        vertices, faces = TETRAHEDRON
        for begins, mesh in (("faces[0]: [0, 9, 1]", (vertices, [[0, 9, 1]])),
                             ("faces[0]: [0, -1, 1]", (vertices, [[0, -1, 1]])),
                             ("faces: has shape (1, 4)", (vertices, [[0, 1, 2, 3]])),
                             ("faces: ", (vertices, [[0.0, 1.0, 2.0]])),
                             ("vertices: has shape (2, 2)", ([[0, 0], [1, 1]], [[0, 1, 1]])),
                             ("vertices[1]", ([[0, 0, 0], [0, math.nan, 0]], [[0, 1, 1]])),
                             ("mesh: int", 5)):  # fmt: skip
            with self.subTest(begins=begins), self.assertRaises(ValueError) as caught:
                vdwmesh.quality(mesh)
            self.assertTrue(str(caught.exception).startswith(begins), caught.exception)


class SignedDistanceTest(unittest.TestCase):
    def test_a_ball(self):
        points = np.random.default_rng(3).normal(size=(500, 3)) * 2
        found = vdwmesh.signed_distance(points, [[0, 0, 0]], [1.5])
        np.testing.assert_allclose(found, np.linalg.norm(points, axis=1) - 1.5, atol=1e-14)

    def test_two_balls_have_a_crease(self):
        # Balls of radius 1 at x = ±0.6 meet in a circle of radius 0.8. From its centre the circle is
        # nearest to points inside, because the caps beyond are covered.
        coords, radii = [[-0.6, 0, 0], [0.6, 0, 0]], [1, 1]
        found = vdwmesh.signed_distance([[0, 0, 0], [0, 0.5, 0], [1.6, 0, 0], [3, 0, 0]], coords, radii)
        np.testing.assert_allclose(found, [-0.8, -0.3, 0, 1.4], atol=1e-14)

    def test_the_excluded_surface_of_two_balls(self):
        # A probe of 3 rolls around balls of radius 2 at x = ±2 on a circle of radius √21, and its
        # torus leaves a waist of √21 - 3.
        coords, radii, waist = [[-2, 0, 0], [2, 0, 0]], [2, 2], math.sqrt(21) - 3
        points = [[0, 0, 0], [0, waist, 0], [0, waist + 1, 0], [0, 9, 0], [5, 0, 0], [-2, 1, 0]]
        found = vdwmesh.signed_distance(points, coords, radii, probe=3, surface="excluded")
        # From (0, 9, 0) the atoms are nearest; the place at x = -2 is next to its atom's sphere and to
        # the torus.
        torus = 3 - math.hypot(2, math.sqrt(21) - 1)
        np.testing.assert_allclose(found, [-waist, 0, 1, math.sqrt(85) - 2, 1, max(-1, torus)], atol=1e-12)
        water = vdwmesh.signed_distance([[0, 0, 0]], coords, radii, surface="excluded")
        np.testing.assert_allclose(water, [1.4 - math.sqrt(3.4**2 - 4)], atol=1e-12)
        accessible, grown = (vdwmesh.signed_distance(points, coords, radii, **options)
                             for options in ({"surface": "sas"}, {"probe": 1.4}))  # fmt: skip
        np.testing.assert_array_equal(accessible, grown)
        with self.assertRaisesRegex(ValueError, "surface: msms: not known; choose vdw, sas or ses; did you mean ses"):
            vdwmesh.signed_distance(points, coords, radii, surface="msms")

    def test_wrong_points_are_named(self):
        for points in ([[0, 0]], [[0, 0, math.nan]], [], "x"):
            with self.assertRaisesRegex(ValueError, "points"):
                vdwmesh.signed_distance(points, [[0, 0, 0]], [1])


class SameAsProgramTest(ProgramTest):
    def test_comparison_with_the_excluded_surface(self):
        path = self.folder / "x.ply"
        options = ("--surface", "excluded", "--probe", "2")
        self.run_ok("mesh", UBIQUITIN, *options, "--edge-length", "0.8", "-o", path)
        report = self.report("compare", path, UBIQUITIN, *options)
        found = vdwmesh.compare(path, vdwmesh.read(UBIQUITIN), probe=2, surface="excluded")
        comparison, exact = report["comparison"], report["excluded"]["complete"]
        self.assertEqual((found.exact_area, found.exact_volume), (exact["area"], exact["volume"]))
        self.assertEqual(found.area_relative_error, comparison["area_relative_error"])
        self.assertEqual(found.euler_characteristic_difference, 0)
        self.assertEqual(found.hausdorff_lower_bound, comparison["hausdorff_lower_bound"])
        most = max(comparison["bounds"][way]["upper"] for way in ("mesh_to_surface", "surface_to_mesh"))
        self.assertEqual(found.hausdorff_upper_bound, most)
        reached = max(comparison["bounds"][way]["lower"] for way in ("mesh_to_surface", "surface_to_mesh"))
        self.assertLessEqual(found.hausdorff_lower_bound, most)
        self.assertLessEqual(most, 1.1 * reached)
        for way in ("mesh_to_surface", "surface_to_mesh"):
            self.assertEqual(asdict(getattr(found, way)), comparison[way])
        self.assertLess(np.abs(found.face_distance).max(), 0.2)

    def test_comparison_and_quality_have_the_programs_figures(self):
        molecule = vdwmesh.read(UBIQUITIN)
        mesh = vdwmesh.mesh(molecule, mesher="marching-cubes", spacing=1.0)
        path = self.folder / "m.ply"
        mesh.save(path)
        report = self.report("compare", path, UBIQUITIN, "--samples", 2, "--seed", 7)
        for ours in (mesh, path):
            found = vdwmesh.compare(ours, molecule, samples=2, seed=7)
            block = report["comparison"]
            for key in ("area_relative_error", "volume_relative_error", "euler_characteristic_difference"):
                self.assertEqual(getattr(found, key), block[key], key)
            distances = block.get("distances", block)
            self.assertEqual(asdict(found.mesh_to_surface), distances["mesh_to_surface"])
            self.assertEqual(asdict(found.surface_to_mesh), distances["surface_to_mesh"])
            self.assertEqual(found.hausdorff_lower_bound, distances["hausdorff_lower_bound"])
        quality = vdwmesh.quality(path, self_intersections=True).to_dict()
        self.assertEqual(quality, {key: report["mesh"][key] for key in quality})

    def test_face_distances_are_those_of_the_centres(self):
        molecule = vdwmesh.sample("bpti")
        mesh = vdwmesh.mesh(molecule, mesher="marching-cubes", spacing=1.0)
        found = vdwmesh.compare(mesh, molecule, samples=1).face_distance
        centers = mesh.vertices[mesh.faces].mean(axis=1)
        np.testing.assert_allclose(found, vdwmesh.signed_distance(centers, molecule), atol=1e-12)

    def test_vertices_apart_are_merged_where_that_closes_a_file(self):
        vertices, faces = (np.array(a) for a in TETRAHEDRON)
        soup = vertices[faces].reshape(-1, 3)
        path = self.folder / "soup.obj"
        path.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in soup)
                        + "".join(f"f {3 * t + 1} {3 * t + 2} {3 * t + 3}\n" for t in range(4)))  # fmt: skip
        found = vdwmesh.compare(path, [[0.25, 0.25, 0.25]], [0.3], samples=1)
        self.assertAlmostEqual(found.volume, 1 / 6, delta=1e-15)
        self.assertIn("merged", found.notes[0])

    def test_wrong_arguments_are_named(self):
        for name, value in (("samples", 0), ("samples", math.nan), ("seed", -1), ("seed", 1.5)):
            with self.subTest(name=name), self.assertRaisesRegex(ValueError, name):
                vdwmesh.compare(TETRAHEDRON, [[0, 0, 0]], [1], **{name: value})


if __name__ == "__main__":
    unittest.main()
