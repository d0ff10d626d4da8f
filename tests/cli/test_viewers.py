"""Programs of Debian that people look at meshes and atoms with open what is written: Blender, ParaView and PyMOL. They take
a gigabyte, so a test skips where its program is not installed (scripts/install-deps.sh viewers). ParaView's Python stands
against python3-vtk9, which other tests need: unpack the package elsewhere and name its folder in PYTHONPATH."""

import os
import re
import shutil
import subprocess
import unittest

from program import SOURCE_DIR, UBIQUITIN, ProgramTest, parse_json

MOLECULE = SOURCE_DIR / "data" / "bpti.pdb"
SURFACES = {"crease-exact": ("--edge-length", "1.2"), "excluded": ("--surface", "ses", "--density", "1")}

# Debian's importer of GLB says numpy.bool, which NumPy 1.24 has no more.
IN_BLENDER = """
import sys, bpy, numpy
numpy.bool = bool
calls = {"ply": bpy.ops.import_mesh.ply, "obj": bpy.ops.wm.obj_import, "stl": bpy.ops.import_mesh.stl,
         "glb": bpy.ops.import_scene.gltf}
for path in sys.argv[sys.argv.index("--") + 1 :]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    calls[path[-3:]](filepath=path)
    (mesh,) = [thing.data for thing in bpy.data.objects if thing.type == "MESH"]
    print("FOUND", path, len(mesh.vertices), len(mesh.polygons), sum(p.area for p in mesh.polygons), len(mesh.color_attributes))
"""

IN_PARAVIEW = """
import sys
from paraview.simple import OpenDataFile, IntegrateVariables, FetchData
for path in sys.argv[1:]:
    source = OpenDataFile(path)
    source.UpdatePipeline()
    facts = source.GetDataInformation()
    cells = [source.CellData.GetArray(k).Name for k in range(len(source.CellData))]
    sums = IntegrateVariables(Input=source)
    sums.UpdatePipeline()
    print("FOUND", path, facts.GetNumberOfPoints(), facts.GetNumberOfCells(), sums.CellData["Area"].GetRange()[0], ",".join(cells))
"""

IN_PYMOL = """
import sys
from pymol import cmd
for path in sys.argv[1:]:
    cmd.reinitialize()
    cmd.do("@" + path) if path.endswith(".pml") else cmd.load(path)
    found = cmd.get_model("all").atom
    print("FOUND", path, len(found), sum(a.b for a in found), sum(a.vdw for a in found), ",".join(cmd.get_names("all")))
"""


class Viewers(ProgramTest):
    def program(self, name):
        found = shutil.which(name, path="/usr/bin")
        if found is None:
            self.skipTest(f"{name} is not installed (scripts/install-deps.sh viewers)")
        return found

    def environment(self):
        return {"PATH": "/usr/bin:/bin", "HOME": str(self.folder), "PYTHONPATH": os.environ.get("PYTHONPATH", "")}

    def found_by(self, script, paths, *command):
        """What the script prints of each path behind its name."""
        file = self.file("script.py", script)
        told = subprocess.run([*(str(file) if word == "SCRIPT" else word for word in command), *paths], capture_output=True,
                              text=True, timeout=300, env=self.environment())  # fmt: skip
        rows = {path: words.split() for path, words in re.findall(r"^FOUND (\S+) (.*)$", told.stdout, re.M)}
        self.assertEqual(sorted(rows), sorted(paths), told.stdout[-2000:] + told.stderr[-2000:])
        return rows

    def meshes(self, extensions):
        """Files of each kind of surface, with what the report says of them."""
        made = {}
        for surface, options in SURFACES.items():
            for extension in extensions:
                path, json_path = self.folder / f"{surface}.{extension}", self.folder / "a.json"
                self.run_ok("mesh", MOLECULE, "-o", path, "--json", json_path, *options)
                made[str(path)] = parse_json(json_path.read_text())["mesh"]
        return made

    def assert_meshes(self, found, made):
        for path, mesh in made.items():
            vertices, triangles, area = found[path][:3]
            self.assertEqual((int(vertices), int(triangles)), (mesh["vertices"], mesh["triangles"]), path)
            self.assert_close(float(area), mesh["area"], 1e-4)  # single precision

    def test_blender(self):
        blender = self.program("blender")
        made = self.meshes(("ply", "obj", "stl", "glb"))
        found = self.found_by(IN_BLENDER, made, blender, "-b", "--factory-startup", "-P", "SCRIPT", "--")
        self.assert_meshes(found, made)
        for path, row in found.items():
            self.assertEqual(int(row[3]), 1 if path.endswith(("ply", "glb")) else 0, path)  # colours

    def test_paraview(self):
        pvbatch = self.program("pvbatch")
        told = subprocess.run(["python3", "-c", "import paraview"], capture_output=True, env=self.environment())
        if told.returncode != 0:
            self.skipTest("python3-paraview is not installed, nor in PYTHONPATH")
        made = self.meshes(("ply", "obj", "stl", "glb", "vtp", "vtu"))
        found = self.found_by(IN_PARAVIEW, made, pvbatch, "SCRIPT")
        self.assert_meshes(found, made)
        for path, row in found.items():
            if path.endswith(("vtp", "vtu")):
                self.assertEqual(row[3], "atom,patch_kind" if "excluded" in path else "atom")

    def test_pymol(self):
        """B factors are the areas; voids and pockets are spheres with their radii."""
        pymol = self.program("pymol")
        paths = [self.folder / name for name in ("a.pdb", "a.cif", "v.pdb", "v.pml", "p.pml")]
        for path in paths[:2]:
            self.run_ok("exact", UBIQUITIN, "--surface", "sas", "--write", path)
        for path in paths[2:4]:
            self.run_ok("exact", UBIQUITIN, "--surface", "sas", "--voids", path)
        self.run_ok("pockets", UBIQUITIN, "-o", paths[4])
        area = self.report("exact", UBIQUITIN, "--surface", "sas")["exact"]["area"]
        found = self.found_by(IN_PYMOL, [str(path) for path in paths], pymol, "-cq", "SCRIPT", "--")
        for path in paths[:2]:
            self.assertEqual(int(found[str(path)][0]), 602)
            self.assert_close(float(found[str(path)][1]), area, 1e-3)  # PDB has two decimals
        self.assertEqual([int(found[str(path)][0]) for path in paths[2:4]], [2, 2])
        for path in paths[3:]:
            _, b, vdw, names = found[str(path)]
            self.assert_close(float(vdw), float(b), 1e-6)
            self.assertRegex(names, r"^(voids|pockets),")


if __name__ == "__main__":
    unittest.main()
