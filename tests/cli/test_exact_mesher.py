"""--mesher exact: the crease-exact mesh on the command line."""

import csv

from program import ProgramTest


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
        errors = [1 - level["area"] / exact["area"] for level in mesh["levels"]]
        self.assertGreater(errors[1] / errors[2], 3.8)
        self.assertLess(errors[1] / errors[2], 4.2)

    def test_area_of_every_atom_is_near_the_exact_one(self):
        path = self.folder / "atoms.csv"
        self.exact_report("--edge-length", "0.2", "--subdivide", "0", "--distances", "off", "--per-atom",
                    str(path))
        with open(path, newline="") as file:
            for row in csv.DictReader(file):
                exact, mesh = float(row["exact_area"]), float(row["mesh_area"])
                if exact > 1:
                    self.assertLess(abs(mesh - exact) / exact, 0.01, row)
