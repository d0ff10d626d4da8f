"""exact --surface excluded: figures, columns, and what does not go with it."""

import csv
import math

from program import BAD_INPUT, UBIQUITIN, ProgramTest

SUM = 1e-12  # relative: rounding of sums over some thousand patches
CLOSED = 1e-14  # of the area


class Excluded(ProgramTest):
    def measures(self, *arguments):
        return self.report("exact", UBIQUITIN, "--surface", "excluded", *arguments)

    def test_what_ties_the_figures_together(self):
        report = self.measures()
        self.assertIsNone(report["exact"])
        excluded = report["excluded"]
        self.assertEqual(excluded["probe"], 1.4)
        self.assertEqual(report["input"]["probe"], 1.4)
        for surface in (excluded["complete"], excluded["exterior"]):
            areas = sum(surface[kind + "_area"] for kind in ("contact", "saddle", "concave"))
            layers = sum(surface[kind + "_layer"] for kind in ("contact", "saddle", "concave"))
            self.assert_close(areas, surface["area"], SUM)
            self.assert_close(surface["accessible_volume"] - layers, surface["volume"], SUM)
            self.assert_close(surface["check_volume"], surface["volume"], SUM)
            self.assert_close(sum(s["area"] for s in surface["shells"]), surface["area"], SUM)
            self.assert_close(sum(s["volume"] for s in surface["shells"]), surface["volume"], SUM)
            euler = sum(s["euler_characteristic"] for s in surface["shells"])
            self.assertEqual(euler, surface["euler_characteristic"])
            for shell in surface["shells"]:
                self.assertEqual(shell["euler_characteristic"], 2 - 2 * shell["genus"])
            self.assertLessEqual(surface["closure"], CLOSED)
            self.assertEqual(surface["uncertified_patches"], 0)
        self.assertEqual(excluded["exterior"]["cavities"], 0)

    def test_the_accessible_surface_is_that_of_the_balls_grown_by_the_probe(self):
        grown = self.report("exact", UBIQUITIN, "--probe", "2.1")["exact"]
        complete = self.measures("--probe", "2.1")["excluded"]["complete"]
        self.assert_close(complete["accessible_area"], grown["area"], SUM)
        self.assert_close(complete["accessible_volume"], grown["volume"], SUM)

    def test_shares_of_atoms_and_residues(self):
        for group, rows in (("atom", 602), ("residue", 76)):
            table = self.folder / "a.csv"
            complete = self.measures("--per-atom", table, "--group", group)["excluded"]["complete"]
            with table.open(newline="") as file:
                shares = list(csv.DictReader(file))
            self.assertEqual(len(shares), rows)
            columns = {"excluded_area": "area", "excluded_volume": "volume"}
            columns |= {kind + "_area": kind + "_area" for kind in ("contact", "saddle", "concave")}
            for column, key in columns.items():
                total = math.fsum(float(row[column]) for row in shares)
                self.assert_close(total, complete[key], SUM)

    def test_without_shells(self):
        complete = self.measures("--topology", "off")["excluded"]["complete"]
        self.assertIsNone(complete["shells"])
        self.assertIsNone(complete["euler_characteristic"])
        self.assertGreater(complete["area"], 0)

    def test_the_text_has_both_surfaces(self):
        text = self.run_ok("exact", UBIQUITIN, "--surface", "excluded").stdout
        for word in ("complete", "exterior", "contact", "saddle", "concave", "Euler characteristic"):
            self.assertIn(word, text)

    def test_refusals(self):
        for option in (
            ("--certify",),
            ("--method", "arcs"),
            ("--voids", "v.csv"),
            ("--measure", "(ALA)"),
            ("--probe", "0"),
            ("--topology", "counts"),
            ("--backend", "cuda"),
        ):
            arguments = ("exact", UBIQUITIN, "--surface", "excluded", *option)
            self.assert_refused(BAD_INPUT, *arguments, says=(option[0],))


class ExcludedMesh(ProgramTest):
    """mesh --surface excluded: the mesh beside the exact figures."""

    def test_mesh_and_exact_figures(self):
        path = self.folder / "u.ply"
        report = self.report("mesh", UBIQUITIN, "--surface", "excluded", "--edge-length", "0.5", "-o", path)
        self.assertEqual(report["parameters"]["surface"], "excluded")
        self.assertEqual(report["input"]["probe"], 1.4)
        mesh, exact = report["mesh"], report["excluded"]["complete"]
        self.assertTrue(mesh["closed"] and mesh["manifold"] and mesh["oriented"])
        self.assertEqual(mesh["euler_characteristic"], exact["euler_characteristic"])
        self.assertEqual(mesh["shells"], len(exact["shells"]))
        self.assertEqual(mesh["degenerate_triangles"], 0)
        # Chords of pieces of 0.5 Å on radii of some 1.5 Å.
        self.assert_close(mesh["area"], exact["area"], 0.02)
        self.assert_close(mesh["volume"], exact["volume"], 0.02)
        header = path.read_bytes()[:2000].decode("latin-1")
        self.assertIn(f"element face {mesh['triangles']}\n", header)

    def test_refusals(self):
        for option in (
            ("--mesher", "marching-cubes"),
            ("--subdivide", "1"),
            ("--relative-edge", "0.2"),
            ("--spacing", "0.5"),
            ("--probe", "0"),
            ("--backend", "cuda"),
            ("--field", "blinn"),
        ):
            arguments = ("mesh", UBIQUITIN, "--surface", "excluded", "-o", self.folder / "u.ply", *option)
            self.assert_refused(BAD_INPUT, *arguments, says=(option[0],))
