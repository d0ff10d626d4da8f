"""vdwmesh pockets: its table beside another program's, its JSON, and refusals."""

import collections
import csv
import math
import re
from xml.etree import ElementTree

import program
from program import BAD_INPUT, DONE, UBIQUITIN, ProgramTest, need_shared, parse_json, run, schema_validator

TWELVE_DIGITS = 1e-9  # the other program's table has twelve digits, its largest figure is 4296
LISTS = {"lining_areas", "lining_residues", "mouth_table"}


class Pockets(ProgramTest):
    def table(self, *arguments):
        path = self.folder / "pockets.csv"
        self.run_ok("pockets", *arguments, "--csv", path, "--quiet")
        with path.open(newline="") as file:
            return list(csv.DictReader(file))

    def test_beside_another_program(self):
        with need_shared("reference/pockets.csv").open(newline="") as file:
            expected = [row for row in csv.DictReader(file) if row["set"] == "1CRN"]
        rows = self.table(need_shared("reference/1CRN.xyzr"))
        self.assertEqual(len(rows), len(expected))
        for row, other in zip(rows, expected, strict=True):
            self.assertLessEqual(set(other), set(row))
            for name in other:
                if name in ("ms_volume", "ms_area"):
                    self.assertEqual(row[name], "")
                elif name == "kind":
                    self.assertEqual(row[name] == "void", other[name] == "void")
                elif name == "set":
                    self.assertEqual(row[name], other[name])
                else:
                    value = float(other[name])
                    self.assert_near(float(row[name]), value, TWELVE_DIGITS * max(1, abs(value)))

    def test_meshes_have_an_object_for_each_pocket_and_a_group_for_each_mouth(self):
        path = self.folder / "rooms.obj"
        report = self.report("pockets", UBIQUITIN, "--mesh", path, "--edge-length", "0.2")
        objects, places = collections.defaultdict(list), []
        for line in path.read_text().splitlines():
            word, *rest = line.split()
            if word == "v":
                places.append(tuple(map(float, rest)))
            elif word == "o":
                name = rest[0]
            elif word == "g":
                group = rest[0]
            elif word == "f":
                objects[name].append((group, [int(index) - 1 for index in rest]))
        pockets = report["pockets"]["pockets"]
        self.assertEqual(list(objects), [f"pocket_{p['rank']}" for p in pockets])
        for pocket, (name, faces) in zip(pockets, objects.items(), strict=True):
            mouths = {f"{name}_mouth_{k + 1}" for k in range(pocket["mouths"])}
            self.assertEqual({group for group, _ in faces}, {f"{name}_wall"} | mouths)
            halves = [pair for _, (a, b, c) in faces for pair in ((a, b), (b, c), (c, a))]
            self.assertEqual(len(halves), len(set(halves)))
            self.assertEqual(set(halves), {(b, a) for a, b in halves})
            volume = math.fsum(
                x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) + x[2] * (y[0] * z[1] - y[1] * z[0])
                for x, y, z in ([places[v] for v in face] for _, face in faces)) / 6  # fmt: skip
            # Chords of 0.2 Å on balls of 2.5 Å or more.
            self.assert_near(volume, pocket["volume"], 0.2**2 / 8 / 2.5 * pocket["area"])

    def test_meshes_as_glb_have_nodes_with_names(self):
        path = self.folder / "rooms.glb"
        self.run_ok("pockets", UBIQUITIN, "--mesh", path, "--quiet")
        data = path.read_bytes()
        document = parse_json(data[20 : 20 + int.from_bytes(data[12:16], "little")].decode())
        rows = self.table(UBIQUITIN)
        nodes = [document["nodes"][i] for i in document["scenes"][0]["nodes"]]
        self.assertEqual([n["name"] for n in nodes], [f"pocket {row['rank']}" for row in rows])
        for node, row in zip(nodes, rows, strict=True):
            below = [document["nodes"][i]["name"] for i in node.get("children", [])]
            self.assertEqual(below, [f"{node['name']} mouth {k + 1}" for k in range(int(row["mouths"]))])

    def assert_near(self, value, expected, error):
        self.assertTrue(abs(value - expected) <= error, f"{value} is not {expected}")

    def test_json_has_the_columns_of_the_table(self):
        rows = self.table(UBIQUITIN)
        report = self.report("pockets", UBIQUITIN)
        pockets = report["pockets"]["pockets"]
        self.assertEqual(report["pockets"]["face_ties"], 0)
        self.assertEqual(len(rows), len(pockets))
        for row, pocket in zip(rows, pockets, strict=True):
            self.assertEqual(set(row), set(pocket) - LISTS)
            self.assertEqual(len(row["lining"].split()), len(pocket["lining_areas"]))
            self.assert_near(math.fsum(pocket["lining_areas"]), pocket["area"], 1e-10)
            self.assertEqual(len(pocket["mouth_table"]), int(row["mouths"]))
            residues = collections.defaultdict(float)
            for atom, area in zip(row["lining"].split(), pocket["lining_areas"], strict=True):
                residues[atom.rpartition("/")[0]] += area
            found = [(re.sub("/[A-Z]+ ", "/", r["residue"]), r["area"]) for r in pocket["lining_residues"]]
            self.assertEqual(found, sorted(found, key=lambda pair: -pair[1]))
            self.assertEqual({name for name, _ in found}, set(residues))
            for name, area in found:
                self.assert_near(area, residues[name], 1e-12)
            self.assert_near(float(row["volume"]), pocket["volume"], 0)

    def test_voids_are_those_of_exact(self):
        voids = self.folder / "voids.csv"
        self.run_ok("exact", UBIQUITIN, "--probe", "1.4", "--voids", voids)
        with voids.open(newline="") as file:
            expected = list(csv.DictReader(file))
        found = [row for row in self.table(UBIQUITIN) if row["kind"] == "void"]
        self.assertEqual([row["lining"] for row in found], [row["lining"] for row in expected])
        for row, other in zip(found, expected, strict=True):
            self.assert_near(float(row["volume"]), float(other["volume"]), 1e-11)

    def test_text_names_the_largest(self):
        text = self.run_ok("pockets", UBIQUITIN).stdout
        self.assertRegex(text, r"Pockets +\d+: with one mouth: \d+, channels: \d+, voids: 2; ties: 0")
        self.assertRegex(text, r"(?m)^ +1  pocket +\d+\.\d+ ")

    def test_margins(self):
        for row in self.table(UBIQUITIN):
            bottleneck, fits, margin = (float(row[k]) for k in ("bottleneck_radius", "depth_probe", "margin"))
            self.assert_near(margin, min(abs(bottleneck - 1.4), fits - 1.4), 1e-12)
            if row["kind"] != "void" or 1.4 - bottleneck > fits - 1.4:
                continue
            # A little less than the margin leaves the void, a little more opens it.
            for change, voids in ((-1e-6, 1), (1e-6, 0)):
                found = self.table(UBIQUITIN, "--probe", f"{1.4 - margin - change:.9f}")
                kinds = [r["kind"] for r in found if math.dist(self.place(r), self.place(row)) < 1e-6]
                self.assertEqual(kinds.count("void"), voids)

    @staticmethod
    def place(row):
        return [float(row[f"depth_{axis}"]) for axis in "xyz"]

    def test_scan_has_the_voids_of_each_probe(self):
        path = self.folder / "places.csv"
        scan = self.report("pockets", UBIQUITIN, "--scan", "1.2:2.5", "-o", path)["scan"]
        self.assertTrue(scan["is_complete"])
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(scan["places"]))
        for probe in ("1.3", "1.4"):
            alive = [r for r in rows if float(r["radius"]) > float(probe) and float(r["joins_at"] or 0) <= float(probe)]
            voids = [r for r in self.table(UBIQUITIN, "--probe", probe) if r["kind"] == "void"]
            self.assertEqual(len(alive), len(voids))
            for row in voids:
                nearest = min(alive, key=lambda r, row=row: math.dist([float(r[a]) for a in "xyz"], self.place(row)))
                self.assert_near(float(nearest["opens_at"] or row["bottleneck_radius"]), float(row["bottleneck_radius"]), 1e-9)
        self.assert_refused(BAD_INPUT, "pockets", UBIQUITIN, "--scan", "2", says=("--scan", "LO:HI"))
        self.assert_refused(BAD_INPUT, "pockets", UBIQUITIN, "--scan", "2:1", says=("smaller",))

    def test_shell_is_the_difference_of_two_surfaces(self):
        with need_shared("reference/pockets_shell.csv").open(newline="") as file:
            expected = [row for row in csv.DictReader(file) if row["set"] in ("1CRN", "1UBQ")]
        for row in expected:
            path = self.folder / "shell.csv"
            report = self.report("pockets", need_shared(f"reference/{row['set']}.xyzr"), "--shell", row["large_probe"],
                                 "-o", path)["shell"]  # fmt: skip
            with path.open(newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(list(rows[0])[: len(row)], list(row))
            for name in row:
                if name != "set":
                    self.assert_near(float(rows[0][name]), float(row[name]), TWELVE_DIGITS * max(1, float(row[name])))
            self.assertEqual(len(rows), len(report["pockets"]))
            for found, pocket in zip(rows, report["pockets"], strict=True):
                self.assertEqual(found["shell_exterior"], rows[0]["shell_exterior"])
                self.assertEqual(found["pocket_lining"], pocket["lining"])
                self.assertEqual(len(pocket["lining"].split()), pocket["atoms"])
                for name in ("volume", "area", "mouth_area", "mouths"):
                    self.assert_near(float(found[f"pocket_{name}"]), pocket[name], 0)
            total = report["shell_exterior"]
            self.assert_near(sum(pocket["volume"] for pocket in report["pockets"]), total, 1e-10 * total)

    def test_shell_of_cages(self):
        """A probe of 1.2 Å gets into the host A1 and one of 1.4 Å does not: its exit is 1.2302 Å (notes/pockets.md).

        MoloVol's grid gives the room of the cavity 1410.7 Å³.
        """
        cage = need_shared("molecules/cages/A1.pdb.gz")
        shells = {p: self.report("pockets", cage, "--radii", "alvarez", "--probe", p, "--shell", "4")["shell"]
                  for p in ("0.8", "1.2", "1.4")}  # fmt: skip
        room = {p: s["shell_complete"] - s["shell_exterior"] for p, s in shells.items()}
        self.assert_near(room["0.8"], 0, 1e-9)
        self.assert_near(room["1.2"], 0, 1e-9)
        self.assertLess(abs(room["1.4"] / 1410.7 - 1), 0.05)
        for shell in shells.values():
            self.assert_near(sum(p["volume"] for p in shell["pockets"]), shell["shell_exterior"], 1e-7)
        self.assertGreater(shells["1.2"]["pockets"][0]["volume"], room["1.4"])
        self.assertLess(shells["1.4"]["pockets"][0]["volume"], room["1.4"])

    def test_shell_without_pockets(self):
        path, table = self.folder / "ball.xyzr", self.folder / "ball.csv"
        path.write_text("0 0 0 1.5\n")
        shell = self.report("pockets", path, "--shell", "4", "-o", table)["shell"]
        self.assertEqual(shell["pockets"], [])
        with table.open(newline="") as file:
            (row,) = csv.DictReader(file)
        self.assertEqual(row["pocket_volume"], "")
        self.assert_near(float(row["shell_exterior"]), 0, 1e-12)

    def test_way_out(self):
        path = self.folder / "way.csv"
        way = self.report("pockets", UBIQUITIN, "--from", "pocket:1", "-o", path)["way"]
        first = self.table(UBIQUITIN)[0]
        self.assert_near(way["bottleneck"], float(first["bottleneck_radius"]), 1e-9)
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(way["points"]))
        self.assert_near(math.dist([float(rows[0][a]) for a in "xyz"], self.place(first)), 0, 1e-6)
        for place in ("A/LEU 50/CD1", "A/50/CD1", "30,28,14"):
            self.assertGreater(self.report("pockets", UBIQUITIN, "--from", place)["way"]["length"], 0)
        self.assert_refused(BAD_INPUT, "pockets", UBIQUITIN, "--from", "A/1/XX", says=("--from", "pocket:1"))

    def rows(self, *arguments, code=DONE):
        result = run("batch", *arguments, "--verb", "pockets")
        self.assertEqual(result.returncode, code, result.stderr)
        rows = [parse_json(line) for line in result.stdout.splitlines()]
        for row in rows:
            schema_validator("batch").validate(row)
        return rows

    def test_batch_has_the_pockets_of_single_calls(self):
        two = self.file("two.xyzr", "0 0 0 1\n2.5 0 0 1\n")
        bad = self.file("bad.xyzr", "0 0 0\n")
        ubiquitin, few, refused = self.rows(UBIQUITIN, two, bad, code=BAD_INPUT)
        single = self.report("pockets", UBIQUITIN)["pockets"]
        self.assertEqual(ubiquitin["pockets"], single)
        self.assertEqual(ubiquitin["pocket_count"], len(single["pockets"]))
        self.assertEqual(ubiquitin["voids"], 2)
        self.assert_near(ubiquitin["pocket_volume"], math.fsum(p["volume"] for p in single["pockets"]), 1e-10)
        self.assertEqual((few["pocket_count"], few["pocket_volume"]), (0, 0))
        self.assertIsNone(refused["pockets"])
        self.assertIn("bad.xyzr", refused["error"])

    def test_batch_table_goes_on(self):
        two = self.file("two.xyzr", "0 0 0 1\n2.5 0 0 1\n")
        path, call = self.folder / "rows.csv", ("batch", UBIQUITIN, two, "--verb", "pockets", "-o")
        self.run_ok(*call, path)
        whole = path.read_bytes()
        self.assertIn(b",pocket_count,pocket_volume,", whole.splitlines()[0])
        path.write_bytes(whole[: len(whole) - 20])
        self.run_ok(*call, path)
        self.assertEqual(path.read_bytes(), whole)
        self.assert_refused(BAD_INPUT, *call, path, "--sums", says=("name another file",))

    def test_sums_alone_are_those_beside_exact_figures(self):
        exact = self.report("pockets", UBIQUITIN)["pockets"]["pockets"]
        sums = self.report("pockets", UBIQUITIN, "--sums")["pockets"]["pockets"]
        key = lambda p: p["depth_alpha"]  # noqa: E731
        self.assertEqual(len(sums), len(exact))
        for one, other in zip(sorted(sums, key=key), sorted(exact, key=key), strict=True):
            for name in ("kind", "volume_sum", "area_sum", "mouth_area_sum", "mouth_rim_sum", "atoms", "bottleneck_alpha"):
                self.assertEqual(one[name], other[name], name)
            for name in ("volume", "area", "mouth_area", "mouth_rim", "depth_probe"):
                self.assertIsNone(one[name], name)
            self.assertTrue(all(m["area"] is None for m in one["mouth_table"]))
        (row,) = self.rows(UBIQUITIN, "--sums")
        self.assertEqual(row["pockets"]["pockets"], sums)
        self.assertIsNone(row["pocket_volume"])

    def test_spheres_of_a_cube(self):
        """The centre of the cube is the orthogonal centre of each of its tetrahedra."""
        corners = [(x, y, z) for x in (0, 4.6) for y in (0, 4.6) for z in (0, 4.6)]
        cube = self.file("cube.xyzr", "".join(f"{x} {y} {z} 1.5\n" for x, y, z in corners))
        (row,) = self.table(cube)
        radius = math.sqrt(3) * 2.3 - 1.5
        for name in ("s.pdb", "s.pml", "s.bild"):
            self.run_ok("pockets", cube, "-o", self.folder / name, "--quiet")
        records = [line for line in (self.folder / "s.pdb").read_text().splitlines() if line.startswith("HETATM")]
        self.assertEqual(len(records), int(row["tetrahedra"]))
        for line in records:
            self.assertEqual((line[12:16], line[17:20], line[21], line[22:26]), ("APOL", "STP", "C", "   1"))
            self.assertEqual([float(line[k : k + 8]) for k in (30, 38, 46)], [2.3, 2.3, 2.3])
            self.assertEqual(float(line[60:66]), round(radius, 2))
        script = (self.folder / "s.pml").read_text()
        self.assertIn("\n".join(records), script)
        self.assertIn("select channel_1, pockets and resi 1", script)
        spheres = [line.split()[1:] for line in (self.folder / "s.bild").read_text().splitlines() if ".sphere" in line]
        self.assertEqual(len(spheres), len(records))
        for x, y, z, r in spheres:
            self.assert_near(float(x) + float(y) + float(z), 6.9, 1e-12)
            self.assert_near(float(r), radius, 1e-12)

    def test_spheres_and_plots_of_other_questions(self):
        """Of a cube: one place, which opens through six gates at once, and one gate on the way."""
        side, radius = 4.6, 1.5
        corners = [(x, y, z) for x in (0, side) for y in (0, side) for z in (0, side)]
        cube = self.file("cube.xyzr", "".join(f"{x} {y} {z} {radius}\n" for x, y, z in corners))
        fits, gate = math.sqrt(3) * side / 2 - radius, side / math.sqrt(2) - radius
        scene, ways = self.folder / "s.mvsj", ("--from", f"{side / 2},{side / 2},{side / 2}")
        self.run_ok("pockets", cube, "-o", scene, "--quiet")
        (row,) = self.table(cube)
        tree = parse_json(scene.read_text())
        self.assertEqual(tree["metadata"]["version"], "1")
        (group,) = tree["root"]["children"]
        self.assertEqual((group["kind"], group["params"]["color"]), ("primitives", "#e69e00"))
        self.assertTrue(group["params"]["tooltip"].startswith("channel 1, 13.497"), group["params"]["tooltip"])
        self.assertEqual(len(group["children"]), int(row["tetrahedra"]))
        self.assertEqual({(n["kind"], n["params"]["kind"]) for n in group["children"]}, {("primitive", "ellipsoid")})
        self.assert_near(group["children"][0]["params"]["radius"], fits, 1e-12)
        self.run_ok("pockets", cube, "--scan", "0.5:3", "-o", self.folder / "places.bild", "--quiet")
        (sphere,) = [line for line in (self.folder / "places.bild").read_text().splitlines() if ".sphere" in line]
        for number, expected in zip(sphere.split()[1:], (side / 2,) * 3 + (fits,), strict=True):
            self.assert_near(float(number), expected, 1e-12)
        points = self.report("pockets", cube, *ways, "-o", self.folder / "way.pdb")["way"]["points"]
        records = [line for line in (self.folder / "way.pdb").read_text().splitlines() if line.startswith("HETATM")]
        self.assertEqual([float(line[60:66]) for line in records], [round(p["radius"], 2) for p in points])
        for question in (("--scan", "0.5:3"), ways):
            self.run_ok("pockets", cube, *question, "-o", self.folder / "plot.svg", "--quiet")
            svg = ElementTree.parse(self.folder / "plot.svg").getroot()
            (title,) = svg.iter("{http://www.w3.org/2000/svg}title")
            self.assertIn(f"{gate:.4f} Å", title.text)
        # The line of the place ends at the dot, 0.5 Å being at the left edge of 60 and `fits` at 760.
        self.run_ok("pockets", cube, "--scan", "0.5:3", "-o", self.folder / "plot.svg", "--quiet")
        (dot,) = ElementTree.parse(self.folder / "plot.svg").getroot().iter("{http://www.w3.org/2000/svg}circle")
        self.assert_near(float(dot.get("cx")), 60 + 700 * (gate - 0.5) / (fits - 0.5), 0.01)

    def test_refuses_what_it_cannot_write(self):
        for arguments, says in (
            (("-o", "x.glb"), "writes .csv"),
            (("-o", "x.svg"), "--scan and --from"),
            (("--shell", "4", "-o", "x.svg"), "--scan and --from"),
            (("--shell", "4", "-o", "x.pdb"), "leave out --shell"),
            (("--shell", "1.4"), "the larger probe"),
        ):
            self.assert_refused(BAD_INPUT, "pockets", UBIQUITIN, *arguments, says=(says,))

    def test_few_atoms_have_none(self):
        path = self.file("two.xyzr", "0 0 0 1\n2.5 0 0 1\n")
        self.assertEqual(self.table(path), [])
        self.assert_refused(BAD_INPUT, "pockets", path, "--probe", "-2", says=("--probe",))


if __name__ == "__main__":
    program.unittest.main()
