"""exact --surface excluded: figures, columns, and what does not go with it."""

import csv
import math
import struct

from program import BAD_INPUT, LIMIT_HIT, NO_BACKEND, UBIQUITIN, ProgramTest, parse_json

# Of a property of a PLY file, as the module struct calls it.
PLY_TYPES = {"double": "d", "float": "f", "int": "i", "uint": "I", "uchar": "B"}


def ply_rows(path):
    """Vertices and faces of a binary PLY file of triangles, as dictionaries by the header's names."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements = []  # [count, format, names]
    for line in data[:end].decode().splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append([int(words[2]), "<", []])
        elif words[0] == "property" and words[1] == "list":
            elements[-1][1] += "B3" + PLY_TYPES[words[3]]
            elements[-1][2].append(words[4])
        elif words[0] == "property":
            elements[-1][1] += PLY_TYPES[words[1]]
            elements[-1][2].append(words[2])
    found, place = [], end
    for count, layout, names in elements:
        rows, size = [], struct.calcsize(layout)
        for values in struct.iter_unpack(layout, data[place : place + count * size]):
            if "vertex_indices" in names:
                values = (values[1:4], *values[4:])
            rows.append(dict(zip(names, values)))
        found.append(rows)
        place += count * size
    assert place == len(data)
    return found


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
        text = self.run_ok("exact", UBIQUITIN, "--surface", "excluded", "--verbose").stdout
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
            ("--backend", "cuda", "--topology", "on"),
        ):
            arguments = ("exact", UBIQUITIN, "--surface", "excluded", *option)
            self.assert_refused(BAD_INPUT, *arguments, says=(option[0],))
        # What rounding leaves of three small balls under a large probe is no surface, or is doubted.
        three = self.file("three.xyzr", "0 0 0 1.7\n3 0 0 1.7\n0 3 0 1.7\n")
        excluded = ("exact", three, "--surface", "excluded", "--probe")
        self.assert_refused(BAD_INPUT, *excluded, "1e6", says=("probe of 1e+06",))
        self.assertIn("by one formula", self.run_ok(*excluded, "1e5").stdout)
        self.assertNotIn("warning", self.run_ok(*excluded, "10").stdout)

    def test_cuda_has_the_same_figures_or_says_what_is_missing(self):
        table = self.folder / "a.csv"
        options = ("exact", UBIQUITIN, "--surface", "excluded", "--backend", "cuda")
        if not parse_json(self.run_ok("info", "--json", "-").stdout)["cuda"]["devices"]:
            self.assert_refused(NO_BACKEND, *options, says=("CUDA",))
            return
        report, cpu = self.report(*options, "--per-atom", table), self.measures()["excluded"]["complete"]
        cuda = report["excluded"]["complete"]
        self.assertEqual(report["backend"]["used"], "cuda")
        self.assertIsNone(report["excluded"]["exterior"])
        self.assertIsNone(cuda["shells"])
        self.assertEqual(cuda["counts"], cpu["counts"])
        self.assertEqual(cuda["euler_characteristic"], cpu["euler_characteristic"])
        for key in ("area", "volume", "contact_area", "saddle_area", "concave_area", "contact_layer",
                    "saddle_layer", "concave_layer", "accessible_area", "accessible_volume"):  # fmt: skip
            self.assert_close(cuda[key], cpu[key], 1e-11)
        with table.open(newline="") as file:
            total = math.fsum(float(row["excluded_area"]) for row in csv.DictReader(file))
        self.assert_close(total, cuda["area"], SUM)


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

    def test_subdivision_is_of_second_order(self):
        errors = []
        for levels in ("0", "1", "2"):
            path = self.folder / "u.ply"
            report = self.report("mesh", UBIQUITIN, "--surface", "excluded", "--subdivide", levels, "-o", path)
            mesh, exact = report["mesh"], report["excluded"]["complete"]
            self.assertEqual(report["parameters"]["project"], "patches" if levels != "0" else "none")
            self.assertEqual(mesh["euler_characteristic"], exact["euler_characteristic"])
            self.assertEqual(mesh["shells"], len(exact["shells"]))
            self.assertEqual(mesh["degenerate_triangles"], 0)
            if levels != "0":
                newton = mesh["newton"]
                self.assertEqual(newton["unconverged"] + newton["turned"], 0)
                self.assertEqual(newton["projected"], mesh["vertices"])
                self.assertLessEqual(newton["residual_max"], 1e-12)
            errors.append([mesh[key] / exact[key] - 1 for key in ("area", "volume")])
        for coarse, fine in zip(errors[1], errors[2]):
            self.assertAlmostEqual(coarse / fine, 4, delta=0.1)
            self.assertLessEqual(abs(fine + (fine - coarse) / 3), 1e-5)

    def test_patches_in_the_file_and_in_the_report(self):
        path = self.folder / "u.ply"
        report = self.report("mesh", UBIQUITIN, "--surface", "excluded", "--edge-length", "0.5", "-o", path)
        patches, exact = report["mesh"]["patches"], report["excluded"]["complete"]
        vertices, faces = ply_rows(path)
        kinds = ("contact", "saddle", "concave")
        for number, kind in enumerate(kinds):
            of_kind = [f for f in faces if f["patch_kind"] == number]
            self.assertEqual(len(of_kind), patches[kind]["triangles"])
            self.assert_close(patches[kind]["area"], exact[kind + "_area"], 0.03)
            for face in of_kind:
                atoms = [face[f"patch_atom{k}"] for k in (1, 2, 3)]
                self.assertEqual([a >= 0 for a in atoms], [k <= number for k in range(3)])
        self.assertEqual(sum(patches[kind]["triangles"] for kind in kinds), report["mesh"]["triangles"])
        self.assertEqual(patches["saddle"]["patches"], exact["counts"]["arcs"] + exact["counts"]["spindle_saddles"]
                         - exact["counts"]["dropped_arcs"])  # fmt: skip
        self.assertEqual(patches["concave"]["patches"], exact["counts"]["probes"])
        # Inside of patches curvature is that of a ball: of the probe, seen from inside, or an atom.
        around = [set() for _ in vertices]
        for face in faces:
            for v in face["vertex_indices"]:
                around[v].add(face["patch_kind"])
        concave = [v for v, seen in zip(vertices, around) if seen == {2}]
        self.assertGreater(len(concave), 1000)
        for vertex in concave:
            self.assert_close(vertex["mean_curvature"], -1 / 1.4, 1e-6)
            self.assert_close(vertex["gaussian_curvature"], 1 / 1.4**2, 1e-6)
        radii = {1.7, 1.55, 1.52, 1.8}  # of Bondi: C, N, O, S
        for vertex, seen in zip(vertices, around):
            if seen == {0}:
                self.assertLess(min(abs(1 / vertex["mean_curvature"] - r) for r in radii), 1e-5)

    def test_other_formats_say_what_they_lack(self):
        path = self.folder / "u.obj"
        report = self.report("mesh", UBIQUITIN, "--surface", "excluded", "--edge-length", "0.7", "-o", path)
        self.assertTrue(any("patch" in note for note in report["notes"]), report["notes"])

    def test_pictures(self):
        sizes = set()
        for color in ("element", "kind", "mean-curvature", "gaussian-curvature", "angle", "white"):
            path = self.folder / f"{color}.png"
            self.run_ok("render", UBIQUITIN, "--surface", "excluded", "--edge-length", "0.7", "--subdivide", "0",
                        "--color", color, "--size", "300x200", "-o", path)  # fmt: skip
            self.assertTrue(path.read_bytes().startswith(b"\x89PNG"))
            sizes.add(path.read_bytes())
        self.assertEqual(len(sizes), 6)

    def test_refusals_of_pictures(self):
        picture = ("-o", self.folder / "u.png")
        for color in ("kind", "mean-curvature", "gaussian-curvature"):
            self.assert_refused(BAD_INPUT, "render", UBIQUITIN, "--color", color, *picture, says=("--color",))
        self.assert_refused(BAD_INPUT, "render", UBIQUITIN, "--surface", "excluded", "--color", "distance",
                            *picture, says=("--color distance",))  # fmt: skip

    def test_refusals(self):
        for option in (
            ("--mesher", "marching-cubes"),
            ("--project", "vdw"),
            ("--crossings", "allow"),
            ("--relative-edge", "0.2"),
            ("--spacing", "0.5"),
            ("--probe", "0"),
            ("--backend", "cuda"),
            ("--field", "blinn"),
        ):
            arguments = ("mesh", UBIQUITIN, "--surface", "excluded", "-o", self.folder / "u.ply", *option)
            self.assert_refused(BAD_INPUT, *arguments, says=(option[0],))


class ExcludedReport(ProgramTest):
    """report and compare --surface excluded: meshes beside the exact surface, with distances."""

    def check_comparison(self, report):
        mesh, exact = report["mesh"], report["excluded"]["complete"]
        comparison = report["comparison"]
        self.assertEqual(comparison["surface"], "excluded")
        self.assertIsNone(report["exact"])
        self.assert_close(comparison["area_relative_error"], mesh["area"] / exact["area"] - 1, 1e-12)
        self.assert_close(comparison["volume_relative_error"], mesh["volume"] / exact["volume"] - 1, 1e-12)
        self.assertEqual(comparison["euler_characteristic_difference"], 0)
        # A chord of 0.5 Å is 0.022 Å from a circle of 1.4 Å in its middle.
        for way in ("mesh_to_surface", "surface_to_mesh"):
            self.assertLess(comparison[way]["rms"], 0.022)
            self.assertLess(comparison[way]["max"], 0.1)
        self.assertEqual(comparison["distances_backend"], "cpu")

    def test_report_and_compare_agree(self):
        table, path = self.folder / "a.csv", self.folder / "u.ply"
        options = ("--surface", "excluded", "--edge-length", "0.5")
        report = self.report("report", UBIQUITIN, *options, "--per-atom", table)
        self.check_comparison(report)
        self.assertEqual(report["input"]["probe"], 1.4)
        self.assertEqual(report["mesh"]["self_intersections"], 0)
        self.assertIs(report["comparison"]["proof"]["topology_is_exact"], True)
        self.assertIsNone(report["comparison"]["proof"]["atom_area_error"])
        self.assertGreater(report["parameters"]["memory_estimate"], 0)
        for stage in ("plan", "extract", "measure", "exact", "compare"):
            self.assertGreaterEqual(report["timing"][stage], 0)
        with table.open(newline="") as file:
            total = math.fsum(float(row["excluded_area"]) for row in csv.DictReader(file))
        self.assert_close(total, report["excluded"]["complete"]["area"], SUM)
        self.run_ok("mesh", UBIQUITIN, *options, "-o", path)
        compared = self.report("compare", path, UBIQUITIN, "--surface", "excluded")
        self.check_comparison(compared)
        self.assertIsNone(compared["comparison"]["proof"])
        for key in ("mesh_to_surface", "surface_to_mesh"):
            self.assert_close(compared["comparison"][key]["mean"], report["comparison"][key]["mean"], 1e-3)

    def test_another_probe_and_the_union_are_farther(self):
        path = self.folder / "u.ply"
        self.run_ok("mesh", UBIQUITIN, "--surface", "excluded", "--edge-length", "0.7", "-o", path)
        near = self.report("compare", path, UBIQUITIN, "--surface", "excluded")
        other = self.report("compare", path, UBIQUITIN, "--surface", "excluded", "--probe", "2")
        union = self.report("compare", path, UBIQUITIN)
        self.assertEqual(union["comparison"]["surface"], "vdw")
        mean = [r["comparison"]["mesh_to_surface"]["mean"] for r in (near, other, union)]
        self.assertLess(4 * mean[0], min(mean[1:]))

    def test_the_text_sets_them_side_by_side(self):
        text = self.run_ok("report", UBIQUITIN, "--surface", "excluded", "--edge-length", "0.6", "--verbose").stdout
        for words in ("mesh - exact", "Tunnels (genus)", "are those of the excluded surface",
                      "surface to mesh", "Hausdorff distance", "no point of the mesh is farther than"):
            self.assertIn(words, text)

    def test_without_topology_and_distances(self):
        report = self.report("report", UBIQUITIN, "--surface", "excluded", "--edge-length", "0.8",
                             "--topology", "off", "--distances", "off")
        self.assertIsNone(report["comparison"]["euler_characteristic_difference"])
        self.assertIsNone(report["comparison"]["proof"]["topology_is_exact"])
        self.assertIsNone(report["comparison"]["mesh_to_surface"])
        self.assertLess(abs(report["comparison"]["area_relative_error"]), 0.1)

    def test_memory_is_checked_before(self):
        for verb in (("report", UBIQUITIN), ("mesh", UBIQUITIN, "-o", self.folder / "u.ply")):
            self.assert_refused(LIMIT_HIT, *verb, "--surface", "excluded", "--edge-length", "0.01",
                                "--memory-limit", "200M", says=("memory", "--edge-length"))

    def test_a_mesh_of_the_outside_alone(self):
        """A cube of eight atoms around a cavity, and a ball that fills the cavity: one exterior surface."""
        cage = "".join(f"{x} {y} {z} 1.5\n" for x in (-2, 2.1) for y in (-2.05, 2) for z in (-2, 2.02))
        walls = "".join(f"{s * x} {s * y} {s * z} 1.7\n" for x, y, z in ((2.2, 0, 0), (0, 2.2, 0), (0, 0, 2.2))
                        for s in (-1, 1))  # fmt: skip
        hollow = self.file("hollow.xyzr", cage + walls)
        filled = self.file("filled.xyzr", cage + walls + "0 0 0 0.9\n")
        options, path = ("--surface", "excluded", "--probe", "0.4"), self.folder / "outside.ply"
        self.run_ok("mesh", filled, *options, "--edge-length", "0.3", "-o", path)
        alone, beside = (self.report("compare", path, atoms, *options) for atoms in (filled, hollow))
        self.assertIsNone(alone["comparison"]["exterior"])
        self.assertEqual(beside["excluded"]["complete"]["cavities"], 1)
        outside, expected = beside["comparison"]["exterior"], alone["comparison"]
        self.assertEqual(outside["euler_characteristic_difference"], 0)
        self.assertEqual(beside["comparison"]["euler_characteristic_difference"], -2)
        for key in ("area_relative_error", "volume_relative_error"):
            self.assert_close(outside[key], expected[key], 1e-9)
        self.assert_close(outside["mesh_to_surface"]["mean"], expected["mesh_to_surface"]["mean"], 1e-9)
        self.assertLess(outside["surface_to_mesh"]["max"], 0.1)
        self.assertGreater(beside["comparison"]["surface_to_mesh"]["max"], 0.5)
        text = self.run_ok("compare", path, hollow, *options, "--verbose").stdout
        for words in ("Mesh - exterior surface", "Euler characteristic equal", "Distance, exterior"):
            self.assertIn(words, text)
        # A mesh with the walls of the cavity is not held to be one of the exterior surface.
        self.run_ok("mesh", hollow, *options, "--edge-length", "0.3", "-o", path)
        complete = self.report("compare", path, hollow, *options)["comparison"]
        self.assertEqual(complete["euler_characteristic_difference"], 0)
        self.assertEqual(complete["exterior"]["euler_characteristic_difference"], 2)
        self.assertIsNone(complete["exterior"]["mesh_to_surface"])
        # Nor is it if a triangle is missing, so that nobody knows what is a wall.
        path = path.with_suffix(".off")
        self.run_ok("mesh", hollow, *options, "--edge-length", "0.3", "-o", path)
        lines = [line for line in path.read_text().splitlines() if line.strip() and line[0] != "#"]
        vertices, faces, *rest = lines[1].split()
        lines[1:] = [" ".join([vertices, str(int(faces) - 1), *rest]), *lines[2:-1]]
        path.write_text("\n".join(lines) + "\n")
        opened = self.report("compare", path, hollow, *options, "--self-intersections", "off")
        self.assertIs(opened["mesh"]["closed"], False)
        self.assertIsNone(opened["mesh"]["self_intersections"])
        self.assertIsNone(opened["comparison"]["exterior"]["mesh_to_surface"])

    def test_refusals(self):
        for option in (("--method", "arcs"), ("--topology", "counts"), ("--probe", "0"), ("--backend", "cuda")):
            self.assert_refused(BAD_INPUT, "report", UBIQUITIN, "--surface", "excluded", *option, says=(option[0],))


class ForeignMesh(ProgramTest):
    """compare --surface excluded: a mesh that no program of ours made, of a surface of revolution."""

    # Two carbon-like atoms on the z axis, far enough apart for a waist, which the probe of 1.4 Å rolls around.
    RADIUS, APART, PROBE = 1.7, 4.0, 1.4

    def profile(self, steps):
        """Distance from the axis and height of points of the surface, and of its exact area and volume."""
        grown = self.RADIUS + self.PROBE
        ring = math.sqrt(grown**2 - (self.APART / 2) ** 2)
        touch = math.acos(self.APART / 2 / grown)  # at an atom's centre, from the axis towards the other atom
        contact = [math.pi * k / steps for k in range(steps + 1) if math.pi * k / steps < math.pi - touch]
        sphere = [(self.RADIUS * math.sin(a), self.APART / 2 + self.RADIUS * math.cos(a))
                  for a in contact + [math.pi - touch]]  # fmt: skip
        end = math.pi / 2 - touch  # the profile's angle from the plane in the middle
        waist = [end * (1 - 2 * k / steps) for k in range(1, steps)]
        saddle = [(ring - self.PROBE * math.cos(a), self.PROBE * math.sin(a)) for a in waist]
        points = sphere + saddle + [(x, -z) for x, z in reversed(sphere)]
        area = 2 * 2 * math.pi * self.RADIUS**2 * (1 + math.cos(touch))
        area += 2 * math.pi * self.PROBE * (ring * 2 * end - 2 * self.PROBE * math.sin(end))
        return points, area

    def soup(self, steps):
        """Separate triangles, as STL has them: no vertex is shared, and nothing is labelled."""
        points, area = self.profile(steps)
        turns = [2 * math.pi * k / steps for k in range(steps)]
        triangles = []
        for (r0, z0), (r1, z1) in zip(points, points[1:]):
            for k, a in enumerate(turns):
                b = turns[(k + 1) % steps]
                corner = [(r * math.cos(t), r * math.sin(t), z) for r, z, t in
                          ((r0, z0, a), (r1, z1, a), (r1, z1, b), (r0, z0, b))]  # fmt: skip
                if r1 > 1e-9:
                    triangles.append((corner[0], corner[1], corner[2]))
                if r0 > 1e-9:
                    triangles.append((corner[0], corner[2], corner[3]))
        path = self.folder / "foreign.stl"
        with path.open("wb") as file:
            file.write(bytes(80) + struct.pack("<I", len(triangles)))
            for t in triangles:
                file.write(struct.pack("<12fH", 0, 0, 0, *t[0], *t[1], *t[2], 0))
        return path, area

    def test_a_soup_of_triangles_is_joined_and_judged(self):
        half = self.APART / 2
        atoms = self.file("two.xyzr", f"0 0 {half} {self.RADIUS}\n0 0 {-half} {self.RADIUS}\n")
        steps = 96
        path, area = self.soup(steps)
        report = self.report("compare", path, atoms, "--surface", "excluded")
        exact, mesh, comparison = report["excluded"]["complete"], report["mesh"], report["comparison"]
        self.assert_close(exact["area"], area, 1e-12)
        self.assertIs(mesh["closed"], True)
        self.assertEqual(mesh["euler_characteristic"], 2)
        self.assertEqual(comparison["euler_characteristic_difference"], 0)
        # Chords of the longest step are no farther from the widest circle than its sagitta, twice for both directions.
        sagitta = self.RADIUS * (1 - math.cos(math.pi / steps))
        for way in ("mesh_to_surface", "surface_to_mesh"):
            self.assertLess(comparison[way]["max"], 2 * sagitta + 1e-6)
            self.assertGreater(comparison[way]["max"], sagitta / 2)
        self.assertLess(abs(comparison["area_relative_error"]), 2e-3)
        self.assertLess(comparison["area_relative_error"], 0)
        # The union and a smaller probe are other surfaces.
        for other in (("--surface", "excluded", "--probe", "0.7"), ("--surface", "vdw")):
            there = self.report("compare", path, atoms, *other)["comparison"]
            self.assertGreater(there["mesh_to_surface"]["max"], 20 * sagitta)
