"""SIGINT and SIGTERM end the program with 130 and 143 and leave nothing half-written."""

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

    def test_while_working(self):
        for number in EXIT_CODES:
            process = self.start(
                "mesh", UBIQUITIN, "-o", self.folder / "a.ply", "--spacing", "0.05", "--progress"
            )
            # The bar tells that the extraction has begun, which takes seconds at this spacing.
            seen = b""
            while b"extract" not in seen and b"field" not in seen:
                byte = process.stderr.read(1)
                self.assertTrue(byte, "the program ended by itself")
                seen += byte
            self.assert_ends(process, number)
