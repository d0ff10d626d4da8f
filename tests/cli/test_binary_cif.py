"""BinaryCIF files hold the atoms of the mmCIF of the entry, whatever encodings they use."""

import csv
import gzip
import resource
import unittest

import binary_cif
import program

# What differs between two files of one structure.
FILE_KEYS = ("path", "format")


class SameAtoms(program.ProgramTest):
    @classmethod
    def setUpClass(cls):
        program.need_package("python3-msgpack", module="msgpack")
        cls.gemmi = program.need_package("python3-gemmi", module="gemmi")

    def figures(self, path, *options):
        """What the program says of the structure, as JSON and atom by atom."""
        table = self.folder / "atoms.csv"
        report = self.report("exact", path, "--topology", "off", "--per-atom", table, *options)
        source = {key: value for key, value in report["input"].items() if key not in FILE_KEYS}
        return source, report["exact"], report["notes"], report["warnings"], table.read_text()

    def cif_of(self, name):
        """The path of an mmCIF file; PDB files are converted by gemmi."""
        path = program.need_shared(f"molecules/{name}")
        if ".cif" in name:
            return path
        structure = self.gemmi.read_structure(str(path))
        structure.setup_entities()
        converted = self.folder / (path.stem + ".cif")
        structure.make_mmcif_document().write_file(str(converted))
        return converted

    def assert_same(self, name, plan, *runs):
        cif = self.cif_of(name)
        packed = self.folder / "a.bcif"
        packed.write_bytes(binary_cif.of_cif(cif, binary_cif.PLANS[plan]))
        gzipped = self.folder / "b.bcif.gz"
        gzipped.write_bytes(gzip.compress(packed.read_bytes(), 1, mtime=0))
        for options in runs or [()]:
            with self.subTest(name=name, plan=plan, options=options):
                expected = self.figures(cif, *options)
                for file in (packed, gzipped):
                    *figures, atoms = self.figures(file, *options)
                    self.assertEqual(figures, list(expected[:-1]))
                    # Where they differ, unittest would look for minutes for the way from one to the other.
                    self.assertTrue(atoms == expected[-1], "the atoms differ")

    def test_alternate_locations_and_hydrogens(self):
        for plan in binary_cif.PLANS:
            self.assert_same("special/1EJG.cif", plan, (), ("--altloc", "B"), ("--altloc", "all"),
                             ("--no-hydrogens", "--select", "A/10-20"))

    def test_models(self):
        for plan in binary_cif.PLANS:
            self.assert_same("special/1L2Y.pdb", plan, (), ("--model", "all"), ("--model", "38"))

    def test_assemblies_waters_and_hetero_atoms(self):
        self.assert_same("thesis/1HH0.cif", "packed", ("--assembly", "1"), ("--waters",))
        self.assert_same("thesis/1QL2.cif", "plain", ("--assembly", "1"), ())
        self.assert_same("special/19HC.pdb", "packed", ("--no-hetatm",), ("--select", ";polymer"))
        for name in ("assembly_product", "assembly_X0", "assembly_mixed_list"):
            self.assert_same(f"traps/{name}.cif", "packed", ("--assembly", "1"))

    def test_insertion_codes_and_odd_files(self):
        for name in ("odd/pdbtbx_insertion_codes.pdb", "odd/biopython_a_structure.cif",
                     "odd/openmm_altlocs2.pdb", "special/1D3Z.pdb"):
            self.assert_same(name, "packed", ("--waters",))

    def test_from_standard_input(self):
        cif = self.cif_of("special/1EJG.cif")
        report = self.folder / "r.json"
        result = program.subprocess.run(
            [program.PROGRAM, "exact", "-", "--format", "bcif", "--json", report, "--quiet"],
            input=binary_cif.of_cif(cif), capture_output=True, timeout=300)
        self.assertEqual((result.returncode, result.stderr), (program.DONE, b""))
        found = program.parse_json(report.read_text())
        self.assertEqual(found["exact"], self.report("exact", cif)["exact"])
        self.assertEqual(found["input"]["format"], "bcif")


class Encodings(program.ProgramTest):
    """Coordinates in each encoding that can hold them, to the last bit where it loses nothing."""

    # Multiples of 1/8 are exact in every encoding.
    X = [0, 20.5, 41.125, -62.25, 83.375, 300, -300, 0.125]
    LOW, STEP, STEPS = -512.0, 0.125, 8193  # of the quantised values: -512 to 512

    @classmethod
    def setUpClass(cls):
        program.need_package("python3-msgpack", module="msgpack")

    def write(self, x, **columns):
        rows = len(self.X)
        texts = {"label_asym_id": ["A"] * rows, "label_comp_id": ["UNL"] * rows,
                 "label_atom_id": [f"C{i}" for i in range(rows)], "type_symbol": ["C"] * rows,
                 "auth_seq_id": ["1"] * rows, "Cartn_y": ["0.0"] * rows, "Cartn_z": ["0.0"] * rows}
        table = [binary_cif.column(name, values) for name, values in (texts | columns).items()]
        table.append({"name": "Cartn_x", "data": binary_cif.packed_data(x), "mask": None})
        path = self.folder / "a.bcif"
        path.write_bytes(binary_cif.pack(binary_cif.document(
            ("x", [binary_cif.category("_atom_site", table, rows)]))))
        return path

    def area(self, path):
        return self.report("exact", path, "--topology", "off")["exact"]["area"]

    def test_coordinates(self):
        b, pack = binary_cif, binary_cif.integer_packing
        eighths = {f"packed in {count} bytes": b.fixed_point(self.X, 8, lambda v: pack(v, count, False))
                   for count in (1, 2)}

        def quantised(then):
            return b.interval_quantization(self.X, self.LOW, -self.LOW, self.STEPS, then)
        ways = eighths | {
            "float32": b.byte_array(self.X, "f"),
            "float64": b.byte_array(self.X, "d"),
            "int16": b.fixed_point(self.X, 8, lambda v: b.byte_array(v, "h")),
            "int32 of differences": b.fixed_point(self.X, 8, lambda v: b.delta(v, b.int32)),
            "runs of differences": b.fixed_point(self.X, 8, lambda v: b.delta(v, b.run_length)),
            "quantised": quantised(b.smallest_packing),
            "quantised, uint16": quantised(lambda v: b.byte_array(v, "H")),
            "quantised, uint32": quantised(lambda v: b.byte_array(v, "I")),
            "quantised, unsigned": quantised(lambda v: pack(v, 1, True)),
        }
        text = "".join(f"{x} 0 0 1.7\n" for x in self.X)
        expected = self.area(self.file("a.xyzr", text))
        for way, encoded in ways.items():
            with self.subTest(way):
                self.assertEqual(self.area(self.write(encoded)), expected)

    def test_a_table_takes_memory_for_the_rows_that_its_data_hold(self):
        """A file of 2 MB may claim 30 million rows, for which 2.2 GB would be reserved."""
        rows, memory = 30_000_000, 1 << 31
        run = [{"kind": "RunLength", "srcType": 3, "srcSize": rows}, *binary_cif.int32([])[0]]
        runs = run, binary_cif.int32([0, rows])[1]
        text = [{"kind": "StringArray", "dataEncoding": run, "stringData": "C",
                 "offsetEncoding": binary_cif.int32([])[0], "offsets": binary_cif.int32([0, 1])[1]}], runs[1]
        short = [{"kind": "IntegerPacking", "byteCount": 1, "isUnsigned": True, "srcSize": rows},
                 *binary_cif.byte_array([], "B")[0]], bytes(5000)
        encoded = {"label_asym_id": text, "label_comp_id": text, "label_atom_id": text, "type_symbol": text,
                   "auth_seq_id": runs, "Cartn_x": short, "Cartn_y": runs, "Cartn_z": runs}
        table = [{"name": name, "data": binary_cif.packed_data(data), "mask": None} for name, data in encoded.items()]
        filler = {"name": "of_no_use", "data": binary_cif.packed_data(binary_cif.byte_array(bytes(1 << 21), "B")),
                  "mask": None}
        path = self.folder / "claims.bcif"
        path.write_bytes(binary_cif.pack(binary_cif.document(
            ("x", [binary_cif.category("_filler", [filler], 1 << 21),
                   binary_cif.category("_atom_site", table, rows)]))))

        def bound():
            if not program.SANITIZED:  # address space, of which the sanitizers reserve terabytes
                resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        result = program.run("exact", path, "--threads", "2", preexec_fn=bound)
        self.assertEqual(result.returncode, program.BAD_INPUT, result.stderr)
        self.assertIn(f"IntegerPacking gives not the {rows} values", result.stderr)

    def test_masks_and_texts_that_are_not_given(self):
        x = binary_cif.byte_array(self.X, "d")
        path = self.write(x, type_symbol=["C", "?", ".", "C", "N", "O", "?", "C"],
                          label_alt_id=["."] * 8, occupancy=["?"] * 8,
                          pdbx_PDB_ins_code=["?"] * 8, id=["a", "?", "3", "4", "5", "6", "7", "8"])
        table = self.folder / "atoms.csv"
        self.run_ok("exact", path, "--per-atom", table)
        rows = list(csv.DictReader(table.read_text().splitlines()))
        self.assertEqual([row["element"] for row in rows], list("CCCCNOCC"))
        # An id that is no integer is replaced by the row.
        self.assertEqual([row["serial"] for row in rows], list("12345678"))


if __name__ == "__main__":
    unittest.main()
