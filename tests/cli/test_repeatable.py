"""The figures of a report do not depend on luck: threads, runs, the order of the work."""

import program
from program import UBIQUITIN, ProgramTest, parse_json

SURFACES = {
    "marching cubes": (),
    "two subdivisions": ("--subdivide", "2", "--spacing", "1"),
    "a probe": ("--probe", "1.4", "--spacing", "0.9"),
    "crease-exact": ("--mesher", "exact", "--edge-length", "0.7", "--subdivide", "0"),
    "crease-exact, subdivided": ("--mesher", "exact", "--edge-length", "1", "--subdivide", "1"),
    "blinn": ("--field", "blinn", "--spacing", "0.9"),
    "soft": ("--field", "soft", "--spacing", "0.9", "--method", "both"),
    "inverse squared": ("--field", "inverse-squared", "--spacing", "0.9", "--project", "vdw"),
    "as in the thesis": ("--field", "blinn", "--preset", "thesis"),
    "no topology": ("--topology", "off", "--spacing", "0.9"),
}
CHEAPER = ("--self-intersections", "off", "--cgal-check", "off")
THREADS = ("1", "2", "2")


def figures(text):
    """The report but for its times and the number of threads."""
    report = parse_json(text)
    del report["timing"], report["backend"]["threads"], report["parameters"]["memory_limit"]
    if report["mesh"]["arrangement"]:
        del report["mesh"]["arrangement"]["seconds"]
    return report


class Repeatable(ProgramTest):
    def check(self, inputs, surfaces):
        for source in inputs:
            for name in surfaces:
                with self.subTest(input=str(source), surface=name):
                    arguments = ("report", source, *SURFACES[name], "--samples", "3", *CHEAPER, "--json", "-")
                    texts = [self.run_ok(*arguments, "--threads", n).stdout for n in THREADS]
                    first, *others = map(figures, texts)
                    for other in others:
                        self.assertEqual(other, first)
                    # To the last digit, and a figure that changes is seen.
                    self.assertGreater(first["mesh"]["area"], 0)

    def test_a_protein_in_every_way(self):
        self.check([program.SOURCE_DIR / "data" / "bpti.pdb"], SURFACES)

    def test_another_protein(self):
        self.check([UBIQUITIN], ["no topology"])

    def test_degenerate_spheres(self):
        lattice = "".join(f"{x} {y} {z} 1\n" for x in range(4) for y in range(4) for z in range(4))
        path = self.file("lattice.xyzr", lattice + "0 0 0 1\n9 9 9 0.7\n")
        self.check([path], ["marching cubes", "two subdivisions", "a probe", "crease-exact"])

    def test_mesh_files(self):
        surfaces = (("--spacing", "0.6"), ("--mesher", "exact", "--edge-length", "0.6"))
        for options in (*surfaces, ("--subdivide", "1")):
            for extension in ("ply", "glb"):
                path = self.folder / f"a.{extension}"
                contents = set()
                for threads in THREADS:
                    self.run_ok("mesh", UBIQUITIN, "-o", path, *options, "--threads", threads)
                    contents.add(path.read_bytes())
                self.assertEqual(len(contents), 1, f"{extension} {options}")

    def test_per_atom_tables(self):
        tables = set()
        for threads in THREADS:
            path = self.folder / "a.csv"
            self.run_ok("report", UBIQUITIN, "--per-atom", path, "--distances", "off", "--threads",
                        threads)
            tables.add(path.read_bytes())
        self.assertEqual(len(tables), 1)
