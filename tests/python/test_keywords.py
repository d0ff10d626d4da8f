"""Keywords never vanish: each changes what its function gives, or is refused with one line that names it.

keyword_pairs.csv says for each function and keyword what becomes of it, and a call that shows it: the value is given
beside others to the function on a small structure. "changes": the result is another than without the value.
"""

import csv
import dataclasses
import inspect
import pathlib
import tempfile
import unittest

import numpy as np
import vdwmesh
from test_option_pairs import STRUCTURE

TABLE = pathlib.Path(__file__).with_name("keyword_pairs.csv")
# Of `mesh`, which `meshes` hands on to it.
OF_MESHES = {"probe", "surface", "mesher", "field", "spacing", "edge_length", "min_angle", "subdivide", "crossings",
             "normals", "fixed_grid", "threads", "device"}  # fmt: skip


def rows():
    with TABLE.open(newline="") as file:
        for row in csv.DictReader(file):
            for name in row["functions"].split():
                yield name, row["keyword"], row["beside"], row["value"], row["outcome"]


def content(value):
    """What a result holds, in a form that can be compared."""
    if isinstance(value, vdwmesh.Mesh):
        return [content(v) for v in (*value, value.face_patches)]
    if dataclasses.is_dataclass(value):
        return [content(getattr(value, field.name)) for field in dataclasses.fields(value)]
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    if isinstance(value, (list, tuple)) or inspect.isgenerator(value):
        return [content(v) for v in value]
    return repr(value)


class KeywordPairs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name) / "in.pdb"
        cls.path.write_text(STRUCTURE)
        cls.molecule = vdwmesh.read(cls.path)
        coords, radii = cls.molecule.coords, cls.molecule.radii
        places = np.stack([coords, coords + 0.3, coords * 1.1])
        ball = vdwmesh.mesh(coords, radii, edge_length=0.9)
        corners = 4.6 * np.indices((2, 2, 2)).reshape(3, 8).T
        bars = np.stack([corners, corners * 0.5, corners * 1.02])  # the second has no room for a pocket
        x, y, z = np.mgrid[-1:1:9j, -1:1:9j, -1:1:9j]
        around = coords.mean(0) + np.stack(np.mgrid[-4:5:2, -4:5:2, -4:5:2], axis=-1).reshape(-1, 3)
        cls.calls = {
            "read": lambda **k: vdwmesh.read(cls.path, **k),
            "batch": lambda **k: list(vdwmesh.batch([cls.path, cls.path], **k)),
            "sample": lambda **k: vdwmesh.sample("bpti", **k),
            "exact": lambda **k: vdwmesh.exact(coords, radii, **k),
            "exact_many": lambda **k: vdwmesh.exact_many(coords, radii, [0, 4, len(radii)], **k),
            "rates": lambda **k: vdwmesh.rates(coords, radii, **{"growth": radii, **k}),
            "jacobian": lambda **k: vdwmesh.jacobian(coords, radii, **k),
            "interface": lambda **k: vdwmesh.interface(cls.molecule, **k),
            "sasa": lambda **k: vdwmesh.sasa(coords, radii, **k),
            "pockets": lambda **k: vdwmesh.pockets(corners, [1.5] * 8, **k),
            "pocket_frames": lambda **k: list(vdwmesh.pocket_frames(bars, **{"radii": [1.5] * 8, **k})),
            "frames": lambda **k: list(vdwmesh.frames(places, **{"radii": radii, **k})),
            "meshes": lambda **k: list(vdwmesh.meshes(places, **{"radii": radii, **k})),
            "mesh": lambda **k: vdwmesh.mesh(coords, radii, **k),
            "mesh_many": lambda **k: vdwmesh.mesh_many([cls.molecule], **k),
            "marching_cubes": lambda **k: vdwmesh.marching_cubes(0.5 - np.sqrt(x**2 + y**2 + z**2), 0, **k),
            "quality": lambda **k: vdwmesh.quality(ball, **k),
            "compare": lambda **k: vdwmesh.compare(ball, coords, radii, **k),
            "signed_distance": lambda **k: vdwmesh.signed_distance(around, coords, radii, **k),
        }

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def arguments(self, text):
        return eval(f"dict({text})", {"RADII": self.molecule.radii})  # of this table

    def test_every_pair_is_in_the_table(self):
        listed = {(name, keyword) for name, keyword, *_ in rows()}
        there = {("meshes", keyword) for keyword in OF_MESHES}
        for name in self.calls:
            for keyword, parameter in inspect.signature(getattr(vdwmesh, name)).parameters.items():
                if parameter.kind == inspect.Parameter.KEYWORD_ONLY:
                    there.add((name, keyword))
        self.assertEqual(listed, there)

    def test_none_vanishes(self):
        plain = {}
        for name, keyword, beside, value, outcome in rows():
            with self.subTest(f"{name}({beside}, {keyword}={value})"):
                given = self.arguments(beside) | self.arguments(f"{keyword}={value}")
                if outcome == "refused":
                    with self.assertRaises((vdwmesh.Error, ValueError)) as caught:
                        self.calls[name](**given)
                    self.assertNotIn("\n", str(caught.exception))
                    continue
                if (name, beside) not in plain:
                    plain[name, beside] = content(self.calls[name](**self.arguments(beside)))
                self.assertNotEqual(content(self.calls[name](**given)), plain[name, beside], "without effect")


if __name__ == "__main__":
    unittest.main()
