"""vdwmesh batch: rows of many structures are those of single calls, whatever their source, the number of
threads, the shards, and whatever ended the call before."""

import csv
import fcntl
import gzip
import io
import json
import os
import pathlib
import signal
import subprocess
import tarfile
import time

import program
from program import BAD_INPUT, DONE, SOURCE_DIR, ProgramTest, need_shared, run, schema_validator

DATA = SOURCE_DIR / "data"
WRITE = ("-o",)


def atoms(count, spacing=2.0, shift=0.0):
    """A row of carbons as XYZR."""
    return "".join(f"{spacing * i + shift} 0 {0.3 * (i % 3)} 1.7\n" for i in range(count))


class BatchTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.inputs = self.folder / "in"
        (self.inputs / "b").mkdir(parents=True)
        for name in ("bpti.pdb", "ubiquitin.pdb"):
            (self.inputs / name).write_bytes((DATA / name).read_bytes())
        (self.inputs / "b" / "packed.pdb.gz").write_bytes(gzip.compress((DATA / "bpti.pdb").read_bytes()))
        for i in range(12):
            (self.inputs / "b" / f"row{i:02}.xyzr").write_text(atoms(5 + i, shift=i))
        self.paths = sorted((p for p in self.inputs.rglob("*") if p.is_file()), key=str)

    def leave_out_xyzr(self):
        """Spheres of XYZR have radii of their own and no elements; options on these are refused."""
        for path in self.paths:
            if path.suffix == ".xyzr":
                path.unlink()
        self.paths = [path for path in self.paths if path.suffix != ".xyzr"]

    def rows(self, *arguments, code=DONE, **options):
        result = run("batch", *arguments, **options)
        self.assertEqual(result.returncode, code, result.stderr)
        rows = [program.parse_json(line) for line in result.stdout.splitlines()]
        for row in rows:
            schema_validator("batch").validate(row)
        return rows

    def file_of(self, *arguments, name="rows.jsonl", code=DONE):
        """The bytes of the file that the call writes or continues."""
        path = self.folder / name
        result = run("batch", *arguments, "-o", path)
        self.assertEqual(result.returncode, code, result.stderr)
        return path.read_bytes()


def nameless(rows):
    return [{key: value for key, value in row.items() if key not in ("name", "content")} for row in rows]


class Rows(BatchTest):
    def assert_as_single_calls(self, *options):
        rows = self.rows(self.inputs, *options)
        self.assertEqual([row["name"] for row in rows], [str(path) for path in self.paths])
        for row, path in zip(rows, self.paths, strict=True):
            if "row" in path.name and path.name != "row07.xyzr":
                continue
            report = self.report("exact", path, *(options or ("--topology", "off")))
            exact, source = report["exact"], report["input"]
            self.assertEqual((row["area"], row["volume"], row["method"]),
                             (exact["area"], exact["volume"], exact["method"]))
            for key in ("components", "tunnels", "voids", "euler_characteristic"):
                self.assertEqual(row[key], exact[key], key)
            self.assertEqual(row["atoms"], source["spheres"])
            self.assertEqual(row["left_out"], source["skipped"])
            self.assertIsNone(row["error"])

    def test_are_those_of_single_calls(self):
        self.assert_as_single_calls()
        self.assert_as_single_calls("--probe", "1.4", "--topology", "counts")
        self.leave_out_xyzr()
        self.assert_as_single_calls("--topology", "on", "--no-hydrogens", "--radii", "alvarez")

    def test_of_part_of_the_atoms(self):
        options = ("--measure", "I/1-9", "--topology", "off", "--method", "arcs")
        row = self.rows(DATA / "bpti.pdb", *options)[0]
        exact = self.report("exact", DATA / "bpti.pdb", *options)["exact"]
        self.assertEqual((row["area"], row["volume"]), (exact["area"], exact["volume"]))

    def test_of_the_excluded_surface(self):
        """The block of a report; its figures again where those of other surfaces stand; a table has them all."""
        paths = [DATA / "bpti.pdb", DATA / "ubiquitin.pdb"]
        for options in (("--surface", "ses", "--topology", "off"), ("--surface", "excluded", "--topology", "full", "--probe", "1")):
            rows = self.rows(*paths, *options)
            for row, path in zip(rows, paths, strict=True):
                report = self.report("exact", path, *options)
                self.assertEqual(row["excluded"], report["excluded"])
                complete = row["excluded"]["complete"]
                for name in ("area", "volume", "euler_characteristic"):
                    self.assertEqual(row[name], complete[name])
                self.assertIsNone(row["method"])
                if "full" in options:
                    self.assertEqual(row["euler_characteristic"], 2 * (row["components"] - row["tunnels"] + row["voids"]))
                    self.assertEqual(row["voids"], complete["cavities"])
            table = run("batch", *paths, *options, "--rows", "csv").stdout
            for cells, row in zip(csv.DictReader(io.StringIO(table)), rows, strict=True):
                self.assertEqual(float(cells["excluded_exterior_volume"]), row["excluded"]["exterior"]["volume"])
                self.assertEqual(float(cells["area"]), row["area"])
        two = self.rows(*paths, "--surface", "ses", "--verb", "interface", code=1)
        self.assertIn("chain", two[0]["error"])

    def test_do_not_depend_on_threads(self):
        one = run("batch", self.inputs, "--threads", "1").stdout
        self.assertEqual(len(one.splitlines()), len(self.paths))
        self.assertEqual(run("batch", self.inputs, "--threads", "4").stdout, one)

    def test_as_a_table_are_those_of_json(self):
        rows = self.rows(self.inputs, "--topology", "counts")
        table = run("batch", self.inputs, "--topology", "counts", "--rows", "csv").stdout
        found = list(csv.DictReader(io.StringIO(table)))
        self.assertEqual(list(found[0]), list(rows[0]))
        for cells, row in zip(found, rows, strict=True):
            expected = {key: "" if value is None else str(value) for key, value in row.items()}
            expected |= {"left_out": str(sum(row["left_out"].values())), "warnings": "0"}
            for key in ("area", "volume"):
                self.assertEqual(float(cells[key]), float(expected.pop(key)))
                cells.pop(key)
            self.assertEqual(cells, expected)


def flattened(value, name=""):
    """The figures of a JSON value by the names of their columns; lists have none."""
    if isinstance(value, dict):
        inner = {f"{name}_{key}" if name else key: part for key, part in value.items()}
        return {key: cell for outer, part in inner.items() for key, cell in flattened(part, outer).items()}
    return {} if isinstance(value, list) else {name: value}


class Reports(BatchTest):
    """Rows of --verb report are what `vdwmesh report` finds."""

    fast = ("--verb", "report", "--spacing", "0.8", "--samples", "2")

    def test_are_those_of_single_calls(self):
        for options in (self.fast[2:], ("--mesher", "exact", "--edge-length", "0.7", "--probe", "0.3"),
                        ("--spacing", "1", "--subdivide", "0", "--distances", "off", "--topology", "counts"),
                        ("--field", "blinn", "--spacing", "1", "--self-intersections", "off")):  # fmt: skip
            with self.subTest(options):
                for row, path in zip(self.rows(self.inputs, "--verb", "report", *options), self.paths, strict=True):
                    if path.name not in ("packed.pdb.gz", "row03.xyzr", "row11.xyzr"):
                        continue
                    report = self.report("report", path, "--backend", "cpu", *options)
                    if report["mesh"]["arrangement"]:
                        report["mesh"]["arrangement"]["seconds"] = None
                    self.assertEqual(row["mesh"], report["mesh"])
                    self.assertEqual(row["comparison"], report["comparison"])
                    self.assertEqual(row["warnings"], report["warnings"])
                    for key in ("area", "volume", "tunnels", "voids", "euler_characteristic", "method"):
                        self.assertEqual(row[key], report["exact"][key], key)

    def test_of_members_do_not_depend_on_threads(self):
        path = self.folder / "a.tar"
        with tarfile.open(path, "w") as archive:
            for file in self.paths:
                archive.add(file, str(file.relative_to(self.inputs)))
        one = run("batch", path, *self.fast, "--threads", "1").stdout
        self.assertEqual(len(one.splitlines()), len(self.paths))
        self.assertEqual(run("batch", path, *self.fast, "--threads", "4").stdout, one)
        self.assertEqual(nameless(map(json.loads, one.splitlines())),
                         nameless(self.rows(self.inputs, *self.fast)))

    def test_as_a_table_have_all_figures_of_json(self):
        columns, filled = set(), {"error", "comparison_distances_reason"}  # of rows without figures
        for options in (("--spacing", "0.5"), ("--edge-length", "0.8", "--subdivide", "2")):
            arguments = (self.inputs / "b", "--verb", "report", "--samples", "2", *options)
            rows = self.rows(*arguments)
            table = csv.DictReader(io.StringIO(run("batch", *arguments, "--rows", "csv").stdout))
            self.assertEqual(table.fieldnames[:2] + table.fieldnames[-2:], ["name", "settings", "warnings", "error"])
            found = list(table)
            columns |= set(table.fieldnames)
            filled |= {name for cells in found for name in cells if cells[name]}
            for cells, row in zip(found, rows, strict=True):
                row["left_out"] = sum(row["left_out"].values())
                row["warnings"] = len(row["warnings"])
                figures = {key: value for key, value in flattened(row).items() if value is not None}
                for name, value in figures.items():
                    text = str(value).lower() if isinstance(value, bool) else str(value)
                    if isinstance(value, float):
                        self.assertEqual(float(cells.pop(name)), value, name)
                    else:
                        self.assertEqual(cells.pop(name), text, name)
                self.assertEqual(set(cells.values()), {""})
        empty = {name for name in columns - filled if not name.startswith("comparison_bounds_")}  # of the excluded surface
        self.assertEqual(empty, {"doubtful_spheres"}, "columns that are empty in every table")

    def test_a_structure_that_is_refused_has_no_mesh(self):
        (self.inputs / "b" / "row03.xyzr").write_text("0 0 0 0.001\n")  # no node lies inside
        rows = self.rows(self.inputs / "b", *self.fast, code=BAD_INPUT)
        refused = [row for row in rows if row["error"]]
        self.assertEqual([pathlib.Path(row["name"]).name for row in refused], ["row03.xyzr"])
        self.assertEqual([refused[0][key] for key in ("mesh", "comparison", "area")], [None] * 3)
        single = run("report", refused[0]["name"], *self.fast[2:])
        self.assertEqual(single.stderr, f"vdwmesh: {refused[0]['error']}\n")

    def test_are_continued_with_the_same_options_alone(self):
        inputs = self.inputs / "b"
        for extension in ("jsonl", "csv"):
            name = f"rows.{extension}"
            whole = self.file_of(inputs, *self.fast, name=name)
            (self.folder / name).write_bytes(whole[: len(whole) // 2])
            self.assertEqual(self.file_of(inputs, *self.fast, name=name), whole)
            for other in ((), (*self.fast, "--seed", "2"), (*self.fast, "--subdivide", "0"),
                          (*self.fast, "--padding", "3"), (*self.fast, "--crossings", "allow")):  # fmt: skip
                self.assertEqual(run("batch", inputs, *other, "-o", self.folder / name).returncode, BAD_INPUT)

    def test_options_of_the_mesh_need_them(self):
        for option in ("--spacing", "--mesher", "--samples", "--self-intersections", "--subdivide"):
            value = {"--mesher": "exact", "--self-intersections": "off"}.get(option, "1")
            result = run("batch", self.inputs, option, value)
            self.assertEqual(result.returncode, BAD_INPUT)
            self.assertRegex(result.stderr, rf"\Avdwmesh: {option}: is of --verb report[^\n]*\n\Z")


class Refusals(BatchTest):
    def test_a_bad_structure_is_a_row(self):
        (self.inputs / "b" / "bad.pdb").write_text("ATOM      1  N   ALA A   1      abc\n")
        (self.inputs / "b" / "row03.xyzr").write_text("")
        rows = self.rows(self.inputs, code=BAD_INPUT)
        refused = [row for row in rows if row["error"]]
        self.assertEqual([pathlib.Path(row["name"]).name for row in refused], ["bad.pdb", "row03.xyzr"])
        for row in refused:
            self.assertIsNone(row["area"])
            self.assertIn(row["name"], row["error"])
            single = run("exact", row["name"])
            self.assertEqual(single.stderr, f"vdwmesh: {row['error']}\n")
        result = run("batch", self.inputs)
        self.assertEqual(result.stderr,
                         f"vdwmesh: 2 of {len(rows)} structures were refused; their rows say why\n")

    def test_names_that_are_not_there(self):
        listed = self.file("list.txt", f"{DATA / 'bpti.pdb'}\nnowhere.pdb\n\n{DATA / 'ubiquitin.pdb'}\r\n")
        rows = self.rows(listed, code=BAD_INPUT)
        self.assertEqual([row["error"] is None for row in rows], [True, False, True])
        self.assertIn("nowhere.pdb: cannot be opened", rows[1]["error"])
        for arguments in (("nowhere",), (self.folder / "empty.tar",)):
            self.assertRegex(run("batch", *arguments).stderr, r"\Avdwmesh: [^\n]* is not there; name [^\n]*\n\Z")

    def test_other_files_are_left_out(self):
        (self.inputs / "README").write_text("no structure")
        result = run("batch", self.inputs)
        self.assertEqual(result.returncode, DONE)
        self.assertIn("1 of the files had no extension of a structure and was left out", result.stderr)
        nothing = self.folder / "nothing"
        nothing.mkdir()
        self.assertIn(f"vdwmesh: {nothing}: holds no structures", run("batch", nothing).stderr)

    def test_options(self):
        for arguments, words in (
            (("--shard", "0/4"), "--shard"), (("--shard", "5/4"), "--shard"),
            (("--shard", "4"), "needs I/N"), (("--shard", "1/x"), "--shard"),
            (("-o", self.folder / "rows.txt"), "rows are .jsonl"), (("--rows", "xml"), "--rows"),
            (("--sample", "bpti"), "--sample"), (("--method", "arcs", "--topology", "on"), "--topology"),
        ):
            with self.subTest(arguments):
                result = run("batch", self.inputs, *arguments)
                self.assertEqual(result.returncode, BAD_INPUT)
                self.assertRegex(result.stderr, rf"\Avdwmesh: [^\n]*{words}[^\n]*\n\Z")
        self.assertIn("standard input", run("batch", "-", "--shard", "1/2", input="").stderr)


class Sources(BatchTest):
    def archive(self, name, mode):
        path = self.folder / name
        with tarfile.open(path, mode) as archive:
            archive.add(self.inputs / "b", "b")  # in any order, as tar finds them
            for file in self.paths:
                if file.parent == self.inputs:
                    archive.add(file, file.name)
        return path

    def test_all_hold_the_same(self):
        expected = self.rows(self.inputs)
        listed = "".join(f"{path}\n" for path in self.paths)
        self.assertEqual(self.rows(self.file("list", listed)), expected)
        self.assertEqual(self.rows("-", input=listed), expected)
        self.assertEqual(self.rows(*self.paths), expected)
        by_name = {str(pathlib.Path(row["name"]).relative_to(self.inputs)): row for row in expected}
        for name, mode in (("a.tar", "w"), ("a.tar.gz", "w:gz"), ("a.tgz", "w:gz"),
                           ("a.tar.bz2", "w:bz2"), ("a.tar.xz", "w:xz")):
            with self.subTest(name):
                path = self.archive(name, mode)
                rows = self.rows(path)
                self.assertEqual({row["name"]: row | {"name": ""} for row in rows},
                                 {key: row | {"name": ""} for key, row in by_name.items()})
                with path.open("rb") as archive:
                    piped = subprocess.run([program.PROGRAM, "batch", "-"], stdin=archive,
                                           capture_output=True, text=True, timeout=300)
                self.assertEqual([json.loads(line) for line in piped.stdout.splitlines()], rows)

    def test_formats_of_one_entry_agree(self):
        program.need_package("python3-msgpack", module="msgpack")
        program.need_package("python3-gemmi", module="gemmi")
        import binary_cif
        cif = need_shared("molecules/special/1EJG.cif")
        packed = self.folder / "a.bcif.gz"
        packed.write_bytes(gzip.compress(binary_cif.of_cif(cif)))
        first, second = nameless(self.rows(cif, packed))
        self.assertEqual(first, second)

    def test_a_cut_archive_ends_the_batch_with_a_line(self):
        whole = self.archive("a.tar", "w").read_bytes()
        cut = self.folder / "cut.tar"
        cut.write_bytes(whole[: len(whole) * 2 // 3])
        result = run("batch", cut)
        self.assertEqual(result.returncode, BAD_INPUT)
        self.assertRegex(result.stderr, r"\Avdwmesh: [^\n]+\n\Z")
        for name, content in (("no.tar", "no archive"), ("no.tar.gz", b"\x1f\x8b" + bytes(99))):
            path = self.folder / name
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
            self.assertRegex(run("batch", path).stderr, rf"\Avdwmesh: [^\n]*{name}[^\n]*\n\Z")


class Shards(BatchTest):
    def test_follow_each_other(self):
        for extension in ("jsonl", "csv"):
            whole = self.file_of(self.inputs, name=f"whole.{extension}")
            for count in (1, 2, 4, 7, len(self.paths) + 3):
                parts = [self.file_of(self.inputs, "--shard", f"{i}/{count}",
                                      name=f"{i}of{count}.{extension}") for i in range(1, count + 1)]
                self.assertEqual(b"".join(parts), whole)
                self.assertLessEqual(max(p.count(b"\n") for p in parts[1:] or parts)
                                     - min(p.count(b"\n") for p in parts[1:] or parts), 1)

    def test_of_archives(self):
        path = self.folder / "a.tar"
        with tarfile.open(path, "w") as archive:
            archive.add(self.inputs, "in")
        whole = run("batch", path).stdout
        self.assertEqual("".join(run("batch", path, "--shard", f"{i}/3").stdout for i in (1, 2, 3)), whole)


class Continuing(BatchTest):
    def test_a_file_cut_anywhere_becomes_the_whole(self):
        (self.inputs / "b" / "row05.xyzr").write_text("")  # the exit status is kept as well
        for extension in ("jsonl", "csv"):
            name = f"rows.{extension}"
            whole = self.file_of(self.inputs, name=name, code=BAD_INPUT)
            ends = [i + 1 for i, byte in enumerate(whole) if byte == 10]
            for length in (0, 1, ends[0] - 1, *ends[:3], ends[3] + 5, ends[-2], ends[-1] - 1, ends[-1]):
                with self.subTest(extension=extension, length=length):
                    (self.folder / name).write_bytes(whole[:length])
                    self.assertEqual(self.file_of(self.inputs, name=name, code=BAD_INPUT), whole)

    def test_a_killed_call_is_continued(self):
        for i in range(300):
            (self.inputs / f"copy{i:03}.pdb").write_bytes((DATA / "bpti.pdb").read_bytes())
        whole = self.file_of(self.inputs, name="whole.jsonl")
        path = self.folder / "rows.jsonl"
        for how in (signal.SIGKILL, signal.SIGTERM):
            path.unlink(missing_ok=True)
            started = subprocess.Popen([program.PROGRAM, "batch", self.inputs, "-o", path],
                                       stderr=subprocess.DEVNULL)
            while started.poll() is None and (not path.exists() or path.stat().st_size < 2000):
                time.sleep(0.001)
            started.send_signal(how)
            started.wait()
            self.assertTrue(whole.startswith(path.read_bytes()))
            self.assertEqual(self.file_of(self.inputs), whole)

    def test_rows_of_something_else_are_not_continued(self):
        whole = self.file_of(self.inputs)
        for arguments in ((self.inputs, "--probe", "1"), (DATA,), (self.inputs, "--shard", "2/2"),
                          (self.inputs, "--topology", "counts"), (self.paths[0],)):
            with self.subTest(arguments):
                result = run("batch", *arguments, "-o", self.folder / "rows.jsonl")
                self.assertEqual(result.returncode, BAD_INPUT)
                self.assertRegex(result.stderr, r"\Avdwmesh: -o [^\n]*row \d+ is not of [^\n]+\n\Z")
                self.assertEqual((self.folder / "rows.jsonl").read_bytes(), whole)
    def assert_not_continued(self, says, *arguments, name="rows.jsonl"):
        before = (self.folder / name).read_bytes()
        self.assert_refused(BAD_INPUT, "batch", self.inputs, *arguments, "-o", self.folder / name, says=(says,))
        self.assertEqual((self.folder / name).read_bytes(), before)

    def test_a_structure_of_the_same_size_and_time_with_other_bytes_is_another_one(self):
        changed = self.inputs / "b" / "row07.xyzr"
        before = changed.stat()
        for name in ("rows.jsonl", "rows.csv"):
            self.file_of(self.inputs, name=name)
        changed.write_text(changed.read_text().replace("1.7", "1.8"))
        os.utime(changed, ns=(before.st_atime_ns, before.st_mtime_ns))
        for name in ("rows.jsonl", "rows.csv"):
            self.assert_not_continued("row07.xyzr is another one", name=name)

    def test_a_member_of_an_archive_with_other_bytes_is_another_one(self):
        path = self.folder / "in.tar"
        for radius in ("1.7", "1.8"):
            with tarfile.open(path, "w") as archive:
                member = tarfile.TarInfo("one.xyzr")
                text = f"0 0 0 {radius}\n".encode()
                member.size = len(text)
                archive.addfile(member, io.BytesIO(text))
            if radius == "1.7":
                self.file_of(path)
        self.assert_refused(BAD_INPUT, "batch", path, "-o", self.folder / "rows.jsonl", says=("is another one",))

    def test_a_radius_file_with_other_lines_is_another_setting(self):
        radii = self.file("radii.txt", "C 1.7\nN 1.6\nO 1.5\nS 1.8\nH 1.2\n")
        self.leave_out_xyzr()
        self.file_of(self.inputs, "--radii", radii)
        radii.write_text(radii.read_text().replace("1.7", "1.9"))
        self.assert_not_continued("row 1 is not of", "--radii", radii)

    def test_one_line_without_a_break_that_is_no_torn_row_is_refused(self):
        for name in ("notes.jsonl", "notes.csv"):
            for text in ("remember the milk", '{"name":"somebody else"', "name;settings"):
                with self.subTest(name=name, text=text):
                    self.file(name, text)
                    self.assert_not_continued("-o", name=name)

    def test_a_refused_call_leaves_no_file(self):
        empty = self.folder / "empty"
        empty.mkdir()
        path = self.folder / "rows.csv"
        self.assert_refused(BAD_INPUT, "batch", empty, "-o", path, says=("holds no structures",))
        self.assertFalse(path.exists())

    def test_a_second_call_with_one_file_is_refused(self):
        path = self.folder / "rows.jsonl"
        with open(path, "wb") as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            self.assert_not_continued("another call")
        self.file_of(self.inputs)

    def test_upper_case_extensions_are_those_of_tables_too(self):
        self.assertTrue(self.file_of(self.inputs, name="ROWS.CSV").startswith(b"name,"))

    def test_a_file_at_its_limit_of_size_is_one_line(self):
        result = subprocess.run(["/bin/sh", "-c", 'ulimit -f 4; exec "$@"', "sh", program.PROGRAM, "batch",
                                 *[self.inputs] * 9, "-o", self.folder / "rows.jsonl"],
                                capture_output=True, text=True, check=False)  # fmt: skip
        self.assertEqual(result.returncode, BAD_INPUT, result.stderr)
        self.assertRegex(result.stderr, r"\Avdwmesh: [^\n]*cannot be written: File too large\n\Z")

    def test_resume_off_begins_anew(self):
        whole = self.file_of(self.inputs)
        again = self.file_of(self.inputs, "--probe", "1", "--resume", "off")
        self.assertNotEqual(again, whole)
        self.assertEqual(again.count(b"\n"), whole.count(b"\n"))


if __name__ == "__main__":
    program.unittest.main()
