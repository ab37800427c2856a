"""Makes scenes extreme and damages files."""

import re

import h5py
import numpy as np

NUMBERS = ["0", "-0.0", "-1", "1", "2", "0.5", "0.001", "1000", "1e9", "-1e9", "1e-9", "1e150",
           "1e308", "-1e308", "1e-308", "5e-324", "0.9999999999999999", "1.0000000000000002",
           "1.5707963267948966", "3.141592653589793", "nan", "inf", "-inf", "1e999"]
INTEGERS = ["0", "-1", "1", "2", "7", "1000", "2147483648", "9223372036854775807",
            "18446744073709551616", "1e3", "1.5", "nan"]
WORDS = ["", " ", "x", "1,5", "0x1p3", "1e", "--", "1 2", "\u00e4\u0661", "true", "1+1i", "-1i",
         "1.5+1e308i", "x" * 5000, "[1, 2]", "'", "%s%n", "-"]
FILES = ["absent.csv", ".", "/dev/null", "older.h5", "sensors.csv", "rays.csv", "disks.csv",
         "structure.h5", "grid.h5", "points.h5.shards", "/proc/self/mem", "sensors.csv/x",
         "x" * 300]


def extreme_value(row, random):
    """Returns a word or a list of words for a key."""
    usual = {"number": NUMBERS, "integer": INTEGERS, "text": (row["words"] or []) + FILES}
    pool = usual.get(row["type"], WORDS)
    if row["list"]:
        count = random.choice([0, 1, 2, 3, 6, 7, 8, 20_000 if random.random() < 0.1 else 4])
        if random.random() < 0.5:
            return [random.choice(pool)] * count
        return [repr(0.001 * i) for i in range(count)]
    return random.choice(WORDS if random.random() < 0.15 else pool)


def scaled(value, random):
    """Returns a number, or one of a list, times a power of ten; anything else unchanged."""
    if isinstance(value, list) and value:
        at = random.randrange(len(value))
        return [*value[:at], scaled(value[at], random), *value[at + 1:]]
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        power = random.choice([-9, -3, -2, -1, 1, 2, 3, 9])
        changed = value * 10.0 ** power * random.choice([1, 1, 1, -1])
        return round(changed) if isinstance(value, int) and random.random() < 0.8 else changed
    return value


def mutated(keys, rows, random):
    """Returns the keys with one to three of them scaled, made extreme, added or left out."""
    keys = dict(keys)
    rows = [row for row in rows if row["name"] not in ("out", "threads", "seed")]
    for row in random.choices(rows, k=random.choice([1, 1, 2, 3])):
        given = [other for other in rows if other["name"] in keys]
        if given and random.random() < 0.7:
            row = random.choice(given)
        if random.random() < 0.1:
            keys[row["name"]] = None
        elif row in given and random.random() < 0.6:
            keys[row["name"]] = scaled(keys[row["name"]], random)
        else:
            keys[row["name"]] = extreme_value(row, random)
    return keys


def damaged(data, random):
    """Returns bytes with some of them flipped, cut off, doubled or added."""
    kind = random.choice(["flip", "flip", "cut", "empty", "double", "add", "zero"])
    at = random.randrange(len(data)) if data else 0
    if kind == "flip" and data:
        changed = bytearray(data)
        for _ in range(random.choice([1, 1, 5])):
            changed[random.randrange(len(data))] ^= 1 << random.randrange(8)
        return bytes(changed)
    if kind == "zero":
        return data[:at] + bytes(len(data[at:at + 50])) + data[at + 50:]
    return {"cut": data[:at], "empty": b"", "double": data + data}.get(kind, data + b"\x00x\n")


def other_cell(text, random):
    """Returns a table with one number replaced by another or by a word."""
    cells = re.split(r"([,\n])", text)
    cells[2 * random.randrange(len(cells) // 2)] = random.choice(NUMBERS + WORDS)
    return "".join(cells)


def change_a_number(path, random):
    """Changes a dataset or attribute of an HDF5 file, which stays well formed."""
    with h5py.File(path, "r+") as file:
        items = [file]
        file.visititems(lambda _, item: items.append(item))
        places = [(item.attrs, key) for item in items for key, value in item.attrs.items()
                  if np.asarray(value).dtype.kind == "f"]
        places += [(item.parent, item.name) for item in items
                   if isinstance(item, h5py.Dataset) and item.dtype.kind == "f"]
        holder, name = random.choice(places)
        values = np.array(holder[name])
        values.flat[random.randrange(values.size)] = float(random.choice(NUMBERS))
        if isinstance(holder, h5py.AttributeManager):
            holder.modify(name, values)
        else:
            holder[name][...] = values


def damage_bytes(path, random):
    path.write_bytes(damaged(path.read_bytes(), random))


def damage(path, random):
    """Damages bytes or one number of a file."""
    if random.random() < 0.5:
        damage_bytes(path, random)
    elif path.suffix == ".csv":
        path.write_text(other_cell(path.read_text(), random))
    elif path.suffix == ".h5":
        change_a_number(path, random)
