"""vdwmesh-mpi: the same results from any number of ranks, and how all of them end where one fails."""

import contextlib
import functools
import json
import os
import re
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

from program import BAD_INPUT, DONE, LIMIT_HIT, SOURCE_DIR, UBIQUITIN, ProgramTest, missing, need_package, need_shared, run

RANKS_PROGRAM = os.environ["VDWMESH_RANKS_PROGRAM"]
MPIRUN = os.environ["VDWMESH_MPIRUN"]
HAS_HDF5 = os.environ["VDWMESH_RANKS_HDF5"] == "1"
# Open MPI wants to be asked twice before root may start ranks.
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

ONE_ATOM = "0 0 0 1.7\n"
FAR_APART = "0 0 0 1.7\n50 0 0 1.2\n0 60 3 1.5\n1 2 300 2\n"
TWINS = "0 0 0 1.7\n1 0 0 1.7\n0 0 0 1.7\n"
FLAT = "".join(f"{1.5 * x} {1.5 * y} 0 1.6\n" for x in range(30) for y in range(30))


def command(ranks, *arguments, quiet=("-q",)):
    return [MPIRUN, *quiet, "--oversubscribe", "-n", str(ranks), RANKS_PROGRAM, *map(str, arguments)]


def run_ranks(ranks, *arguments, quiet=("-q",), **options):
    return subprocess.run(command(ranks, *arguments, quiet=quiet), capture_output=True, text=True, timeout=300,
                          env=ENVIRONMENT, **options)  # fmt: skip


def need_hdf5():
    if not HAS_HDF5:
        missing("VDWMESH_REQUIRE_PACKAGES", "vdwmesh-mpi was built without libhdf5-openmpi-dev")


class RanksTest(ProgramTest):
    def run_ranks_ok(self, ranks, *arguments, **options):
        """mpirun says why it fails, as it would not with -q. Where it could not even start the ranks, which say
        themselves why they fail, it is asked once more, and its first answer stands in the log."""
        result = run_ranks(ranks, *arguments, quiet=(), **options)
        if result.returncode != DONE and "vdwmesh-mpi: " not in result.stderr and "stdin" not in options:
            print(f"mpirun ended with {result.returncode}: {result.stderr}", file=sys.stderr)
            result = run_ranks(ranks, *arguments, quiet=(), **options)
        self.assertEqual(result.returncode, DONE, result.stderr)
        return result

    def assert_all_end(self, status, *arguments, says=(), ranks=3, **options):
        """All ranks end, and one line says why. mpirun -q adds none of its own."""
        before = self.files()
        result = run_ranks(ranks, *arguments, **options)
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertRegex(result.stderr, r"\Avdwmesh-mpi: [^\n]+\n\Z")
        for word in says:
            self.assertIn(word, result.stderr)
        self.assertEqual(self.files(), before)


class Meshes(RanksTest):
    """The file is that of the plain program, byte by byte, and so is the report but for times, ranks and memory."""

    def mesh(self, start, *arguments):
        """Standard error, the bytes of the mesh and the lines of the report."""
        mesh, report = self.folder / "mesh.ply", self.folder / "report.json"
        result = start("mesh", *arguments, "-o", mesh, "--quiet", "--json", report)
        document = re.sub(r'"timing": \{.*?\}\s*\}', "", report.read_text(), flags=re.DOTALL)
        self.assertNotIn('"total"', document)
        document = re.sub(r'"made by [^"]*each",?', "", document)
        document = re.sub(r",\s*\]", "]", document)
        document = re.sub(r'"(memory_limit|memory_estimate|threads)": \w+', "", document)
        document = re.sub(r'"seconds": [-+.e\w]+', "", document)  # of the arrangement
        return result.stderr.replace("vdwmesh-mpi", "vdwmesh"), mesh.read_bytes(), document

    def assert_same_file(self, path, *options, ranks):
        # Without any option the plain program follows the creases, and ranks do not.
        if "--spacing" not in options and "--mesher" not in options:
            options = (*options, "--spacing", "0.5")
        errors, mesh, report = self.mesh(self.run_ok, path, "--backend", "cpu", *options)
        for count in ranks:
            with self.subTest(path=str(path), options=options, ranks=count):
                start = functools.partial(self.run_ranks_ok, count)
                ours = self.mesh(start, path, "--backend", "cpu", *options)
                self.assertTrue(ours[1] == mesh, "the files differ")
                self.assertEqual(re.sub(r"\s", "", ours[2]), re.sub(r"\s", "", report))
                self.assertEqual(ours[0], errors)
        return mesh

    def test_any_number_of_ranks(self):
        self.assert_same_file(UBIQUITIN, ranks=(1, 2, 3, 5, 7))
        self.assert_same_file(UBIQUITIN, "--field", "blinn", ranks=(2, 5))

    def test_few_and_far_atoms(self):
        """One atom, fewer bricks than ranks, pieces far apart, all bricks in one layer."""
        for name, text in (("one", ONE_ATOM), ("far", FAR_APART), ("twins", TWINS), ("flat", FLAT)):
            path = self.file(f"{name}.xyzr", text)
            self.assert_same_file(path, ranks=(2, 7))
            self.assert_same_file(path, "--spacing", "0.3", "--field", "soft", ranks=(3,))

    def test_every_field_and_preset(self):
        for field in ("blinn", "soft", "inverse-squared"):
            for preset in ("radius-aware", "thesis", "thesis-vdw"):
                self.assert_same_file(UBIQUITIN, "--field", field, "--preset", preset, "--spacing",
                                      "0.7", ranks=(3,))  # fmt: skip

    def test_surfaces_that_the_grid_cuts(self):
        self.assert_same_file(UBIQUITIN, "--padding", "0", "--field", "blinn", ranks=(3,))

    def test_reference_molecules(self):
        for path in sorted(need_shared("molecules/thesis").iterdir()):
            self.assert_same_file(path, "--spacing", "0.8", ranks=(3,))

    def test_sparse_sets(self):
        for path in sorted(need_shared("molecules/sparse").glob("*.xyzr")):
            self.assert_same_file(path, "--probe", "1.4", ranks=(3,))

    REFINED = ("--spacing", "1", "--crossings", "allow")

    def test_subdivisions(self):
        """Moves that turn triangles are taken back on borders too."""
        for level, ranks in ((1, (1, 2, 3, 5, 7)), (2, (2, 7))):
            self.assert_same_file(UBIQUITIN, *self.REFINED, "--subdivide", level, ranks=ranks)
        self.assertGreater(json.loads((self.folder / "report.json").read_text())["mesh"]["newton"]["undone"], 20)

    def test_subdivisions_of_every_field_and_projection(self):
        for field in ("blinn", "soft", "inverse-squared"):
            self.assert_same_file(UBIQUITIN, *self.REFINED, "--subdivide", "1", "--field", field, ranks=(3,))
        self.assert_same_file(UBIQUITIN, *self.REFINED, "--subdivide", "1", "--field", "soft", "--project", "vdw", ranks=(3,))
        self.assert_same_file(UBIQUITIN, "--spacing", "1", "--subdivide", "1", "--project", "none", ranks=(3,))

    def test_subdivisions_of_few_and_far_atoms(self):
        for name, text in (("one", ONE_ATOM), ("far", FAR_APART), ("twins", TWINS), ("flat", FLAT)):
            path = self.file(f"{name}.xyzr", text)
            self.assert_same_file(path, *self.REFINED, "--subdivide", "2", ranks=(3, 7))

    def test_subdivisions_of_reference_molecules(self):
        for path in sorted(need_shared("molecules/thesis").iterdir()):
            self.assert_same_file(path, "--spacing", "1.6", "--crossings", "allow", "--subdivide", "1", ranks=(3,))

    def test_subdivisions_of_sparse_sets(self):
        for path in sorted(need_shared("molecules/sparse").glob("*.xyzr")):
            self.assert_same_file(path, *self.REFINED, "--probe", "1.4", "--subdivide", "2", ranks=(3,))

    EXACT = ("--mesher", "exact", "--edge-length", "0.8")

    def test_crease_exact(self):
        """Every rank splits the pieces of arcs that any of them wants split."""
        self.assert_same_file(UBIQUITIN, *self.EXACT, ranks=(1, 2, 3, 5, 7))
        self.assertGreater(json.loads((self.folder / "report.json").read_text())["mesh"]["arrangement"]["split"], 1000)
        self.assert_same_file(UBIQUITIN, *self.EXACT, "--probe", "1.4", "--relative-edge", "0.3", ranks=(3,))

    def test_crease_exact_with_lengths_of_atoms(self):
        """The first rank alone knows the atoms."""
        self.assert_same_file(UBIQUITIN, *self.EXACT, "--edge-length-of", "A/10-40=0.3", ranks=(2,))

    def test_crease_exact_levels(self):
        for level, ranks in ((1, (1, 2, 3, 5, 7)), (2, (2, 7))):
            self.assert_same_file(UBIQUITIN, *self.EXACT, "--subdivide", level, ranks=ranks)
        self.assert_same_file(UBIQUITIN, *self.EXACT, "--subdivide", "1", "--project", "none", ranks=(3,))

    def test_crease_exact_of_joined_corners(self):
        """Cubes of a lattice meet in points and in edges, where fans of triangles are parted across ranks; and balls
        that touch."""
        lattice = [(x, y, z) for x in range(4) for y in range(4) for z in range(4)]
        corners = "".join(f"{x} {y} {z} {3 ** 0.5 / 2!r}\n" for x, y, z in lattice)
        touching = "".join(f"{2 * x} {2 * y} {2 * z} 1\n" for x, y, z in lattice)
        checkers = "".join(f"{x} {y} {z} {3 ** 0.5 / 2!r}\n" for x, y, z in lattice if (x + y + z) % 2 == 0)
        for name, text in (("corners", corners), ("touching", touching), ("checkers", checkers), ("one", ONE_ATOM),
                           ("far", FAR_APART), ("twins", TWINS)):  # fmt: skip
            path = self.file(f"{name}.xyzr", text)
            self.assert_same_file(path, *self.EXACT, ranks=(2, 5))
            self.assert_same_file(path, *self.EXACT, "--subdivide", "1", ranks=(3,))

    def test_crease_exact_of_reference_molecules(self):
        for path in sorted(need_shared("molecules/thesis").iterdir()):
            self.assert_same_file(path, *self.EXACT, ranks=(3,))

    def test_crease_exact_of_sparse_sets(self):
        for path in sorted(need_shared("molecules/sparse").glob("*.xyzr")):
            if path.name not in ("pencil4.xyzr", "pencil4b.xyzr"):
                self.assert_same_file(path, *self.EXACT, "--subdivide", "1", ranks=(3,))

    def test_curves_that_cannot_be_told_apart(self):
        """All ranks give up alike, with the line of the plain program."""
        path = need_shared("molecules/sparse") / "pencil4.xyzr"
        mesh = ("mesh", path, "-o", self.folder / "a.ply", *self.EXACT)
        plain = run(*mesh)
        self.assertEqual(plain.returncode, LIMIT_HIT)
        ranks = run_ranks(3, *mesh)
        self.assertEqual(ranks.returncode, LIMIT_HIT)
        self.assertEqual(ranks.stderr, plain.stderr.replace("vdwmesh: ", "vdwmesh-mpi: "))

    def test_standard_input_is_of_the_first_rank(self):
        expected = self.assert_same_file(UBIQUITIN, ranks=())
        with open(UBIQUITIN) as text:
            self.run_ranks_ok(2, "mesh", "-", "--format", "pdb", "-o", self.folder / "a.ply", stdin=text)
        self.assertEqual((self.folder / "a.ply").read_bytes(), expected)

    def test_a_file_is_replaced_and_keeps_its_permissions(self):
        path = self.file("a.ply", "old")
        path.chmod(0o640)
        self.run_ranks_ok(2, "mesh", UBIQUITIN, "-o", path, "--spacing", "1")
        self.assertEqual(path.stat().st_mode & 0o777, 0o640)
        self.assertTrue(path.read_bytes().startswith(b"ply"))

    def test_pieces_that_the_mesh_joins(self):
        """Two rods that are 0.1 Å apart, which a spacing of 0.9 Å cannot tell apart; ranks count them together."""
        rods = "".join(f"{1.1 * x} {2.1 * y} 0 1\n" for x in range(40) for y in range(2))
        path = self.file("rods.xyzr", rods)
        for count in (1, 4):
            report = self.folder / "r.json"
            self.run_ranks_ok(count, "mesh", path, "-o", self.folder / "a.ply", "--spacing", "0.9", "--json", report)
            self.assertIn("components: 1 in the mesh, 2 in the union of the spheres", report.read_text())

    def test_text(self):
        text = self.run_ranks_ok(3, "mesh", UBIQUITIN, "-o", self.folder / "a.ply").stdout
        self.assertIn("44650 vertices, 89676 triangles; closed, 2-manifold, oriented", text)
        self.assertRegex(text, r"(?m)^Euler characteristic +-188$")
        self.assertRegex(text, r"(?m)^Note +made by 3 ranks, 1 CPU thread each$")


def read_ply(path):
    """Vertices and corners of triangles, as numpy.fromfile() reads the records that the header describes."""
    numpy = need_package("python3-numpy", module="numpy")
    data = path.read_bytes()
    begin = data.index(b"end_header\n") + len(b"end_header\n")
    vertices, faces = (int(re.search(rb"element %s (\d+)" % what, data)[1]) for what in (b"vertex", b"face"))
    vertex = [("position", "<f8", 3), ("normal", "<f4", 3), ("color", "u1", 3), ("atom", "<i4"), ("others", "<i4", 2)]
    vertex, face = numpy.dtype(vertex), numpy.dtype([("count", "u1"), ("corners", "<i4", 3)])
    middle = begin + vertices * vertex.itemsize
    return (numpy.frombuffer(data[begin:middle], vertex, vertices), numpy.frombuffer(data[middle:], face, faces)["corners"])


class VtkHdf(RanksTest):
    """VTK reads what a PLY file of the same mesh has, and the bytes are the same for any number of ranks."""

    @classmethod
    def setUpClass(cls):
        need_hdf5()
        cls.hdf = need_package("python3-vtk9", module="vtkmodules.vtkIOHDF")
        cls.arrays = need_package("python3-vtk9", module="vtkmodules.util.numpy_support")

    def read(self, path):
        reader = self.hdf.vtkHDFReader()
        self.assertTrue(reader.CanReadFile(str(path)))
        reader.SetFileName(str(path))
        reader.Update()
        return reader.GetOutputAsDataSet()

    def assert_equal_arrays(self, ours, expected):
        self.assertEqual(ours.shape, expected.shape)
        self.assertTrue((ours == expected).all())

    def assert_reads_back(self, path, *options, ranks):
        ply, hdf = self.folder / "a.ply", self.folder / "a.vtkhdf"
        self.run_ok("mesh", path, "-o", ply, "--mesher", "marching-cubes", "--quiet", "--backend", "cpu", *options)
        files = set()
        for count in ranks:
            self.run_ranks_ok(count, "mesh", path, "-o", hdf, "--quiet", "--backend", "cpu", *options)
            files.add(hdf.read_bytes())
        self.assertEqual(len(files), 1)
        vertices, corners = read_ply(ply)
        grid, numpy_of = self.read(hdf), self.arrays.vtk_to_numpy
        self.assert_equal_arrays(numpy_of(grid.GetPoints().GetData()), vertices["position"])
        self.assert_equal_arrays(numpy_of(grid.GetCells().GetConnectivityArray()).reshape(-1, 3), corners)
        self.assertEqual({grid.GetCellType(t) for t in (0, len(corners) - 1)}, {5})
        self.assertEqual(grid.GetNumberOfCells(), len(corners))
        points = grid.GetPointData()
        for name, column in (("Normals", "normal"), ("RGB", "color"), ("atom", "atom")):
            self.assert_equal_arrays(numpy_of(points.GetArray(name)), vertices[column])

    def test_any_number_of_ranks(self):
        self.assert_reads_back(UBIQUITIN, "--spacing", "0.7", ranks=(1, 2, 3, 5))
        self.assert_reads_back(UBIQUITIN, "--spacing", "1", "--field", "blinn", ranks=(3,))
        self.assert_reads_back(UBIQUITIN, "--spacing", "1", "--subdivide", "1", "--crossings", "allow", ranks=(1, 3))

    def test_few_and_far_atoms(self):
        for name, text in (("one", ONE_ATOM), ("far", FAR_APART)):
            self.assert_reads_back(self.file(f"{name}.xyzr", text), ranks=(1, 7))


class ExactUnions(RanksTest):
    """Report and table of atoms are those of the plain program, byte by byte but for the times."""

    def results(self, start, *arguments):
        """Standard output, the JSON report and the table of atoms, without times."""
        report, atoms = self.folder / "r.json", self.folder / "a.csv"
        result = start("exact", *arguments, "--json", report, "--per-atom", atoms)
        text = re.sub(r"(?m)^(Time|CPU) \(s\).*$", "", result.stdout)
        document = re.sub(r'("timing": \{.*?\})\s*\}', "", report.read_text(), flags=re.DOTALL)
        self.assertNotIn('"total"', document)
        return text, document, atoms.read_text(), result.stderr

    def assert_same_results(self, path, *options, ranks, topology="counts"):
        plain = self.results(self.run_ok, path, "--topology", topology, "--backend", "cpu", *options)
        for count in ranks:
            with self.subTest(path=str(path), options=options, ranks=count):
                start = functools.partial(self.run_ranks_ok, count)
                together = self.results(start, path, "--topology", topology, *options)
                for ours, expected in zip(together, plain):
                    self.assertEqual(ours, expected)
        return plain

    def test_any_number_of_ranks(self):
        self.assert_same_results(UBIQUITIN, ranks=(1, 2, 3, 5, 7))
        self.assert_same_results(UBIQUITIN, "--probe", "1.4", ranks=(2, 3, 5))
        self.assert_same_results(UBIQUITIN, topology="off", ranks=(3,))

    def test_chosen_atoms_residues_and_polarity(self):
        self.assert_same_results(UBIQUITIN, "--radii", "protor", "--probe", "1.4", "--group", "residue", ranks=(3,))
        for topology in ("counts", "off"):
            self.assert_same_results(UBIQUITIN, "--measure", "(LYS)", topology=topology, ranks=(5,))

    def test_few_and_far_atoms(self):
        for name, text in (("one", ONE_ATOM), ("far", FAR_APART), ("twins", TWINS), ("flat", FLAT)):
            self.assert_same_results(self.file(f"{name}.xyzr", text), ranks=(2, 7))

    def test_components_that_many_ranks_share(self):
        """Rods along x that the shares cut, and one that joins two of them."""
        rods = "".join(f"{1.1 * x} {10 * y} {0.1 * (x % 7)} {1.6 + 0.01 * (x % 3)}\n" for y in range(5) for x in range(100))
        path = self.file("rods.xyzr", rods + "".join(f"40.3 {y}.2 0.1 1.6\n" for y in range(1, 10)))
        text = self.assert_same_results(path, ranks=(2, 7))[0]
        self.assertRegex(text, r"(?m)^Components +4$")

    def test_spheres_that_the_arcs_cannot_measure(self):
        """A cubic lattice: four circles meet in a point."""
        lattice = "".join(f"{x} {y} {z} 0.9\n" for x in range(4) for y in range(4) for z in range(12))
        document = self.assert_same_results(self.file("cubes.xyzr", lattice), ranks=(2, 5))[1]
        self.assertGreater(int(re.search(r'"fallback_spheres": (\d+)', document)[1]), 0)

    def test_reference_molecules(self):
        for path in sorted(need_shared("molecules/thesis").iterdir()):
            self.assert_same_results(path, ranks=(3,))

    def test_sparse_sets(self):
        for path in sorted(need_shared("molecules/sparse").glob("*.xyzr")):
            self.assert_same_results(path, "--probe", "1.4", ranks=(3,))

    def test_ranks_that_cannot_share_memory_take_copies(self):
        """The first rank may make no file of the size of the spheres, not even in memory."""
        limited = 'if [ "$OMPI_COMM_WORLD_RANK" = 0 ]; then ulimit -f 1; trap "" XFSZ; fi; exec "$@"'
        start = command(3, "exact", UBIQUITIN)
        expected = subprocess.run(start, capture_output=True, text=True, timeout=300, env=ENVIRONMENT)
        place = start.index(RANKS_PROGRAM)
        start[place:place] = ["bash", "-c", limited, "bash"]
        result = subprocess.run(start, capture_output=True, text=True, timeout=300, env=ENVIRONMENT)
        self.assertEqual(result.returncode, DONE, result.stderr)
        times = r"(?m)^(Time|CPU) \(s\).*$"
        self.assertEqual(re.sub(times, "", result.stdout), re.sub(times, "", expected.stdout))

    def test_json_on_standard_output_is_of_the_first_rank(self):
        self.run_ranks_ok(3, "exact", UBIQUITIN, "--json", self.folder / "file.json")
        text = self.run_ranks_ok(3, "exact", UBIQUITIN, "--json", "-").stdout
        self.assertEqual(text.count('"schema"'), 1)


class Faults(RanksTest):
    def mesh(self, *options, path=UBIQUITIN, to="a.ply"):
        return ("mesh", path, "-o", self.folder / to, *options)

    def test_wrong_options(self):
        self.assert_all_end(BAD_INPUT, *self.mesh("--spacing", "0"), says=("--spacing",))
        self.assert_all_end(BAD_INPUT, *self.mesh("--mesher", "exact", "--spacing", "1"), says=("--edge-length",))
        cubes = self.mesh("--mesher", "marching-cubes", "--edge-length", "1")
        self.assert_all_end(BAD_INPUT, *cubes, says=("--edge-length", "--spacing"))
        self.assert_all_end(BAD_INPUT, *self.mesh("--subdivide", "1"), says=("--crossings allow",))
        self.assert_all_end(BAD_INPUT, *self.mesh(to="a.stl"), says=(".ply", ".vtkhdf"))
        if not HAS_HDF5:
            self.assert_all_end(BAD_INPUT, *self.mesh(to="a.vtkhdf"), says=("HDF5", ".ply"))
        self.assert_all_end(BAD_INPUT, "mesh", UBIQUITIN, "-o", self.folder / "no" / "a.ply",
                            says=("there is no folder",))  # fmt: skip
        self.assert_all_end(BAD_INPUT, "mesh", UBIQUITIN, "-o", "/dev/null", says=("/dev/null",))
        self.assert_all_end(BAD_INPUT, "report", UBIQUITIN, says=("not a verb",))

    def test_wrong_options_of_exact(self):
        exact = ("exact", UBIQUITIN)
        self.assert_all_end(BAD_INPUT, *exact, "--topology", "on", says=("vdwmesh exact", "counts"))
        self.assert_all_end(BAD_INPUT, *exact, "--method", "cgal", says=("--method",))
        self.assert_all_end(BAD_INPUT, *exact, "--measure", "(XYZ)", says=("XYZ",))
        self.assert_all_end(BAD_INPUT, *exact, "--probe=-9", says=("--probe",))
        self.assert_all_end(BAD_INPUT, *exact, "--json", self.folder / "no" / "a.json", says=("--json",))

    def test_a_report_that_cannot_be_written(self):
        self.assert_all_end(BAD_INPUT, "exact", UBIQUITIN, "--json", "/dev/full", says=("/dev/full",))

    def test_unreadable_files(self):
        self.assert_all_end(BAD_INPUT, *self.mesh(path=self.folder / "none.pdb"), says=("none.pdb",))
        self.assert_all_end(BAD_INPUT, *self.mesh(path=self.file("a.xyzr", "0 0 x 1\n")), says=("a.xyzr",))

    def test_grids_that_make_no_mesh(self):
        self.assert_all_end(BAD_INPUT, *self.mesh("--spacing", "1e3"), says=("too coarse",))
        self.assert_all_end(BAD_INPUT, *self.mesh("--field", "blinn", "--isovalue", "1e6"),
                            says=("--isovalue",))  # fmt: skip

    def test_memory_limit_of_a_rank(self):
        self.assert_all_end(LIMIT_HIT, *self.mesh("--spacing", "0.1", "--memory-limit", "60M"),
                            says=("more ranks",))  # fmt: skip
        self.run_ranks_ok(7, *self.mesh("--spacing", "0.1", "--memory-limit", "60M"))
        refined = self.mesh("--spacing", "0.7", "--memory-limit", "60M", "--subdivide", "3", "--crossings", "allow")
        self.assert_all_end(LIMIT_HIT, *refined, says=("more ranks", "fewer subdivisions"))
        self.run_ranks_ok(7, *refined)
        exact = ("exact", self.file("a.xyzr", FLAT), "--memory-limit", "250K")
        self.assert_all_end(LIMIT_HIT, *exact, ranks=1, says=("more ranks", "--memory-limit 1M"))

    def assert_full_disk_ends_all(self, rank, says, to="a.ply"):
        """The size of files is limited for one rank of three; the others end with it."""
        limited = f'if [ "$OMPI_COMM_WORLD_RANK" = {rank} ]; then ulimit -f 100; trap "" XFSZ; fi; exec "$@"'
        start = command(3, *self.mesh(to=to))
        place = start.index(RANKS_PROGRAM)
        start[place:place] = ["bash", "-c", limited, "bash"]
        result = subprocess.run(start, capture_output=True, text=True, timeout=300, env=ENVIRONMENT)
        self.assertEqual(result.returncode, BAD_INPUT, result.stderr)
        self.assertRegex(result.stderr, rf"(?m)^vdwmesh-mpi: {says}")
        self.assertEqual(result.stderr.count("vdwmesh-mpi:"), 1, result.stderr)
        self.assertEqual(self.files(), [])

    def test_a_file_that_cannot_be_written_in_full(self):
        self.assert_full_disk_ends_all(1, r"rank 1: .*a\.ply cannot be written in full")

    def test_a_vtkhdf_file_that_cannot_be_written_in_full(self):
        """The first rank cannot give its scratch file the length, or another one cannot write its part."""
        need_hdf5()
        scratch = r".*a\.vtkhdf: the scratch file /[^ ]*/vdwmesh-\w+ cannot be written: File too large; TMPDIR .*$"
        self.assert_full_disk_ends_all(0, scratch, to="a.vtkhdf")
        self.assert_full_disk_ends_all(1, r"rank 1: .*a\.vtkhdf cannot be written in full", to="a.vtkhdf")

    def test_a_folder_for_scratch_files_that_cannot_be_written(self):
        """The folder is said, which is not that of the output."""
        need_hdf5()
        scratch = self.folder / "scratch"
        scratch.write_text("no folder")
        # mpirun keeps files in TMPDIR too, so only the ranks get this one.
        start = command(2, *self.mesh(to="a.vtkhdf"))
        start[start.index(RANKS_PROGRAM):start.index(RANKS_PROGRAM)] = ["env", f"TMPDIR={scratch}"]  # fmt: skip
        result = subprocess.run(start, capture_output=True, text=True, timeout=300, env=ENVIRONMENT)
        self.assertEqual(result.returncode, BAD_INPUT, result.stderr)
        self.assertRegex(result.stderr, r"\Avdwmesh-mpi: [^\n]*a\.vtkhdf: [^\n]*scratch[^\n]*TMPDIR[^\n]*\n\Z")
        self.assertEqual(self.files(), ["scratch"])

    def end_while_writing(self, end, to="a.ply"):
        """Starts a run, stops its ranks as soon as its file is being written, calls end(process, ranks), lets them
        go on, and returns the exit status. Stopped ranks cannot complete the file in the meantime."""
        process = subprocess.Popen(command(3, *self.mesh("--spacing", "0.1", "--quiet", to=to)), env=ENVIRONMENT,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
        ranks = []
        while len(ranks) < 3 and process.poll() is None:
            ranks = self.children(process)
        while not self.files() and process.poll() is None:
            time.sleep(0.001)
        for rank in ranks:
            os.kill(rank, signal.SIGSTOP)
        self.assertNotIn(to, self.files(), "the ranks were faster than this test")
        end(process, ranks)
        for rank in ranks:
            with contextlib.suppress(ProcessLookupError):
                os.kill(rank, signal.SIGCONT)
        return process.wait(timeout=120)

    def children(self, process):
        with contextlib.suppress(OSError):
            return [int(pid) for pid in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]
        return []

    def test_a_killed_rank_ends_all_and_leaves_nothing(self):
        for which in (0, -1):
            status = self.end_while_writing(lambda _, ranks: os.kill(ranks[which], signal.SIGKILL))
            self.assertNotEqual(status, 0)
            self.assertEqual(self.files(), [])

    def test_a_killed_rank_leaves_no_vtkhdf_file(self):
        need_hdf5()
        status = self.end_while_writing(lambda _, ranks: os.kill(ranks[1], signal.SIGKILL), to="a.vtkhdf")
        self.assertNotEqual(status, 0)
        self.assertEqual(self.files(), [])

    def whole_size(self):
        path = self.folder / "whole.ply"
        self.run_ok("mesh", UBIQUITIN, "-o", path, "--spacing", "0.1", "--quiet")
        return path.stat().st_size

    def test_a_stopped_run_leaves_no_half_file(self):
        """The ranks may get as far as to give the file its name before they hear of the end."""
        self.end_while_writing(lambda mpirun, _: mpirun.terminate())
        self.assertIn(self.files(), ([], ["a.ply"]))
        for name in self.files():
            self.assertEqual((self.folder / name).stat().st_size, self.whole_size())


class Help(RanksTest):
    def test_it_is_printed_once(self):
        text = self.run_ranks_ok(3, "--help").stdout
        self.assertEqual(text.count("Usage: mpirun -n P vdwmesh-mpi VERB"), 1)
        self.assertRegex(self.run_ranks_ok(2, "--version").stdout, r"\Avdwmesh-mpi [^\n]+\nbuild [^\n]+\n\Z")

    def test_every_option_is_in_the_table(self):
        table = (SOURCE_DIR / "docs" / "options.md").read_text()
        for verb in re.findall(r"^  (\w+) {10}", self.run_ranks_ok(1, "--help").stdout, re.M):
            told = set(re.findall(r"--[a-z-]+", self.run_ranks_ok(1, verb, "--help").stdout)) - {"--help"}
            self.assertGreater(len(told), 10)
            self.assertEqual({o for o in told if f"`{o}`" not in table}, set())

    def test_the_plain_program_does_not_load_mpi(self):
        libraries = subprocess.run(["ldd", os.environ["VDWMESH_PROGRAM"]], capture_output=True, text=True)
        self.assertNotIn("libmpi", libraries.stdout)


if __name__ == "__main__":
    unittest.main()
