"""What the program loads while it runs: no CUDA driver, unless a device was asked for.

The runtime library may be linked (libcudart); without the driver it cannot make a context.
"""

import os
import re
import unittest

from program import NO_BACKEND, UBIQUITIN, ProgramTest, parse_json, run

DRIVER = re.compile(r"libcuda\.so|libnvidia")


class Libraries(ProgramTest):
    def loaded(self, *arguments):
        """Names that the dynamic loader was asked for, found or not, and the run's result."""
        log = self.folder / "loader"
        environment = {**os.environ, "LD_DEBUG": "files", "LD_DEBUG_OUTPUT": str(log)}
        result = run(*arguments, env=environment)
        text = "".join(path.read_text() for path in self.folder.glob("loader.*"))
        for path in self.folder.glob("loader.*"):
            path.unlink()
        names = set(re.findall(r"file=(\S+) \[\d+\];  (?:needed|dynamically loaded) by", text))
        if not names:
            self.skipTest("this loader does not say what it loads (LD_DEBUG)")
        return names, result

    def driver_libraries(self, *arguments):
        names, result = self.loaded(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return sorted(name for name in names if DRIVER.search(name))

    def test_backend_cpu_loads_no_driver(self):
        mesh, quick = self.folder / "m.ply", ("--distances", "off", "--topology", "off")
        for arguments in (
            ("mesh", UBIQUITIN, "--spacing", "1", "-o", mesh),
            ("report", UBIQUITIN, "--spacing", "1", *quick),
            ("exact", UBIQUITIN, "--topology", "off"),
        ):
            with self.subTest(verb=arguments[0]):
                backend = () if arguments[0] == "exact" else ("--backend", "cpu")
                self.assertEqual(self.driver_libraries(*arguments, *backend), [])

    def test_the_same_look_sees_what_backend_cuda_loads(self):
        info = parse_json(self.run_ok("info", "--json", "-").stdout)
        if "no CUDA backend" in (info["cuda"]["reason"] or ""):
            self.skipTest("this build has no CUDA backend")
        names, result = self.loaded("mesh", UBIQUITIN, "--spacing", "1", "--backend", "cuda",
                                    "-o", self.folder / "m.ply")  # fmt: skip
        self.assertIn(result.returncode, (0, NO_BACKEND), result.stderr)
        self.assertTrue(any(DRIVER.search(name) for name in names), names)


if __name__ == "__main__":
    unittest.main()
