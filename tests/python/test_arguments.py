"""Wrong arguments are a ValueError of one line that names the argument and the element."""

import pathlib
import unittest

import numpy as np
import vdwmesh

NAN = float("nan")
ONE, SIZE = [[0.0, 0.0, 0.0]], [1.0]

# Arguments, options, what the message begins with.
WRONG = [
    ([[0, 0]], SIZE, {}, "coords: has shape (1, 2)"),
    ([0, 0, 0], SIZE, {}, "coords: has shape (3,)"),
    (5, SIZE, {}, "coords: has shape ()"),
    ([], [], {}, "coords: "),
    (np.zeros((0, 3)), [], {}, "coords: is empty"),
    (np.zeros((1, 1, 3)), SIZE, {}, "coords: has shape (1, 1, 3)"),
    ([["a", "b", "c"]], SIZE, {}, "coords: "),
    ("a.pdb", None, {}, "coords: 'a.pdb' is no array of shape (N, 3); vdwmesh.read(path) reads a structure file"),
    (pathlib.Path("a.pdb"), SIZE, {}, "coords: 'a.pdb' is no array of shape (N, 3); vdwmesh.read(path)"),
    ([[0, 0, 0], [1, 1]], SIZE, {}, "coords: "),
    (np.zeros((1, 3), complex), SIZE, {}, "coords: has elements of type complex128"),
    ([[0, NAN, 0]], SIZE, {}, "coords[0]: (0, nan, 0)"),
    ([[0, 0, 0], [0, 0, np.inf]], [1, 1], {}, "coords[1]: (0, 0, inf)"),
    (ONE, [1, 1], {}, "radii: has 2 radii for 1 atoms"),
    (ONE, [[1]], {}, "radii: has shape (1, 1)"),
    (ONE, 1, {}, "radii: has shape ()"),
    (ONE, None, {}, "radii: are needed"),
    (ONE, "bondi", {}, "radii: are needed"),
    (ONE, [-1], {}, "radii[0]: -1"),
    (ONE, [NAN], {}, "radii[0]: nan"),
    (ONE, [np.inf], {}, "radii[0]: inf"),
    (ONE, [0], {}, "radii[0]: 0 with probe 0"),
    (ONE, SIZE, {"probe": -1}, "radii[0]: 1 with probe -1"),
    (ONE, SIZE, {"probe": NAN}, "probe: nan"),
    (ONE, SIZE, {"probe": "big"}, "probe: 'big'"),
    (ONE, SIZE, {"atoms": [1]}, "atoms[0]: 1"),
    (ONE, SIZE, {"atoms": [0, -2]}, "atoms[1]: -2"),
    (ONE, SIZE, {"atoms": [True, False]}, "atoms: is a mask of 2"),
    (ONE, SIZE, {"atoms": [0.5]}, "atoms: has elements of type float64"),
    (ONE, SIZE, {"atoms": [[0]]}, "atoms: has shape (1, 1)"),
    (ONE, SIZE, {"method": "quick"}, "method: quick"),
    (ONE, SIZE, {"atoms": []}, "atoms: chooses no atom"),
    (ONE, SIZE, {"atoms": [False]}, "atoms: chooses no atom"),
    (ONE, SIZE, {"threads": 0}, "threads: 0"),
    (ONE, SIZE, {"threads": 70000}, "threads: 70000"),
    (ONE, SIZE, {"threads": 2**40}, "threads: 1099511627776"),
    (ONE, SIZE, {"threads": 1.5}, "threads: 1.5"),
    (ONE, SIZE, {"threads": True}, "threads: True"),
    (ONE, SIZE, {"device": "tpu"}, "device: tpu"),
]


class OnTheDevice:
    """An array of another library, in the memory of a GPU."""

    __cuda_array_interface__ = {"shape": (1, 3), "typestr": "<f8", "data": (0, True), "version": 3}


class WithAnArrayMethod(OnTheDevice):
    """As of CuPy and PyTorch, which refuse to copy by themselves."""

    def __array__(self, dtype=None):
        raise TypeError("can't convert cuda:0 device type tensor to numpy")


class WrongArgumentsTest(unittest.TestCase):
    def assert_refused(self, begins, call, *arguments, **options):
        with self.assertRaises(ValueError) as caught:
            call(*arguments, **options)
        self.assertIsInstance(caught.exception, vdwmesh.InvalidInput)
        message = str(caught.exception)
        self.assertTrue(message.startswith(begins), f"{message!r} does not begin with {begins!r}")
        self.assertNotIn("\n", message)

    def test_exact(self):
        for coords, radii, options, begins in WRONG:
            with self.subTest(begins=begins):
                self.assert_refused(begins, vdwmesh.exact, coords, radii, **options)

    def test_sasa(self):
        self.assert_refused("coords[1, 0]: (nan", vdwmesh.sasa, [ONE, [[NAN, 0, 0]]], SIZE)
        self.assert_refused("coords: ", vdwmesh.sasa, np.zeros((2, 1, 4)), SIZE)
        self.assert_refused("coords: is empty", vdwmesh.sasa, np.zeros((0, 1, 3)), SIZE)
        self.assert_refused("mode: 'chain'", vdwmesh.sasa, ONE, SIZE, mode="chain")
        self.assert_refused("groups: are needed", vdwmesh.sasa, ONE, SIZE, mode="residue")
        self.assert_refused("groups: has 2", vdwmesh.sasa, ONE, SIZE, mode="residue", groups=[1, 2])
        self.assert_refused("groups: are of", vdwmesh.sasa, ONE, SIZE, groups=[1])
        self.assert_refused("groups: a label for each", vdwmesh.sasa, ONE, SIZE, mode="residue", groups=1)
        self.assert_refused("groups: labels must be", vdwmesh.sasa, ONE, SIZE, mode="residue", groups=[{}])
        two = [[0, 0, 0], [5, 0, 0]], [1, 2]  # labels of several parts, as chain and number
        for groups in ([["A", 1], ["A", 2]], np.array([["A", "1"], ["A", "2"]]), [("A", 1), ("A", 2)]):
            found = vdwmesh.sasa(*two, probe=0, mode="residue", groups=groups)
            np.testing.assert_allclose(found / np.pi, [4, 16])

    def test_masked_elements_are_refused(self):
        coords, radii = np.zeros((2, 3)), np.ones(2)
        masked = np.ma.masked_array(radii, [False, True])
        for call in (lambda: vdwmesh.exact(np.ma.masked_less(coords, 1), radii), lambda: vdwmesh.exact(coords, masked),
                     lambda: vdwmesh.exact(coords, radii, atoms=masked > 0),
                     lambda: vdwmesh.sasa(coords, radii, mode="residue", groups=masked),
                     lambda: vdwmesh.radii_of(np.ma.masked_array(["C", "N"], [True, False]))):
            with self.assertRaisesRegex(ValueError, "has masked elements"):
                call()
        whole = np.ma.masked_array(radii, [False, False])
        self.assertEqual(vdwmesh.exact(coords, whole).area, vdwmesh.exact(coords, radii).area)

    def test_a_missing_device_is_said(self):
        expected = vdwmesh.exact(ONE, SIZE, device="cpu").area
        try:
            self.assertAlmostEqual(vdwmesh.exact(ONE, SIZE, device="cuda").area, expected, places=11)
        except vdwmesh.BackendUnavailable as error:  # on a machine without one
            self.assertIsInstance(error, RuntimeError)
            self.assertNotIn("\n", str(error))
        with self.assertRaises(vdwmesh.BackendUnavailable):  # a device has no topology
            vdwmesh.exact(ONE, SIZE, device="cuda", topology=True)
        for array in (OnTheDevice(), WithAnArrayMethod()):  # others read it where it lies
            with self.assertRaisesRegex(RuntimeError, "coords: is on a CUDA device"):
                vdwmesh.signed_distance(ONE, array, SIZE)

    def test_numbers_of_all_kinds_and_places_are_read(self):
        expected = vdwmesh.exact([[0, 0, 0], [1, 2, 3]], [1, 2]).area
        wide = np.zeros((4, 6))
        wide[1] = [1, 9, 2, 9, 3, 9]
        packed = np.zeros(2, [("tag", "u1"), ("x", "<f8", 3)])  # not aligned
        packed["x"][1] = [1, 2, 3]
        for coords in (np.array([[0, 0, 0], [1, 2, 3]], np.float32), wide[:2, ::2],
                       np.array([[0, 0, 0], [1, 2, 3]], ">f8"), np.array([[0, 0, 0], [1, 2, 3]]),
                       np.asfortranarray([[0.0, 0, 0], [1, 2, 3]]), packed["x"],
                       np.array([[1.0, 2, 3], [0, 0, 0]])[::-1], ((0, 0, 0), (1, 2, 3))):  # fmt: skip
            self.assertEqual(vdwmesh.exact(coords, np.array([1, 2], np.int32)).area, expected)


if __name__ == "__main__":
    unittest.main()
