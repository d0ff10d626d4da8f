"""How calls behave: views and their owners, threads, Ctrl-C, memory."""

import gc
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np
import vdwmesh
from program import need_shared

# Seconds from the signal to the exception. Machines with more to do than cores take longer.
ANSWER = 0.3 * (5 if os.getloadavg()[0] > (os.cpu_count() or 1) else 1)


def crystal(side):
    """Balls that overlap, on a cubic lattice a little out of order."""
    rng = np.random.default_rng(7)
    grid = np.stack(np.meshgrid(*[np.arange(side, dtype=float)] * 3), -1).reshape(-1, 3)
    return 1.5 * grid + rng.uniform(-0.2, 0.2, (side**3, 3)), np.full(side**3, 1.7)


class ViewTest(unittest.TestCase):
    def test_results_are_read_only_views(self):
        found = vdwmesh.exact([[0, 0, 0], [1, 0, 0]], [1, 1], topology=True)
        for array in (found.atom_area, found.atom_volume, found.topology.shells):
            self.assertFalse(array.flags.writeable)
            self.assertFalse(array.flags.owndata)
            with self.assertRaises(ValueError):
                array[...] = 0
        # Areas and volumes lie side by side in the result of the library, so nothing was copied.
        areas, volumes = (a.__array_interface__["data"][0] for a in (found.atom_area, found.atom_volume))
        self.assertEqual(volumes - areas, 8)
        self.assertEqual(found.atom_area.strides, (16,))

    def test_views_outlive_their_results(self):
        coords, radii = crystal(6)
        kept = [vdwmesh.exact(coords, radii, topology=True) for _ in range(8)]
        expected = kept[0].atom_area.copy()
        views = [result.atom_area[1::2] for result in kept]
        shells = kept[0].topology.shells
        before = shells.copy()
        del kept
        gc.collect()
        vdwmesh.exact(coords + 1, radii)  # takes memory that was given back
        for view in views:
            np.testing.assert_array_equal(view, expected[1::2])
        np.testing.assert_array_equal(shells, before)

    def test_results_are_frozen(self):
        with self.assertRaises(AttributeError):
            vdwmesh.exact([[0, 0, 0]], [1]).area = 0


class ThreadsTest(unittest.TestCase):
    def test_results_do_not_depend_on_the_number_of_threads(self):
        coords, radii = crystal(8)
        one, two, all_cores = (vdwmesh.exact(coords, radii, threads=n) for n in (1, 2, None))
        np.testing.assert_array_equal(one.atom_area, all_cores.atom_area)
        np.testing.assert_array_equal(two.atom_volume, all_cores.atom_volume)
        self.assertEqual(one.area, all_cores.area)

    def test_other_threads_run_meanwhile(self):
        coords, radii = crystal(24)
        counted = 0
        done = threading.Event()

        def count():
            nonlocal counted
            while not done.is_set():
                counted += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        before, began = counted, time.monotonic()
        vdwmesh.exact(coords, radii, threads=1, topology=True)
        seconds, after = time.monotonic() - began, counted
        done.set()
        thread.join()
        self.assertGreater(seconds, 0.05)
        self.assertGreater(after - before, seconds / 0.001 * 0.05)  # they slept most of the time

    def test_calls_from_several_threads_agree(self):
        coords, radii = crystal(6)
        expected = vdwmesh.exact(coords, radii).area
        found = []
        threads = [threading.Thread(target=lambda: found.append(vdwmesh.exact(coords, radii).area))
                   for _ in range(8)]  # fmt: skip
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [expected] * 8)

    def test_errors_of_other_threads_have_their_class(self):
        caught = []

        def fail():
            try:
                vdwmesh.exact([[0, 0, 0]], [-1])
            except ValueError as error:
                caught.append(str(error))

        thread = threading.Thread(target=fail)
        thread.start()
        thread.join()
        self.assertTrue(caught[0].startswith("radii[0]"))


def seconds_to_stop(case, work, after=0.15):
    """Sends SIGINT after a while, as Ctrl-C does, and returns how long it took to be raised."""
    sent = []

    def send():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, send)
    timer.start()
    with case.assertRaises(KeyboardInterrupt):
        while True:  # work may be done before the signal
            work()
    timer.join()
    return time.monotonic() - sent[0]


class InterruptTest(unittest.TestCase):
    def test_exact_stops(self):
        coords, radii = crystal(50)
        for method in ("arcs", "cgal"):
            with self.subTest(method=method):
                seconds = seconds_to_stop(self, lambda: vdwmesh.exact(coords, radii, method=method))
                self.assertLess(seconds, ANSWER)

    def test_meshes_stop(self):
        coords, radii = crystal(30)
        volume = np.random.default_rng(1).random((300, 300, 300), np.float32)
        mesh = vdwmesh.mesh(*crystal(12))
        pile = (np.random.default_rng(1).random((90000, 3)), np.arange(90000).reshape(-1, 3))
        for name, work in (
            ("exact mesher", lambda: vdwmesh.mesh(coords, radii, edge_length=0.1)),
            ("marching cubes", lambda: vdwmesh.mesh(coords, radii, mesher="marching-cubes", spacing=0.1)),
            ("subdivision", lambda: vdwmesh.mesh(coords, radii, mesher="marching-cubes", subdivide=2)),
            ("volume", lambda: vdwmesh.marching_cubes(volume, 0.5)),
            ("comparison", lambda: vdwmesh.compare(mesh, *crystal(12), samples=500)),
            ("self-intersections", lambda: vdwmesh.quality(pile, self_intersections=True)),
            ("distances", lambda: vdwmesh.signed_distance(volume[0, :, :3] * 40, coords, radii)),
        ):
            with self.subTest(name):
                seconds = seconds_to_stop(self, work)
                self.assertLess(seconds, ANSWER)

    def test_frames_stop(self):
        coords, radii = crystal(8)
        frames = np.broadcast_to(coords, (2000, *coords.shape))
        self.assertLess(seconds_to_stop(self, lambda: vdwmesh.sasa(frames, radii)), ANSWER)

    def test_work_goes_on_after_it(self):
        coords, radii = crystal(30)
        seconds_to_stop(self, lambda: vdwmesh.exact(coords, radii))
        self.assertGreater(vdwmesh.exact(coords, radii).area, 0)

    def test_handlers_that_do_not_raise_do_not_stop(self):
        coords, radii = crystal(60)
        expected = vdwmesh.exact(coords, radii, threads=1).area
        seen = []
        previous = signal.signal(signal.SIGALRM, lambda *_: seen.append(time.monotonic()))
        signal.setitimer(signal.ITIMER_REAL, 0.03, 0.03)
        found = vdwmesh.exact(coords, radii, threads=1).area
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, previous)
        self.assertEqual(found, expected)
        self.assertGreater(len(seen), 0)


class MemoryTest(unittest.TestCase):
    def resident(self):
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")

    def test_memory_stays_flat_over_calls(self):
        coords, radii = crystal(4)

        def calls(count):
            for _ in range(count):
                vdwmesh.exact(coords, radii)
                vdwmesh.sasa(coords, radii, mode="atom")
                vdwmesh.radii_of(["C", "N"])
                try:
                    vdwmesh.exact(coords, -radii)
                except ValueError:
                    pass

        calls(500)
        gc.collect()
        before = self.resident()
        calls(2500)  # 10,000 calls
        gc.collect()
        # A leak of one result of 64 atoms (1 KiB) a call would be 2.5 MiB or more of each kind.
        self.assertLess(self.resident() - before, 2 << 20)

    def test_memory_stays_flat_over_calls_on_several_threads(self):
        """Each call begins on a thread that oneTBB does not know, and must leave nothing there."""
        volume = np.random.default_rng(1).random((16, 16, 16), np.float32)

        def calls(count):
            for _ in range(count):
                vdwmesh.marching_cubes(volume, 0.9)
                vdwmesh.marching_cubes(volume, 2, threads=2)

        calls(200)
        before = self.resident()
        calls(1000)
        # An arena of oneTBB has 9 KiB: one a call would be 18 MiB.
        self.assertLess(self.resident() - before, 4 << 20)


class ImportTest(unittest.TestCase):
    def test_nothing_of_others_is_imported(self):
        code = "import sys, vdwmesh; print(*{m.partition('.')[0] for m in sys.modules})"
        found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        others = {"MDAnalysis", "mdtraj", "biotite", "gemmi", "trimesh", "pyvista", "meshio", "open3d",
                  "pandas", "scipy", "numpy"}  # fmt: skip
        self.assertEqual(others & set(found.stdout.split()), set())

    def test_all_names_are_there_and_no_others(self):
        self.assertEqual(set(dir(vdwmesh)), set(vdwmesh.__all__))
        for name in vdwmesh.__all__:
            self.assertIs(getattr(vdwmesh, name), getattr(vdwmesh, name))
        self.assertRegex(vdwmesh.__version__, r"^\d+\.\d+\.\d+$")
        with self.assertRaisesRegex(AttributeError, "no attribute 'surface'"):
            vdwmesh.surface

    def test_results_hold_with_the_checks_of_pythons_allocator(self):
        code = ("import vdwmesh, gc; m = vdwmesh.sample(); "
                "a = [vdwmesh.exact(m, topology=True).atom_area for _ in range(20)]; gc.collect(); "
                "print(all((x == a[0]).all() for x in a))")  # fmt: skip
        found = subprocess.run([sys.executable, "-X", "dev", "-c", code], capture_output=True, text=True,
                               env={**os.environ, "PYTHONMALLOC": "debug"})  # fmt: skip
        self.assertEqual((found.stdout, found.stderr), ("True\n", ""))


if __name__ == "__main__":
    unittest.main()
