#!/usr/bin/env python3
"""Makes a large structure as mmCIF and as BinaryCIF: copies of an entry's atoms, moved along z, with chains
of their own names.

    bench/make_ribosomes.py FOLDER 6ZU5.cif.gz [COPIES]

writes FOLDER/copies.cif, .cif.gz, .bcif and .bcif.gz, whose only table is _atom_site; 15 copies of 6ZU5
are 2.5 million atoms. BinaryCIF is encoded as servers do: coordinates by FixedPoint, Delta and
IntegerPacking, the rest by Delta, RunLength and IntegerPacking. Needs NumPy and msgpack.
"""

import gzip
import itertools
import pathlib
import sys

import msgpack
import numpy as np

PITCH = 400  # Å; no two copies touch
CHAINS = ("label_asym_id", "auth_asym_id")


def columns_of(path):
    """The columns of the table _atom_site by name, as lists of texts."""
    with gzip.open(path, "rt") as file:
        lines = itertools.dropwhile(lambda line: not line.startswith("_atom_site."), file)
        names, rows = [], []
        for line in lines:
            if line.startswith("_atom_site."):
                names.append(line.split(".")[1].strip())
            elif line.startswith(("ATOM", "HETATM")):
                rows.append([field.strip('"') for field in line.split()])
            else:
                break
    return dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))


def byte_array(values):
    kinds = {"int8": 1, "int16": 2, "int32": 3, "uint8": 4, "uint16": 5}
    return [{"kind": "ByteArray", "type": kinds[values.dtype.name]}], values.tobytes()


def integer_packing(values, byte_count, is_unsigned):
    info = np.iinfo(f"{'u' if is_unsigned else ''}int{8 * byte_count}")
    limit = np.where(values < 0, info.min, info.max) if not is_unsigned else np.full(len(values), info.max)
    counts = values // limit  # of elements at the limit, before the last one
    packed = np.repeat(limit, counts + 1)
    packed[np.cumsum(counts + 1) - 1] = values - counts * limit
    encodings, data = byte_array(packed.astype(info.dtype))
    return [{"kind": "IntegerPacking", "byteCount": byte_count, "isUnsigned": is_unsigned,
             "srcSize": len(values)}, *encodings], data  # fmt: skip


def packed_integers(values):
    is_unsigned = bool(len(values) == 0 or values.min() >= 0)
    return min((integer_packing(values, count, is_unsigned) for count in (1, 2)), key=lambda e: len(e[1]))


def delta(values, then):
    origin = int(values[0])
    encodings, data = then(np.diff(values, prepend=origin))
    return [{"kind": "Delta", "origin": origin, "srcType": 3}, *encodings], data


def run_length(values):
    starts = np.flatnonzero(np.diff(values, prepend=values[0] + 1))
    pairs = np.stack([values[starts], np.diff(starts, append=len(values))], axis=1).ravel()
    encodings, data = packed_integers(pairs)
    return [{"kind": "RunLength", "srcType": 3, "srcSize": len(values)}, *encodings], data


def fixed_point(values, factor):
    encodings, data = delta(values, packed_integers)
    return [{"kind": "FixedPoint", "factor": factor, "srcType": 32}, *encodings], data


def string_array(texts, indices):
    data_encoding, data = run_length(indices)
    offset_encoding, offsets = delta(np.cumsum([0, *map(len, texts)]), packed_integers)
    return [{"kind": "StringArray", "dataEncoding": data_encoding, "stringData": "".join(texts),
             "offsetEncoding": offset_encoding, "offsets": offsets}], data  # fmt: skip


def encoded(encoding_and_data):
    return {"encoding": encoding_and_data[0], "data": encoding_and_data[1]}


def binary_column(name, values, copies):
    """The column of the whole set, given that of one copy."""
    count = len(values)
    mask = np.tile([{".": 1, "?": 2}.get(value, 0) for value in values], copies)
    if name == "id":
        data = delta(np.arange(1, copies * count + 1), run_length)
    elif name.startswith(("Cartn_", "occupancy", "B_iso")):
        numbers = np.array([round(1000 * float(value)) for value in values])
        shift = PITCH * 1000 * np.repeat(np.arange(copies), count) if name == "Cartn_z" else 0
        data = fixed_point(np.tile(numbers, copies) + shift, 1000)
    elif name.endswith(("seq_id", "model_num")):
        numbers = np.array([0 if value in ".?" else int(value) for value in values])
        data = delta(np.tile(numbers, copies), run_length)
    else:
        texts = {text: i for i, text in enumerate(dict.fromkeys(v for v in values if v not in (".", "?")))}
        indices = np.tile([texts.get(value, -1) for value in values], copies)
        if name in CHAINS:
            indices += len(texts) * np.repeat(np.arange(copies), count)
            texts = [f"{text}{copy}" for copy in range(copies) for text in texts]
        data = string_array(list(texts), indices)
    return {"name": name, "data": encoded(data), "mask": encoded(run_length(mask)) if mask.any() else None}


def text_rows(columns, copies):
    names = list(columns)
    rows = list(zip(*columns.values(), strict=True))
    chains, z, number = [names.index(name) for name in CHAINS], names.index("Cartn_z"), names.index("id")
    for copy in range(copies):
        for i, row in enumerate(rows):
            fields = list(row)
            for chain in chains:
                fields[chain] += str(copy)
            fields[z] = f"{float(row[z]) + PITCH * copy:.3f}"
            fields[number] = str(copy * len(rows) + i + 1)
            yield " ".join(f'"{field}"' if "'" in field else field for field in fields) + "\n"


def write(path, data):
    path.write_bytes(data)
    path.with_name(path.name + ".gz").write_bytes(gzip.compress(data, 6))


def main():
    folder, path = pathlib.Path(sys.argv[1]), sys.argv[2]
    copies = int(sys.argv[3]) if len(sys.argv) > 3 else 15
    folder.mkdir(parents=True, exist_ok=True)
    columns = columns_of(path)
    head = "data_COPIES\n#\nloop_\n" + "".join(f"_atom_site.{name}\n" for name in columns)
    write(folder / "copies.cif", (head + "".join(text_rows(columns, copies)) + "#\n").encode())
    rows = copies * len(columns["id"])
    table = {"name": "_atom_site", "rowCount": rows,
             "columns": [binary_column(name, values, copies) for name, values in columns.items()]}  # fmt: skip
    document = {"encoder": "make_ribosomes.py", "version": "0.3.0",
                "dataBlocks": [{"header": "COPIES", "categories": [table]}]}  # fmt: skip
    write(folder / "copies.bcif", msgpack.packb(document, use_bin_type=True))


main()
