"""Derivatives of areas and volumes, vdwmesh.torch and vdwmesh.jax beside references in quad precision and the program."""

import csv
import importlib.util
import re
import unittest

import numpy as np
import vdwmesh
from program import SOURCE_DIR, ProgramTest, need_package, need_shared

COLUMNS = ("dA_dx", "dA_dy", "dA_dz", "dA_dr", "dV_dx", "dV_dy", "dV_dz", "dV_dr")
BAR = 1e-10  # times 1 + the size of the reference


def reference(name, probe):
    """The balls of a set, and what is known of each: plain derivatives, and weighted ones."""
    balls = np.loadtxt(need_shared(f"reference/{name}.xyzr"))
    with open(need_shared("reference/gradients.csv"), newline="") as file:
        rows = [row for row in csv.DictReader(file) if (row["set"], float(row["probe"])) == (name, probe)]
    plain = np.array([[float(row[c]) for c in COLUMNS] for row in rows])
    weighted = np.array([[float(row[c.replace("_", "w_")]) for c in COLUMNS] for row in rows])
    return balls[:, :3], balls[:, 3], plain, weighted


def columns(gradient):
    return np.column_stack(
        (gradient.area_coords, gradient.area_radii, gradient.volume_coords, gradient.volume_radii)
    )


def assert_close(found, expected):
    np.testing.assert_array_less(np.abs(found - expected), BAR * (1 + np.abs(expected)))


class GradientTest(ProgramTest):
    def test_references(self):
        coords, radii, plain, weighted = reference("1CRN", 1.4)
        union = vdwmesh.exact(coords, radii, probe=1.4, gradient=True)
        assert_close(columns(union.gradient), plain)
        self.assertEqual(union.area, vdwmesh.exact(coords, radii, probe=1.4).area)
        weights = np.arange(len(radii)) % 7 / 7 + 0.25
        for given in (weights, (weights, weights)):
            found = vdwmesh.exact(coords, radii, probe=1.4, gradient=True, weights=given)
            assert_close(columns(found.gradient), weighted)
        mixed = vdwmesh.exact(coords, radii, probe=1.4, gradient=True, weights=(None, weights)).gradient
        assert_close(columns(mixed)[:, :4], plain[:, :4])
        assert_close(columns(mixed)[:, 4:], weighted[:, 4:])

    def test_the_program_writes_the_same(self):
        self.run_ok("exact", "--sample", "bpti", "--gradient", self.folder / "g.csv")
        table = np.genfromtxt(self.folder / "g.csv", delimiter=",", names=True)
        self.assertEqual(table.dtype.names, COLUMNS)
        molecule = vdwmesh.sample("bpti")
        gradient = vdwmesh.exact(molecule, gradient=True).gradient
        np.testing.assert_array_equal(np.column_stack([table[c] for c in COLUMNS]), columns(gradient))

    def test_refusals(self):
        two = ([[0, 0, 0], [1, 0, 0]], [1, 1])
        for weights in ([1], [1, float("nan")], ([1, 1], "w"), [[1, 1]]):
            with self.assertRaisesRegex(vdwmesh.InvalidInput, "weights"):
                vdwmesh.exact(*two, gradient=True, weights=weights)


    def test_frames(self):
        """Each frame has the bytes of the frame alone, for both kinds of surface."""
        dice = np.random.default_rng(11)
        places, radii = dice.uniform(-3, 3, (6, 20, 3)), dice.uniform(1, 1.9, 20)
        weights = (dice.normal(size=20), None)
        for options in ({"probe": 1.4, "weights": weights}, {"surface": "ses"}):
            found = list(vdwmesh.frames(places, radii=radii, gradient=True, per_atom=True, **options))
            self.assertEqual([one.frame for one in found], list(range(6)))
            for one, coords in zip(found, places):
                alone = vdwmesh.exact(coords, radii, gradient=True, **options)
                self.assertEqual((one.area, one.volume), (alone.area, alone.volume))
                np.testing.assert_array_equal(one.atom_area, alone.atom_area)
                np.testing.assert_array_equal(columns(one.gradient), columns(alone.gradient))
        for wrong, why in (({"topology": True}, "topology"), ({"weights": [1.0]}, "weights"), ({"atoms": [0]}, "atoms")):
            with self.assertRaisesRegex(vdwmesh.InvalidInput, why):
                vdwmesh.frames(places, radii=radii, gradient=True, **wrong)
        with self.assertRaisesRegex(vdwmesh.InvalidInput, "gradient"):
            vdwmesh.trajectory(places, radii=radii, gradient=True)


class MapTest(unittest.TestCase):
    """Rates along a motion and the sparse matrix, beside gradients and differences."""

    def setUp(self):
        dice = np.random.default_rng(7)
        self.coords, self.radii = dice.uniform(-3, 3, (30, 3)), dice.uniform(1, 1.9, 30)
        self.move, self.growth = dice.normal(size=(30, 3)), dice.normal(size=30)

    def moved(self, step):
        found = vdwmesh.exact(self.coords + step * self.move, self.radii + step * self.growth, probe=0.5)
        return found.atom_area, found.atom_volume

    def test_rates_are_differences(self):
        step = 1e-5
        rates = vdwmesh.rates(self.coords, self.radii, move=self.move, growth=self.growth, probe=0.5)
        for rate, ahead, behind in zip(rates, self.moved(step), self.moved(-step)):
            np.testing.assert_allclose(rate, (ahead - behind) / (2 * step), atol=1e-5)

    def test_the_matrix_times_the_motion(self):
        sparse = need_package("python3-scipy", module="scipy.sparse")
        j = vdwmesh.jacobian(self.coords, self.radii, probe=0.5)
        self.assertLess(len(j.indices), 30 * 30)
        rates = vdwmesh.rates(self.coords, self.radii, move=self.move, growth=self.growth, probe=0.5)
        pairs = ((j.area_coords, j.area_radii, rates.atom_area), (j.volume_coords, j.volume_radii, rates.atom_volume))
        for by_coords, by_radii, rate in pairs:
            places = sparse.bsr_matrix((by_coords[:, None], j.indices, j.indptr), shape=(30, 90))
            sizes = sparse.csr_matrix((by_radii, j.indices, j.indptr), shape=(30, 30))
            np.testing.assert_allclose(places @ self.move.ravel() + sizes @ self.growth, rate, atol=1e-11)

    def test_part_of_a_motion_and_refusals(self):
        both = vdwmesh.rates(self.coords, self.radii, move=self.move, growth=self.growth)
        parts = [vdwmesh.rates(self.coords, self.radii, **{k: getattr(self, k)}) for k in ("move", "growth")]
        np.testing.assert_allclose(both.atom_area, parts[0].atom_area + parts[1].atom_area, atol=1e-11)
        for given in ({}, {"move": self.move[1:]}, {"growth": [np.nan] * 30}, {"move": self.growth}, {"growth": 1}):
            with self.assertRaises(vdwmesh.InvalidInput):
                vdwmesh.rates(self.coords, self.radii, **given)


class PageTest(unittest.TestCase):
    def test_the_packing_relaxes(self):
        """The code of the page: springs and volumes balance in the end."""
        page = (SOURCE_DIR / "docs" / "tasks" / "gradients.md").read_text()
        code = re.search(r"^A packing that relaxes.*?```python\n(.*?)```", page, re.S | re.M)[1]
        found = {"np": np, "vdwmesh": vdwmesh}
        exec(compile(code, "gradients.md", "exec"), found)
        self.assertLess(np.abs(found["slope"]).max(), 0.05)


class TorchTest(unittest.TestCase):
    def setUp(self):
        need_package("python3-torch", module="torch")

    def test_gradcheck(self):
        import torch
        import vdwmesh.torch

        dice = np.random.default_rng(3)
        coords = torch.tensor(dice.uniform(-2, 2, (8, 3)), requires_grad=True)
        radii = torch.tensor(dice.uniform(0.9, 1.7, 8), requires_grad=True)
        for function in (vdwmesh.torch.areas, vdwmesh.torch.volumes, vdwmesh.torch.measures):
            self.assertTrue(torch.autograd.gradcheck(function, (coords, radii), eps=1e-6, check_forward_ad=True))

    def test_many_sets_and_frames(self):
        """Three sets of one tensor, and five frames of the same atoms: values, backward and forward mode."""
        import torch
        import vdwmesh.torch

        dice = np.random.default_rng(4)
        coords = torch.tensor(dice.uniform(-2, 2, (15, 3)), requires_grad=True)
        radii = torch.tensor(dice.uniform(0.9, 1.7, 15), requires_grad=True)
        offsets = [0, 4, 5, 15]
        check = {"eps": 1e-6, "check_forward_ad": True}
        for given in (offsets, torch.tensor(offsets)):
            of_sets = lambda x, r: vdwmesh.torch.measures(x, r, offsets=given)  # noqa: B023, E731
            self.assertTrue(torch.autograd.gradcheck(of_sets, (coords, radii), **check))
        for first, end in zip(offsets, offsets[1:]):
            alone = vdwmesh.torch.areas(coords[first:end], radii[first:end])
            self.assertTrue(torch.equal(vdwmesh.torch.areas(coords, radii, offsets=offsets)[first:end], alone))
        frames = coords.detach().reshape(5, 3, 3).requires_grad_()
        three = radii.detach()[:3].requires_grad_()
        self.assertEqual(vdwmesh.torch.volumes(frames, three).shape, (5, 3))
        self.assertTrue(torch.autograd.gradcheck(vdwmesh.torch.measures, (frames, three), **check))
        for wrong in ({"offsets": [0, 5]}, {"offsets": [0, 0, 15]}):
            with self.assertRaisesRegex(vdwmesh.InvalidInput, "offsets"):
                vdwmesh.torch.areas(coords, radii, **wrong)

    def test_loss_of_float32(self):
        import torch
        import vdwmesh.torch

        coords = torch.tensor([[0.0, 0, 0], [1, 0, 0]], requires_grad=True)
        vdwmesh.torch.areas(coords, torch.ones(2)).sum().backward()
        self.assertEqual(coords.grad.dtype, torch.float32)
        self.assertAlmostEqual(float(coords.grad[1, 0]), 2 * np.pi, places=5)  # area is 2 pi (2 + d)

    def test_loss_of_the_page(self):
        """Two balls whose distance is d: A = 2 pi (2 + d), and V grows by pi (1 - d²/4) per d."""
        page = (SOURCE_DIR / "docs" / "tasks" / "gradients.md").read_text()
        code = re.search(r"^## As a loss.*?```python\n(.*?)```", page, re.S | re.M)[1].replace("probe=1.4", "probe=0")
        given = {"coords": [[0, 0, 0], [1, 0, 0]], "radii": [1.0, 1.0], "gamma": 3.0, "pressure": 2.0}
        exec(compile(code, "gradients.md", "exec"), given)
        self.assertAlmostEqual(float(given["x"].grad[1, 0]), 3 * 2 * np.pi + 2 * np.pi * 0.75, places=12)


class JaxTest(unittest.TestCase):
    def setUp(self):
        if importlib.util.find_spec("jax") is None:
            self.skipTest("JAX is not installed")
        import jax
        import vdwmesh.jax

        jax.config.update("jax_enable_x64", True)
        self.jax, self.ours = jax, vdwmesh.jax
        dice = np.random.default_rng(3)
        self.atoms = dice.uniform(-2, 2, (8, 3)), dice.uniform(0.9, 1.7, 8)

    def test_gradients_are_differences(self):
        from jax.test_util import check_grads

        for function in (self.ours.areas, self.ours.volumes, self.ours.measures):
            check_grads(function, self.atoms, order=1, modes=["rev"], eps=1e-6)

    def test_many_sets_and_frames(self):
        from jax.test_util import check_grads

        coords, radii = self.atoms
        check_grads(lambda x, r: self.ours.measures(x, r, offsets=(0, 3, 8)), self.atoms, order=1, modes=["rev"], eps=1e-6)
        alone = self.ours.areas(coords[3:], radii[3:])
        np.testing.assert_array_equal(self.ours.areas(coords, radii, offsets=[0, 3, 8])[3:], alone)
        frames = np.stack([coords, 0.9 * coords])
        check_grads(self.ours.measures, (frames, radii), order=1, modes=["rev"], eps=1e-6)

    def test_jit_and_vmap_change_nothing(self):
        jax = self.jax
        loss = lambda x, r: (self.ours.areas(x, r, probe=0.3) * self.ours.volumes(x, r, probe=0.3)).sum()  # noqa: E731
        expected = jax.grad(loss)(*self.atoms)
        np.testing.assert_array_equal(jax.jit(jax.grad(loss))(*self.atoms), expected)
        twice = [np.stack([array, array]) for array in self.atoms]
        np.testing.assert_array_equal(jax.vmap(jax.grad(loss))(*twice)[1], expected)

    def test_float32(self):
        coords, radii = np.array([[0, 0, 0], [1, 0, 0]], np.float32), np.ones(2, np.float32)
        areas, volumes = self.ours.measures(coords, radii)
        self.assertEqual((areas.dtype, volumes.dtype), (np.float32, np.float32))
        slope = self.jax.grad(lambda x: self.ours.areas(x, radii).sum())(coords)
        self.assertEqual(slope.dtype, np.float32)
        self.assertAlmostEqual(float(slope[1, 0]), 2 * np.pi, places=5)  # area is 2 pi (2 + d)

    def test_refusals(self):
        with self.assertRaisesRegex(vdwmesh.InvalidInput, r"\(N, 3\)"):
            self.ours.areas(np.zeros((3, 2)), np.ones(3))


class ExcludedTest(unittest.TestCase):
    def test_excluded_surface(self):
        """Three balls: by differences, and twice the area and three times the volume by scaling."""
        coords, radii, probe = np.array([[0.0, 0, 0], [2.4, 0.3, 0], [1.1, 2.2, 0.4]]), np.array([1.7, 1.5, 1.6]), 1.4
        found = vdwmesh.exact(coords, radii, surface="ses", probe=probe, gradient=True)
        g = found.gradient
        scaled = (coords * g.area_coords).sum() + (radii * g.area_radii).sum() + probe * g.area_probe
        self.assertAlmostEqual(scaled, 2 * found.area, delta=1e-10 * found.area)
        scaled = (coords * g.volume_coords).sum() + (radii * g.volume_radii).sum() + probe * g.volume_probe
        self.assertAlmostEqual(scaled, 3 * found.volume, delta=1e-10 * found.volume)
        step, move = 1e-4, np.zeros((3, 3))
        move[1, 0] = step
        areas = [vdwmesh.exact(coords + sign * move, radii, surface="ses", probe=probe).area for sign in (1, -1)]
        self.assertAlmostEqual((areas[0] - areas[1]) / (2 * step), g.area_coords[1, 0], delta=1e-6)
        self.assertEqual((g.kink_probes, g.kink_atoms), (0, 0))
        self.assertIsNone(vdwmesh.exact(coords, radii, surface="ses").gradient)


if __name__ == "__main__":
    unittest.main()
