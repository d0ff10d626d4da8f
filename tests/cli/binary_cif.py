"""Writes BinaryCIF files, for tests of our reader: an encoder made from the specification alone,
https://github.com/molstar/BinaryCIF/blob/master/encoding.md. It shares nothing with the reader.

A plan says how columns are encoded: PLAIN keeps arrays as they are, PACKED is what servers send. The
tables come from an mmCIF file by gemmi, whose reader of CIF syntax is not ours either.
"""

import decimal
import itertools
import struct

TYPES = {"b": 1, "h": 2, "i": 3, "B": 4, "H": 5, "I": 6, "f": 32, "d": 33}  # letters of struct
VERSION = "0.3.0"


def byte_array(values, letter):
    """(encodings, bytes)"""
    return [{"kind": "ByteArray", "type": TYPES[letter]}], struct.pack(f"<{len(values)}{letter}", *values)


def integer_packing(values, byte_count, is_unsigned):
    upper = (1 << 8 * byte_count) - 1 if is_unsigned else (1 << 8 * byte_count - 1) - 1
    lower = 0 if is_unsigned else -upper - 1
    packed = []
    for value in values:
        while value >= upper:
            packed.append(upper)
            value -= upper
        while not is_unsigned and value <= lower:
            packed.append(lower)
            value -= lower
        packed.append(value)
    letter = {(1, True): "B", (1, False): "b", (2, True): "H", (2, False): "h"}[byte_count, is_unsigned]
    encodings, data = byte_array(packed, letter)
    return [{"kind": "IntegerPacking", "byteCount": byte_count, "isUnsigned": is_unsigned,
             "srcSize": len(values)}, *encodings], data


def smallest_packing(values):
    is_unsigned = min(values, default=0) >= 0
    return min((integer_packing(values, count, is_unsigned) for count in (1, 2)),
               key=lambda encoded: len(encoded[1]))


def delta(values, then=smallest_packing):
    origin = values[0] if values else 0
    steps = [b - a for a, b in itertools.pairwise([origin, *values])]
    encodings, data = then(steps)
    return [{"kind": "Delta", "origin": origin, "srcType": 3}, *encodings], data


def run_length(values, then=smallest_packing):
    pairs = [n for value, run in itertools.groupby(values) for n in (value, len(list(run)))]
    encodings, data = then(pairs)
    return [{"kind": "RunLength", "srcType": 3, "srcSize": len(values)}, *encodings], data


def fixed_point(values, factor, then=delta):
    """`values` are Decimals, or numbers that the factor makes whole."""
    encodings, data = then([int(value * factor) for value in values])
    return [{"kind": "FixedPoint", "factor": factor, "srcType": 32}, *encodings], data


def interval_quantization(values, low, high, steps, then=smallest_packing):
    width = (high - low) / (steps - 1)
    encodings, data = then([min(steps - 1, max(0, round((value - low) / width))) for value in values])
    return [{"kind": "IntervalQuantization", "min": low, "max": high, "numSteps": steps,
             "srcType": 33}, *encodings], data


def string_array(values, indices=run_length, offsets=delta):
    """None is a value that is not given."""
    texts = {text: i for i, text in enumerate(dict.fromkeys(v for v in values if v is not None))}
    data_encoding, data = indices([-1 if value is None else texts[value] for value in values])
    offset_encoding, packed = offsets([0, *itertools.accumulate(map(len, texts))])
    return [{"kind": "StringArray", "dataEncoding": data_encoding, "stringData": "".join(texts),
             "offsetEncoding": offset_encoding, "offsets": packed}], data


def int32(values):
    return byte_array(values, "i")


class Plan:
    """One way to encode the columns of a file."""

    def __init__(self, integers, decimals, texts, mask):
        self.integers, self.decimals, self.texts, self.mask = integers, decimals, texts, mask


def factor_of(values):
    """Zeros at the end of a decimal are none of its digits, because encoders are given numbers and not texts."""
    return 10 ** max(0, *(-value.normalize().as_tuple().exponent for value in values))


PLAIN = Plan(int32, lambda values: byte_array([float(v) for v in values], "d"),
             lambda values: string_array(values, int32, int32), lambda v: byte_array(v, "B"))
PACKED = Plan(lambda values: delta(values, run_length),
              lambda values: fixed_point(values, factor_of(values)), string_array, run_length)
# Every value by the encodings that the other plans leave out.
ODD = Plan(lambda values: run_length(values, int32),
           lambda values: fixed_point(values, factor_of(values), int32),
           lambda values: string_array(values, smallest_packing,
                                       lambda offsets: byte_array(offsets, "I")),
           lambda v: byte_array(v, "b"))
PLANS = {"plain": PLAIN, "packed": PACKED, "odd": ODD}


def is_integer(text):
    return text.removeprefix("-").isdigit() and abs(int(text)) < 2**31


def is_decimal(text):
    whole, _, fraction = text.removeprefix("-").partition(".")
    return (whole + fraction).isdigit() and len(whole + fraction) < 10


def encode_values(values, plan):
    """`values` are texts; None stands for one that is not given."""
    given = [value for value in values if value is not None]
    if given and all(map(is_integer, given)):
        return plan.integers([0 if value is None else int(value) for value in values])
    if given and all(map(is_decimal, given)):
        numbers = [decimal.Decimal(value or 0) for value in values]
        encodings, data = plan.decimals(numbers)
        return encodings, data
    return plan.texts(values)


def packed_data(encoded):
    encodings, data = encoded
    return {"encoding": encodings, "data": data}


def column(name, values, plan=PACKED, encode=encode_values):
    """`values` are texts as gemmi has them: "." and "?" stand for values that are not given."""
    mask = [{".": 1, "?": 2}.get(value, 0) for value in values]
    given = [None if masked else value for value, masked in zip(values, mask)]
    return {"name": name, "data": packed_data(encode(given, plan)),
            "mask": packed_data(plan.mask(mask)) if any(mask) else None}


def category(name, columns, rows):
    return {"name": name, "rowCount": rows, "columns": columns}


def document(*blocks):
    return {"encoder": "a test", "version": VERSION,
            "dataBlocks": [{"header": name, "categories": categories} for name, categories in blocks]}


def pack(tree):
    import msgpack
    return msgpack.packb(tree, use_bin_type=True)


def tables(block):
    """The tables of one of gemmi's blocks: name -> column -> texts."""
    import gemmi
    found = {}
    for item in block:
        if item.pair is not None:
            pairs = [item.pair]
            table, _, name = pairs[0][0].partition(".")
            found.setdefault(table, {})[name] = [pairs[0][1]]
        elif item.loop is not None:
            for i, tag in enumerate(item.loop.tags):
                table, _, name = tag.partition(".")
                found.setdefault(table, {})[name] = item.loop.values[i::item.loop.width()]
    unquoted = {value: value if value in ".?" else gemmi.cif.as_string(value)
                for columns in found.values() for values in columns.values() for value in values}
    return {table: {name: [unquoted[value] for value in values] for name, values in columns.items()}
            for table, columns in found.items()}


def categories_of(block, plan=PACKED):
    return [category(table, [column(name, values, plan) for name, values in columns.items()],
                     len(next(iter(columns.values()))))
            for table, columns in tables(block).items()]


def of_cif(path, plan=PACKED):
    """The bytes of a BinaryCIF file of the same tables."""
    import gemmi
    block = gemmi.cif.read(str(path)).sole_block()
    return pack(document((block.name, categories_of(block, plan))))
