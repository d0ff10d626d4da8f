"""Damaged files of every format: refused with one line, or read without losing anything."""

import concurrent.futures
import math
import os
import subprocess
import unittest

import program
from bad import binary, meshes, outcome, structures

SAMPLE = structures.Sample((program.SOURCE_DIR / "data" / "bpti.pdb").read_text())
STRUCTURE = ("--subdivide", "0", "--spacing", "0.8", "--distances", "off")


class BadFiles(program.ProgramTest):
    def run_case(self, case, arguments):
        folder = self.folder / case.name.replace(".", "-")
        folder.mkdir()
        path = folder / case.name
        path.write_bytes(case.data)
        return outcome.run_bounded(arguments(path), folder, path)

    def check(self, cases, arguments, items, meaning):
        """All cases, two at a time. The first is sound: `meaning` of it is what SAME asks for."""
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(lambda case: self.run_case(case, arguments), cases))
        sound = meaning(results[0].report)
        for case, result in zip(cases, results):
            with self.subTest(file=case.name, damage=case.damage):
                report = result.report
                found = outcome.judged(case, result, report and items(report),
                                       report and meaning_agrees(meaning(report), sound))
                self.assertEqual(found, [])


def meaning_agrees(value, sound):
    return all(abs(a - b) <= 1e-9 * abs(b) for a, b in zip(value, sound, strict=True))


def exact_figures(report):
    return report["exact"]["area"], report["exact"]["volume"]


def mesh_figures(report):
    return report["mesh"]["area"], report["mesh"]["volume"] or math.nan


class Structures(BadFiles):
    def check_structures(self, cases):
        self.check(cases, lambda path: ("report", path, *STRUCTURE), outcome.structure_items,
                   exact_figures)

    def test_plain(self):
        for extension in structures.FORMATS:
            self.check_structures(structures.damages(extension, SAMPLE))

    def test_a_faulty_first_line_takes_no_memory_for_the_others(self):
        """A list of spheres takes 72 bytes a line while it is read, which is 36 times a text of such lines."""
        text = b"1\n" * 20_000_000
        path = self.folder / "a.xyzr"
        path.write_bytes(text)
        process = subprocess.Popen([program.PROGRAM, "exact", path], stderr=subprocess.PIPE, text=True)
        message = process.stderr.read()
        process.stderr.close()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, program.BAD_INPUT, message)
        self.assertIn("a.xyzr:1: has 1 fields", message)
        self.assertLess(usage.ru_maxrss * 1024, 6 * len(text) + 100e6)

    def test_packed(self):
        for extension in structures.FORMATS:
            self.check_structures(structures.packed_damages(extension, SAMPLE))


    def test_binary_cif(self):
        program.need_package("python3-msgpack", module="msgpack")
        self.check_structures(binary.damages(SAMPLE))
        self.check_structures(binary.packed_damages(SAMPLE))


class OddFiles(BadFiles):
    """Files that other projects keep because they once broke a reader."""

    def test_odd_files(self):
        odd = program.need_shared("molecules/odd")
        paths = sorted(odd.iterdir())
        self.assertEqual(len(paths), 38)
        refused = []
        for path in paths:
            with self.subTest(file=path.name):
                result = outcome.run_bounded(("report", path, *STRUCTURE), self.folder, path)
                self.assertEqual(result.problems, [])
                refused += [path.name] if result.code else []
                if result.report:
                    self.assertGreater(outcome.structure_items(result.report), 0)
        self.assertLessEqual(len(refused), 4, refused)


class Meshes(BadFiles):
    def test_meshes(self):
        ball = self.file("ball.xyzr", "0 0 0 1\n")
        for extension in meshes.KINDS:
            self.check(meshes.damages(extension),
                       lambda path: ("compare", path, ball, "--samples", "1"),
                       lambda report: report["mesh"]["triangles"], mesh_figures)


if __name__ == "__main__":
    unittest.main()
