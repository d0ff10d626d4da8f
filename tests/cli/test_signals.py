"""SIGINT and SIGTERM end the program with 130 and 143 and leave nothing half-written."""

import itertools
import os
import pathlib
import signal
import subprocess

from program import PROGRAM, UBIQUITIN, ProgramTest

EXIT_CODES = {signal.SIGINT: 130, signal.SIGTERM: 143}


class Signals(ProgramTest):
    def start(self, *arguments):
        return subprocess.Popen(
            [PROGRAM, *map(str, arguments)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )

    def assert_ends(self, process, number):
        process.send_signal(number)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, EXIT_CODES[number])
        self.assertEqual(self.files(), [])

    def test_while_waiting_for_input(self):
        for number in EXIT_CODES:
            process = self.start("mesh", "-", "--format", "pdb", "-o", self.folder / "a.ply")
            process.stdin.write(UBIQUITIN.read_bytes()[:1000])
            process.stdin.flush()
            # Standard input stays open, so the program is still reading.
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(0.5)
            self.assert_ends(process, number)

    def wait_for(self, process, stage):
        """Until the progress bar names the stage."""
        seen = b""
        while stage.encode() not in seen:
            block = process.stderr.read1(4096)
            self.assertTrue(block, f"the program ended before {stage}")
            seen = seen[-200:] + block

    def test_in_every_stage(self):
        mesh = ("mesh", UBIQUITIN, "-o", self.folder / "a.obj", "--spacing")
        report = ("report", UBIQUITIN, "--json", self.folder / "a.json", "--spacing")
        exact_mesh = ("mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--mesher", "exact")
        picture = ("--picture", self.folder / "a.png", "--per-atom", self.folder / "a.csv")
        numbers = itertools.cycle(EXIT_CODES)
        for stage, arguments in {
            "search": (*mesh, "0.03"),
            "field": (*mesh, "0.04"),
            "extract": (*mesh, "0.04"),
            "refine": (*mesh, "0.2", "--subdivide", "2"),
            "measure": (*report, "0.1", "--subdivide", "0"),
            "write": (*mesh, "0.1"),
            "sample arcs": (*exact_mesh, "--edge-length", "0.02"),
            "mesh patches": (*exact_mesh, "--edge-length", "0.03"),
            "exact union": (*report, "0.3", "--samples", "1000"),
            "distances of the mesh": (*report, "0.3", "--samples", "1000"),
            "distances of the surface": (*report, "0.3", "--samples", "1000", *picture),
        }.items():
            number = next(numbers)
            with self.subTest(stage=stage, signal=number.name):
                process = self.start(*arguments, "--progress")
                self.wait_for(process, stage)
                self.assert_ends(process, number)

    def test_while_writing(self):
        """Where a file system has no unnamed files, what there is of one must be removed."""
        process = self.start("mesh", UBIQUITIN, "-o", self.folder / "a.obj", "--spacing", "0.1")
        while not self.writes(process):
            self.assertIsNone(process.poll(), "the program ended before it was seen writing")
        self.assert_ends(process, signal.SIGTERM)

    def writes(self, process):
        """Whether the process holds a file in the folder open, named or not."""
        try:
            links = [os.readlink(f) for f in pathlib.Path(f"/proc/{process.pid}/fd").iterdir()]
        except OSError:
            return False
        return any(link.startswith(str(self.folder)) for link in links)

    def test_twice(self):
        """A second signal, while the first is being obeyed, changes nothing."""
        process = self.start("mesh", UBIQUITIN, "-o", self.folder / "a.obj", "--spacing", "0.1",
                             "--progress")
        self.wait_for(process, "write")
        process.send_signal(signal.SIGTERM)
        self.assert_ends(process, signal.SIGTERM)

    def test_a_study_goes_on_where_it_was_stopped(self):
        out = self.folder / "out"
        arguments = ("study", UBIQUITIN, "-o", out, "--spacing", "1,0.8,0.6,0.4", "--subdivide", "0")
        process = self.start(*arguments)
        runs = out / "runs"
        while not (runs.is_dir() and len(list(runs.iterdir())) >= 2):
            self.assertIsNone(process.poll(), "the study ended before it was stopped")
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        left = [path.name for path in out.rglob("*") if path.is_file()]
        self.assertTrue(all(name.endswith(".json") for name in left), left)
        kept = len(list(runs.iterdir()))
        result = self.run_ok(*arguments)
        self.assertIn(f"{kept} found finished", result.stdout)
        self.assertTrue((out / "study.json").exists())
