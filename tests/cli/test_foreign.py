"""Every mesh format that is written is read by programs of others, who find the same mesh."""

import collections
import ctypes
import locale
import re
import subprocess
import unittest
import zipfile

from program import SOURCE_DIR, ProgramTest, missing, need_package, parse_json

# Per format, who reads it. Blank: nobody of that package.
MESHIO_FORMATS = ("ply", "obj", "off", "stl", "vtu")
VTK_FORMATS = {"ply": "vtkPLYReader", "obj": "vtkOBJReader", "stl": "vtkSTLReader",
               "glb": "vtkGLTFReader"}
ASSIMP_FORMATS = ("ply", "obj", "off", "stl", "glb", "3mf")
MOLECULE = SOURCE_DIR / "data" / "bpti.pdb"
SURFACES = {
    "marching cubes": ("--spacing", "1.6", "--subdivide", "1"),
    "crease-exact": ("--mesher", "exact", "--edge-length", "1.2"),
}


class Found:
    """What a reader made of a file: plain lists, so that nothing is repaired on the way."""

    def __init__(self, points, triangles):
        self.points = [tuple(map(float, p)) for p in points]
        self.triangles = [tuple(map(int, t)) for t in triangles]

    def welded(self):
        """Corners at one place become one vertex, as for formats without indices."""
        numbers = {}
        index = [numbers.setdefault(p, len(numbers)) for p in self.points]
        return Found(list(numbers), [tuple(index[v] for v in t) for t in self.triangles])

    def area(self):
        return sum(length(normal(*(self.points[v] for v in t))) for t in self.triangles) / 2

    def volume(self):
        return sum(dot(self.points[a], cross(self.points[b], self.points[c]))
                   for a, b, c in self.triangles) / 6

    def is_closed_and_oriented(self):
        """Every directed edge occurs once, and so does its opposite."""
        edges = collections.Counter(
            (t[k], t[(k + 1) % 3]) for t in self.triangles for k in range(3))
        return all(n == 1 and edges[b, a] == 1 for (a, b), n in edges.items())


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def normal(a, b, c):
    return cross([x - y for x, y in zip(b, a)], [x - y for x, y in zip(c, a)])


def length(a):
    return dot(a, a) ** 0.5


def read_by_meshio(meshio, path):
    mesh = meshio.read(path)
    return Found(mesh.points, mesh.get_cells_type("triangle"))


def polygons(data):
    for i in range(data.GetNumberOfCells()):
        cell = data.GetCell(i)
        yield tuple(cell.GetPointId(k) for k in range(cell.GetNumberOfPoints()))


def read_by_vtk(vtk, path, extension):
    reader = getattr(vtk["vtkIOGeometry" if extension != "ply" else "vtkIOPLY"],
                     VTK_FORMATS[extension])()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    if extension == "glb":  # a tree with one leaf
        while data.IsA("vtkMultiBlockDataSet"):
            if data.GetNumberOfBlocks() != 1:
                raise AssertionError("one mesh was written")
            data = data.GetBlock(0)
    points = [data.GetPoint(i) for i in range(data.GetNumberOfPoints())]
    return Found(points, polygons(data))


def read_by_assimp(assimp, path):
    """What assimp read, in the OBJ file that it makes of it: numbers of vertices from 1 on."""
    out = path.with_suffix(".assimp.obj")
    subprocess.run([assimp, "export", path, out], check=True, capture_output=True)
    points, triangles = [], []
    for line in out.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append(words[1:4])
        elif words[:1] == ["f"]:
            triangles.append(int(word.split("/")[0]) - 1 for word in words[1:])
    return Found(points, triangles)


class ForeignReaders(ProgramTest):
    def check(self, extensions, read, unreadable=()):
        for surface, options in SURFACES.items():
            for extension in extensions:
                if (surface, extension) in unreadable:
                    continue
                with self.subTest(surface=surface, format=extension):
                    path = self.folder / f"a.{extension}"
                    json_path = self.folder / "a.json"
                    self.run_ok("mesh", MOLECULE, "-o", path, "--json", json_path, *options)
                    mesh = parse_json(json_path.read_text())["mesh"]
                    self.assert_the_same(read(path, extension), mesh, extension)

    def assert_the_same(self, found, mesh, extension, scale=1):
        if extension == "stl":
            found = found.welded()
        self.assertEqual(len(found.points), mesh["vertices"])
        self.assertEqual(len(found.triangles), mesh["triangles"])
        self.assertTrue(all(len(t) == 3 for t in found.triangles))
        self.assertEqual(found.is_closed_and_oriented(), mesh["closed"] and mesh["oriented"])
        # Coordinates of up to 50 Å in float32 on edges of 0.3 Å; VTK and meshio read PLY and OBJ
        # into float32 as well.
        self.assert_close(found.area(), scale**2 * mesh["area"], 1e-5)
        self.assert_close(found.volume(), scale**3 * mesh["volume"], 1e-5)

    def test_meshio(self):
        meshio = need_package("python3-meshio", module="meshio")
        # It takes the properties of a face for columns, one behind the other, and so reads no PLY
        # whose faces have more than their corners: here, their atoms.
        unreadable = {("crease-exact", "ply")}
        self.check(MESHIO_FORMATS, lambda path, _: read_by_meshio(meshio, path), unreadable)

    def test_vtk(self):
        names = ("vtkIOGeometry", "vtkIOPLY")
        vtk = {name: need_package("python3-vtk9", module="vtkmodules." + name) for name in names}
        self.check(VTK_FORMATS, lambda path, extension: read_by_vtk(vtk, path, extension))

    def test_assimp(self):
        assimp = need_package("assimp-utils", program="assimp")
        self.check(ASSIMP_FORMATS, lambda path, _: read_by_assimp(assimp, path))

    def test_scaled_files(self):
        """Readers of all formats find N times the lengths, so N² times the area; the report stays in Å. Files say their unit."""
        meshio = need_package("python3-meshio", module="meshio")
        assimp = need_package("assimp-utils", program="assimp")
        gmsh = need_package("gmsh", program="gmsh")
        def by_gmsh(path):  # which takes the section with the unit for a comment
            out = path.with_suffix(".gmsh.stl")
            told = subprocess.run([gmsh, path, "-0", "-o", out], capture_output=True, text=True, check=True)
            self.assertNotRegex(told.stdout, "Warning|Error")
            return read_by_meshio(meshio, out).welded()

        readers = {"msh": by_gmsh, "msh4": by_gmsh}
        readers |= {name: lambda path: read_by_meshio(meshio, path) for name in ("ply", "obj", "off", "stl", "vtu")}
        readers |= {name: lambda path: read_by_assimp(assimp, path) for name in ("glb", "3mf")}
        json_path = self.folder / "a.json"
        for scale in (0.1, 2500):
            for name, read in readers.items():
                with self.subTest(scale=scale, format=name):
                    path = self.folder / f"a.{name}"
                    self.run_ok("mesh", MOLECULE, "-o", path, "--json", json_path, "--scale", scale, *SURFACES["marching cubes"])
                    report = parse_json(json_path.read_text())
                    self.assert_the_same(read(path), report["mesh"], name, scale)
                    self.assertTrue(any(f"1 Å is {scale}" in note for note in report["notes"]))
                    packed = zipfile.ZipFile(path).read("3D/3dmodel.model") if name == "3mf" else path.read_bytes()
                    self.assertEqual(f"1 angstrom is {scale}".encode() in packed, name != "off")
        self.run_ok("mesh", MOLECULE, "-o", self.folder / "a.vtp", "--scale", 2500, *SURFACES["marching cubes"])
        vtp = (self.folder / "a.vtp").read_text().replace("PolyData", "UnstructuredGrid")
        points = re.search(r"<Points>.*</Points>", vtp, re.S)
        self.assertIn(points[0], (self.folder / "a.vtu").read_text())

    def test_scaled_curvatures(self):
        """A sphere of radius r has the curvatures 1/r and 1/r², in the lengths of the file."""
        ball = self.file("ball.xyzr", "0 0 0 2\n")
        for scale in (1, 0.1, 50):
            path = self.folder / "ball.ply"
            self.run_ok("mesh", ball, "-o", path, "--surface", "ses", "--scale", scale, "--ascii")
            header, body = path.read_text().split("end_header\n")
            names = re.findall(r"property \w+ (\w+)", header.split("element face")[0])
            row = dict(zip(names, map(float, body.split("\n")[0].split())))
            radius = scale * 2
            self.assert_close(length((row["x"], row["y"], row["z"])), radius, 1e-6)
            self.assert_close(row["mean_curvature"], 1 / radius, 1e-6)
            self.assert_close(row["gaussian_curvature"], 1 / radius**2, 1e-6)

    def test_msh_and_vtp_have_the_atoms(self):
        """As PLY, whose properties the report of a reader of ours is made of."""
        meshio = need_package("python3-meshio", module="meshio")
        vtk = need_package("python3-vtk9", module="vtkmodules.vtkIOXML")
        paths = {name: self.folder / f"a.{name}" for name in ("msh", "vtp", "json")}
        for path in (paths["msh"], paths["vtp"]):
            self.run_ok("mesh", MOLECULE, "-o", path, "--json", paths["json"], *SURFACES["crease-exact"])
        mesh = parse_json(paths["json"].read_text())["mesh"]
        gmsh = meshio.read(paths["msh"])
        self.assert_the_same(Found(gmsh.points, gmsh.get_cells_type("triangle")), mesh, "msh")
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName(str(paths["vtp"]))
        reader.Update()
        data = reader.GetOutput()
        points = [data.GetPoint(i) for i in range(data.GetNumberOfPoints())]
        self.assert_the_same(Found(points, polygons(data)), mesh, "vtp")
        array = data.GetCellData().GetArray("atom")
        atoms = [int(array.GetValue(i)) for i in range(array.GetNumberOfTuples())]
        self.assertEqual([tag - 1 for tag in gmsh.get_cell_data("gmsh:physical", "triangle")], atoms)
        self.assertEqual(len(set(atoms)), 454)  # of BPTI, all that are exposed
        # A triangle's corners lie on the sphere of its atom.
        centers = {i: tuple(float(line[k : k + 8]) for k in (30, 38, 46)) for i, line in enumerate(
            line for line in MOLECULE.read_text().splitlines() if line.startswith(("ATOM", "HETATM")) and "HOH" not in line)}
        for triangle, atom in zip(polygons(data), atoms):
            radii = [length(tuple(a - b for a, b in zip(points[v], centers[atom]))) for v in triangle]
            self.assertLess(max(radii) - min(radii), 1e-6)

    def test_vtu_has_the_cells_of_vtp(self):
        meshio = need_package("python3-meshio", module="meshio")
        vtk = need_package("python3-vtk9", module="vtkmodules.vtkIOXML")
        for surface in (("--edge-length", "1.2"), ("--surface", "ses", "--density", "1")):
            paths = {name: self.folder / f"a.{name}" for name in ("vtu", "vtp")}
            for path in paths.values():
                self.run_ok("mesh", MOLECULE, "-o", path, *surface)
            mesh = meshio.read(paths["vtu"])
            reader = vtk.vtkXMLPolyDataReader()
            reader.SetFileName(str(paths["vtp"]))
            reader.Update()
            data = reader.GetOutput()
            self.assertEqual([tuple(t) for t in mesh.get_cells_type("triangle")], list(polygons(data)))
            self.assertEqual(sorted(mesh.cell_data), ["atom", "patch_kind"] if "ses" in surface else ["atom"])
            for name in mesh.cell_data:
                array = data.GetCellData().GetArray(name)
                values = [int(array.GetValue(i)) for i in range(array.GetNumberOfTuples())]
                self.assertEqual(mesh.get_cell_data(name, "triangle").tolist(), values)

    def test_3mf(self):
        """The library of the 3MF consortium reads it without a warning, in millimetres, and calls it fit for a printer."""
        meshes = {}
        for number, options in enumerate(SURFACES.values()):
            path, json_path = self.folder / f"{number}.3mf", self.folder / "a.json"
            self.run_ok("mesh", MOLECULE, "-o", path, "--json", json_path, *options)
            meshes[path] = parse_json(json_path.read_text())["mesh"]
        self.addCleanup(locale.setlocale, locale.LC_ALL, "")  # which the library changes
        try:
            library = ctypes.CDLL("lib3MF.so.1")
        except OSError:
            missing("VDWMESH_REQUIRE_PACKAGES", "lib3mf1 is not installed")

        def call(name, *arguments):
            self.assertEqual(getattr(library, "lib3mf_" + name)(*arguments), 0, name)

        def number_of(name, thing):
            value = ctypes.c_int()
            call(name, thing, ctypes.byref(value))
            return value.value

        for path, mesh in meshes.items():
            model, reader, objects, found = (ctypes.c_void_p() for _ in range(4))
            call("createmodel", ctypes.byref(model))
            call("model_queryreader", model, b"3mf", ctypes.byref(reader))
            call("reader_readfromfileutf8", reader, str(path).encode())
            self.assertEqual(number_of("reader_getwarningcount", reader), 0)
            self.assertEqual(number_of("model_getunit", model), 1)  # MODELUNIT_MILLIMETER
            call("model_getmeshobjects", model, ctypes.byref(objects))
            self.assertTrue(number_of("resourceiterator_movenext", objects))
            call("resourceiterator_getcurrent", objects, ctypes.byref(found))
            self.assertEqual(number_of("meshobject_getvertexcount", found), mesh["vertices"])
            self.assertEqual(number_of("meshobject_gettrianglecount", found), mesh["triangles"])
            self.assertEqual(bool(number_of("meshobject_ismanifoldandoriented", found)), mesh["manifold"])

    def test_tetgen(self):
        """It fills the surface and keeps its triangles. PLY and STL it reads as text alone."""
        for name, options in (("t.off", ()), ("p.ply", ("--ascii",)), ("s.stl", ("--ascii",))):
            with self.subTest(name):
                self.fill_by_tetgen(self.folder / name, *options)

    def fill_by_tetgen(self, path, *options):
        tetgen = need_package("tetgen", program="tetgen")
        json_path = self.folder / "t.json"
        self.run_ok("mesh", MOLECULE, "-o", path, "--json", json_path, *SURFACES["crease-exact"], *options)
        mesh = parse_json(json_path.read_text())["mesh"]
        told = subprocess.run([tetgen, "-pYQ", path], capture_output=True, text=True, timeout=300)
        self.assertEqual(told.returncode, 0, told.stdout + told.stderr)
        elements = path.with_suffix(".1.ele").read_text().split("\n")
        nodes = [line.split() for line in path.with_suffix(".1.node").read_text().split("\n")[1:]]
        places = {row[0]: tuple(map(float, row[1:4])) for row in nodes if len(row) >= 4 and row[0] != "#"}
        volume = 0.0
        for line in elements[1:]:
            row = line.split()
            if len(row) < 5 or row[0] == "#":
                continue
            a, b, c, d = (places[i] for i in row[1:5])
            edges = [tuple(x - y for x, y in zip(p, d)) for p in (a, b, c)]
            volume += abs(dot(edges[0], cross(edges[1], edges[2]))) / 6
        self.assert_close(volume, mesh["volume"], 1e-5)

    def test_gmsh(self):
        """It fills the surface of a file of its own forms, by the commands that a note says."""
        for extension in (".msh", ".msh4"):
            with self.subTest(extension):
                self.fill_by_gmsh(extension)

    def fill_by_gmsh(self, extension):
        need_package("gmsh", program="gmsh")
        path, json_path = self.folder / f"it's g{extension}", self.folder / "g.json"
        self.run_ok("mesh", MOLECULE, "-o", path, "--json", json_path, *SURFACES["crease-exact"])
        report = parse_json(json_path.read_text())
        mesh = report["mesh"]
        (commands,) = [note.split("tetrahedra: ")[1] for note in report["notes"] if note.startswith("Gmsh fills")]
        told = subprocess.run(commands, shell=True, capture_output=True, text=True, timeout=300)
        self.assertEqual(told.returncode, 0, told.stdout + told.stderr)
        meshio = need_package("python3-meshio", module="meshio")
        volume = meshio.read(self.folder / "it's g.volume.msh")
        total = 0.0
        for cell in volume.get_cells_type("tetra"):
            a, b, c, d = (volume.points[i] for i in cell)
            total += abs(dot(a - d, cross(b - d, c - d))) / 6
        self.assert_close(total, mesh["volume"], 1e-5)

    def test_surfaces_of_gmsh(self):
        """Both versions of its form have the same triangles of the same atoms, or patches, in both numbers."""
        meshio, np = need_package("python3-meshio", module="meshio"), need_package("python3-numpy", module="numpy")
        for options in (SURFACES["crease-exact"], ("--surface", "ses")):
            found = []
            for extension in (".msh2", ".msh4"):
                path = self.folder / f"a{extension}"
                self.run_ok("mesh", MOLECULE, "-o", path, *options)
                mesh = meshio.read(path, "gmsh")
                tags = [np.concatenate(mesh.cell_data[f"gmsh:{kind}"]) for kind in ("physical", "geometrical")]
                corners = np.concatenate([block.data for block in mesh.cells])
                found.append(sorted(map(tuple, np.column_stack((corners, *tags)).tolist())))
                places = mesh.points if extension == ".msh2" else np.abs(mesh.points - places).max()
            self.assertEqual(found[0], found[1])
            self.assertEqual(places, 0)

    def test_text(self):
        """`--ascii`: meshio reads the same mesh as from the binary form, to the last digit where that has doubles; VTK
        reads as many triangles."""
        meshio, np = need_package("python3-meshio", module="meshio"), need_package("python3-numpy", module="numpy")
        vtk = need_package("python3-vtk9", module="vtk")
        for extension, reader in ((".ply", vtk.vtkPLYReader), (".stl", vtk.vtkSTLReader)):
            text, binary = self.folder / f"t{extension}", self.folder / f"b{extension}"
            for path, options in ((text, ["--ascii"]), (binary, [])):
                self.run_ok("mesh", MOLECULE, "-o", path, "--spacing", "0.8", *options)
            found, expected = meshio.read(text), meshio.read(binary)
            corners = [m.points[m.get_cells_type("triangle")] for m in (found, expected)]
            self.assertLessEqual(np.abs(corners[0] - corners[1]).max(), 0 if extension == ".ply" else 4e-6)
            told = reader()
            told.SetFileName(str(text))
            told.Update()
            self.assertEqual(told.GetOutput().GetNumberOfCells(), len(corners[0]))

    def test_admesh(self):
        """It reads STL, joins equal corners, and says what a printer would have to repair: nothing."""
        admesh = need_package("admesh", program="admesh")
        for surface, options in SURFACES.items():
            with self.subTest(surface=surface):
                path, json_path = self.folder / "a.stl", self.folder / "a.json"
                self.run_ok("mesh", MOLECULE, "-o", path, "--json", json_path, *options)
                mesh = parse_json(json_path.read_text())["mesh"]
                told = subprocess.run([admesh, path], capture_output=True, text=True, check=True).stdout
                numbers = {name.strip(): float(value) for name, value in
                           re.findall(r"(\w[^:\n]*?) *: +(-?[\d.]+)", told)}
                self.assertEqual(numbers["Number of facets"], mesh["triangles"])
                self.assertEqual(numbers["Number of parts"], mesh["shells"])
                for fault in ("Total disconnected facets", "Edges fixed", "Facets removed", "Facets added",
                              "Facets reversed", "Backwards edges"):
                    self.assertEqual(numbers[fault], 0, fault)
                # Sums of 20,000 terms in float32, whose roundings add up like a random walk.
                self.assert_close(numbers["Volume"], mesh["volume"], 1e-4)


class TheChecksThemselves(unittest.TestCase):
    def test_an_open_and_a_turned_face_are_seen(self):
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
        whole = Found(points, faces)
        self.assertTrue(whole.is_closed_and_oriented())
        self.assertAlmostEqual(whole.volume(), 1 / 6)
        self.assertAlmostEqual(whole.area(), 1.5 + 3**0.5 / 2)
        self.assertFalse(Found(points, faces[1:]).is_closed_and_oriented())
        self.assertFalse(Found(points, [(0, 1, 2), *faces[1:]]).is_closed_and_oriented())


if __name__ == "__main__":
    unittest.main()
