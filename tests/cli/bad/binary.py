"""Damaged BinaryCIF files. The sound one is made by binary_cif.py of the rows of a sample."""

import copy

import binary_cif
from .case import Expect, Maker
from .structures import ATOMS, CIF_COLUMNS, packed

REFUSED, READ, SAME, EITHER = Expect.REFUSED, Expect.READ, Expect.SAME, Expect.EITHER
FLIPS = 60


def columns_of(sample):
    rows = [row.split() for row in sample.rows["cif"]]
    return {name: list(values) for name, values in zip(CIF_COLUMNS, zip(*rows))}


def tree_of(columns, rows=ATOMS, plan=binary_cif.PACKED):
    table = [binary_cif.column(name, values, plan) for name, values in columns.items()]
    return binary_cif.document(("sample", [binary_cif.category("_atom_site", table, rows)]))


def atom_site(tree):
    return tree["dataBlocks"][0]["categories"][0]


def data_of(tree, name):
    return next(c for c in atom_site(tree)["columns"] if c["name"] == name)["data"]


class Damager:
    """Adds the file with one thing changed."""

    def __init__(self, make, tree):
        self.make, self.tree = make, tree

    def __call__(self, damage, change, expect=REFUSED, items=None):
        tree = copy.deepcopy(self.tree)
        self.make.add(damage, binary_cif.pack(change(tree) or tree), expect, items)

    def data(self, damage, column, encoded, expect=REFUSED, items=None):
        """Another encoding and other data for one column."""
        def change(tree):
            data_of(tree, column).update(binary_cif.packed_data(encoded))
        self(damage, change, expect, items)

    def encoding(self, damage, column, index, expect=REFUSED, **keys):
        """Other values in one encoding of a column; None takes the key away."""
        def change(tree):
            encoding = data_of(tree, column)["encoding"][index]
            encoding.update(keys)
            for key in [key for key, value in keys.items() if value is None]:
                del encoding[key]
        self(damage, change, expect)


def bytes_of_no_file(make, whole):
    dice = make.dice("noise")
    make.add("empty", b"", REFUSED)
    make.add("random bytes", b"\x80" + dice.randbytes(5000), REFUSED)
    make.add("zero bytes", bytes(5000), REFUSED)
    make.add("holds mmCIF", "data_x\nloop_\n_atom_site.id\n1\n", REFUSED)
    make.add("a web page", "<!DOCTYPE html><html></html>", REFUSED)
    make.add("a zip archive", b"PK\x03\x04" + dice.randbytes(500), REFUSED)
    make.add("an empty map", b"\x80", REFUSED)
    make.add("a map of 2^32 - 1 keys", b"\xdf\xff\xff\xff\xff", REFUSED)
    make.add("a list of 2^32 - 1 elements", b"\x81\xaadataBlocks\xdd\xff\xff\xff\xff", REFUSED)
    make.add("a text of 4 GiB", b"\x81\xaadataBlocks\xdb\xff\xff\xff\xff", REFUSED)
    make.add("lists in lists, 100,000 deep", b"\x81\xaadataBlocks" + b"\x91" * 100_000 + b"\xc0",
             REFUSED)
    make.add("a million small elements", b"\x81\xaadataBlocks\xdd\x00\x0f\x42\x40" + b"\x01" * 1_000_000,
             REFUSED)
    make.add("an extension type", b"\x81\xaadataBlocks\xd4\x01\x00", REFUSED)
    for part in (1, 2, 3):
        make.add(f"cut at {part}/4", whole[: len(whole) * part // 4], REFUSED)
    make.add("cut in its last byte", whole[:-1], REFUSED)
    make.add("something behind it", whole + b"\xc0", REFUSED)
    for i in range(FLIPS):
        flipped = bytearray(whole)
        flipped[dice.randrange(len(whole))] ^= 1 << dice.randrange(8)
        make.add(f"bit {i} flipped", bytes(flipped), EITHER)


def structure(damage):
    def replace(key, value):
        def change(tree):
            atom_site(tree)[key] = value
        return change

    def drop(column):
        def change(tree):
            table = atom_site(tree)
            table["columns"] = [c for c in table["columns"] if c["name"] != column]
        return change

    damage("no data blocks", lambda tree: {**tree, "dataBlocks": []})
    damage("data blocks that are no list", lambda tree: {**tree, "dataBlocks": 7})
    damage("two blocks with atoms", lambda tree: {**tree, "dataBlocks": 2 * tree["dataBlocks"]})
    damage("the atom table twice", lambda tree: tree["dataBlocks"][0]["categories"].append(
        atom_site(tree)))
    damage("no atom table", replace("name", "_atom_sites"))
    damage("a table without rows", replace("rowCount", 0))
    damage("columns that are no list", replace("columns", {}))
    for rows in (-1, ATOMS - 1, ATOMS + 1, 10_000_000, 2**31, 2**62, "60", None):
        damage(f"rowCount is {rows}", replace("rowCount", rows))
    for column in ("Cartn_z", "label_asym_id", "auth_seq_id", "label_atom_id"):
        damage(f"without the column {column}", drop(column))
    for column in ("id", "type_symbol", "occupancy", "label_alt_id"):
        damage(f"without the column {column}", drop(column), READ, ATOMS)
    damage("a column twice", lambda tree: atom_site(tree)["columns"].append(
        atom_site(tree)["columns"][8]))


def encodings(damage):
    b = binary_cif
    whole = [8] * ATOMS
    damage("no encoding", lambda tree: data_of(tree, "Cartn_x").update(encoding=[]))
    damage("bytes alone", lambda tree: data_of(tree, "Cartn_x").update(
        encoding=[], data=b"\x01" * ATOMS))
    damage("nine encodings", lambda tree: data_of(tree, "Cartn_x").update(
        encoding=[{"kind": "Delta", "origin": 0}] * 8 + b.int32(whole)[0], data=b.int32(whole)[1]))
    damage("data that are a text", lambda tree: data_of(tree, "Cartn_x").update(data="abc"))
    damage("data that are a list", lambda tree: data_of(tree, "Cartn_x").update(data=[1, 2]))
    damage.encoding("an unknown encoding", "Cartn_x", 0, kind="Zip")
    damage.encoding("an encoding without its kind", "Cartn_x", 0, kind=None)
    for factor in (0, float("nan"), float("inf"), "1000", None):
        damage.encoding(f"a factor of {factor}", "Cartn_x", 0, factor=factor)
    for size in (-1, ATOMS - 1, ATOMS + 1, 10**9, 2**62, None):
        damage.encoding(f"IntegerPacking of {size} values", "Cartn_x", 2, srcSize=size)
        damage.encoding(f"RunLength of {size} values", "auth_seq_id", 1, srcSize=size)
    damage.encoding("integers packed in 3 bytes", "Cartn_x", 2, byteCount=3)
    damage.encoding("an origin of 2^40", "Cartn_x", 1, origin=2**40)
    damage.encoding("an origin near 2^31", "Cartn_x", 1, origin=2**31 - 1)
    for kind in (0, 7, 31, 34, None):
        damage.encoding(f"a ByteArray of type {kind}", "Cartn_x", -1, type=kind)
    damage.data("bytes that are no whole elements", "Cartn_x", (b.int32([])[0], b"\0" * 7))
    damage.data("a packed integer without end", "Cartn_x", (
        [*b.integer_packing(whole, 1, False)[0]], bytes([8] * (ATOMS - 1) + [127])))
    damage.data("counts that are negative", "Cartn_x", b.run_length(whole, lambda v: b.int32([8, -1])))
    damage.data("counts beyond the rows", "Cartn_x", b.run_length(whole, lambda v: b.int32([8, 2**31 - 1])))
    damage.data("a value without its count", "Cartn_x", b.run_length(whole, lambda v: b.int32([8])))
    damage.data("integers above 2^31", "auth_seq_id", b.byte_array([2**32 - 1] * ATOMS, "I"))
    damage.data("coordinates that are texts", "Cartn_x", b.string_array(["abc"] * ATOMS))
    for value in (float("nan"), float("inf"), 1e30):
        damage.data(f"x of an atom is {value}", "Cartn_x", b.byte_array([value, *whole[1:]], "d"))
    for steps in (0, 1, -5):
        damage.data(f"quantised in {steps} steps", "Cartn_x", ([
            {"kind": "IntervalQuantization", "min": 0, "max": 1, "numSteps": steps},
            *b.int32(whole)[0]], b.int32(whole)[1]))


def texts_and_masks(damage):
    b = binary_cif
    names = [f"C{i}" for i in range(ATOMS)]

    def mask(encoded):
        def change(tree):
            atom_site(tree)["columns"][0]["mask"] = b.packed_data(encoded)
        return change

    damage("a mask that is too short", mask(b.byte_array([0] * (ATOMS - 1), "B")))
    damage("a mask of numbers with a fraction", mask(b.byte_array([0.0] * ATOMS, "d")))
    damage("a mask that is no map", lambda tree: atom_site(tree)["columns"][0].update(mask=3))
    damage("a mask that is all 0", mask(b.byte_array([0] * ATOMS, "B")), SAME, ATOMS)
    for indices in ([ATOMS] * ATOMS, [-2] * ATOMS, [2**31 - 1] * ATOMS):
        damage.data(f"text {indices[0]} of {ATOMS}", "label_atom_id",
                    b.string_array(names, lambda _: b.int32(indices)))
    for what, offsets in (("beyond the texts", [0, 10**6]), ("that go down", [0, 5, 3]),
                          ("below 0", [-1, 3])):
        damage.data(f"offsets {what}", "label_atom_id",
                    b.string_array(names, lambda _: b.int32([0] * ATOMS), lambda _: b.int32(offsets)))
    damage.data("texts that are not ASCII", "label_atom_id", b.string_array(["Cα"] * ATOMS))
    damage("alternate locations of two letters", lambda tree: atom_site(tree)["columns"].__setitem__(
        CIF_COLUMNS.index("label_alt_id"), b.column("label_alt_id", ["AB"] * ATOMS)))


def bomb(columns):
    """A table of 10^9 rows in a few hundred bytes."""
    rows = 10**9
    run = [{"kind": "RunLength", "srcType": 3, "srcSize": rows}, *binary_cif.int32([])[0]]
    data = binary_cif.int32([0, rows])[1]
    text = [{"kind": "StringArray", "dataEncoding": run, "stringData": "C",
             "offsetEncoding": binary_cif.int32([])[0], "offsets": binary_cif.int32([0, 1])[1]}]
    numbers = ("id", "auth_seq_id", "Cartn_x", "Cartn_y", "Cartn_z")
    table = [{"name": name, "mask": None,
              "data": binary_cif.packed_data((run if name in numbers else text, data))}
             for name in columns]
    return binary_cif.document(("bomb", [binary_cif.category("_atom_site", table, rows)]))


def damages(sample):
    make = Maker("bcif")
    columns = columns_of(sample)
    tree = tree_of(columns)
    whole = binary_cif.pack(tree)
    make.add("as it should be", whole, SAME, ATOMS)
    for name, plan in binary_cif.PLANS.items():
        make.add(f"encoded in the way {name}", binary_cif.pack(tree_of(columns, plan=plan)), SAME, ATOMS)
    bytes_of_no_file(make, whole)
    damage = Damager(make, tree)
    structure(damage)
    encodings(damage)
    texts_and_masks(damage)
    make.add("a table of 10^9 rows in a few bytes", binary_cif.pack(bomb(columns)), REFUSED)
    return make.cases


def packed_damages(sample):
    make = Maker("bcif.gz")
    whole = binary_cif.pack(tree_of(columns_of(sample)))
    make.add("as it should be", packed(whole), SAME, ATOMS)
    make.add("not packed", whole, SAME, ATOMS)
    make.add("cut in the middle", packed(whole)[: len(packed(whole)) // 2], REFUSED)
    return make.cases
