"""Arrays in the memory of a CUDA device: what is refused, on machines with and without one; and on a
machine with one the same bits as from the host, views by CuPy and PyTorch, and memory."""

import ctypes
import gc
import importlib.util
import unittest

import numpy as np
import vdwmesh
from device_memory import OnDevice, need_device, values_of
from program import UBIQUITIN

NAN = float("nan")
SOMEWHERE = 1 << 20  # an address that no check before the device's own can tell from one of a device
GRID = {"mesher": "marching-cubes", "spacing": 0.5}


class Fake:
    """What another library says of an array."""

    def __init__(self, **said):
        self.said = {"shape": (2, 3), "typestr": "<f8", "data": (SOMEWHERE, True), "version": 3, **said}

    @property
    def __cuda_array_interface__(self):
        return {name: value for name, value in self.said.items() if value is not Fake}


# What is said, and how the refusal begins.
WRONG = [
    ({"shape": (2, 2)}, "coords: has shape (2, 2)"),
    ({"shape": (3,)}, "coords: has shape (3,)"),
    ({"shape": (1, 1, 1, 3)}, "coords: has shape (1, 1, 1, 3)"),
    ({"shape": (0, 3)}, "coords: is empty"),
    ({"shape": (-1, 3)}, "coords: has shape (-1, 3)"),
    ({"shape": Fake}, "coords: its __cuda_array_interface__ is broken"),
    ({"shape": None}, "coords: its __cuda_array_interface__ is broken"),
    ({"data": Fake}, "coords: its __cuda_array_interface__ is broken"),
    ({"data": ()}, "coords: its __cuda_array_interface__ is broken"),
    ({"data": (0, True)}, "coords: its address on the device is 0"),
    ({"data": (SOMEWHERE + 4, True)}, "coords: is not aligned"),
    ({"version": Fake}, "coords: its __cuda_array_interface__ is broken"),
    ({"typestr": "<i4"}, "coords: has elements of type int32"),
    ({"typestr": ">f8"}, "coords: has elements of type >f8"),
    ({"typestr": "<f2"}, "coords: has elements of type float16"),
    ({"typestr": "<c16"}, "coords: has elements of type complex128"),
    ({"typestr": "nothing"}, "coords: its __cuda_array_interface__ is broken"),
    ({"strides": (24,)}, "coords: has shape (2, 3), but strides (24,)"),
    ({"strides": (24, 7)}, "coords: is not aligned"),
    ({"strides": "ab"}, "coords: its __cuda_array_interface__ is broken"),
    ({"mask": object()}, "coords: is masked"),
    ({"stream": 0}, "coords: its stream is 0"),
    ({"stream": -1}, "coords: its stream is -1"),
]


class RefusalsTest(unittest.TestCase):
    def assert_refused(self, kind, begins, call, *arguments, **options):
        with self.assertRaises(kind) as caught:
            call(*arguments, **options)
        message = str(caught.exception)
        self.assertTrue(message.startswith(begins), f"{message!r} does not begin with {begins!r}")
        self.assertNotIn("\n", message)

    def test_what_no_kernel_could_read(self):
        for said, begins in WRONG:
            with self.subTest(**said):
                for call, options in ((vdwmesh.exact, {}), (vdwmesh.sasa, {}), (vdwmesh.mesh, GRID)):
                    self.assert_refused(ValueError, begins, call, Fake(**said), [1, 1], **options)
        for said, begins in (({"shape": (2, 1)}, "radii: has shape (2, 1)"), ({"shape": (0,)}, "radii: is empty"),
                             ({"typestr": "<i8"}, "radii: has elements of type int64")):  # fmt: skip
            self.assert_refused(ValueError, begins, vdwmesh.exact, Fake(), Fake(**{"shape": (2,), **said}))

    def test_of_trajectories(self):
        self.assert_refused(ValueError, "traj: has shape (2, 3)", vdwmesh.frames, Fake(), radii=[1, 1])
        frames = Fake(shape=(4, 2, 3))
        self.assert_refused(ValueError, "select: traj is on a CUDA device", vdwmesh.frames, frames,
                            radii=[1, 1], select=[0])  # fmt: skip
        self.assert_refused(ValueError, "radii: are needed", vdwmesh.frames, frames)

    def test_what_only_the_host_computes(self):
        self.assert_refused(ValueError, 'device: is "cpu"', vdwmesh.exact, Fake(), [1, 1], device="cpu")
        self.assert_refused(RuntimeError, "coords: are on a CUDA device, which measures", vdwmesh.exact,
                            Fake(), [1, 1], topology=True)  # fmt: skip
        self.assert_refused(ValueError, "gradient: is of areas and volumes of all atoms", vdwmesh.exact, Fake(), [1, 1],
                            gradient=True, atoms=[0])  # fmt: skip
        self.assert_refused(ValueError, "weights: are on the host", vdwmesh.exact, Fake(), [1, 1], gradient=True,
                            weights=[1, 1])  # fmt: skip
        self.assert_refused(RuntimeError, "surface: the excluded surface", vdwmesh.mesh, Fake(), [1, 1],
                            surface="excluded")  # fmt: skip
        self.assert_refused(RuntimeError, "radii: is on a CUDA device", vdwmesh.exact, [[0, 0, 0]],
                            Fake(shape=(1,)))  # fmt: skip
        for call in (vdwmesh.quality, lambda m: vdwmesh.marching_cubes(m, 0)):
            with self.assertRaises(vdwmesh.Error):
                call(Fake())
        self.assert_refused(RuntimeError, "coords: is on a CUDA device", vdwmesh.signed_distance,
                            [[0, 0, 0]], Fake(), [1, 1])  # fmt: skip

    def test_an_address_that_is_not_of_a_device(self):
        """A ValueError where there is a device that could have it, else the device is what is missing."""
        memory = np.zeros((2, 3))
        said = Fake(data=(memory.ctypes.data, True))
        try:
            vdwmesh.exact([[0, 0, 0]], [1], device="cuda")
            kind, begins = ValueError, "coords: does not lie in the memory of a CUDA device"
        except vdwmesh.BackendUnavailable:
            kind, begins = RuntimeError, "coords: is on a CUDA device, but"
        for call, options in ((vdwmesh.exact, {}), (vdwmesh.sasa, {}), (vdwmesh.mesh, GRID)):
            self.assert_refused(kind, begins, call, said, [1, 1], **options)
        frames = Fake(shape=(1, 2, 3), data=(memory.ctypes.data, True))
        with self.assertRaises(kind):
            next(vdwmesh.frames(frames, radii=[1, 1]))

    def test_importing_does_not_load_cuda_s_driver(self):
        import subprocess
        import sys

        code = ("import vdwmesh, vdwmesh._mesh, vdwmesh._exact, vdwmesh._frames\n"
                "print('libcuda.so' in open('/proc/self/maps').read())")  # fmt: skip
        found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        self.assertEqual(found.stdout, "False\n")


class DeviceTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        need_device()
        cls.molecule = vdwmesh.read(UBIQUITIN)
        cls.coords, cls.radii = OnDevice(cls.molecule.coords), OnDevice(cls.molecule.radii)

    def assert_same_mesh(self, mesh, expected):
        self.assertIsNone(expected.cuda)
        for name in ("vertices", "faces", "normals", "vertex_atoms", "face_atoms"):
            there, host, wanted = (getattr(m, name) for m in (mesh.cuda, mesh, expected))
            if wanted is None:
                self.assertIsNone(there)
                self.assertIsNone(host)
                continue
            self.assertEqual(there.dtype, wanted.dtype)
            for found in (values_of(there), there.to_numpy(), host):
                self.assertEqual(found.shape, wanted.shape)
                self.assertEqual(found.tobytes(), wanted.tobytes(), name)

    def test_meshes_are_those_of_the_host(self):
        for options in ({}, {"probe": 1.4}, {"field": "blinn"}, {"normals": False}, {"fixed_grid": True},
                        {"subdivide": 1}, {"subdivide": 1, "crossings": "allow", "normals": False},
                        {"field": "soft", "subdivide": 1}):  # fmt: skip
            options = {**GRID, **options}
            with self.subTest(**options):
                expected = vdwmesh.mesh(self.molecule, device="cpu", **options)
                for radii in (self.radii, self.molecule.radii):
                    self.assert_same_mesh(vdwmesh.mesh(self.coords, radii, **options), expected)

    def test_exact_meshes_are_those_of_the_host(self):
        lengths = np.linspace(0.3, 0.9, len(self.molecule.radii))
        for options in ({}, {"probe": 1.4}, {"edge_length": lengths}, {"normals": False}, {"subdivide": 1},
                        {"subdivide": 2, "normals": False}, {"min_angle": 15, "subdivide": 1}):  # fmt: skip
            with self.subTest(**options):
                expected = vdwmesh.mesh(self.molecule, device="cpu", **options)
                self.assert_same_mesh(vdwmesh.mesh(self.coords, self.radii, **options), expected)

    def test_the_excluded_surface_is_that_of_the_cpu(self):
        expected = vdwmesh.exact(self.molecule, surface="excluded", topology=True, device="cpu")
        found = vdwmesh.exact(self.molecule, surface="excluded", device="cuda")
        # 1e-11 of area and volume, as ExcludedMeasurer promises; an atom's share may be wrong by the whole of that.
        for name in ("area", "contact_area", "saddle_area", "concave_area"):
            self.assertLessEqual(abs(getattr(found, name) - getattr(expected, name)), 1e-11 * expected.area)
            atoms = "atom_" + name
            worst = np.abs(getattr(found, atoms) - getattr(expected, atoms)).max()
            self.assertLessEqual(worst, 1e-11 * expected.area)
        self.assertLessEqual(abs(found.volume - expected.volume), 1e-11 * expected.accessible_volume)
        self.assertEqual((found.probes, found.low_probes), (expected.probes, expected.low_probes))
        self.assertEqual(found.euler_characteristic, expected.topology.euler_characteristic)
        self.assertIsNone(found.topology)
        self.assertIsNone(found.exterior)
        with self.assertRaises(vdwmesh.BackendUnavailable):
            vdwmesh.exact(self.molecule, surface="excluded", device="cuda", topology=True)

    def test_layouts(self):
        coords = self.molecule.coords[:100]
        wide = np.zeros((3, 100, 2))
        wide[:, :, 0] = coords.T
        columns = OnDevice(wide)
        columns.shape, columns.strides = (100, 3), (16, 1600)
        backwards = OnDevice(coords[::-1])
        backwards.strides, backwards.offset = (-24, 8), 99 * 24
        expected = vdwmesh.mesh(coords, self.molecule.radii[:100], device="cpu", **GRID)
        for given in (columns, backwards):
            self.assert_same_mesh(vdwmesh.mesh(given, self.molecule.radii[:100], **GRID), expected)
        single = coords.astype(np.float32)
        self.assert_same_mesh(vdwmesh.mesh(OnDevice(single), self.molecule.radii[:100], **GRID),
                              vdwmesh.mesh(single, self.molecule.radii[:100], device="cpu", **GRID))  # fmt: skip

    def test_measures_are_those_of_a_copy_on_the_host(self):
        for options in ({}, {"atoms": [3, 5, 600]}, {"probe": 1.4}):
            with self.subTest(**options):
                found = vdwmesh.exact(self.coords, self.radii, **options)
                expected = vdwmesh.exact(self.molecule, device="cuda", **options)
                self.assertIsNone(expected.cuda)
                self.assertEqual((found.area, found.volume), (expected.area, expected.volume))
                for name in ("atom_area", "atom_volume"):
                    wanted = getattr(expected, name).tobytes()
                    self.assertEqual(getattr(found, name).tobytes(), wanted)
                    self.assertEqual(values_of(getattr(found.cuda, name)).tobytes(), wanted)
                    self.assertEqual(getattr(found.cuda, name).to_numpy().tobytes(), wanted)
                cpu = vdwmesh.exact(self.molecule, device="cpu", **options)
                self.assertLess(abs(found.area - cpu.area), 1e-11 * cpu.area)

    def test_gradients_are_those_of_the_host(self):
        """Left on the device, with weights that lie there."""
        dice = np.random.default_rng(5)
        weights = dice.normal(size=(2, len(self.molecule.radii)))
        there = OnDevice(weights[0]), OnDevice(weights[1])
        names = ("area_coords", "area_radii", "volume_coords", "volume_radii")
        for given, on_host in ((None, None), (there, tuple(weights)), (there[0], weights[0]), ((None, there[1]), (None, weights[1]))):
            found = vdwmesh.exact(self.coords, self.radii, probe=1.4, gradient=True, weights=given)
            expected = vdwmesh.exact(self.molecule, probe=1.4, gradient=True, weights=on_host)
            self.assertIsNone(found.gradient)
            np.testing.assert_allclose(found.area, expected.area, rtol=1e-12)
            np.testing.assert_allclose(found.atom_area, expected.atom_area, atol=1e-10)
            np.testing.assert_array_equal(values_of(found.cuda.atom_area), found.atom_area)
            for name in names:
                slope, wanted = getattr(found.cuda.gradient, name), getattr(expected.gradient, name)
                self.assertEqual(slope.shape, wanted.shape)
                np.testing.assert_allclose(slope.to_numpy(), wanted, atol=1e-9)
                np.testing.assert_array_equal(values_of(slope), slope.to_numpy())
            self.assertEqual(found.cuda.gradient.kink_atoms, expected.gradient.kink_atoms)
        for wrong in (weights[0], OnDevice(weights[0][1:]), OnDevice(weights[0].astype(np.float32))):
            with self.assertRaisesRegex(vdwmesh.InvalidInput, "weights"):
                vdwmesh.exact(self.coords, self.radii, gradient=True, weights=wrong)

    def test_frames_and_many_sets_with_gradients(self):
        """Each frame, and each set, has on the device the bits that it has there alone."""
        names = ("area_coords", "area_radii", "volume_coords", "volume_radii")
        places = np.stack([self.molecule.coords * scale for scale in (1, 1.05, 0.9)])
        weights = OnDevice(np.random.default_rng(6).normal(size=len(self.molecule.radii)))

        def slopes(gradient):
            return [values_of(getattr(gradient, name)) for name in names]

        alone = [
            vdwmesh.exact(OnDevice(frame), self.radii, gradient=True, weights=weights) for frame in places
        ]
        found = list(vdwmesh.frames(OnDevice(places), radii=self.radii, chunk=2, gradient=True, weights=weights))
        self.assertEqual([one.area for one in found], [one.area for one in alone])
        for one, expected in zip(found, alone):
            self.assertIsNone(one.gradient)
            self.assertEqual(one.cuda.gradient.kink_atoms, expected.cuda.gradient.kink_atoms)
            for a, b in zip(slopes(one.cuda.gradient), slopes(expected.cuda.gradient)):
                np.testing.assert_allclose(a, b, rtol=0, atol=1e-10)  # balls in doubt differ by rounding
        atoms = len(self.molecule.radii)
        offsets = [0, 100, 101, atoms]
        sets = vdwmesh.exact_many(self.coords, self.radii, offsets, gradient=True, weights=weights)
        host = vdwmesh.exact_many(self.molecule.coords, self.molecule.radii, offsets, device="cpu",
                                  gradient=True, weights=values_of(weights))  # fmt: skip
        self.assertIsNone(sets.gradient)
        np.testing.assert_allclose(sets.area, host.area, rtol=1e-12)
        np.testing.assert_array_equal(values_of(sets.cuda.atom_area), sets.atom_area)
        for name in names:
            there = getattr(sets.cuda.gradient, name).to_numpy()
            np.testing.assert_allclose(there, getattr(host.gradient, name), atol=1e-9)
        self.assertIsNone(vdwmesh.exact_many(self.coords, self.radii, offsets).cuda.gradient)
        with self.assertRaisesRegex(vdwmesh.InvalidInput, "offsets: are needed"):
            vdwmesh.exact_many(self.coords, self.radii)

    def test_torch_stays_on_the_device(self):
        if importlib.util.find_spec("torch") is None:
            self.skipTest("PyTorch is not installed")
        import torch
        import vdwmesh.torch

        if not torch.cuda.is_available():
            self.skipTest("PyTorch has no CUDA")
        found = []
        for place in ("cpu", "cuda"):
            coords = torch.tensor(self.molecule.coords, device=place, requires_grad=True)
            radii = torch.tensor(self.molecule.radii, device=place, requires_grad=True)
            half = len(radii) // 2
            areas, volumes = vdwmesh.torch.measures(coords, radii, probe=1.4, offsets=[0, half, len(radii)])
            self.assertEqual(areas.device.type, place)
            (torch.sin(areas).sum() + 0.1 * volumes.sum()).backward()
            self.assertEqual(coords.grad.device.type, place)
            found.append([t.detach().cpu().numpy() for t in (areas, volumes, coords.grad, radii.grad)])
        for host, there in zip(*found):
            np.testing.assert_allclose(there, host, atol=1e-8)

    def test_sasa(self):
        frames = np.stack([self.molecule.coords + shift for shift in (0, 0.5, 1)])
        there = OnDevice(frames)
        for given, host in ((self.coords, self.molecule.coords), (there, frames)):
            area = vdwmesh.sasa(given, self.radii)
            np.testing.assert_array_equal(area, vdwmesh.sasa(host, self.molecule.radii, device="cuda"))
            atoms = vdwmesh.sasa(given, self.radii, mode="atom")
            self.assertIsInstance(atoms, vdwmesh.CudaArray)
            expected = vdwmesh.sasa(host, self.molecule.radii, mode="atom", device="cuda")
            np.testing.assert_array_equal(values_of(atoms), expected)
        groups = self.molecule.resids
        np.testing.assert_array_equal(
            vdwmesh.sasa(there, self.radii, mode="residue", groups=groups),
            vdwmesh.sasa(frames, self.molecule.radii, mode="residue", groups=groups, device="cuda"))  # fmt: skip

    def test_frames(self):
        frames = np.stack([self.molecule.coords * (1 + 0.01 * t) for t in range(7)]).astype(np.float32)
        there = OnDevice(frames)
        options = {"per_atom": True, "chunk": 2, "start": 1, "step": 2}
        found = list(vdwmesh.frames(there, radii=self.radii, **options))
        expected = list(vdwmesh.frames(frames, radii=self.molecule.radii, device="cuda", **options))
        self.assertEqual([f.frame for f in found], [1, 3, 5])
        for a, b in zip(found, expected):
            self.assertEqual((a.frame, a.area, a.volume), (b.frame, b.area, b.volume))
            np.testing.assert_array_equal(values_of(a.cuda.atom_area), b.atom_area)
        self.assertIsNone(next(vdwmesh.frames(there, radii=self.radii)).cuda)
        meshes = vdwmesh.meshes(there, radii=self.radii, stop=2)
        for one, coords in zip(meshes, frames):
            expected = vdwmesh.mesh(coords, self.molecule.radii, fixed_grid=True, device="cpu", **GRID)
            self.assert_same_mesh(one.mesh, expected)

    def test_wrong_numbers_are_named(self):
        coords, radii = np.array(self.molecule.coords), np.array(self.molecule.radii)
        coords[70, 1] = NAN
        for call, options in ((vdwmesh.exact, {}), (vdwmesh.mesh, GRID)):
            with self.assertRaisesRegex(ValueError, r"^coords\[70\]: \(.*nan.*\) is not finite"):
                call(OnDevice(coords), self.radii, **options)
        radii[5] = -2
        for sizes in (radii, OnDevice(radii)):
            with self.assertRaisesRegex(ValueError, r"^radii\[5\]: -2 is no radius"):
                vdwmesh.exact(self.coords, sizes)
            with self.assertRaisesRegex(ValueError, r"^radii: has 601 radii for 602 atoms"):
                vdwmesh.exact(OnDevice(coords), OnDevice(radii[1:]))
        frames = OnDevice(np.stack([self.molecule.coords, coords]))
        result = vdwmesh.frames(frames, radii=self.radii)
        next(result)
        with self.assertRaisesRegex(ValueError, "^traj: frame 1, atom 70: "):
            next(result)
        with self.assertRaisesRegex(ValueError, "^spacing: 9 is too coarse"):
            vdwmesh.mesh(OnDevice(np.zeros((1, 3)) + 0.1), [0.2], mesher="marching-cubes", spacing=9)

    def test_arrays_outlive_their_owners(self):
        kept = vdwmesh.mesh(self.coords, self.radii, **GRID).cuda.vertices
        expected = values_of(kept)
        for _ in range(5):
            vdwmesh.mesh(self.coords, self.radii, probe=1, **GRID)
        gc.collect()
        np.testing.assert_array_equal(values_of(kept), expected)

    def test_dlpack(self):
        array = vdwmesh.mesh(self.coords, self.radii, **GRID).cuda.vertices
        self.assertEqual(array.__dlpack_device__(), (2, 0))
        capsule = array.__dlpack__(stream=1, max_version=(1, 0), dl_device=(2, 0), copy=False)
        is_valid = ctypes.pythonapi.PyCapsule_IsValid
        is_valid.argtypes = [ctypes.py_object, ctypes.c_char_p]
        self.assertTrue(is_valid(capsule, b"dltensor"))
        for options in ({"dl_device": (1, 0)}, {"copy": True}):
            with self.assertRaises(BufferError):
                array.__dlpack__(**options)

    def test_other_libraries_see_the_values(self):
        mesh = vdwmesh.mesh(self.coords, self.radii, **GRID)
        areas = vdwmesh.sasa(self.coords, self.radii, mode="atom")
        for array in (mesh.cuda.vertices, mesh.cuda.normals, mesh.cuda.faces, areas):
            expected = array.to_numpy()
            for name, views in self.views(array).items():
                for found in views:
                    with self.subTest(library=name, shape=array.shape):
                        np.testing.assert_array_equal(found, expected)

    def views(self, array):
        """What each library that is there makes of the array, by each way in, back on the host."""
        found = {}
        if importlib.util.find_spec("cupy"):
            import cupy

            found["cupy"] = [cupy.asnumpy(cupy.asarray(array)), cupy.asnumpy(cupy.from_dlpack(array))]
        if importlib.util.find_spec("torch"):
            import torch

            found["torch"] = [torch.as_tensor(array, device="cuda").cpu().numpy(),
                              torch.from_dlpack(array).cpu().numpy()]  # fmt: skip
        return found

    def test_other_libraries_give_coordinates(self):
        expected = vdwmesh.mesh(self.molecule, device="cpu", **GRID)
        coords, radii = np.array(self.molecule.coords), np.array(self.molecule.radii)
        if importlib.util.find_spec("cupy"):
            import cupy

            with cupy.cuda.Stream(non_blocking=True):  # the values are made on a stream of its own
                given = cupy.asarray(coords) * cupy.ones((500, 1, 1)).prod()
                mesh = vdwmesh.mesh(given, cupy.asarray(radii), **GRID)
            self.assert_same_mesh(mesh, expected)
        if importlib.util.find_spec("torch"):
            import torch

            mesh = vdwmesh.mesh(torch.tensor(coords, device="cuda"), torch.tensor(radii).cuda(), **GRID)
            self.assert_same_mesh(mesh, expected)


if __name__ == "__main__":
    unittest.main()
