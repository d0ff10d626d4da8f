"""vdwmesh.mesh and marching_cubes: beside formulas, the exact union, the program and scikit-image."""

import math
import pickle
import unittest
import warnings

import numpy as np
import vdwmesh
from program import UBIQUITIN, ProgramTest, need_package, need_shared, run


def edges_are_paired(faces):
    """Every directed edge once, and once the other way: closed and oriented."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    forward = edges[:, 0] * (edges.max() + 1) + edges[:, 1]
    backward = edges[:, 1] * (edges.max() + 1) + edges[:, 0]
    return len(np.unique(forward)) == len(forward) and np.array_equal(np.sort(forward), np.sort(backward))


def volume_inside(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


class MeshTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.molecule = vdwmesh.sample("bpti")
        cls.exact = vdwmesh.exact(cls.molecule, topology=True)

    def test_both_meshers_give_closed_meshes_that_say_what_they_measure(self):
        for mesher in ("exact", "marching-cubes"):
            mesh = vdwmesh.mesh(self.molecule, mesher=mesher)
            vertices, faces, normals = mesh
            self.assertTrue(edges_are_paired(faces) and mesh.is_closed)
            self.assertAlmostEqual(mesh.volume, volume_inside(vertices, faces), delta=1e-9 * mesh.volume)
            edges = 3 * len(faces) // 2
            self.assertEqual(mesh.euler_characteristic, len(vertices) - edges + len(faces))
            np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)  # float32
            self.assertEqual((vertices.dtype, faces.dtype, normals.dtype), ("f8", "u4", "f4"))

    def test_the_exact_mesher_has_the_topology_and_the_atoms(self):
        mesh = vdwmesh.mesh(self.molecule)
        self.assertEqual(mesh.euler_characteristic, self.exact.topology.euler_characteristic)
        centers, radii = self.molecule.coords[mesh.vertex_atoms], self.molecule.radii[mesh.vertex_atoms]
        np.testing.assert_allclose(np.linalg.norm(mesh.vertices - centers, axis=1), radii, atol=1e-9)
        self.assertEqual(len(mesh.face_atoms), len(mesh.faces))
        self.assertEqual(set(mesh.face_atoms), set(np.flatnonzero(self.exact.atom_area)))

    def test_subdivision_is_of_second_order(self):
        coarse, fine = (vdwmesh.mesh(self.molecule, subdivide=n) for n in (0, 1))
        self.assertEqual(len(fine.faces), 4 * len(coarse.faces))
        errors = [abs(mesh.area / self.exact.area - 1) for mesh in (coarse, fine)]
        self.assertLess(errors[1], errors[0] / 3)

    def test_the_excluded_surface_knows_its_patches(self):
        exact = vdwmesh.exact(self.molecule, surface="excluded", topology=True)
        errors = []
        for levels in (0, 1):
            mesh = vdwmesh.mesh(self.molecule, surface="excluded", subdivide=levels)
            self.assertTrue(edges_are_paired(mesh.faces) and mesh.is_closed)
            self.assertEqual(mesh.euler_characteristic, exact.topology.euler_characteristic)
            errors.append(abs(mesh.area / exact.area - 1))
            kinds, atoms = mesh.face_kinds, mesh.patch_atoms[mesh.face_patches]
            self.assertEqual((len(kinds), kinds.max()), (len(mesh.faces), 2))
            np.testing.assert_array_equal((atoms >= 0).sum(axis=1), kinds + 1)
            corners = mesh.vertices[mesh.faces]
            areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
            for number, kind in enumerate(vdwmesh.PATCH_KINDS):
                self.assertAlmostEqual(areas[kinds == number].sum() / getattr(exact, kind + "_area"), 1, delta=0.03)
            # Contact triangles lie on their atoms.
            contact = kinds == 0
            centers, radii = self.molecule.coords[atoms[contact, 0]], self.molecule.radii[atoms[contact, 0]]
            off = np.linalg.norm(corners[contact] - centers[:, None], axis=2) - radii[:, None]
            self.assertLess(np.abs(off).max(), 1e-12)
            inside = np.ones(len(mesh.vertices), dtype=bool)
            inside[mesh.faces[kinds != 2]] = False
            self.assertGreater(inside.sum(), 100)
            np.testing.assert_allclose(mesh.mean_curvature[inside], -1 / 1.4, rtol=1e-6)
            np.testing.assert_allclose(mesh.gaussian_curvature[inside], 1 / 1.4**2, rtol=1e-6)
        self.assertLess(errors[1], errors[0] / 3.8)
        wide = vdwmesh.mesh(self.molecule, surface="excluded", probe=3.0, edge_length=0.5, normals=False)
        self.assertGreater(wide.volume, mesh.volume)
        self.assertIsNone(wide.normals)
        of_balls = vdwmesh.mesh(self.molecule)
        self.assertEqual((of_balls.face_patches, of_balls.face_kinds, of_balls.mean_curvature), (None, None, None))
        for wrong in ({"surface": "grid"}, {"mesher": "marching-cubes"}, {"edge_length": np.full(len(self.molecule.radii), 0.5)},
                      {"field": "blinn"}, {"probe": 0.0}):  # fmt: skip
            with self.subTest(**{name: str(value) for name, value in wrong.items()}):
                with self.assertRaisesRegex(ValueError, next(iter(wrong))):
                    vdwmesh.mesh(self.molecule, **{"surface": "excluded", **wrong})
        with self.assertRaises(vdwmesh.BackendUnavailable):
            vdwmesh.mesh(self.molecule, surface="excluded", device="cuda")

    def test_pickles_are_the_meshes(self):
        molecule = vdwmesh.sample("bpti")[:60]
        for options in ({"edge_length": 1.0}, {"surface": "excluded", "edge_length": 1.0},
                        {"mesher": "marching-cubes", "normals": False}):  # fmt: skip
            with self.subTest(options):
                mesh = vdwmesh.mesh(molecule, **options)
                found = pickle.loads(pickle.dumps(mesh))
                for name in ("vertices", "faces", "normals", "vertex_atoms", "face_atoms", "face_patches",
                             "patch_kinds", "patch_atoms", "mean_curvature"):
                    np.testing.assert_array_equal(getattr(found, name), getattr(mesh, name))
                self.assertEqual(found.area, mesh.area)
                self.assertEqual(vdwmesh.quality(found, self_intersections=True),
                                 vdwmesh.quality(mesh, self_intersections=True))  # fmt: skip

    def test_options(self):
        grown = vdwmesh.mesh([[0, 0, 0]], [1.0], probe=1.0, mesher="marching-cubes", spacing=0.1)
        np.testing.assert_allclose(np.linalg.norm(grown.vertices, axis=1), 2, atol=1e-9)
        self.assertIsNone(grown.face_atoms)
        for mesher in ("exact", "marching-cubes"):
            self.assertIsNone(vdwmesh.mesh([[0, 0, 0]], [1.0], mesher=mesher, normals=False).normals)
        areas = {vdwmesh.mesh(self.molecule, mesher="marching-cubes", field=field).area
                 for field in ("vdw", "blinn", "soft", "inverse-squared")}  # fmt: skip
        self.assertEqual(len(areas), 4)
        undone, allowed = (vdwmesh.mesh(self.molecule, mesher="marching-cubes", subdivide=1, crossings=crossings)
                           for crossings in ("undo", "allow"))  # fmt: skip
        self.assertFalse(np.array_equal(undone.vertices, allowed.vertices))
        np.testing.assert_array_equal(undone.faces, allowed.faces)
        self.assertLess(len(vdwmesh.mesh(self.molecule, edge_length=0.8).faces),
                        len(vdwmesh.mesh(self.molecule, edge_length=0.4).faces))  # fmt: skip

    def test_edge_lengths_by_atom(self):
        radii = self.molecule.radii
        one, each = (vdwmesh.mesh(self.molecule, edge_length=lengths) for lengths in (0.5, np.full(len(radii), 0.5)))
        np.testing.assert_array_equal(one.vertices, each.vertices)
        np.testing.assert_array_equal(one.faces, each.faces)
        fine = np.where(np.arange(len(radii)) < 20, 0.1, 0.5)
        graded = vdwmesh.mesh(self.molecule, edge_length=fine)
        self.assertEqual(graded.euler_characteristic, one.euler_characteristic)
        faces_of = lambda mesh, chosen: np.isin(mesh.face_atoms, chosen).sum()
        self.assertGreater(faces_of(graded, range(20)), 10 * faces_of(one, range(20)))
        self.assertLess(faces_of(graded, range(100, 400)), 2 * faces_of(one, range(100, 400)))
        for wrong in ([0.5], np.zeros(len(radii)), np.full(len(radii), math.nan), np.full((len(radii), 2), 0.5), "abc"):
            with self.assertRaisesRegex(ValueError, "edge_length"):
                vdwmesh.mesh(self.molecule, edge_length=wrong)

    def test_a_bound_on_the_angles(self):
        plain, bounded = (vdwmesh.mesh(self.molecule, min_angle=bound) for bound in (None, 20))
        self.assertTrue(bounded.is_closed)
        self.assertEqual(bounded.euler_characteristic, plain.euler_characteristic)
        self.assertLess(len(plain.faces), len(bounded.faces))
        self.assertLess(len(bounded.faces), 1.4 * len(plain.faces))
        for wrong in ({"min_angle": 26}, {"min_angle": 0}, {"min_angle": math.nan}, {"min_angle": 20, "surface": "excluded"},
                      {"min_angle": 20, "mesher": "marching-cubes"}):  # fmt: skip
            with self.subTest(**wrong), self.assertRaisesRegex(ValueError, "min_angle"):
                vdwmesh.mesh(self.molecule, **wrong)

    def test_arrays_are_views_of_one_mesh(self):
        mesh = vdwmesh.mesh(self.molecule)
        again = [np.asarray(array()) for array in (mesh._handle.vertices, mesh._handle.faces,
                                                   mesh._handle.normals, mesh._handle.face_atoms)]  # fmt: skip
        for ours, other in zip((*mesh, mesh.face_atoms), again):
            self.assertEqual(ours.ctypes.data, other.ctypes.data)  # the address of the library's array
            self.assertFalse(ours.flags.writeable)
        vertices, before = mesh.vertices, mesh.vertices.copy()
        del mesh, again, ours, other
        vdwmesh.mesh(self.molecule)
        np.testing.assert_array_equal(vertices, before)

    def test_wrong_arguments_are_named(self):
        for options in ({"mesher": "quick"}, {"field": "gauss"}, {"spacing": 0}, {"spacing": math.nan},
                        {"edge_length": -1}, {"crossings": "maybe"}, {"subdivide": -1}, {"subdivide": 1.5}, {"device": "tpu"},
                        {"threads": 0}, {"probe": -2}):  # fmt: skip
            with self.subTest(**options):
                with self.assertRaisesRegex(ValueError, "radii" if "probe" in options else next(iter(options))):
                    vdwmesh.mesh([[0, 0, 0]], [1.0], **{"mesher": "marching-cubes", **options})
        with self.assertRaisesRegex(ValueError, "field"):
            vdwmesh.mesh([[0, 0, 0]], [1.0], mesher="exact", field="blinn")
        by_spacing, by_name = (vdwmesh.mesh([[0, 0, 0]], [1.0], **options)
                               for options in ({"spacing": 0.4}, {"spacing": 0.4, "mesher": "marching-cubes"}))  # fmt: skip
        np.testing.assert_array_equal(by_spacing.vertices, by_name.vertices)
        with self.assertRaisesRegex(ValueError, "spacing: 50 is too coarse"):
            vdwmesh.mesh([[0.3, 0.2, 0.1]], [1.0], mesher="marching-cubes", spacing=50)

    def test_limits_come_before_memory(self):
        with self.assertRaises(MemoryError):
            vdwmesh.mesh(self.molecule, mesher="marching-cubes", spacing=1e-5)


TYPES = {"double": "<f8", "float": "<f4", "int": "<i4", "uint": "<u4", "uchar": "u1"}


def read_ply(path):
    """The rows of vertices and of faces of a binary PLY file of triangles, by its header."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    elements = []
    for words in map(str.split, header.decode().splitlines()):
        if words[0] == "element":
            elements.append((int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][1].extend([("corners", TYPES[words[2]]), (words[4], TYPES[words[3]], 3)])
        elif words[0] == "property":
            elements[-1][1].append((words[2], TYPES[words[1]]))
    found = []
    for count, fields in elements:
        found.append(np.frombuffer(body, fields, count))
        body = body[found[-1].nbytes :]
    assert body == b"" and (found[1]["corners"] == 3).all()
    return found


class MeshManyTest(unittest.TestCase):
    """The mesh of each molecule is, array by array, that of a call of its own."""

    MOLECULES = (
        vdwmesh.sample("bpti"),
        ([[1.0, 2.0, 3.0]], [1.7]),
        ([[0, 0, 0], [300, -200, 100]], [1.5, 2.5]),
        vdwmesh.sample("ubiquitin"),
        (np.float32([[0, 0, 0], [0, 0, 0]]), np.float32([1.1, 1.1])),
    )

    def each(self):
        for one in self.MOLECULES:
            yield one if isinstance(one, tuple) else (one.coords, one.radii)

    def assert_alone(self, found, **options):
        self.assertEqual(len(found), len(self.MOLECULES))
        for mesh, (coords, radii) in zip(found, self.each()):
            own = vdwmesh.mesh(coords, radii, mesher="marching-cubes", **options)
            for name in ("vertices", "faces", "normals", "vertex_atoms"):
                np.testing.assert_array_equal(getattr(mesh, name), getattr(own, name))

    def test_meshes_are_those_of_calls_alone(self):
        coords, radii = zip(*self.each())
        self.assert_alone(vdwmesh.mesh_many(coords, radii))
        for options in ({"field": "blinn", "spacing": 0.7}, {"fixed_grid": True, "probe": 1.4}):
            self.assert_alone(vdwmesh.mesh_many(coords, radii, **options), **options)

    def test_molecules_bring_their_radii(self):
        molecules = [vdwmesh.sample("bpti"), vdwmesh.sample("ubiquitin")]
        for radii in (None, "alvarez"):
            found = vdwmesh.mesh_many(iter(molecules), radii)
            self.assertEqual(len(found), 2)
            for mesh, one in zip(found, molecules):
                own = vdwmesh.mesh(one, radii, mesher="marching-cubes")
                np.testing.assert_array_equal(mesh.vertices, own.vertices)

    def test_normals_are_left_out(self):
        self.assertIsNone(vdwmesh.mesh_many([[[0, 0, 0]]], [[1.7]], normals=False)[0].normals)

    def test_none_are_none(self):
        self.assertEqual(vdwmesh.mesh_many([]), [])

    def test_wrong_arguments_are_named(self):
        ball = [[0, 0, 0]]
        for arguments, options, message in (
            (([ball, [[1, 2]]], [[1], [1]]), {}, r"molecules\[1\]: coords"),
            (([ball, ball], [[1], [1, 2]]), {}, r"molecules\[1\]: has 1 atoms and 2 radii"),
            (([ball, ball], [[1]]), {}, "radii: has those of 1 molecules, but there are 2"),
            (([ball, ball],), {}, r"molecules\[0\]: radii: are needed"),
            (([ball], [[-1]]), {}, "radii"),
            (([ball], [[1]]), {"spacing": 0}, "spacing"),
            (([ball, ball], [[1], [0.01]]), {}, "spacing: 0.5 is too coarse"),
            (([ball], [[1]]), {"field": "van der Waals"}, "field"),
        ):
            with self.assertRaisesRegex(vdwmesh.InvalidInput, message):
                vdwmesh.mesh_many(*arguments, **options)


class SameAsProgramTest(ProgramTest):
    """A PLY file has doubles, so meshes are equal to the last digit."""

    def test_patches_are_saved(self):
        mesh = vdwmesh.mesh([[0, 0, 0], [3.2, 0, 0]], [1.7, 1.5], surface="excluded")
        path = self.folder / "m.ply"
        mesh.save(path)
        vertices, faces = read_ply(path)
        np.testing.assert_array_equal(faces["patch_kind"], mesh.face_kinds)
        np.testing.assert_array_equal(faces["patch_atom2"], mesh.patch_atoms[mesh.face_patches, 1])
        np.testing.assert_array_equal(vertices["mean_curvature"], mesh.mean_curvature)
        np.testing.assert_array_equal(vertices["gaussian_curvature"], mesh.gaussian_curvature)

    def compare(self, path, *arguments, **options):
        file = self.folder / "m.ply"
        self.run_ok("mesh", path, "-o", file, *arguments)
        vertices, faces = read_ply(file)
        ours = vdwmesh.mesh(vdwmesh.read(path), **options)
        for axis, name in enumerate("xyz"):
            np.testing.assert_array_equal(vertices[name], ours.vertices[:, axis])
            np.testing.assert_array_equal(vertices["n" + name], ours.normals[:, axis])
        np.testing.assert_array_equal(faces["vertex_indices"], ours.faces)
        np.testing.assert_array_equal(vertices["atom"], ours.vertex_atoms)

    def test_options_both_have(self):
        path = need_shared("molecules/thesis/4PTI.pdb")
        self.compare(path, "--mesher", "exact", mesher="exact")
        self.compare(path, "--mesher", "exact", "--edge-length", 0.6, "--subdivide", 1,
                     edge_length=0.6, subdivide=1)  # fmt: skip
        self.compare(path)
        self.compare(path, "--mesher", "marching-cubes", mesher="marching-cubes")
        self.compare(path, "--spacing", 0.8, "--subdivide", 1, "--probe", 1.4,
                     mesher="marching-cubes", spacing=0.8, subdivide=1, probe=1.4)  # fmt: skip
        self.compare(path, "--surface", "excluded", "--edge-length", 0.5, "--subdivide", 1,
                     surface="excluded", edge_length=0.5, subdivide=1)  # fmt: skip
        for field in ("blinn", "soft", "inverse-squared"):
            self.compare(path, "--field", field, "--subdivide", 1,
                         mesher="marching-cubes", field=field, subdivide=1)  # fmt: skip

    def test_sparse_sets(self):
        for path in sorted(need_shared("molecules/sparse").glob("*.xyzr")):
            with self.subTest(path=path.name):
                try:
                    vdwmesh.mesh(vdwmesh.read(path))
                except vdwmesh.LimitExceeded as error:  # what double coordinates cannot tell apart
                    result = run("mesh", path, "-o", self.folder / "m.ply")
                    self.assertEqual(result.stderr, f"vdwmesh: {error}\n")
                else:
                    self.compare(path, "--mesher", "exact")

    def test_files_of_the_package_are_meshes_of_the_program(self):
        mesh = vdwmesh.mesh(vdwmesh.read(UBIQUITIN), mesher="marching-cubes")
        for extension in ("ply", "obj", "off", "stl", "glb"):
            path = self.folder / f"m.{extension}"
            if extension in ("stl", "glb"):
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    mesh.save(path)
            else:
                mesh.save(path)
            block = self.report("compare", path, UBIQUITIN, "--distances", "off")["mesh"]
            self.assertEqual(block["triangles"], len(mesh.faces))
            self.assert_close(block["volume"], mesh.volume, 1e-5)  # float32 coordinates
        with self.assertRaisesRegex(ValueError, "xyz"):
            mesh.save(self.folder / "m.xyz")
        mesh.save(self.folder / "t.stl", ascii=True)
        self.assertTrue((self.folder / "t.stl").read_text().startswith("solid "))
        with self.assertRaisesRegex(vdwmesh.InvalidInput, "ascii"):
            mesh.save(self.folder / "t.glb", ascii=True)
        mesh.save(self.folder / "n.ply", scale=0.5)
        block = self.report("compare", self.folder / "n.ply", UBIQUITIN, "--distances", "off")["mesh"]
        self.assert_close(block["area"], mesh.area / 4, 1e-12)
        self.assert_close(block["volume"], mesh.volume / 8, 1e-12)
        for scale in (0, -1, float("nan")):
            with self.assertRaisesRegex(vdwmesh.InvalidInput, "scale"):
                mesh.save(self.folder / "n.ply", scale=scale)


def distance_to_sphere(x, y, z, radius):
    return radius - np.sqrt(x * x + y * y + z * z)


class MarchingCubesTest(unittest.TestCase):
    spacing, origin = (2 / 32, 2 / 40, 2 / 24), (-1, -1, -1)

    def ball(self, dtype=np.float64):
        x, y, z = np.mgrid[-1:1:33j, -1:1:41j, -1:1:25j]
        return distance_to_sphere(x, y, z, 0.6).astype(dtype)

    def test_a_ball_lies_where_the_axes_say(self):
        stretched = (2 / 32, 4 / 40, 6 / 24)
        mesh = vdwmesh.marching_cubes(self.ball(), 0, spacing=stretched, origin=(9, 18, 27))
        ellipsoid = (mesh.vertices - (9, 18, 27)) / (1, 2, 3) - 1
        # Linear interpolation in cells of side h errs by up to h²/(8 r) for a distance field.
        np.testing.assert_allclose(np.linalg.norm(ellipsoid, axis=1), 0.6, atol=(2 / 24) ** 2 * 3 / 8 / 0.6)
        self.assertTrue(edges_are_paired(mesh.faces))
        self.assertGreater(volume_inside(mesh.vertices, mesh.faces), 0)  # outward
        outward = ellipsoid / (1, 2, 3)
        outward /= np.linalg.norm(outward, axis=1)[:, None]
        self.assertGreater(np.einsum("ij,ij->i", outward, mesh.normals).min(), 0.98)

    def test_types_and_layouts_of_volumes(self):
        expected = vdwmesh.marching_cubes(self.ball(np.float32), 0).vertices
        volume = self.ball(np.float32)
        padded = np.zeros((33, 41, 50), np.float32)
        padded[:, :, ::2] = volume
        for other in (volume.astype(float), np.asfortranarray(volume), padded[:, :, ::2],
                      volume.astype(">f4"), volume.tolist()):  # fmt: skip
            np.testing.assert_array_equal(vdwmesh.marching_cubes(other, 0).vertices, expected)
        for dtype in (np.float32, float):
            room = bytearray(1 + volume.size * np.dtype(dtype).itemsize)
            unaligned = np.frombuffer(room, dtype, offset=1).reshape(volume.shape)
            unaligned[...] = volume
            np.testing.assert_array_equal(vdwmesh.marching_cubes(unaligned, 0).vertices, expected)
        counts = (self.ball() * 100).astype(np.int16)
        self.assertTrue(vdwmesh.marching_cubes(counts, 10).is_closed)

    def test_values_that_are_no_numbers_are_refused(self):
        for value in (np.nan, np.inf):
            volume = np.ones((3, 3, 3))
            volume[1, 2, 0] = value
            with self.subTest(value), self.assertRaisesRegex(ValueError, r"volume\[\(1, 2, 0\)\]: (nan|inf) is not"):
                vdwmesh.marching_cubes(volume, 0.5)

    def test_grids_that_doubles_do_not_tell_apart_are_refused(self):
        """Nodes half a unit apart at 10^16, where doubles are 2 apart, and nodes beyond the largest."""
        far = {"origin": (1e16, 0, 0)}, {"origin": (0, 0, -1e12), "spacing": (1, 1, 1e-5)}, {"spacing": (1, 1e308, 1)}
        for options in far:
            with self.subTest(options), self.assertRaisesRegex(vdwmesh.LimitExceeded, "double precision"):
                vdwmesh.marching_cubes(self.ball(), 0, **options)
        self.assertGreater(len(vdwmesh.marching_cubes(self.ball(), 0, origin=(1e12, 0, 0)).faces), 0)

    def test_the_border_is_closed(self):
        mesh = vdwmesh.marching_cubes(np.ones((3, 4, 5)), 0.5)
        self.assertTrue(edges_are_paired(mesh.faces))
        self.assertEqual(mesh.euler_characteristic, 2)

    def test_nothing_crosses_the_level(self):
        mesh = vdwmesh.marching_cubes(np.zeros((3, 4, 5)), 1)
        self.assertEqual((mesh.vertices.shape, mesh.faces.shape), ((0, 3), (0, 3)))

    def test_the_surface_is_that_of_scikit_image(self):
        measure = need_package("python3-skimage", module="skimage.measure")
        volume = self.ball(np.float32)
        theirs, faces, *_ = measure.marching_cubes(volume, 0, spacing=self.spacing)
        ours = vdwmesh.marching_cubes(volume, 0, spacing=self.spacing)
        rows = [np.unique(np.round(v, 5), axis=0) for v in (theirs, ours.vertices)]  # theirs: float32
        self.assertEqual(rows[0].shape, rows[1].shape)
        np.testing.assert_allclose(rows[0], rows[1], atol=2e-5)
        area = measure.mesh_surface_area(theirs, faces)
        self.assertAlmostEqual(ours.area, area, delta=1e-3 * area)  # ambiguous cells may differ

    def test_wrong_arguments_are_named(self):
        volume = np.zeros((3, 3, 3))
        for name, arguments, options in (
            ("volume", (np.zeros((3, 3)), 0), {}), ("volume", (np.zeros((1, 3, 3)), 0), {}),
            ("volume", (np.zeros((0, 3, 3)), 0), {}), ("volume", (volume.astype(complex), 0), {}),
            ("level", (volume, math.nan), {}), ("level", (volume, "low"), {}),
            ("spacing", (volume, 0), {"spacing": (1, 1)}), ("spacing", (volume, 0), {"spacing": (1, 0, 1)}),
            ("origin", (volume, 0), {"origin": (0, math.inf, 0)}), ("device", (volume, 0), {"device": "x"}),
        ):  # fmt: skip
            with self.subTest(name=name), self.assertRaisesRegex(ValueError, name):
                vdwmesh.marching_cubes(*arguments, **options)


if __name__ == "__main__":
    unittest.main()
