"""Memory limits: with less memory a verb makes the same bytes or refuses, and it keeps to its limit and its estimate."""

import hashlib
import os
import subprocess
import unittest
import zipfile

from program import DONE, LIMIT_HIT, PROGRAM, SANITIZED, UBIQUITIN, ProgramTest, parse_json

# Bytes of the program itself, of its libraries and threads, below which no limit is held against it.
FLOOR = 52 << 20
# Of a limit or an estimate, which count what is asked for and not what the allocator keeps.
ROOM = 1.1

THREE = "0 0 0 1.7\n3 0 0 1.5\n1.4 2.6 0 1.6\n"
# Eight spheres through one circle, to 1e-5, and six through one point.
PENCIL = "".join(f"{i % 3 * 1e-5} 0 {0.4 * i - 1.4} {(1 + (0.4 * i - 1.4) ** 2) ** 0.5}\n" for i in range(8))
RING = "1 0 0 1\n0.5 0.866025403784 0 1\n-0.5 0.866025403785 0 1\n-1 0 0 1\n-0.5 -0.866025403784 0 1\n0.5 -0.866025403785 0 1\n"
# The probe's circle has just the probe's radius.
PAIR = "0 0 0 1\n4 0 0 1\n"


def digest(path):
    """Of the bytes, which this process never has: a program's peak counts that of the process that started it."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def figures(path):
    """What a report says but of the run itself."""
    return {key: value for key, value in parse_json(path.read_text()).items() if key not in ("timing", "parameters")}


@unittest.skipIf(SANITIZED, "the sanitizers take memory of their own")
class MemoryLimits(ProgramTest):
    def measured(self, *arguments):
        """Exit code, peak resident bytes and standard error."""
        with open(self.folder / "stderr", "w+") as errors:
            process = subprocess.Popen([PROGRAM, *map(str, arguments), "--threads", "2"],
                                       stdout=subprocess.DEVNULL, stderr=errors)  # fmt: skip
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            errors.seek(0)
            return process.returncode, usage.ru_maxrss * 1024, errors.read()

    def holds(self, *arguments, result="a.ply", may_refuse=False, read=digest):
        """Runs without a limit and with shares of the memory that this took. Returns which of these were done."""
        done = []
        output = self.folder / result
        code, peak, errors = self.measured(*arguments)
        if may_refuse and code == LIMIT_HIT:
            return
        self.assertEqual(code, DONE, errors)
        whole = read(output)
        for share in (1, 0.5, 0.25, 0.1):
            limit = int(share * peak)
            output.unlink(missing_ok=True)
            code, taken, errors = self.measured(*arguments, "--memory-limit", f"{limit >> 10}K")
            self.assertIn(code, (DONE, LIMIT_HIT), (share, errors))
            self.assertLess(taken, ROOM * limit + FLOOR, (share, errors))
            if code == DONE:
                done.append(share)
                self.assertEqual(read(output), whole, share)
            else:
                self.assertFalse(output.exists(), share)
        return done

    def test_meshes(self):
        ply = self.folder / "a.ply"
        for options in (("--edge-length", "0.2"), ("--edge-length", "0.4", "--subdivide", "1"),
                        ("--spacing", "0.3"), ("--spacing", "0.5", "--subdivide", "1"),
                        ("--surface", "excluded", "--edge-length", "0.4"),
                        ("--surface", "excluded", "--edge-length", "0.8", "--subdivide", "1")):  # fmt: skip
            with self.subTest(options=options):
                self.holds("mesh", UBIQUITIN, "-o", ply, *options)

    def test_subdivisions(self):
        ply = self.folder / "a.ply"
        for options in (("--edge-length", "0.8", "--subdivide", "2"), ("--spacing", "0.8", "--subdivide", "2"),
                        ("--surface", "excluded", "--edge-length", "1.2", "--subdivide", "2")):  # fmt: skip
            with self.subTest(options=options):
                self.holds("mesh", UBIQUITIN, "-o", ply, *options)
        json = self.folder / "a.json"
        self.holds("report", UBIQUITIN, "--edge-length", "0.6", "--subdivide", "2", "--json", json,
                   result="a.json", read=figures)  # fmt: skip

    def test_comparisons_of_foreign_meshes(self):
        # Of so many triangles that the program itself is a small part of the memory. STL names no vertices.
        json = self.folder / "a.json"
        for extension, surface in (("stl", "vdw"), ("ply", "ses")):
            with self.subTest(extension=extension, surface=surface):
                mesh = self.folder / f"foreign.{extension}"
                self.run_ok("mesh", UBIQUITIN, "-o", mesh, "--edge-length", "0.15", "--threads", "2")
                done = self.holds("compare", mesh, UBIQUITIN, "--surface", surface, "--json", json,
                                  result="a.json", read=figures)  # fmt: skip
                self.assertNotIn(0.1, done, "the limit is none")

    def test_degenerate_sets(self):
        ply = self.folder / "a.ply"
        for name, text in (("pencil", PENCIL), ("ring", RING)):
            with self.subTest(name=name):
                self.holds("mesh", self.file(f"{name}.xyzr", text), "-o", ply, "--edge-length", "0.1", may_refuse=True)
        self.holds("mesh", self.file("pair.xyzr", PAIR), "-o", ply, "--surface", "excluded", "--probe", "1.5",
                   "--edge-length", "0.02")  # fmt: skip

    def test_small_patches_of_large_probes(self):
        arguments = ("mesh", self.file("three.xyzr", THREE), "-o", self.folder / "a.ply",
                     "--surface", "excluded", "--probe", "50", "--edge-length", "0.02")  # fmt: skip
        code, taken, errors = self.measured(*arguments, "--memory-limit", "300M")
        self.assertIn(code, (DONE, LIMIT_HIT), errors)
        self.assertLess(taken, ROOM * (300 << 20) + FLOOR)

    def test_exact_measures(self):
        self.holds("exact", UBIQUITIN, "--method", "cgal", "--per-atom", self.folder / "a.csv", result="a.csv")

    def test_text_that_is_packed_is_never_whole(self):
        """3MF takes the memory of PLY: blocks of its text, not the text. Python's unpacker finds the checksum of them all."""
        peaks = {}
        for name in ("a.ply", "a.3mf"):
            code, peaks[name], errors = self.measured("mesh", UBIQUITIN, "--edge-length", "0.2", "-o", self.folder / name)
            self.assertEqual(code, DONE, errors)
        with zipfile.ZipFile(self.folder / "a.3mf") as archive:
            text = archive.getinfo("3D/3dmodel.model").file_size
            self.assertIsNone(archive.testzip())
        self.assertLess(peaks["a.3mf"], peaks["a.ply"] + text / 4)

    def test_estimates(self):
        json = self.folder / "a.json"
        for options in (("--edge-length", "0.3"), ("--surface", "excluded", "--edge-length", "0.5"),
                        ("--edge-length", "0.5", "--subdivide", "1")):  # fmt: skip
            with self.subTest(options=options):
                code, peak, errors = self.measured("mesh", UBIQUITIN, "-o", self.folder / "a.ply", *options,
                                                   "--json", json)  # fmt: skip
                self.assertEqual(code, DONE, errors)
                self.assertLess(peak, ROOM * parse_json(json.read_text())["parameters"]["memory_estimate"])


if __name__ == "__main__":
    unittest.main()
