"""The study: its figures, its files, and what an interrupted one leaves."""

import base64
import csv
import json
import math
import os
import re
import signal
import subprocess
import zlib

from program import BAD_INPUT, PROGRAM, ProgramTest, parse_json, schema_validator

FILES = ["index.html", "runs", "study.csv", "study.json"]
# Two balls of radius 2 whose centres are 1.5 apart: each loses a cap of height 2 - 0.75.
RADIUS, HALF_DISTANCE = 2.0, 0.75
CAP = RADIUS - HALF_DISTANCE
EXACT_AREA = 2 * (4 * math.pi * RADIUS**2 - 2 * math.pi * RADIUS * CAP)
EXACT_VOLUME = 2 * (4 / 3 * math.pi * RADIUS**3 - math.pi * CAP**2 * (3 * RADIUS - CAP) / 3)


class StudyTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"
        self.ball = self.file("ball.xyzr", f"0.1 0.2 0.3 {RADIUS}\n")
        self.pair = self.file("pair.xyzr", f"0 0 0 {RADIUS}\n{2 * HALF_DISTANCE} 0 0 {RADIUS}\n")

    def study(self, *arguments):
        """By marching cubes, unless the arguments name other meshers."""
        if "--mesher" not in arguments:
            arguments = (*arguments, "--mesher", "marching-cubes")
        self.run_ok("study", *arguments, "-o", self.out)
        document = parse_json((self.out / "study.json").read_text())
        schema_validator("study").validate(document)
        return document

    def outputs(self):
        return sorted(path.name for path in self.out.iterdir())


class Figures(StudyTest):
    def test_one_ball_converges_with_second_order(self):
        study = self.study(self.ball, "--spacing", "0.8,0.4,0.2,0.1", "--field", "vdw")
        runs = study["inputs"][0]["runs"]
        self.assertEqual(len(runs), 8)
        series = {s["subdivide"]: s for s in study["inputs"][0]["series"]}
        self.assertEqual(sorted(series), [0, 1])
        for level, one in series.items():
            self.assertEqual(one["project"], "vdw" if level else "none")
            # Vertices on a sphere: area, volume and distances of the flat triangles are off by
            # O(h²), triangles go by h^-2. The grid's place on the ball scatters the fit.
            for figure in ("area_error", "volume_error", "mesh_to_surface_rms"):
                order = one["by_resolution"][figure]["order"]
                self.assertTrue(1.8 < order < 2.2, f"{figure} {order}")
                by_triangles = one["by_triangles"][figure]["order"]
                self.assertTrue(-1.1 < by_triangles < -0.9, f"{figure} {by_triangles}")
            # The finest mesh is off by about 0.05² / 2² of the value; its limit by far less.
            finest = abs(runs[one["runs"][0]]["comparison"]["area_relative_error"])
            self.assertLess(abs(one["area_extrapolated_relative_error"]), finest / 5)

    def test_exact_values_of_a_pair(self):
        study = self.study(self.pair, "--spacing", "0.5", "--field", "vdw")
        exact = study["inputs"][0]["exact"]
        self.assert_close(exact["area"], EXACT_AREA, 1e-12)
        self.assert_close(exact["volume"], EXACT_VOLUME, 1e-12)
        for run in study["inputs"][0]["runs"]:
            error = run["mesh"]["area"] / EXACT_AREA - 1
            self.assert_close(run["comparison"]["area_relative_error"], error, 1e-9)
            for name, total in (("min_angle_deg", "triangles"), ("edge_length", "edges")):
                histogram = run["histograms"][name]
                counted = sum(histogram["counts"]) + histogram["below"] + histogram["above"]
                self.assertEqual(counted, run["mesh"][total])

    def test_runs_are_those_of_the_report(self):
        study = self.study("--sample", "bpti", "--spacing", "0.7", "--field", "vdw,blinn")
        runs = study["inputs"][0]["runs"]
        for run in runs:
            p = run["parameters"]
            report = self.report(
                "report", "--sample", "bpti", "--spacing", "0.7", "--field", p["field"],
                "--subdivide", p["subdivide"], "--project", p["project"])  # fmt: skip
            for key in ("vertices", "triangles", "area", "volume", "euler_characteristic",
                        "min_angle_deg", "edge_length", "self_intersections"):  # fmt: skip
                self.assertEqual(run["mesh"][key], report["mesh"][key], (p, key))
            self.assertEqual(
                run["comparison"]["distances"]["mesh_to_surface"],
                report["comparison"]["mesh_to_surface"],
            )
        self.assertEqual(len(runs), 5)  # level 0 of each field is the same for all projections

    def test_csv_has_the_same_runs(self):
        study = self.study(self.ball, self.pair, "--spacing", "1,0.5", "--field", "vdw,soft")
        with (self.out / "study.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        runs = [(i["name"], run) for i in study["inputs"] for run in i["runs"]]
        self.assertEqual(len(rows), len(runs))
        for row, (name, run) in zip(rows, runs):
            self.assertEqual(row["input"], name)
            self.assertEqual(int(row["triangles"]), run["mesh"]["triangles"])
            self.assertEqual(float(row["area"]), run["mesh"]["area"])
            rms = run["comparison"]["distances"]["mesh_to_surface"]["rms"]
            self.assertEqual(float(row["mesh_to_surface_rms"]), rms)

    def test_threads_change_times_alone(self):
        arguments = (self.pair, "--spacing", "0.25", "--field", "vdw,blinn")
        one = self.study(*arguments, "--threads", "1")
        three = self.study(*arguments, "--threads", "3")
        self.assertEqual((one["backends"][0]["threads"], three["backends"][0]["threads"]), (1, 3))
        self.assertEqual(three["runs_made"], one["runs_made"])
        for a, b in zip(one["inputs"][0]["runs"], three["inputs"][0]["runs"]):
            for block in ("parameters", "mesh", "histograms", "comparison"):
                self.assertEqual(a[block], b[block])

    def test_both_meshers_side_by_side(self):
        study = self.study(self.pair, "--mesher", "marching-cubes,exact", "--spacing", "0.5,0.25",
                           "--edge-length", "0.5,0.25,0.125", "--field", "vdw")  # fmt: skip
        series = {(s["mesher"], s["subdivide"]): s for s in study["inputs"][0]["series"]}
        self.assertEqual(len(series), 4)
        # Triangles between vertices on the sphere and on the crease: second order, and χ = 2.
        order = series["exact", 0]["by_resolution"]["area_error"]["order"]
        self.assertTrue(1.7 < order < 2.3, order)
        for run in study["inputs"][0]["runs"]:
            if run["parameters"]["mesher"] == "exact":
                self.assertEqual(run["comparison"]["euler_characteristic_difference"], 0)
        self.assertEqual(study["inputs"][0]["refused"], [])

    def test_both_meshers_are_the_default(self):
        self.run_ok("study", self.pair, "-o", self.out, "--spacing", "0.5", "--edge-length", "0.5", "--field", "vdw")
        runs = parse_json((self.out / "study.json").read_text())["inputs"][0]["runs"]
        made = sorted((r["parameters"]["mesher"], r["parameters"]["subdivide"]) for r in runs)
        self.assertEqual(made, [("exact", 0), ("exact", 1), ("marching-cubes", 0), ("marching-cubes", 1)])

    def test_what_was_not_computed_is_null(self):
        study = self.study(
            self.ball, "--spacing", "1", "--distances", "off", "--self-intersections", "off"
        )
        for run in study["inputs"][0]["runs"]:
            self.assertIsNone(run["comparison"]["distances"])
            self.assertIsNone(run["mesh"]["self_intersections"])
        for series in study["inputs"][0]["series"]:
            self.assertIsNone(series["by_resolution"]["area_error"])
            self.assertIsNone(series["area_extrapolated"])

    def test_what_cannot_be_made_is_refused_and_the_rest_made(self):
        study = self.study(self.ball, "--spacing", "40,0.5", "--field", "vdw", "--subdivide", "0")
        found = study["inputs"][0]
        self.assertEqual([r["parameters"]["resolution"] for r in found["runs"]], [0.5])
        self.assertEqual([r["parameters"]["resolution"] for r in found["refused"]], [40])
        self.assertIn("coarse", found["refused"][0]["reason"])
        small = self.study(self.ball, "--spacing", "0.02", "--field", "vdw", "--subdivide", "0,2",
                           "--distances", "off", "--memory-limit", "200M")  # fmt: skip
        self.assertEqual([r["parameters"]["subdivide"] for r in small["inputs"][0]["refused"]], [2])
        self.assertEqual([r["parameters"]["subdivide"] for r in small["inputs"][0]["runs"]], [0])

    def test_the_excluded_surface(self):
        """Two balls with a waist: integers are exact, errors of second order, and the limit is the exact area."""
        atoms = self.file("two.xyzr", "0 0 2 1.7\n0 0 -2 1.7\n")
        options = ("--surface", "excluded", "--mesher", "exact", "--edge-length", "0.6,0.3", "--subdivide", "0,1")
        document = self.study(atoms, self.ball, *options)
        self.assertEqual(document["parameters"]["surface"], "excluded")
        for found, waist in zip(document["inputs"], (True, False)):
            exact = found["excluded"]["complete"]
            self.assertEqual(exact["counts"]["whole_rings"], int(waist))
            self.assertEqual(found["exact"]["area"], exact["area"])
            self.assertEqual(len(found["runs"]), 4)
            for run in found["runs"]:
                self.assertEqual(run["mesh"]["euler_characteristic"], 2)
                self.assertEqual(run["comparison"]["euler_characteristic_difference"], 0)
                # A circumcircle no larger than the edge length is that far below a sphere of 1.4 Å.
                far = run["parameters"]["resolution"] ** 2 / (2 * 1.4)
                self.assertLess(run["comparison"]["distances"]["mesh_to_surface"]["max"], far)
                self.assert_close(run["comparison"]["area_relative_error"],
                                  run["mesh"]["area"] / exact["area"] - 1, 1e-9)
            by_level = {(r["parameters"]["resolution"], r["parameters"]["subdivide"]): r["comparison"]
                        for r in found["runs"]}
            for length in (0.6, 0.3):
                ratio = (by_level[length, 0]["area_relative_error"] / by_level[length, 1]["area_relative_error"])
                self.assertAlmostEqual(ratio, 4, delta=0.3)
        self.assertEqual(self.outputs(), FILES)
        # Runs of another probe are other runs; the same ones are found.
        again = self.study(atoms, self.ball, *options)
        self.assertEqual(again["runs_made"], 0)
        other = self.study(atoms, *options, "--probe", "0.7")
        self.assertEqual(other["runs_found"], 0)

    def test_the_excluded_surface_refuses_what_is_not_its_own(self):
        for option in (("--spacing", "0.5"), ("--field", "blinn"), ("--mesher", "marching-cubes"),
                       ("--backend", "cuda"), ("--project", "own"), ("--probe", "0")):
            self.assert_refused(BAD_INPUT, "study", self.ball, "--surface", "excluded", *option, "-o", self.out,
                                says=(option[0],))


class Page(StudyTest):
    """The meshes in the page, decoded here as the page's script does it."""

    def read_page(self):
        page = (self.out / "index.html").read_text()
        blocks = dict(re.findall(r'<script type="application/octet-stream" id="([^"]+)">([^<]*)</script>', page))
        return {name: zlib.decompress(base64.b64decode(text)) for name, text in blocks.items()}

    @staticmethod
    def read_planes(data, at, count, width):
        """Differences modulo the width, the low bytes of all before the next ones."""
        values, last = [], 0
        for i in range(count):
            difference = sum(data[at + plane * count + i] << (8 * plane) for plane in range(width))
            last = (last + difference) % (1 << (8 * width))
            values.append(last)
        return values, at + width * count

    def decoded(self, data, about):
        count, triangles = about["vertices"], about["triangles"]
        at, columns = 0, []
        for axis in range(3):
            steps, at = self.read_planes(data, at, count, 2)
            step = (about["upper"][axis] - about["lower"][axis]) / 65535
            columns.append([about["lower"][axis] + step * s for s in steps])
        corners, at = self.read_planes(data, at, 3 * triangles, 4)
        elements, at = data[at : at + count], at + count
        distances, angles = data[at : at + triangles], data[at + triangles :]
        self.assertEqual(len(angles), triangles)
        faces = list(zip(corners[::3], corners[1::3], corners[2::3]))
        return list(zip(*columns)), faces, elements, distances, angles

    def meshed(self, structure, parameters):
        """The same mesh by `mesh`, whose OBJ holds every digit."""
        path = self.folder / "a.obj"
        self.run_ok("mesh", structure, "-o", path, "--spacing", parameters["resolution"],
                    "--subdivide", parameters["subdivide"], "--project", parameters["project"])  # fmt: skip
        points, faces = [], []
        for line in path.read_text().splitlines():
            kind, *words = line.split()
            if kind == "v":
                points.append(tuple(map(float, words)))
            elif kind == "f":
                faces.append(tuple(int(word.split("/")[0]) - 1 for word in words))
        return points, faces

    @staticmethod
    def smallest_angle(a, b, c):
        def angle(p, q, r):
            u, v = [y - x for x, y in zip(p, q)], [y - x for x, y in zip(p, r)]
            cosine = sum(x * y for x, y in zip(u, v)) / math.hypot(*u) / math.hypot(*v)
            return math.degrees(math.acos(max(-1, min(1, cosine))))

        return min(angle(a, b, c), angle(b, c, a), angle(c, a, b))

    def test_scenes_are_the_meshes(self):
        # Two balls apart, of different elements and sizes (Bondi 1964), so that distances are closed forms.
        atom = "HETATM    {0}  {1}   LIG A   {0}    {2:8.3f}{3:8.3f}   0.250  1.00  0.00           {1}\n"
        balls = {"O": ((0.125, 0, 0.25), 1.52), "N": ((5, -3, 0.25), 1.55)}
        pair = self.file("pair.pdb", "".join(atom.format(i, e, *c[:2]) for i, (e, (c, _)) in enumerate(balls.items(), 1)))
        self.study(pair, "--spacing", "0.6", "--field", "vdw", "--subdivide", "1")
        blocks = self.read_page()
        (about,) = json.loads(blocks["scenes"])
        points, faces, elements, distances, angles = self.decoded(blocks["scene-0"], about)
        true_points, true_faces = self.meshed(pair, about["parameters"])
        self.assertEqual(faces, true_faces)
        self.assertEqual(len(points), len(true_points))
        for axis in range(3):
            column = [p[axis] for p in true_points]
            self.assertEqual((about["lower"][axis], about["upper"][axis]), (min(column), max(column)))
            half_step = (max(column) - min(column)) / 65535 / 2 * (1 + 1e-9)
            self.assertLessEqual(max(abs(p[axis] - q) for p, q in zip(points, column)), half_step)
        for point, number in zip(true_points, elements):
            nearest = min(balls, key=lambda e: abs(math.dist(point, balls[e][0]) - balls[e][1]))
            self.assertEqual(about["elements"][number]["element"], nearest)
        bound = about["distance_range"]
        for face, distance, angle in zip(true_faces, distances, angles):
            a, b, c = (true_points[v] for v in face)
            center = [sum(x) / 3 for x in zip(a, b, c)]
            true = min(math.dist(center, place) - radius for place, radius in balls.values())
            share = min(1, max(0, (true + bound) / (2 * bound)))
            self.assertLessEqual(abs(distance - 255 * share), 0.51)  # half a step, and float32
            self.assertLessEqual(abs(angle - 255 * self.smallest_angle(a, b, c) / 60), 0.51)

    def test_the_scene_is_the_finest_mesh_that_a_browser_turns_smoothly(self):
        """At most 200,000 triangles of those that there are."""
        self.study(self.ball, "--spacing", "0.5,0.1,0.02", "--field", "vdw", "--subdivide", "0", "--distances", "off")
        (about,) = json.loads(self.read_page()["scenes"])
        self.assertEqual(float(about["parameters"]["resolution"]), 0.1)

    def test_the_page_keeps_to_the_threads_allowed(self):
        """TBB's threads stay once they are there. The last look is before the page is there: one may be
        started while the program ends."""
        command = [PROGRAM, "study", "--sample", "bpti", "-o", self.out, "--spacing", "0.5", "--field", "vdw",
                   "--subdivide", "1", "--distances", "off", "--threads", "1", "--quiet"]  # fmt: skip
        process = subprocess.Popen(list(map(str, command)))
        most = 0
        while process.poll() is None:
            try:
                threads = len(os.listdir(f"/proc/{process.pid}/task"))
            except OSError:
                break
            if not (self.out / "index.html").exists():
                most = max(most, threads)
        self.assertEqual(process.wait(60), 0)
        self.assertEqual(most, 1)

    def test_a_mesh_beyond_the_limit_is_left_out_with_a_word(self):
        arguments = (self.ball, "--spacing", "0.02", "--field", "vdw", "--subdivide", "0", "--distances", "off",
                     "--page-triangles", "10000000", "--mesher", "marching-cubes")  # fmt: skip
        self.study(*arguments)
        result = self.run_ok("study", *arguments, "-o", self.out, "--memory-limit", "20M")
        self.assertIn("1 found finished", result.stdout)
        self.assertIn("left out of the page", result.stderr)
        self.assertNotIn("scene-0", self.read_page())


class Options(StudyTest):
    def test_bad_options(self):
        self.assert_refused(BAD_INPUT, "study", self.ball, says=("-o",))
        self.assert_refused(BAD_INPUT, "study", "-o", self.out, says=("INPUT",))
        for option, value in (("--spacing", "1,x"), ("--field", "vdw,xyz"), ("--subdivide", "-1"),
                              ("--project", "x"), ("--backend", "gpu"),
                              ("--resume", "maybe")):  # fmt: skip
            self.assert_refused(
                BAD_INPUT, "study", self.ball, "-o", self.out, option, value, says=(option,)
            )
        self.assert_refused(
            BAD_INPUT, "study", self.ball, "-o", self.folder / "no" / "out", says=("no/out",)
        )
        self.assertFalse(self.out.exists())

    def test_inputs_of_the_same_name_stay_apart(self):
        other = self.folder / "other"
        other.mkdir()
        (other / "ball.xyzr").write_text("0 0 0 1\n")
        study = self.study(self.ball, other / "ball.xyzr", "--spacing", "1", "--field", "vdw")
        names = [i["name"] for i in study["inputs"]]
        self.assertEqual(len(set(names)), 2)

    def test_names_cannot_break_the_page(self):
        name = "<script>alert(1)<!--.xyzr"
        self.file(name, "0 0 0 1\n")
        self.study(self.folder / name, "--spacing", "0.5", "--field", "vdw")
        page = (self.out / "index.html").read_text()
        self.assertNotIn("<script>alert(1)", page)
        self.assertEqual(page.count("<script"), page.count("</script>"))
        self.assertIn("vdwmesh study: &lt;script&gt;alert(1)&lt;!--.xyzr", page)


class Resume(StudyTest):
    def test_finished_runs_are_found_again(self):
        arguments = (self.pair, "--spacing", "1,0.5", "--field", "vdw,soft")
        first = self.study(*arguments)
        self.assertEqual((first["runs_found"], first["runs_made"]), (0, 10))
        again = self.study(*arguments)
        self.assertEqual((again["runs_found"], again["runs_made"]), (10, 0))
        self.assertEqual(first["inputs"][0]["runs"], again["inputs"][0]["runs"])
        self.assertEqual(first["inputs"][0]["series"], again["inputs"][0]["series"])
        more = self.study(*arguments[:-1], "vdw,soft,blinn")
        self.assertEqual((more["runs_found"], more["runs_made"]), (10, 6))
        anew = self.study(*arguments, "--resume", "off")
        self.assertEqual((anew["runs_found"], anew["runs_made"]), (0, 10))

    def test_other_spheres_or_options_are_other_runs(self):
        arguments = ("--spacing", "1", "--field", "vdw", "--subdivide", "0")
        self.study(self.pair, *arguments)
        self.assertEqual(self.study(self.pair, *arguments, "--probe", "0.5")["runs_found"], 0)
        self.assertEqual(self.study(self.pair, *arguments, "--samples", "20")["runs_found"], 0)
        self.assertEqual(self.study(self.pair, *arguments, "--seed", "2")["runs_found"], 0)
        self.assertEqual(self.study(self.pair, *arguments, "--self-intersections", "off")["runs_found"], 0)
        self.assertEqual(self.study(self.pair, *arguments)["runs_found"], 1)
        self.pair.write_text(self.pair.read_text().replace("1.5", "1.6"))
        self.assertEqual(self.study(self.pair, *arguments)["runs_found"], 0)

    def test_another_program_makes_its_own_runs(self):
        """Runs kept by a program built from other sources are not taken for this one's."""
        arguments = (self.ball, "--spacing", "1", "--field", "vdw", "--subdivide", "0")
        study = self.study(*arguments)
        kept = next((self.out / "runs").iterdir())
        key = parse_json(kept.read_text())["key"]
        info = parse_json(self.run_ok("info", "--json", "-").stdout)
        for name in ("version", "revision", "build"):
            self.assertEqual(key[name], info[name])
        self.assertEqual(study["revision"], info["revision"])

    def test_a_time_limit_leaves_the_rest_for_the_next_call(self):
        arguments = (self.pair, "--spacing", "1,0.5", "--field", "vdw")
        none = self.study(*arguments, "--time-limit", "0")
        self.assertEqual((none["runs_made"], none["runs_left"]), (0, 4))
        self.assertEqual(none["inputs"][0]["runs"], [])
        rest = self.study(*arguments)
        self.assertEqual((rest["runs_made"], rest["runs_left"]), (4, 0))

    def test_damaged_files_are_made_anew(self):
        arguments = (self.ball, "--spacing", "1,0.5", "--field", "vdw", "--subdivide", "0")
        whole = self.study(*arguments)
        kept = sorted((self.out / "runs").iterdir())
        self.assertEqual(len(kept), 2)
        kept[0].write_text(kept[0].read_text()[:100])
        again = self.study(*arguments)
        self.assertEqual((again["runs_found"], again["runs_made"]), (1, 1))
        self.assertEqual(
            [r["mesh"] for r in whole["inputs"][0]["runs"]],
            [r["mesh"] for r in again["inputs"][0]["runs"]],
        )

    def test_an_interrupted_study_leaves_whole_runs_and_goes_on(self):
        arguments = ["study", "--sample", "bpti", "-o", self.out, "--spacing", "1,0.5,0.05",
                     "--field", "vdw", "--mesher", "marching-cubes", "--progress"]  # fmt: skip
        process = subprocess.Popen(
            [PROGRAM, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        # The line names the run in progress; the last one takes seconds.
        seen = b""
        while " 0.05 Å".encode() not in seen:
            byte = process.stderr.read(1)
            self.assertTrue(byte, "the program ended by itself")
            seen += byte
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(self.outputs(), ["runs"])
        for path in (self.out / "runs").iterdir():
            self.assertEqual(path.suffix, ".json")
            parse_json(path.read_text())
        study = self.study("--sample", "bpti", "--spacing", "1,0.5", "--field", "vdw")
        self.assertEqual((study["runs_found"], study["runs_made"]), (4, 0))
        self.assertEqual(self.outputs(), FILES)
        self.assertRegex(seen.decode(), r"study +\d+ %, .* left: bpti vdw 0.05 Å")
