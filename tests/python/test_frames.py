"""Trajectories: every frame has the digits of a call for it alone, whatever it is read from; memory
stays flat; frames that cannot be measured are named, and those before them are not lost."""

import csv
import functools
import gc
import importlib
import os
import pathlib
import sys
import tempfile
import threading
import types
import unittest
import warnings
from unittest import mock

import numpy as np
import vdwmesh
from program import UBIQUITIN, need_package
from test_calls import ANSWER, seconds_to_stop

NAN = float("nan")

# By default a machine with a CUDA device takes it where there is much to do, and the last bit of a sum may then be
# another one. test_cuda_arrays tries the device.
exact_of = functools.partial(vdwmesh.exact, device="cpu")
frames_of = functools.partial(vdwmesh.frames, device="cpu")


def jittered(molecule, frames, seed=1):
    """The molecule with atoms that are moved by about 0.2 Å in each frame, float32."""
    moves = np.random.default_rng(seed).normal(0, 0.2, (frames, len(molecule), 3))
    return (molecule.coords + moves).astype(np.float32)


def areas(frames):
    return [frame.area for frame in frames]


class ExcludedTest(unittest.TestCase):
    def test_frames_are_those_of_exact(self):
        molecule = vdwmesh.sample("bpti")[:80]
        places = jittered(molecule, 3)
        found = vdwmesh.trajectory(places, radii=molecule.radii, surface="excluded", per_atom=True)
        for i, place in enumerate(places):
            alone = exact_of(place, molecule.radii, surface="excluded")
            self.assertEqual((found.area[i], found.volume[i]), (alone.area, alone.volume))
            np.testing.assert_array_equal(found.atom_area[i], alone.atom_area)
        for wrong, word in (({"topology": True}, "surface"), ({"atoms": [1]}, "surface"), ({"surface": "vdv"}, "surface")):
            with self.subTest(wrong), self.assertRaisesRegex(ValueError, word):
                frames_of(places, radii=molecule.radii, **({"surface": "excluded"} | wrong))


class ArraysTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.molecule = vdwmesh.sample("bpti")
        cls.radii = cls.molecule.radii
        cls.places = jittered(cls.molecule, 7)

    def test_frames_have_the_digits_of_single_calls(self):
        half = np.arange(len(self.molecule)) % 2 == 0
        for options in ({}, {"probe": 1.4}, {"atoms": half}, {"topology": "counts"}, {"topology": True}):
            expected = [exact_of(frame, self.radii, **options) for frame in self.places]
            for chunk, threads in ((1, 1), (3, 2), (64, None)):
                found = list(frames_of(self.places, radii=self.radii, per_atom=True, chunk=chunk,
                                            threads=threads, **options))  # fmt: skip
                with self.subTest(options=options.keys(), chunk=chunk):
                    self.assertEqual([one.frame for one in found], list(range(7)))
                    for one, alone in zip(found, expected):
                        self.assertEqual((one.area, one.volume), (alone.area, alone.volume))
                        np.testing.assert_array_equal(one.atom_area, alone.atom_area)
                        np.testing.assert_array_equal(one.atom_volume, alone.atom_volume)
                        self.assertEqual(one.counts, alone.counts)
                        self.assertEqual(one.counts is None, "topology" not in options)
                        self.assertEqual(one.topology is None, options.get("topology") is not True)
                        if one.topology:
                            self.assertEqual(one.topology.tunnels, alone.topology.tunnels)
                            np.testing.assert_array_equal(one.topology.shells, alone.topology.shells)

    def test_counts_are_those_of_the_whole_topology(self):
        counts = vdwmesh.trajectory(self.places, radii=self.radii, probe=1.4, topology="counts")
        whole = vdwmesh.trajectory(self.places, radii=self.radii, probe=1.4, topology=True)
        for name in ("components", "euler_characteristic", "hidden_atoms"):
            np.testing.assert_array_equal(getattr(counts, name), getattr(whole, name))
        np.testing.assert_array_equal(whole.euler_characteristic,
                                      2 * (whole.components - whole.tunnels + whole.voids))  # fmt: skip
        self.assertIsNone(counts.tunnels)

    def test_atoms_are_not_kept_unless_asked_for(self):
        one = next(frames_of(self.places, radii=self.radii))
        self.assertIsNone(one.atom_area)
        self.assertIsNone(one.time)

    def test_slices(self):
        expected = areas(frames_of(self.places, radii=self.radii))
        for part in (slice(2, None), slice(None, None, 3), slice(-2, None), slice(5, 1, -2), slice(1, 6, 2)):
            found = list(frames_of(self.places, radii=self.radii, start=part.start, stop=part.stop,
                                        step=part.step, chunk=2))  # fmt: skip
            self.assertEqual(areas(found), expected[part])
            self.assertEqual([one.frame for one in found], list(range(7))[part])

    def test_iterables_and_arrays_of_all_kinds(self):
        expected = areas(frames_of(self.places, radii=self.radii))
        wide = areas(frames_of(self.places.astype(float) + 0.1, radii=self.radii))
        self.assertNotEqual(expected, wide)
        rows = np.zeros((7, 3, len(self.molecule)), np.float32)
        rows[...] = self.places.transpose(0, 2, 1)
        for name, traj, digits in (
            ("list", list(self.places), expected),
            ("generator", (frame for frame in self.places), expected),
            ("lists of lists", self.places.tolist(), expected),
            ("axis by axis", rows.transpose(0, 2, 1), expected),
            ("float64", self.places.astype(float) + 0.1, wide),
            ("generator of float64", (frame.astype(float) + 0.1 for frame in self.places), wide),
            ("both", (f if i < 3 else f.astype(float) for i, f in enumerate(self.places)), expected),
        ):
            with self.subTest(name):
                self.assertEqual(areas(frames_of(traj, radii=self.radii, chunk=2)), digits)

    def test_an_iterable_may_use_one_array_for_all_frames(self):
        def one_array():
            array = np.empty_like(self.places[0])
            for frame in self.places:
                array[...] = frame
                yield array

        self.assertEqual(areas(frames_of(one_array(), radii=self.radii, chunk=2)),
                         areas(frames_of(self.places, radii=self.radii)))  # fmt: skip

    def test_streams_are_cut_from_the_left(self):
        expected = areas(frames_of(self.places, radii=self.radii))
        found = list(frames_of(iter(self.places), radii=self.radii, start=1, stop=6, step=2))
        self.assertEqual(areas(found), expected[1:6:2])
        self.assertEqual([one.frame for one in found], [1, 3, 5])
        with self.assertRaisesRegex(ValueError, "start: is -1, but the number of frames is not known"):
            frames_of(iter(self.places), radii=self.radii, start=-1)

    def test_selected_atoms_are_alone_and_chosen_ones_are_not(self):
        ids = np.flatnonzero(self.molecule.chains == self.molecule.chains[0])[:200]
        for traj in (self.places, iter(self.places)):
            found = next(frames_of(traj, radii=self.radii, select=ids, atoms=[0, 5], per_atom=True))
            alone = exact_of(self.places[0][ids], self.radii[ids], atoms=[0, 5])
            self.assertEqual(found.area, alone.area)
            np.testing.assert_array_equal(found.atom_area, alone.atom_area)
            self.assertEqual(next(frames_of(self.places, radii=self.radii[ids], select=ids)).area,
                             exact_of(self.places[0][ids], self.radii[ids]).area)  # fmt: skip

    def test_a_molecule_is_one_frame(self):
        self.assertEqual(areas(frames_of(self.molecule)), [exact_of(self.molecule).area])

    def test_wrong_arguments(self):
        frames = self.places
        for begins, traj, options in (
            ("traj: has shape", np.zeros((2, 3)), {}),
            ("traj: has shape", np.zeros((2, 3, 4)), {}),
            ("traj: has shape", np.zeros((2, 0, 3)), {}),
            ("traj: has no frames", frames[:0], {}),
            ("traj: has no frames", [], {}),
            ("traj: has no frames", iter([]), {}),
            ("traj: has no frames", frames, {"start": 9}),
            ("traj: has no frames", iter(frames), {"start": 9}),
            ("traj: frame 0 has shape (3,)", [[1, 2, 3]], {}),
            ("traj: 'a.xtc' is a path; give what a reader makes of it, such as MDAnalysis", "a.xtc", {}),
            ("radii: has 2 radii for 454 atoms", frames, {"radii": [1, 1]}),
            ("radii: are needed", frames, {"radii": "bondi"}),
            ("radii[0]: -1", frames, {"radii": -self.radii / self.radii[0]}),
            ("select: 'protein' needs names", frames, {"select": "protein"}),
            ("select: is a mask of 2", frames, {"select": [True, False]}),
            ("atoms[0]: 454 is no index", frames, {"atoms": [454]}),
            ("topology: all", frames, {"topology": "all"}),
            ("chunk: 0", frames, {"chunk": 0}),
            ("step: is 0", frames, {"step": 0}),
            ("stop: 1.5", frames, {"stop": 1.5}),
            ("probe: nan", frames, {"probe": NAN}),
            ("threads: 0", frames, {"threads": 0}),
            ("device: tpu", frames, {"device": "tpu"}),
        ):
            with self.subTest(begins=begins), self.assertRaises(vdwmesh.InvalidInput) as caught:
                list(frames_of(traj, **{"radii": self.radii, **options}))
            self.assertTrue(str(caught.exception).startswith(begins), str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))


class BadFramesTest(unittest.TestCase):
    def setUp(self):
        self.places = np.zeros((9, 2, 3))
        self.places[:, 1, 0] = np.arange(9) / 4

    def assert_ends(self, traj, message, number, **options):
        found = []
        with self.assertRaises(ValueError) as caught:
            for frame in frames_of(traj, radii=[1, 1], **options):
                found.append(frame)
        self.assertEqual(str(caught.exception), message)
        self.assertEqual(len(found), number)
        for one in found:
            self.assertEqual(one.area, exact_of(self.places[one.frame], [1, 1]).area)

    def test_numbers_that_are_not_finite(self):
        self.places[[5, 7], 1, 1] = NAN
        text = "traj: frame 5, atom 1: (1.25, nan, 0) is not finite; coordinates are in angstrom"
        for chunk in (1, 2, 64):
            self.assert_ends(self.places, text, 5, chunk=chunk)
            self.assert_ends(iter(self.places), text, 5, chunk=chunk)
            self.assert_ends(self.places, text, 2, chunk=chunk, start=3)
        self.places[4, 0] = 1e31
        with self.assertRaisesRegex(ValueError, "^traj: frame 4: sphere 0: centre"):
            vdwmesh.trajectory(self.places, radii=[1, 1])

    def test_other_atoms(self):
        frames = list(self.places)
        frames[6] = np.zeros((3, 3))
        text = "traj: frame 6 has shape (3, 3); those before have (2, 3)"
        for chunk in (2, 64):
            self.assert_ends(frames, text, 6, chunk=chunk)
            self.assert_ends(iter(frames), text, 6, chunk=chunk)

    def test_readers_that_fail(self):
        def damaged():
            yield from self.places[:5]
            raise OSError("the file ends within a frame")

        found = []
        with self.assertRaisesRegex(OSError, "the file ends within a frame"):
            for frame in frames_of(damaged(), radii=[1, 1], chunk=3):
                found.append(frame.frame)
        self.assertEqual(found, [0, 1, 2, 3, 4])


class MeshesTest(unittest.TestCase):
    """The first atom stays, and the second one moves, which moves the box of the molecule as well."""

    def setUp(self):
        self.places = np.zeros((4, 2, 3))
        self.places[:, 0] = 0.11, 0.07, -0.05  # no node is at its radius
        self.places[:, 1] = [[6, 0, 0], [6.1, 0.2, 0], [6.3, 0, -0.9], [-5.77, 0, 0]]

    def test_what_stays_does_not_flicker(self):
        for spacing in (0.5, 0.3):
            found = list(vdwmesh.meshes(iter(self.places), radii=[1.5, 1.7], spacing=spacing, start=1))
            self.assertEqual([one.frame for one in found], [1, 2, 3])
            still = []
            for one in found:
                vertices = one.mesh.vertices
                # Marching cubes puts vertices on edges of the grid: two coordinates are those of nodes.
                off = np.abs(vertices - spacing * np.round(vertices / spacing))
                self.assertLess(np.sort(off, axis=1)[:, 1].max(), 1e-13)
                # The order of the vertices follows the bricks, which move with the grid's corner.
                digits = 15 if spacing == 0.5 else 11
                still.append(np.unique(vertices[one.mesh.vertex_atoms == 0].round(digits) + 0.0, axis=0))
            for other in still[1:]:
                np.testing.assert_array_equal(other, still[0])

    def test_a_grid_moves_with_the_molecule_otherwise(self):
        loose, fixed = ([one.mesh.vertices[0, 0] % 0.5 for one in
                         vdwmesh.meshes(self.places, radii=[1.5, 1.7], fixed_grid=is_fixed)]
                        for is_fixed in (False, True))  # fmt: skip
        self.assertGreater(len(set(loose)), 1)
        self.assertNotEqual(loose, fixed)

    def test_meshes_are_those_of_single_calls(self):
        for options, alone in (
            ({"mesher": "exact", "probe": 0.5}, {}),
            ({"spacing": 0.4, "subdivide": 1, "normals": False}, {"mesher": "marching-cubes", "fixed_grid": True}),
            ({"surface": "ses", "density": 2, "threads": 3}, {}),
            ({"surface": "ses"}, {}),
            ({"edge_length": 0.5}, {}),
        ):
            found = list(vdwmesh.meshes(self.places, radii=[1.5, 1.7], **options))
            self.assertEqual([one.frame for one in found], [0, 1, 2, 3])
            for place, one in zip(self.places, found):
                expected = vdwmesh.mesh(place, [1.5, 1.7], **{**alone, **options})
                np.testing.assert_array_equal(one.mesh.vertices, expected.vertices)
                np.testing.assert_array_equal(one.mesh.faces, expected.faces)

    def test_wrong_frames_and_options(self):
        self.places[2, 0, 0] = NAN
        for surface in ("vdw", "ses"):
            found = []
            with self.assertRaisesRegex(ValueError, r"^traj: frame 2: coords\[0\]: \(nan, 0.07, -0.05\) is not finite"):
                for one in vdwmesh.meshes(self.places, radii=[1.5, 1.7], surface=surface, threads=2):
                    found.append(one.frame)
            self.assertEqual(found, [0, 1])
        with self.assertRaisesRegex(ValueError, 'fixed_grid: mesher="exact" has no grid'):
            list(vdwmesh.meshes(self.places, radii=[1, 1], mesher="exact", fixed_grid=True))


class MannersTest(unittest.TestCase):
    def test_at_most_two_chunks_are_read_ahead(self):
        read = 0

        def places():
            nonlocal read
            for _ in range(100):
                read += 1
                yield np.zeros((1, 3))

        found = frames_of(places(), radii=[1], chunk=5)
        for number, _ in enumerate(found):
            # Those of this chunk, of the next one, and the one that is waited for.
            self.assertLessEqual(read, 5 * (number // 5 + 2) + 1)

    def test_the_reader_ends_with_the_frames(self):
        before = threading.active_count()
        frames = frames_of((np.zeros((1, 3)) for _ in range(10**6)), radii=[1], chunk=4)
        next(frames)
        frames.close()
        self.assertEqual(threading.active_count(), before)

    def test_ctrl_c(self):
        molecule = vdwmesh.sample("ubiquitin")
        places = np.broadcast_to(molecule.coords, (5000, *molecule.coords.shape))
        for traj in (places, (frame for frame in places)):
            for options in ({"topology": True}, {"probe": 1.4, "chunk": 5000}):
                radii = molecule.radii
                work = lambda: vdwmesh.trajectory(traj, radii=radii, **options)  # noqa: E731
                self.assertLess(seconds_to_stop(self, work), ANSWER)
                if not isinstance(traj, np.ndarray):
                    break  # the generator has an end

    def test_memory_does_not_depend_on_the_number_of_frames(self):
        def resident():
            with open("/proc/self/statm") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")

        def places(count):
            frame = np.random.default_rng(1).random((200, 3)) * 60
            return (frame + i for i in range(count))

        def run(count):
            for _ in frames_of(places(count), radii=np.full(200, 1.5), chunk=16, per_atom=True):
                pass
            gc.collect()
            return resident()

        before = run(1000)
        # 4000 frames more: all coordinates would be 19 MB, all areas 13 MB. What threads leave to the
        # allocator comes and goes by some MB.
        self.assertLess(run(5000) - before, 6 << 20)


class TablesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        places = np.zeros((4, 2, 3))
        places[:, 1, 0] = 0.5, 1, 1.5, 3
        cls.result = vdwmesh.trajectory(places, radii=[1, 1], topology=True, per_atom=True, atoms=[1],
                                        start=1)  # fmt: skip

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_arrays(self):
        result = self.result
        self.assertEqual(len(result), 3)
        self.assertEqual(result.frames.tolist(), [1, 2, 3])
        self.assertIsNone(result.times)
        self.assertEqual(result.components.tolist(), [1, 1, 2])
        self.assertEqual(result.atom_area.shape, (3, 2))
        self.assertTrue(np.isnan(result.atom_area[:, 0]).all())
        np.testing.assert_allclose(result.area / np.pi, [3, 3.5, 4], rtol=1e-12)
        np.testing.assert_array_equal(result.atom_area[:, 1], result.area)

    def test_csv(self):
        path = self.folder / "x.csv"
        self.result.save(path)
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([int(row["frame"]) for row in rows], [1, 2, 3])
        self.assertEqual([float(row["volume"]) for row in rows], self.result.volume.tolist())
        self.assertEqual({row["atom_area_0"] for row in rows}, {""})
        self.assertEqual(float(rows[2]["atom_area_1"]), self.result.atom_area[2, 1])
        self.assertEqual(os.listdir(self.folder), ["x.csv"])

    def test_hdf5(self):
        tables = need_package("python3-tables", module="tables")
        path = self.folder / "x.h5"
        self.result.save(path)
        with tables.open_file(str(path)) as file:
            np.testing.assert_array_equal(file.root.frame[:], self.result.frames)
            np.testing.assert_array_equal(file.root.atom_volume[:], self.result.atom_volume)
            self.assertEqual(file.root.area.attrs.units, "Å²")

    def test_netcdf(self):
        io = need_package("python3-scipy", module="scipy.io")
        path = self.folder / "x.nc"
        self.result.save(str(path))
        with io.netcdf_file(str(path), mmap=False) as file:
            np.testing.assert_array_equal(file.variables["frame"][:], self.result.frames)
            np.testing.assert_array_equal(file.variables["atom_area"][:], self.result.atom_area)
            self.assertEqual(file.variables["area"].units, b"angstrom2")

    def test_pandas(self):
        need_package("python3-pandas", module="pandas")
        found = self.result.to_pandas()
        self.assertEqual(found.index.name, "frame")
        np.testing.assert_array_equal(found["volume"], self.result.volume)
        np.testing.assert_array_equal(found["atom_area_1"], self.result.atom_area[:, 1])

    def test_xarray(self):
        given = {}
        dataset = lambda values, coordinates: given.update(values=values, coords=coordinates)  # noqa: E731
        with mock.patch.dict(sys.modules, xarray=types.SimpleNamespace(Dataset=dataset)):
            self.result.to_xarray()
        self.assertEqual(given["values"]["atom_area"][0], ("frame", "atom"))
        self.assertEqual(given["values"]["area"][2], {"units": "Å²"})
        np.testing.assert_array_equal(given["coords"]["frame"], self.result.frames)

    def test_unknown_extensions_and_places(self):
        with self.assertRaisesRegex(ValueError, "path: x.xlsx ends with none of .csv, .h5, .nc"):
            self.result.save("x.xlsx")
        with self.assertRaises(OSError):
            self.result.save(self.folder / "none" / "x.csv")
        self.assertEqual(os.listdir(self.folder), [])

    def test_no_file_beside_it_is_written_to(self):
        guessed = self.folder / "x.csv.part"
        guessed.write_text("of another")
        self.result.save(self.folder / "x.csv")
        self.assertEqual(guessed.read_text(), "of another")
        self.assertEqual(sorted(os.listdir(self.folder)), ["x.csv", "x.csv.part"])


class MdtrajTest(unittest.TestCase):
    def setUp(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.mdtraj = need_package("python3-mdtraj", module="mdtraj")
            whole = self.mdtraj.load(str(UBIQUITIN))
        protein = whole.atom_slice(whole.topology.select("not water"))
        self.molecule = vdwmesh.read(UBIQUITIN)
        places = jittered(self.molecule, 5) / 10  # nm
        self.traj = self.mdtraj.Trajectory(places, protein.topology, time=np.arange(5) * 2.0)

    def test_trajectories(self):
        found = list(frames_of(self.traj, probe=1.4, chunk=2, topology="counts"))
        self.assertEqual([one.time for one in found], [0, 2, 4, 6, 8])
        for one in found:
            alone = exact_of(self.traj[one.frame], probe=1.4, topology="counts")
            self.assertEqual((one.area, one.counts), (alone.area, alone.counts))

    def test_residues_of_chosen_atoms(self):
        path = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "r.csv"
        self.assertEqual(vdwmesh.residue_table(self.traj, path, select="resSeq 30 to 40", start=4), 1)
        chosen = self.traj[4].atom_slice(self.traj.topology.select("resSeq 30 to 40"))
        alone = vdwmesh.residue_areas(chosen, "protor")
        rows = list(csv.DictReader(path.open(newline="")))
        self.assertEqual([(r["resid"], r["resname"]) for r in rows], list(zip(alone.resids, alone.resnames)))
        np.testing.assert_allclose([float(row["relative"]) for row in rows], alone.relative, rtol=1e-13)

    def test_selections(self):
        chosen = self.traj.topology.select("backbone")
        found = vdwmesh.trajectory(self.traj, select="backbone", step=2)
        self.assertEqual(found.times.tolist(), [0, 4, 8])
        alone = exact_of(self.traj[4].atom_slice(chosen))
        self.assertEqual(found.area[2], alone.area)

    def test_iterload(self):
        with tempfile.TemporaryDirectory() as folder:
            path, top = f"{folder}/x.xtc", f"{folder}/x.pdb"
            self.traj.save(path)
            self.traj[0].save(top)
            loaded = self.mdtraj.load(path, top=top)
            expected = vdwmesh.trajectory(loaded, select="backbone")
            parts = self.mdtraj.iterload(path, top=top, chunk=2)
            found = vdwmesh.trajectory(parts, select="backbone", chunk=3)
        np.testing.assert_array_equal(found.area, expected.area)
        np.testing.assert_array_equal(found.times, expected.times)
        self.assertEqual(found.frames.tolist(), [0, 1, 2, 3, 4])


class MdanalysisTest(unittest.TestCase):
    def setUp(self):
        self.package = need_package("python3-mdanalysis", module="MDAnalysis")
        self.enterContext(warnings.catch_warnings())
        warnings.simplefilter("ignore")
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.universe = self.package.Universe(str(UBIQUITIN))
        self.protein = self.universe.select_atoms("protein")
        moves = np.random.default_rng(1).normal(0, 0.2, (5, len(self.universe.atoms), 3))
        self.places = (self.universe.atoms.positions + moves).astype(np.float32)
        self.paths = {}
        for extension in ("dcd", "xtc"):
            path = self.paths[extension] = f"{folder}/x.{extension}"
            with self.package.Writer(path, len(self.universe.atoms)) as writer:
                for place in self.places:
                    self.universe.atoms.positions = place
                    writer.write(self.universe.atoms)

    def test_files(self):
        for extension, path in self.paths.items():
            universe = self.package.Universe(str(UBIQUITIN), path)
            protein = universe.select_atoms("protein")
            universe.trajectory[3]
            for select, traj in ((None, protein), ("protein", universe)):
                found = list(frames_of(traj, select=select, chunk=2, topology="counts"))
                self.assertEqual(universe.trajectory.frame, 3)  # the universe stays where it is
                for ts, one in zip(universe.trajectory, found):
                    self.assertEqual((one.frame, one.time), (ts.frame, ts.time))
                    alone = exact_of(protein, topology="counts")
                    self.assertEqual((one.area, one.counts), (alone.area, alone.counts), extension)
                universe.trajectory[3]
            self.assertEqual(len(found), 5)

    def test_residues_of_frames(self):
        """Each frame has the rows of residue_areas; united radii leave hydrogens out."""
        universe = self.package.Universe(str(UBIQUITIN), self.paths["dcd"])
        path = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "r.csv"
        for radii, select, step in (("protor", "protein", 2), ("bondi", "resid 5:9", 3)):
            frames = vdwmesh.residue_table(universe, path, radii=radii, select=select, step=step, chunk=1)
            rows = list(csv.DictReader(path.open(newline="")))
            for number in range(frames):
                ts = universe.trajectory[number * step]
                expected = vdwmesh.residue_areas(universe.select_atoms(select), radii)
                part = rows[number * len(expected) : (number + 1) * len(expected)]
                self.assertEqual({(row["frame"], row["time"]) for row in part}, {(str(ts.frame), str(ts.time))})
                self.assertEqual([row["resid"] for row in part], expected.resids.tolist())
                self.assertEqual([row["resname"] for row in part], expected.resnames.tolist())
                self.assertEqual([row["chain"] for row in part], expected.chains.tolist())
                np.testing.assert_allclose([float(row["area"]) for row in part], expected.area, rtol=1e-13)
                shares = [float(row["relative"] or "nan") for row in part]
                np.testing.assert_allclose(shares, expected.relative, rtol=1e-13)
            self.assertEqual((frames, len(rows)), (-(-5 // step), frames * len(expected)))
        hydrogens = self.package.Universe(str(UBIQUITIN))
        hydrogens.atoms[7].element, hydrogens.atoms[7].name = "H", "HG1"
        vdwmesh.residue_table(hydrogens.select_atoms("protein"), path)
        alone = vdwmesh.residue_areas(hydrogens.select_atoms("protein and not element H"), "protor")
        rows = list(csv.DictReader(path.open(newline="")))
        np.testing.assert_allclose([float(row["area"]) for row in rows], alone.area, rtol=1e-13)
        with self.assertRaisesRegex(vdwmesh.InvalidInput, "traj: has no residues"):
            vdwmesh.residue_table(self.places, path)

    def test_slices_and_chosen_atoms(self):
        universe = self.package.Universe(str(UBIQUITIN), self.paths["dcd"])
        protein = universe.select_atoms("protein")
        found = vdwmesh.trajectory(protein, start=-1, stop=0, step=-2, atoms=[7], per_atom=True)
        self.assertEqual(found.frames.tolist(), [4, 2])
        universe.trajectory[2]
        self.assertEqual(found.area[1], exact_of(protein, atoms=[7]).area)

    def test_in_memory(self):
        for order in ("fac", "afc"):
            array = self.places.transpose([("fac").index(axis) for axis in order])
            universe = self.package.Universe(str(UBIQUITIN), np.ascontiguousarray(array), order=order, dt=2.0)
            found = vdwmesh.trajectory(universe, select="protein", start=1)
            self.assertEqual(found.times.tolist(), [2, 4, 6, 8])
            universe.trajectory[2]
            self.assertEqual(found.area[1], exact_of(universe.select_atoms("protein")).area)

    def test_damaged_files(self):
        path = self.paths["xtc"]
        whole = vdwmesh.trajectory(self.package.Universe(str(UBIQUITIN), path)).area
        found = []
        universe = self.package.Universe(str(UBIQUITIN), path)
        with open(path, "r+b") as file:
            file.truncate(pathlib.Path(path).stat().st_size - 100)
        with self.assertRaisesRegex(OSError, "^traj: frame 4 cannot be read"):
            for frame in frames_of(universe, chunk=3):
                found.append(frame.area)
        self.assertEqual(found, whole[:4].tolist())

    def analysis(self, *arguments, **options):
        return importlib.import_module("vdwmesh.mdanalysis").SurfaceAnalysis(*arguments, **options)

    def test_analysis(self):
        universe = self.package.Universe(str(UBIQUITIN), self.paths["xtc"])
        protein = universe.select_atoms("protein")
        for chunk in (1, 2, 64):
            done = self.analysis(protein, probe=1.4, topology="counts", chunk=chunk).run(start=1)
            results = done.results
            self.assertEqual(done.frames.tolist(), [1, 2, 3, 4])
            self.assertEqual(results.residue_area.shape, (4, len(protein.residues)))
            for row, _ in enumerate(universe.trajectory[1:]):
                alone = exact_of(protein, probe=1.4, topology="counts")
                self.assertEqual((results.area[row], results.volume[row]), (alone.area, alone.volume))
                self.assertEqual(results.euler_characteristic[row], alone.counts.euler_characteristic)
                np.testing.assert_array_equal(results.atom_area[row], alone.atom_area)
                np.testing.assert_array_equal(results.residue_area[row],
                                              vdwmesh.sasa(protein, mode="residue"))  # fmt: skip
        results = self.analysis(protein, per_atom=False).run(stop=2).results
        self.assertIsNone(results.atom_area)
        self.assertIsNone(results.euler_characteristic)
        self.assertEqual(len(results.area), 2)

    def test_analysis_in_a_context(self):
        universe = self.package.Universe(str(UBIQUITIN), self.paths["dcd"])
        # In an order of their own; residue 10 comes before residue 2 in neither result.
        part = universe.atoms[universe.select_atoms("resid 2 10 50").ix[::-1]]
        for context in (universe.atoms, universe.select_atoms("protein and not resid 10")):
            results = self.analysis(part, 1.4, context=context).run(frames=[0, 3]).results
            universe.trajectory[3]
            everything = context | part
            chosen = np.isin(everything.ix, part.ix)
            alone = exact_of(everything, probe=1.4, atoms=chosen)
            self.assertEqual(results.area[1], alone.area)
            np.testing.assert_array_equal(results.atom_area[1], alone.atom_area[chosen][::-1])
            for column, residue in enumerate(part.residues):
                of_it = alone.atom_area[np.isin(everything.ix, residue.atoms.ix)].sum()
                self.assertAlmostEqual(results.residue_area[1, column], of_it, places=9)

    def test_an_analysis_of_a_bad_frame_keeps_those_before(self):
        places = self.places.copy()
        places[3, 5, 0] = NAN
        universe = self.package.Universe(str(UBIQUITIN), places)
        for chunk in (2, 64):
            analysis = self.analysis(universe.atoms, chunk=chunk)
            with self.assertRaisesRegex(ValueError, "^traj: frame 3, atom 5: "):
                analysis.run()
            whole = vdwmesh.trajectory(universe, stop=3)
            np.testing.assert_array_equal(analysis.results.area, whole.area)
        with self.assertRaisesRegex(ValueError, "radii: has 1 radii"):
            self.analysis(universe.atoms, radii=[1])
        with self.assertRaisesRegex(ValueError, "ag: has no atoms"):
            self.analysis(universe.atoms[:0])

    def test_nothing_selected(self):
        with self.assertRaisesRegex(ValueError, "select: 'resname NONE' chooses no atom"):
            frames_of(self.universe, select="resname NONE")


if __name__ == "__main__":
    unittest.main()
