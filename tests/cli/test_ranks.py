"""vdwmesh-mpi: the same results from any number of ranks, and how all of them end where one fails."""

import collections
import concurrent.futures
import contextlib
import functools
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from program import (BAD_INPUT, DONE, LIMIT_HIT, SOURCE_DIR, UBIQUITIN, ProgramTest, missing, need_package, need_shared,
                     ranks_environment, run)  # fmt: skip

RANKS_PROGRAM = os.environ["VDWMESH_RANKS_PROGRAM"]
MPIRUN = os.environ["VDWMESH_MPIRUN"]
HAS_HDF5 = os.environ["VDWMESH_RANKS_HDF5"] == "1"

ONE_ATOM = "0 0 0 1.7\n"
FAR_APART = "0 0 0 1.7\n50 0 0 1.2\n0 60 3 1.5\n1 2 300 2\n"
TWINS = "0 0 0 1.7\n1 0 0 1.7\n0 0 0 1.7\n"
FLAT = "".join(f"{1.5 * x} {1.5 * y} 0 1.6\n" for x in range(30) for y in range(30))


FIELDS = ("blinn", "soft", "inverse-squared")
COUNTS = ("--topology", "counts")
LEVELS = ((1, (1, 2, 3, 5, 7)), (2, (2, 7)))  # of subdivision, and by how many ranks


def thesis_molecules():
    return sorted(need_shared("molecules/thesis").iterdir())


def sparse_sets():
    return sorted(need_shared("molecules/sparse").glob("*.xyzr"))


def mpirun(ranks, program):
    return [MPIRUN, "--oversubscribe", "-n", str(ranks), program]


def command(ranks, *arguments):
    return [*mpirun(ranks, RANKS_PROGRAM), *map(str, arguments)]


def run_start(start, **options):
    """The result of one mpirun. What mpirun itself says is `mpirun_stderr` alone: of a failure, in frames of dashes, and
    lines that begin with [HOST:PID] or [warn]. Open MPI 5 now and then adds bytes 0 to what a rank wrote."""
    result = subprocess.run(start, capture_output=True, text=True, timeout=300, env=ranks_environment(), **options)
    result.mpirun_stderr = result.stderr
    result.stderr = re.sub(r"(?m)^(-{40,})\n(?:.*\n)*?\1\n|^\[(warn|[\w.-]+:\d+)\] .*\n", "", result.stderr)
    result.stdout, result.stderr = (text.replace("\0", "") for text in (result.stdout, result.stderr))
    return result


def run_ranks(ranks, *arguments, **options):
    return run_start(command(ranks, *arguments), **options)


def at_once(calls):
    """The results of functions without arguments. A start takes some tenths of a second, in which processes wait for
    each other and cores have nothing to do, so several runs are under way at the same time."""
    with concurrent.futures.ThreadPoolExecutor(4) as threads:
        return [result.result() for result in [threads.submit(call) for call in calls]]


def need_hdf5():
    if not HAS_HDF5:
        missing("VDWMESH_REQUIRE_PACKAGES", "vdwmesh-mpi was built without libhdf5-openmpi-dev")


class RanksTest(ProgramTest):
    def few_and_far(self):
        """One atom, fewer atoms than ranks, pieces far apart, and all in one plane."""
        sets = (("one", ONE_ATOM), ("far", FAR_APART), ("twins", TWINS), ("flat", FLAT))
        return [self.file(f"{name}.xyzr", text) for name, text in sets]

    def run_ranks_ok(self, ranks, *arguments, **options):
        """Where mpirun could not even start the ranks, which say themselves why they fail, it is asked once more, and
        its first answer stands in the log."""
        result = run_ranks(ranks, *arguments, **options)
        if result.returncode != DONE and "vdwmesh-mpi: " not in result.stderr and "stdin" not in options:
            print(f"mpirun ended with {result.returncode}: {result.mpirun_stderr}", file=sys.stderr)
            result = run_ranks(ranks, *arguments, **options)
        self.assertEqual(result.returncode, DONE, f"{ranks} ranks, {arguments}: {result.mpirun_stderr}")
        return result

    def assert_all_end(self, status, *arguments, says=(), ranks=3, **options):
        """All ranks end, and one line says why."""
        self.assert_each_ends(status, (arguments, says), ranks=ranks, **options)

    def assert_each_ends(self, status, *cases, ranks=3, **options):
        """The same for several cases, each of arguments and of what the line must say."""
        before = self.files()
        results = at_once(functools.partial(run_ranks, ranks, *arguments, **options) for arguments, _ in cases)
        for (arguments, says), result in zip(cases, results):
            with self.subTest(arguments=arguments):
                self.assertEqual(result.returncode, status, result.stderr)
                self.assertEqual(result.stdout, "")
                self.assertRegex(result.stderr, r"\Avdwmesh-mpi: [^\n]+\n\Z")
                for word in says:
                    self.assertIn(word, result.stderr)
        self.assertEqual(self.files(), before)


# Standard error, a hash of the mesh file, and the report with and without what may differ.
Made = collections.namedtuple("Made", "errors digest document report")


class MeshTest(RanksTest):
    """Compares meshes and their reports with those of the plain program."""

    def mesh(self, start, *arguments):
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            mesh, path = Path(folder) / "mesh.ply", Path(folder) / "report.json"
            result = start("mesh", *arguments, "-o", mesh, "--quiet", "--json", path)
            digest, report = hashlib.sha256(mesh.read_bytes()).hexdigest(), path.read_text()
        document = re.sub(r'"timing": \{.*?\}\s*\}', "", report.replace(folder, ""), flags=re.DOTALL)
        self.assertNotIn('"total"', document)
        document = re.sub(r'"made by [^"]*each",?', "", document)
        document = re.sub(r",\s*\]", "]", document)
        document = re.sub(r'"(memory_limit|memory_estimate|threads)": \w+', "", document)
        document = re.sub(r'"seconds": [-+.e\w]+', "", document)  # of the arrangement
        return Made(result.stderr.replace("vdwmesh-mpi", "vdwmesh"), digest, re.sub(r"\s", "", document), report)

    def assert_same_file(self, path, *options, ranks):
        return self.assert_same_files((path, options, ranks))[0]

    def assert_same_files(self, *cases):
        """For each case, of a path, options and numbers of ranks. Returns what the plain program made."""
        # Without any option the plain program follows the creases, and ranks do not.
        cases = [(path, options if "--spacing" in options or "--mesher" in options else (*options, "--spacing", "0.5"), ranks)
                 for path, options, ranks in cases]  # fmt: skip
        plain = at_once(functools.partial(self.mesh, self.run_ok, path, "--backend", "cpu", *options)
                        for path, options, _ in cases)  # fmt: skip
        runs = [(path, options, count, expected) for (path, options, ranks), expected in zip(cases, plain) for count in ranks]
        made = at_once(functools.partial(self.mesh, functools.partial(self.run_ranks_ok, count), path, "--backend", "cpu",
                                         *options) for path, options, count, _ in runs)  # fmt: skip
        for (path, options, count, expected), ours in zip(runs, made):
            with self.subTest(path=str(path), options=options, ranks=count):
                self.assertEqual(ours.digest, expected.digest, "the files differ")
                self.assertEqual(ours.document, expected.document)
                self.assertEqual(ours.errors, expected.errors)
        return plain


class Meshes(MeshTest):
    """The file is that of the plain program, byte by byte, and so is the report but for times, ranks and memory."""

    def test_any_number_of_ranks(self):
        self.assert_same_files((UBIQUITIN, (), (1, 2, 3, 5, 7)), (UBIQUITIN, ("--field", "blinn"), (2, 5)))

    def test_few_and_far_atoms(self):
        """One atom, fewer bricks than ranks, pieces far apart, all bricks in one layer."""
        paths = self.few_and_far()
        self.assert_same_files(*((path, (), (2, 7)) for path in paths),
                               *((path, ("--spacing", "0.3", "--field", "soft"), (3,)) for path in paths))  # fmt: skip

    def test_every_field_and_preset(self):
        self.assert_same_files(*((UBIQUITIN, ("--field", field, "--preset", preset, "--spacing", "0.7"), (3,))
                                 for field in FIELDS for preset in ("radius-aware", "thesis", "thesis-vdw")))  # fmt: skip

    def test_surfaces_that_the_grid_cuts(self):
        self.assert_same_file(UBIQUITIN, "--padding", "0", "--field", "blinn", ranks=(3,))

    def test_reference_molecules(self):
        self.assert_same_files(*((path, ("--spacing", "0.8"), (3,)) for path in thesis_molecules()))

    def test_sparse_sets(self):
        self.assert_same_files(*((path, ("--probe", "1.4"), (3,)) for path in sparse_sets()))

    REFINED = ("--spacing", "1", "--crossings", "allow")

    def test_subdivisions(self):
        """Moves that turn triangles are taken back on borders too."""
        made = self.assert_same_files(*((UBIQUITIN, (*self.REFINED, "--subdivide", level), ranks)
                                        for level, ranks in LEVELS))  # fmt: skip
        self.assertGreater(json.loads(made[-1].report)["mesh"]["newton"]["undone"], 20)

    def test_subdivisions_of_every_field_and_projection(self):
        refined = (*self.REFINED, "--subdivide", "1")
        self.assert_same_files(*((UBIQUITIN, (*refined, "--field", field), (3,)) for field in FIELDS),
                               (UBIQUITIN, (*refined, "--field", "soft", "--project", "vdw"), (3,)),
                               (UBIQUITIN, ("--spacing", "1", "--subdivide", "1", "--project", "none"), (3,)))  # fmt: skip

    def test_a_rank_without_vertices_of_its_own_has_normals(self):
        result = run_start(mpirun(3, os.environ["VDWMESH_RANK_WITHOUT_VERTICES"]))
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_subdivisions_of_few_and_far_atoms(self):
        self.assert_same_files(*((path, (*self.REFINED, "--subdivide", "2"), (3, 7)) for path in self.few_and_far()))

    def test_subdivisions_of_reference_molecules(self):
        refined = ("--spacing", "1.6", "--crossings", "allow", "--subdivide", "1")
        self.assert_same_files(*((path, refined, (3,)) for path in thesis_molecules()))

    def test_subdivisions_of_sparse_sets(self):
        refined = (*self.REFINED, "--probe", "1.4", "--subdivide", "2")
        self.assert_same_files(*((path, refined, (3,)) for path in sparse_sets()))

    EXACT = ("--mesher", "exact", "--edge-length", "0.8")

    def test_crease_exact(self):
        """Every rank splits the pieces of arcs that any of them wants split."""
        made = self.assert_same_files((UBIQUITIN, self.EXACT, (1, 2, 3, 5, 7)),
                                      (UBIQUITIN, (*self.EXACT, "--probe", "1.4", "--relative-edge", "0.3"), (3,)))  # fmt: skip
        self.assertGreater(json.loads(made[0].report)["mesh"]["arrangement"]["split"], 1000)

    def test_crease_exact_with_lengths_of_atoms(self):
        """The first rank alone knows the atoms."""
        self.assert_same_file(UBIQUITIN, *self.EXACT, "--edge-length-of", "A/10-40=0.3", ranks=(2,))

    def test_crease_exact_levels(self):
        self.assert_same_files(*((UBIQUITIN, (*self.EXACT, "--subdivide", level), ranks) for level, ranks in LEVELS),
                               (UBIQUITIN, (*self.EXACT, "--subdivide", "1", "--project", "none"), (3,)))  # fmt: skip

    def test_crease_exact_of_joined_corners(self):
        """Cubes of a lattice meet in points and in edges, where fans of triangles are parted across ranks; and balls
        that touch."""
        lattice = [(x, y, z) for x in range(4) for y in range(4) for z in range(4)]
        corners = "".join(f"{x} {y} {z} {3 ** 0.5 / 2!r}\n" for x, y, z in lattice)
        touching = "".join(f"{2 * x} {2 * y} {2 * z} 1\n" for x, y, z in lattice)
        checkers = "".join(f"{x} {y} {z} {3 ** 0.5 / 2!r}\n" for x, y, z in lattice if (x + y + z) % 2 == 0)
        paths = [self.file(f"{name}.xyzr", text)
                 for name, text in (("corners", corners), ("touching", touching), ("checkers", checkers),
                                    ("one", ONE_ATOM), ("far", FAR_APART), ("twins", TWINS))]  # fmt: skip
        self.assert_same_files(*((path, self.EXACT, (2, 5)) for path in paths),
                               *((path, (*self.EXACT, "--subdivide", "1"), (3,)) for path in paths))  # fmt: skip

    def test_crease_exact_of_reference_molecules(self):
        self.assert_same_files(*((path, self.EXACT, (3,)) for path in thesis_molecules()))

    def test_crease_exact_of_sparse_sets(self):
        self.assert_same_files(*((path, (*self.EXACT, "--subdivide", "1"), (3,)) for path in sparse_sets()
                                 if path.name not in ("pencil4.xyzr", "pencil4b.xyzr")))  # fmt: skip

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
        expected = self.assert_same_file(UBIQUITIN, ranks=()).digest
        with open(UBIQUITIN) as text:
            self.run_ranks_ok(2, "mesh", "-", "--format", "pdb", "-o", self.folder / "a.ply", stdin=text)
        self.assertEqual(hashlib.sha256((self.folder / "a.ply").read_bytes()).hexdigest(), expected)

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
        self.assertRegex(text, r"(?m)^Topology +mesh 1 piece, 95 tunnels, no voids$")
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
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            report, atoms = Path(folder) / "r.json", Path(folder) / "a.csv"
            result = start("exact", *arguments, "--json", report, "--per-atom", atoms)
            document, table = report.read_text().replace(folder, ""), atoms.read_text()
        text = re.sub(r"(?m)^(Time|CPU) \(s\).*$", "", result.stdout)
        document = re.sub(r'("timing": \{.*?\})\s*\}', "", document, flags=re.DOTALL)
        self.assertNotIn('"total"', document)
        return text, document, table, result.stderr

    def assert_same_results(self, path, *options, ranks, topology="counts"):
        return self.assert_all_same_results((path, (*options, "--topology", topology), ranks))[0]

    def assert_all_same_results(self, *cases):
        """For each case, of a path, options and numbers of ranks. Returns what the plain program made."""
        plain = at_once(functools.partial(self.results, self.run_ok, path, "--backend", "cpu", *options)
                        for path, options, _ in cases)  # fmt: skip
        runs = [(path, options, count, expected) for (path, options, ranks), expected in zip(cases, plain) for count in ranks]
        made = at_once(functools.partial(self.results, functools.partial(self.run_ranks_ok, count), path, *options)
                       for path, options, count, _ in runs)  # fmt: skip
        for (path, options, count, expected), together in zip(runs, made):
            with self.subTest(path=str(path), options=options, ranks=count):
                for ours, theirs in zip(together, expected):
                    self.assertEqual(ours, theirs)
        return plain

    def test_any_number_of_ranks(self):
        self.assert_all_same_results((UBIQUITIN, COUNTS, (1, 2, 3, 5, 7)),
                                     (UBIQUITIN, (*COUNTS, "--probe", "1.4"), (2, 3, 5)),
                                     (UBIQUITIN, ("--topology", "off"), (3,)))  # fmt: skip

    def test_gradients(self):
        """Also of balls in doubt, which the first rank measures, equal ones and such as touch."""
        doubtful = "".join(f"{x} {y} {z} 1\n" for x in range(4) for y in range(4) for z in range(4)) + "0 0 0 1\n" * 3
        for name, path, options in (("ubiquitin", UBIQUITIN, ("--probe", "1.4")), ("one", self.file("1.xyzr", ONE_ATOM), ()),
                                    ("lattice", self.file("l.xyzr", doubtful), ())):  # fmt: skip
            tables = {}
            for ranks in (0, 1, 2, 3, 5):
                start = functools.partial(self.run_ranks_ok, ranks) if ranks else self.run_ok
                table = self.folder / f"{name}{ranks}.csv"
                tables[ranks] = start("exact", path, "--gradient", table, *options).stderr, table.read_bytes()
            for ranks, made in tables.items():
                self.assertEqual(made, tables[0], (name, ranks))

    def test_memory_of_gradients(self):
        """Measures fit, derivatives do not: refused with what would do, and no table is written."""
        row = self.file("row.xyzr", "".join(f"{x} 0 0 1\n" for x in range(2000)))
        table = self.folder / "g.csv"
        exact = ("exact", row, "--gradient", table, "--memory-limit")
        self.assert_all_end(LIMIT_HIT, *exact, "900K", ranks=1, says=("derivatives", "--memory-limit 2M"))
        self.run_ranks_ok(1, *exact[:2], *exact[4:], "900K")
        self.run_ranks_ok(1, *exact, "2M")

    def test_chosen_atoms_residues_and_polarity(self):
        self.assert_same_results(UBIQUITIN, "--radii", "protor", "--probe", "1.4", "--group", "residue", ranks=(3,))
        for topology in ("counts", "off"):
            self.assert_same_results(UBIQUITIN, "--measure", "(LYS)", topology=topology, ranks=(5,))

    def test_few_and_far_atoms(self):
        self.assert_all_same_results(*((path, COUNTS, (2, 7)) for path in self.few_and_far()))

    def test_components_that_many_ranks_share(self):
        """Rods along x that the shares cut, and one that joins two of them."""
        rods = "".join(f"{1.1 * x} {10 * y} {0.1 * (x % 7)} {1.6 + 0.01 * (x % 3)}\n" for y in range(5) for x in range(100))
        path = self.file("rods.xyzr", rods + "".join(f"40.3 {y}.2 0.1 1.6\n" for y in range(1, 10)))
        text = self.assert_same_results(path, ranks=(2, 7))[0]
        self.assertRegex(text, r"(?m)^Topology +4 pieces,")

    def test_spheres_that_the_arcs_cannot_measure(self):
        """A cubic lattice: four circles meet in a point."""
        lattice = "".join(f"{x} {y} {z} 0.9\n" for x in range(4) for y in range(4) for z in range(12))
        document = self.assert_same_results(self.file("cubes.xyzr", lattice), ranks=(2, 5))[1]
        self.assertGreater(int(re.search(r'"fallback_spheres": (\d+)', document)[1]), 0)

    def test_reference_molecules(self):
        self.assert_all_same_results(*((path, COUNTS, (3,)) for path in thesis_molecules()))

    def test_sparse_sets(self):
        self.assert_all_same_results(*((path, (*COUNTS, "--probe", "1.4"), (3,)) for path in sparse_sets()))

    def test_ranks_that_cannot_share_memory_take_copies(self):
        """The first rank may make no file of the size of the spheres, not even in memory."""
        limited = 'if [ "$OMPI_COMM_WORLD_RANK" = 0 ]; then ulimit -f 1; trap "" XFSZ; fi; exec "$@"'
        times = r"(?m)^(Time|CPU) \(s\).*$"
        two = self.file("two.pdb", TWO_COPIES % "  11.50000" + UBIQUITIN.read_text())
        lines = self.file("lines.xyzr", "".join(f"{3 * i} 0 0 1.{i % 9}\n" for i in range(300)))
        for given in ((UBIQUITIN,), (two, "--assembly", "1"), (lines,)):
            with self.subTest(given=given):
                start = command(3, "exact", *given)
                expected = run_start(start)
                place = start.index(RANKS_PROGRAM)
                start[place:place] = ["bash", "-c", limited, "bash"]
                result = run_start(start)
                self.assertEqual(result.returncode, DONE, result.stderr)
                self.assertEqual(re.sub(times, "", result.stdout), re.sub(times, "", expected.stdout))

    def test_json_on_standard_output_is_of_the_first_rank(self):
        self.run_ranks_ok(3, "exact", UBIQUITIN, "--json", self.folder / "file.json")
        text = self.run_ranks_ok(3, "exact", UBIQUITIN, "--json", "-").stdout
        self.assertEqual(text.count('"schema"'), 1)


# Two copies of all chains, the second one turned about z and shifted.
TWO_COPIES = """REMARK 350 BIOMOLECULE: 1
REMARK 350 APPLY THE FOLLOWING TO CHAINS: A
REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000
REMARK 350   BIOMT1   2  0.000000 -1.000000  0.000000       %s
REMARK 350   BIOMT2   2  1.000000  0.000000  0.000000        3.21000
REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        1.50000
"""


class Inputs(MeshTest):
    """Spheres that ranks make of lines of text, and of an assembly's operators, are those of the plain program. What is
    not as it should be ends as it does there."""

    def exact(self, start, *arguments):
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            report = Path(folder) / "r.json"
            result = start("exact", *arguments, "--topology", "counts", "--json", report)
            document = report.read_text().replace(folder, "")
        document = re.sub(r'("timing": \{.*?\})\s*\}', "", document, flags=re.DOTALL)
        return re.sub(r"(?m)^(Time|CPU) \(s\).*$", "", result.stdout), document, result.stderr

    def assert_same_exact(self, path, *options, ranks):
        expected = self.exact(self.run_ok, path, "--backend", "cpu", *options)
        for count in ranks:
            with self.subTest(path=str(path), options=options, ranks=count):
                made = self.exact(functools.partial(self.run_ranks_ok, count), path, *options)
                for ours, theirs in zip(made, expected):
                    self.assertEqual(ours, theirs)

    def two_copies(self, shift):
        return self.file("two.pdb", TWO_COPIES % f"{shift:10.5f}" + UBIQUITIN.read_text())

    def test_assemblies(self):
        two, capsid = self.two_copies(11.5), need_shared("molecules/special/1F2N.pdb")
        chains = need_shared("molecules/thesis/1HH0.cif")
        options = ("--assembly", "1")
        self.assert_same_files((two, options, (1, 2, 3, 5, 7)), (capsid, (*options, "--spacing", "4"), (3,)),
                               (chains, (*options, "--waters"), (2,)),
                               (two, (*options, "--mesher", "exact", "--relative-edge", "0.9"), (2,)))  # fmt: skip
        self.assert_same_exact(two, *options, ranks=(1, 2, 3, 5, 7))
        self.assert_same_exact(capsid, *options, "--probe", "1.4", ranks=(3,))
        self.assert_same_exact(two, *options, "--radii", "protor", ranks=(2,))

    def test_an_assembly_too_far_away(self):
        far, plain = self.two_copies(2e6 - 1), ("--assembly", "1", "--topology", "counts")
        expected = run("exact", far, *plain)
        self.assertEqual(expected.returncode, BAD_INPUT)
        self.assertIn("operator 2 moves an atom", expected.stderr)
        made = run_ranks(3, "exact", far, *plain)
        self.assertEqual((made.returncode, made.stderr), (BAD_INPUT, expected.stderr.replace("vdwmesh:", "vdwmesh-mpi:")))

    def many_lines(self, name, *, at=19000, line="0 0 0 0", end="\n", last="\n", head=""):
        """0.6 MB of spheres on a grid, which are three pieces, and a line of another kind among them."""
        lines = [f"{5.1 * (i % 41):.4f} {5.3 * (i // 41 % 37):.4f} {2.3 * (i // 1517):.4f} 1.{i % 7}000" for i in range(20000)]
        lines[at] = line
        path = self.folder / name
        path.write_bytes((head + end.join(lines) + last).encode())
        return path

    def test_lines_of_spheres(self):
        texts = {
            "blank.xyzr": {"line": " \t "},
            "comment.xyzr": {"line": "1 2 3 1.5 # a comment", "head": "# x y z r\n\n"},
            "zero.xyzr": {"line": "0 0 0 0"},
            "windows.xyzr": {"line": "", "end": "\r\n"},
            "old.xyzr": {"line": "", "end": "\r"},
            "cut.xyzr": {"line": "", "last": ""},
            "mark.xyzr": {"line": "", "head": "\ufeff"},
            "tail.xyzr": {"line": "7 7 7 1.5 and more"},
        }
        for name, text in texts.items():
            self.assert_same_exact(self.many_lines(name, **text), ranks=(2,))
        path = self.many_lines("all.xyzr", line="")
        self.assert_same_exact(path, ranks=(1, 2, 3, 5, 7))
        self.assert_same_exact(path, "--model", "all", "--probe", "0.3", ranks=(3,))
        self.assert_same_files((path, ("--spacing", "1.3"), (1, 2, 3, 5, 7)),
                               (self.file("four.xyzr", FAR_APART), ("--probe", "0.4"), (5,)))  # fmt: skip

    def test_lines_that_are_no_spheres(self):
        cases = [(self.many_lines("word.xyzr", line="1 2 x 1"), ()), (self.many_lines("few.xyzr", line="1 2 3"), ()),
                 (self.many_lines("minus.xyzr", line="1 2 3 -1"), ()), (self.many_lines("far.xyzr", line="1 2 1e7 1"), ()),
                 (self.many_lines("large.xyzr", line="1 2 3 2e6"), ()), (self.file("none.xyzr", "# none\n"), ()),
                 (self.many_lines("marks.xyzr", line="", head="\ufeff\ufeff"), ()),
                 (self.many_lines("probe.xyzr", line=""), ("--probe=-1.35",)),
                 (self.many_lines("all.xyzr", line=""), ("--select", "A/1")),
                 (self.many_lines("all.xyzr", line=""), ("--model", "2"))]  # fmt: skip
        for path, options in cases:
            with self.subTest(path=path.name, options=options):
                expected = run("exact", path, *options)
                self.assertNotEqual(expected.returncode, DONE)
                made = run_ranks(3, "exact", path, *options)
                self.assertEqual(made.returncode, expected.returncode)
                self.assertEqual(made.stderr, expected.stderr.replace("vdwmesh:", "vdwmesh-mpi:"))


class Faults(RanksTest):
    def mesh(self, *options, path=UBIQUITIN, to="a.ply"):
        return ("mesh", path, "-o", self.folder / to, *options)

    def test_wrong_options(self):
        cubes = self.mesh("--mesher", "marching-cubes", "--edge-length", "1")
        cases = [
            (self.mesh("--spacing", "0"), ("--spacing",)),
            (self.mesh("--mesher", "exact", "--spacing", "1"), ("--edge-length",)),
            (cubes, ("--edge-length", "--spacing")),
            (self.mesh("--subdivide", "1"), ("--crossings allow",)),
            (self.mesh(to="a.stl"), (".ply", ".vtkhdf")),
            (("mesh", UBIQUITIN, "-o", self.folder / "no" / "a.ply"), ("there is no folder",)),
            (("mesh", UBIQUITIN, "-o", "/dev/null"), ("/dev/null",)),
            (("report", UBIQUITIN), ("not a verb",)),
        ]
        if not HAS_HDF5:
            cases.append((self.mesh(to="a.vtkhdf"), ("HDF5", ".ply")))
        self.assert_each_ends(BAD_INPUT, *cases)

    def test_wrong_options_of_exact(self):
        exact = ("exact", UBIQUITIN)
        self.assert_each_ends(
            BAD_INPUT,
            ((*exact, "--topology", "on"), ("vdwmesh exact", "counts")),
            ((*exact, "--method", "cgal"), ("--method",)),
            ((*exact, "--measure", "(XYZ)"), ("XYZ",)),
            ((*exact, "--probe=-9"), ("--probe",)),
            ((*exact, "--json", self.folder / "no" / "a.json"), ("--json",)),
        )

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
        self.assert_all_end(LIMIT_HIT, *self.mesh("--spacing", "0.1", "--memory-limit", "30M"),
                            says=("more ranks",))  # fmt: skip
        self.run_ranks_ok(7, *self.mesh("--spacing", "0.1", "--memory-limit", "30M"))
        refined = self.mesh("--spacing", "0.7", "--memory-limit", "60M", "--subdivide", "3", "--crossings", "allow")
        self.assert_all_end(LIMIT_HIT, *refined, says=("more ranks", "fewer subdivisions"))
        self.run_ranks_ok(7, *refined)
        exact = ("exact", self.file("a.xyzr", FLAT), "--memory-limit", "250K")
        self.assert_all_end(LIMIT_HIT, *exact, ranks=1, says=("more ranks", "--memory-limit 1M"))

    def run_with_failing_allocation(self, number):
        """Three ranks, of which the second one finds no memory at that allocation; 0 counts them."""
        library = os.environ["VDWMESH_FAIL_ALLOCATION"]
        to = f"{number}.ply"
        start = command(3, *self.mesh("--mesher", "exact", "--edge-length", "0.8", "--threads", "1", "--quiet", to=to))
        place = start.index(RANKS_PROGRAM)
        start[place:place] = ["env", f"LD_PRELOAD={library}", *([f"FAIL_ALLOCATION={number}"] if number else [])]
        return run_start(start)

    def test_an_mpi_without_threads_is_refused(self):
        start = command(2, *self.mesh("--quiet", to="a.ply"))
        place = start.index(RANKS_PROGRAM)
        start[place:place] = ["env", f"LD_PRELOAD={os.environ['VDWMESH_GRANT_NO_THREADS']}"]
        result = run_start(start)
        self.assertNotEqual(result.returncode, 0)
        self.assertRegex(result.stderr, r"\Avdwmesh-mpi: [^\n]*grants no threads[^\n]*\n\Z")
        self.assertEqual(self.files(), [])

    def test_a_rank_without_memory_ends_all(self):
        """At a dozen places of the run."""
        counted = self.run_with_failing_allocation(0)
        count = int(re.fullmatch(r"allocations: (\d+)\n", counted.stderr)[1])
        (self.folder / "0.ply").unlink()
        numbers = [count * part // 100 for part in range(20, 98, 7)]
        for number, result in zip(numbers, at_once(functools.partial(self.run_with_failing_allocation, n) for n in numbers)):
            with self.subTest(allocation=number, of=count):
                self.assertEqual(result.returncode, LIMIT_HIT, result.stderr)
                self.assertRegex(result.stderr, r"\Avdwmesh-mpi: [^\n]*out of memory[^\n]*\n\Z")
        self.assertEqual(self.files(), [])

    def assert_full_disk_ends_all(self, rank, says, to="a.ply"):
        """The size of files is limited for one rank of three; the others end with it."""
        limited = f'if [ "$OMPI_COMM_WORLD_RANK" = {rank} ]; then ulimit -f 100; trap "" XFSZ; fi; exec "$@"'
        start = command(3, *self.mesh(to=to))
        place = start.index(RANKS_PROGRAM)
        start[place:place] = ["bash", "-c", limited, "bash"]
        result = run_start(start)
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
        result = run_start(start)
        self.assertEqual(result.returncode, BAD_INPUT, result.stderr)
        self.assertRegex(result.stderr, r"\Avdwmesh-mpi: [^\n]*a\.vtkhdf: [^\n]*scratch[^\n]*TMPDIR[^\n]*\n\Z")
        self.assertEqual(self.files(), ["scratch"])

    def end_while_writing(self, end, to="a.ply"):
        """Starts a run, stops its ranks as soon as its file is being written, calls end(process, ranks), lets them
        go on, and returns the exit status. Stopped ranks cannot complete the file in the meantime."""
        process = subprocess.Popen(command(3, *self.mesh("--spacing", "0.1", "--quiet", to=to)), env=ranks_environment(),
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


    def test_a_rank_that_fails_after_a_failure_that_was_caught(self):
        """All end, as they would not if they took the first failure for one that leaves nobody waiting."""
        result = run_start(mpirun(3, os.environ["VDWMESH_RANKS_AFTER_FAILURE"]))
        self.assertEqual((result.returncode, result.stderr), (LIMIT_HIT, "rank 2 ends all\n"))


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
