"""Objects of other packages as sources and sinks. Packages that Debian lacks have stand-ins here,
with the attributes that their documentation names."""

import pathlib
import sys
import tempfile
import types
import unittest
import warnings
from unittest import mock

import numpy as np
import vdwmesh
from program import UBIQUITIN, need_package, need_shared

# float32 coordinates of other packages move atoms by 4e-6 Å at 60 Å; areas by a little more.
FLOAT32 = 1e-5


def stand_in(package, name, **attributes):
    """An object of a class of that name that seems to come from the package."""
    kind = type(name, (), {"__module__": f"{package}.structure"})
    found = kind()
    for key, value in attributes.items():
        setattr(found, key, value)
    return found


class SourcesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.molecule = vdwmesh.read(UBIQUITIN)
        cls.expected = vdwmesh.exact(cls.molecule)
        cls.residues = vdwmesh.sasa(cls.molecule, mode="residue")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def assert_same(self, source, relative=FLOAT32):
        found = vdwmesh.exact(source)
        self.assertEqual(len(found.atom_area), len(self.molecule))
        self.assertAlmostEqual(found.area, self.expected.area, delta=relative * self.expected.area)
        self.assertAlmostEqual(found.volume, self.expected.volume, delta=relative * self.expected.volume)
        np.testing.assert_allclose(vdwmesh.sasa(source, mode="residue"), self.residues, atol=1e-3)
        own = vdwmesh.exact(source, np.full(len(self.molecule), 1.0))
        self.assertLess(own.area, self.expected.area)  # own radii are obeyed
        self.assertGreater(vdwmesh.exact(source, "alvarez").volume, self.expected.volume)

    def test_molecules(self):
        self.assert_same(self.molecule, relative=0)

    def test_mdanalysis(self):
        package = need_package("python3-mdanalysis", module="MDAnalysis")
        group = package.Universe(str(UBIQUITIN)).select_atoms("not resname HOH")
        self.assert_same(group)
        self.assertEqual(vdwmesh.exact(group.residues[:2]).atom_area.shape, (group.residues[:2].atoms.n_atoms,))

    def test_mdtraj(self):
        package = need_package("python3-mdtraj", module="mdtraj")
        trajectory = package.load(str(UBIQUITIN))
        protein = trajectory.atom_slice(trajectory.topology.select("not water"))
        self.assert_same(protein)

    def test_frames_of_mdtraj(self):
        package = need_package("python3-mdtraj", module="mdtraj")
        path = need_shared("molecules/special/1D3Z.pdb")
        models = package.load(str(path))
        found = vdwmesh.sasa(models)
        self.assertEqual(found.shape, (10,))
        second = float(vdwmesh.sasa(vdwmesh.read(path, model=2)))
        self.assertAlmostEqual(found[1], second, delta=FLOAT32 * second)
        with self.assertRaisesRegex(ValueError, "coords: has shape"):
            vdwmesh.exact(models)

    def test_gemmi(self):
        package = need_package("python3-gemmi", module="gemmi")
        structure = package.read_structure(str(UBIQUITIN))
        structure.remove_waters()
        self.assert_same(structure, relative=1e-12)  # doubles
        self.assert_same(structure[0]["A"], relative=1e-12)
        with self.assertRaisesRegex(ValueError, "gemmi's Position"):
            vdwmesh.exact(package.Position(0, 0, 0))

    def test_biotite(self):
        m = self.molecule
        array = stand_in("biotite", "AtomArray", coord=m.coords.astype(np.float32), element=np.char.upper(m.elements),
                         res_name=m.resnames, atom_name=m.names, chain_id=m.chains,
                         res_id=m.resids.astype(int), ins_code=np.full(len(m), ""))  # fmt: skip
        self.assert_same(array)
        array.coord = np.stack([m.coords, m.coords])
        self.assertEqual(vdwmesh.sasa(array).shape, (2,))

    def universe(self, **attributes):
        """A universe of MDAnalysis with one residue LIG and these attributes of its atoms."""
        package = need_package("python3-mdanalysis", module="MDAnalysis")
        count = len(next(iter(attributes.values())))
        made = package.Universe.empty(count, 1, atom_resindex=[0] * count, trajectory=True)
        made.add_TopologyAttr("resnames", ["LIG"])
        for name, values in attributes.items():
            made.add_TopologyAttr(name, values)
        made.atoms.positions = np.arange(3 * count).reshape(count, 3) * 10.0
        return made

    def radii_that_are_used(self, source):
        """By the areas of balls that are apart."""
        return np.sqrt(vdwmesh.exact(source).atom_area / (4 * np.pi)).tolist()

    def assert_elements(self, source, elements):
        np.testing.assert_allclose(self.radii_that_are_used(source), vdwmesh.radii_of(elements), rtol=1e-9)

    def test_types_of_force_fields_are_no_elements(self):
        charmm = self.universe(names=["CA", "CG", "HA", "SOD", "OH", "NE"], types=["CA", "CA", "HP", "SOD", "OH1", "NC2"],
                               masses=[12.011, 12.011, 1.008, 22.98977, 15.9994, 14.007])  # fmt: skip
        self.assert_elements(charmm, ["C", "C", "H", "Na", "O", "N"])
        gaff = self.universe(names=["C1", "C2", "O1", "H1", "N1"], types=["ca", "cd", "os", "ho", "ne"])
        self.assert_elements(gaff, ["C", "C", "O", "H", "N"])
        numbers = self.universe(types=["56", "1", "2"], masses=[15.9994, 1.008, 55.845])
        self.assert_elements(numbers, ["O", "H", "Fe"])
        moved = self.universe(names=["N", "HN", "CA", "O", "HO", "CB"], types=["N"] * 6,  # of hydrogens times three
                              masses=[14.007 - 2.016, 3.024, 12.011 - 2.016, 15.999 - 2.016, 3.024, 12.011 - 6.048])
        self.assert_elements(moved, ["N", "H", "C", "O", "H", "C"])
        united = self.universe(names=["CH3", "CB"], types=["CH3", "CH2"], masses=[15.035, 14.027])
        self.assert_elements(united, ["C", "C"])

    def test_types_alone_are_refused(self):
        for types in (["CT2"], ["56"], ["ca"]):
            with self.subTest(types), self.assertRaisesRegex(ValueError, "radii: are needed"):
                vdwmesh.exact(self.universe(types=types))
        site = self.universe(names=["OW", "MW"], types=["OT", "MW"], masses=[15.9994, 0.0])
        with self.assertRaisesRegex(ValueError, "element of atom 1 .MW of LIG. cannot be told; types of a force field"):
            vdwmesh.exact(site)
        self.assertEqual(self.radii_that_are_used(site.select_atoms("prop mass > 0")), [1.52])

    def test_elements_that_are_missing_in_part(self):
        part = self.universe(names=["CA", "N"], elements=["Ca", ""])
        self.assert_elements(part, ["Ca", "N"])

    def assert_told_of_waters(self, source, remedy):
        with self.assertWarnsRegex(UserWarning, f"58 of 660 atoms are those of waters and are measured.*{remedy}"):
            found = vdwmesh.exact(source)
        expected = vdwmesh.exact(vdwmesh.read(UBIQUITIN, waters=True))
        self.assertAlmostEqual(found.area, expected.area, delta=FLOAT32 * expected.area)

    def test_waters_are_measured_and_told(self):
        MDAnalysis = need_package("python3-mdanalysis", module="MDAnalysis")
        universe = MDAnalysis.Universe(str(UBIQUITIN))
        self.assert_told_of_waters(universe, "not resname HOH")
        self.assertEqual(universe.select_atoms("not resname HOH").n_atoms, len(self.molecule))
        gemmi = need_package("python3-gemmi", module="gemmi")
        self.assert_told_of_waters(gemmi.read_structure(str(UBIQUITIN)), "remove_waters")
        mdtraj = need_package("python3-mdtraj", module="mdtraj")
        trajectory = mdtraj.load(str(UBIQUITIN))
        self.assert_told_of_waters(trajectory, "remove_solvent")
        self.assertEqual(trajectory.remove_solvent().n_atoms, len(self.molecule))
        need_package("python3-biopython", module="Bio")
        from Bio.PDB import PDBParser
        structure = PDBParser(QUIET=True).get_structure("x", str(UBIQUITIN))
        self.assert_told_of_waters(structure, "id.0. is 'W'")
        self.assert_same([atom for atom in structure.get_atoms() if atom.get_parent().id[0] != "W"])

    def test_united_radii_want_no_hydrogens(self):
        with self.assertRaisesRegex(ValueError, "elements.1.: the radii of the set include the hydrogens"):
            vdwmesh.exact(self.universe(names=["N", "H"], types=["N", "H"]), "protor")

    def test_residues_with_their_names(self):
        expected = vdwmesh.residue_areas(vdwmesh.read(UBIQUITIN, radii="protor"))
        self.assertEqual((len(expected), expected.chains[0], expected.resids[75]), (76, "A", "76"))
        MDAnalysis = need_package("python3-mdanalysis", module="MDAnalysis")
        gemmi = need_package("python3-gemmi", module="gemmi")
        mdtraj = need_package("python3-mdtraj", module="mdtraj")
        need_package("python3-biopython", module="Bio")
        from Bio.PDB import PDBParser
        structure = gemmi.read_structure(str(UBIQUITIN))
        structure.remove_waters()
        for source in (MDAnalysis.Universe(str(UBIQUITIN)).select_atoms("protein"), structure,
                       mdtraj.load(str(UBIQUITIN)).remove_solvent(),
                       self.without_waters(PDBParser(QUIET=True).get_structure("x", str(UBIQUITIN)))):
            with self.subTest(type(source)):
                found = vdwmesh.residue_areas(source, "protor")
                self.assertEqual(found.resids.tolist(), expected.resids.tolist())
                self.assertEqual(found.resnames.tolist(), expected.resnames.tolist())
                np.testing.assert_allclose(found.relative, expected.relative, rtol=1e-3)
    NAMES_AS_SYMBOLS = """\
ATOM      1  N   SER A   1       0.000   0.000   0.000  1.00 10.00           N
ATOM      2  CA  SER A   1       9.000   0.000   0.000  1.00 10.00          CA
ATOM      3  HG  SER A   1      18.000   0.000   0.000  1.00 10.00          HG
ATOM      4 CA    CA A   2      27.000   0.000   0.000  1.00 10.00          CA
END
"""

    def test_symbols_that_are_names_are_weighed(self):
        """Packages take symbols from files of programs that write names there."""
        path = self.folder / "n.pdb"
        path.write_text(self.NAMES_AS_SYMBOLS)
        for open_file in self.opened(path):
            with self.subTest(open_file), self.assertWarnsRegex(UserWarning, "2 atoms contradict the names"):
                self.assert_elements(open_file(), ["N", "C", "H", "Ca"])
        alpha_sphere = self.NAMES_AS_SYMBOLS.replace(" HG  SER A   1", " POL STP A   3").replace("HG\n", " P\n")
        path.write_text(alpha_sphere)
        for open_file in self.opened(path):
            with self.subTest(open_file), warnings.catch_warnings(), self.assertRaisesRegex(ValueError, "POL of STP"):
                warnings.simplefilter("ignore")
                vdwmesh.exact(open_file())

    def opened(self, path):
        """What the packages make of a file."""
        mdanalysis = need_package("python3-mdanalysis", module="MDAnalysis")
        mdtraj = need_package("python3-mdtraj", module="mdtraj")
        gemmi = need_package("python3-gemmi", module="gemmi")
        need_package("python3-biopython", module="Bio")
        from Bio.PDB import PDBParser
        return (lambda: mdanalysis.Universe(str(path)), lambda: mdtraj.load(str(path)),
                lambda: gemmi.read_structure(str(path)),
                lambda: PDBParser(QUIET=True).get_structure("x", str(path)))  # fmt: skip

    ALTERNATIVES = """\
ATOM      1  N   SER A   1       0.000   0.000   0.000  1.00 10.00           N
ATOM      2  CA ASER A   1       1.450   0.000   0.000  0.40 10.00           C
ATOM      3  CA BSER A   1       1.470   0.300   0.000  0.60 10.00           C
ATOM      4  OG ASER A   1       2.000   1.400   0.000  0.40 10.00           O
ATOM      5  N  AGLY A   2       9.000   0.000   0.000  0.70 10.00           N
ATOM      6  N  BALA A   2       9.000   0.500   0.000  0.30 10.00           N
ATOM      7  CA AGLY A   2      10.450   0.000   0.000  0.70 10.00           C
ATOM      8  CA BALA A   2      10.450   0.500   0.000  0.30 10.00           C
END
"""

    def assert_one_location(self, open_file):
        path = self.folder / "a.pdb"
        path.write_text(self.ALTERNATIVES)
        expected = vdwmesh.exact(vdwmesh.read(path))
        source = open_file(path)
        with self.assertWarnsRegex(UserWarning, "3 of 8 atoms are alternate locations"):
            found = vdwmesh.exact(source)
        np.testing.assert_allclose(found.atom_area, expected.atom_area, rtol=FLOAT32)
        with self.assertWarns(UserWarning), self.assertRaisesRegex(ValueError, "radii: has 8 radii for 5 atoms"):
            vdwmesh.exact(source, np.full(8, 1.5))
        return source, expected

    def test_alternate_locations_of_gemmi(self):
        package = need_package("python3-gemmi", module="gemmi")
        self.assert_one_location(lambda path: package.read_structure(str(path)))

    def test_alternate_locations_of_mdanalysis(self):
        package = need_package("python3-mdanalysis", module="MDAnalysis")
        source, expected = self.assert_one_location(lambda path: package.Universe(str(path)))
        with self.assertWarns(UserWarning):
            frames = list(vdwmesh.frames(source, per_atom=True))
        self.assertAlmostEqual(frames[0].area, expected.area, delta=FLOAT32 * expected.area)
        from vdwmesh.mdanalysis import SurfaceAnalysis
        with self.assertWarns(UserWarning):
            results = SurfaceAnalysis(source.atoms).run().results
        self.assertAlmostEqual(results.area[0], expected.area, delta=FLOAT32 * expected.area)
        self.assertEqual(results.atom_area.shape, (1, 5))

    def test_biopython(self):
        need_package("python3-biopython", module="Bio")
        from Bio.PDB import PDBParser
        structure = PDBParser(QUIET=True).get_structure("x", str(UBIQUITIN))
        self.assert_same(self.without_waters(structure))
        with self.assertRaisesRegex(ValueError, "Bio.PDB's Vector has no atoms"):
            vdwmesh.exact(next(structure.get_atoms()).get_vector())

    def without_waters(self, structure):
        for chain in structure[0]:
            for residue in [residue for residue in chain if residue.get_resname() == "HOH"]:
                chain.detach_child(residue.id)
        return structure

    def test_virtual_sites_of_mdtraj(self):
        package = need_package("python3-mdtraj", module="mdtraj")
        topology = package.Topology()
        residue = topology.add_residue("HOH", topology.add_chain())
        topology.add_atom("O", package.element.oxygen, residue)
        topology.add_atom("VS", package.element.virtual, residue)
        topology.add_atom("H", package.element.hydrogen, residue)
        made = package.Trajectory(np.arange(9).reshape(1, 3, 3) * 1.0, topology)
        with self.assertRaisesRegex(ValueError, "element of atom 1 .VS of HOH. cannot be told; virtual sites"):
            vdwmesh.exact(made)
        self.assert_elements(made.atom_slice([0, 2]), ["O", "H"])

    def test_other_objects_are_refused_by_their_class(self):
        with self.assertRaisesRegex(ValueError, "objects of ase.structure.Atoms are not read"):
            vdwmesh.exact(stand_in("ase", "Atoms"))

    def test_sources_without_elements_are_refused(self):
        group = stand_in("MDAnalysis", "AtomGroup", positions=np.zeros((1, 3)), resindices=np.zeros(1, int),
                         types=[""])  # fmt: skip
        with self.assertRaisesRegex(ValueError, "radii: are needed"):
            vdwmesh.exact(group)
        self.assertGreater(vdwmesh.exact(group, [1.0]).area, 12)


class SinksTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = vdwmesh.mesh(vdwmesh.sample("bpti"), edge_length=1.0)

    def test_meshio(self):
        need_package("python3-meshio", module="meshio")
        found = self.mesh.to_meshio()
        np.testing.assert_array_equal(found.points, self.mesh.vertices)
        np.testing.assert_array_equal(found.get_cells_type("triangle"), self.mesh.faces)
        np.testing.assert_array_equal(found.point_data["normals"], self.mesh.normals)
        np.testing.assert_array_equal(found.cell_data["atom"][0], self.mesh.face_atoms)
        self.assertEqual(vdwmesh.quality(found), vdwmesh.quality(self.mesh))

    def test_faces_of_meshio_that_are_no_triangles(self):
        meshio = need_package("python3-meshio", module="meshio")
        points = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2]]
        cube = meshio.Mesh(points, [("quad", quads), ("triangle", [[1, 3, 7], [1, 7, 5]]),
                                    ("vertex", [[0]]), ("hexahedron", [[0, 1, 3, 2, 4, 5, 7, 6]])])  # fmt: skip
        found = vdwmesh.quality(cube)
        self.assertEqual((found.triangles, found.closed, found.oriented), (12, True, True))
        self.assertAlmostEqual(found.volume, 1, places=14)
        prism = meshio.Mesh([[np.cos(a), np.sin(a), z] for z in (0, 1) for a in np.arange(5) * 2 * np.pi / 5],
                            [("polygon", [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9]]),
                             ("quad", [[i, (i + 1) % 5, (i + 1) % 5 + 5, i + 5] for i in range(5)])])  # fmt: skip
        self.assertAlmostEqual(vdwmesh.quality(prism).volume, 2.5 * np.sin(2 * np.pi / 5), places=13)
        with self.assertRaisesRegex(ValueError, "mesh: has faces of type triangle6"):
            vdwmesh.quality(meshio.Mesh(points, [("triangle6", [[0, 1, 2, 3, 4, 5]])]))

    def test_open3d(self):
        need_package("python3-open3d", module="open3d")
        found = self.mesh.to_open3d()
        np.testing.assert_array_equal(np.asarray(found.vertices), self.mesh.vertices)
        np.testing.assert_array_equal(np.asarray(found.triangles), self.mesh.faces)
        self.assertTrue(found.is_watertight())
        self.assertAlmostEqual(found.get_volume(), self.mesh.volume, delta=1e-9 * self.mesh.volume)
        self.assertEqual(vdwmesh.quality(found), vdwmesh.quality(self.mesh))

    def test_trimesh(self):
        given = {}
        module = types.SimpleNamespace(Trimesh=lambda **arguments: given.update(arguments) or "a mesh")
        with mock.patch.dict(sys.modules, trimesh=module):
            self.assertEqual(self.mesh.to_trimesh(), "a mesh")
        self.assertIs(given["process"], False)  # vertices stay welded and in order
        np.testing.assert_array_equal(given["vertices"], self.mesh.vertices)
        np.testing.assert_array_equal(given["faces"], self.mesh.faces)
        np.testing.assert_array_equal(given["vertex_attributes"]["atom"], self.mesh.vertex_atoms)
        np.testing.assert_array_equal(given["face_attributes"]["atom"], self.mesh.face_atoms)
        again = stand_in("trimesh", "Trimesh", vertices=given["vertices"], faces=given["faces"])
        self.assertEqual(vdwmesh.quality(again), vdwmesh.quality(self.mesh))

    def test_pyvista(self):
        class PolyData:
            __module__ = "pyvista.core.pointset"

            def __init__(self, points, faces):
                self.points, self.faces, self.point_data, self.cell_data = points, faces, {}, {}

        with mock.patch.dict(sys.modules, pyvista=types.SimpleNamespace(PolyData=PolyData)):
            found = self.mesh.to_pyvista()
        np.testing.assert_array_equal(found.faces.reshape(-1, 4)[:, 0], 3)
        np.testing.assert_array_equal(found.point_data["Normals"], self.mesh.normals)
        np.testing.assert_array_equal(found.cell_data["atom"], self.mesh.face_atoms)
        self.assertEqual(vdwmesh.quality(found), vdwmesh.quality(self.mesh))
        # Squares take five numbers each, so that four of them look like five triangles.
        found.faces = np.tile([4, 0, 1, 2, 3], 4)
        with self.assertRaisesRegex(vdwmesh.InvalidInput, "no triangles"):
            vdwmesh.quality(found)

    def test_copies_can_be_written_to(self):
        need_package("python3-meshio", module="meshio")
        self.mesh.to_meshio().points[0] = 0
        self.assertFalse((self.mesh.vertices[0] == 0).all())


if __name__ == "__main__":
    unittest.main()
