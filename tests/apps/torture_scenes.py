"""Small scenes of every subcommand for torture.py, the files that they read, and how their values
are made extreme."""

import json
import re
import subprocess

import h5py
import numpy as np

from program import BOX, CYLINDERS, PROGRAM, SLAB, TILTS, flags

STAGE = {"stage_box": [-1, -1, 0, 1, 1, 4], "beam_light": [0, 0, 0, 0, 0, 1, 0.3, 2],
         "mu_s": 0.4, "mu_a": 0.1}
AREA = {"sensor": "area", "sensor_at": [0, 0, 4], "sensor_size": [1, 0.8], "pixels": [4, 3]}
CAMERA = {"sensor_at": [0.2, 0, 3.9], "sensor_direction": [0, 0, -1], "field_of_view": 1,
          "pixels": [6, 4]}
FIBRE = {"field": "parabolic", "index": 1.5, "alpha": 0.5}
PLANE = {"stop_plane": [0, 0, 2, 0, 0, 1], "max_length": 20, "ray_count": 5}
GRID = {"depth": 100, "optical_depth": [1, 2], "g": [0, 0.5], "tilts": [0, 0.001, 0.01]}
VIEWS = {"light_angles": [0, 0.03], "view_angles": [0.1, 0.13, 3.1]}

# (subcommand, keys); each takes some hundredths of a second of one thread.
SCENES = [
    ("covariance", {**BOX, "samples": 4000}),
    ("covariance", {**CYLINDERS, "covariance": "full", **VIEWS, "samples": 3000}),
    ("covariance", {**CYLINDERS, "width": 12, "depth": 8, "structure": "structure.h5", "samples": 3000}),
    ("covariance", {**BOX, "near_sensors": "sensors.csv", "near_sources": "sources.csv",
                    "covariance": "full", "samples": 4000}),
    ("covariance", {**BOX, "beam_waist": 2, "beam_positions": [0, 1], "beam_depth": 5,
                    "covariance": "full", "samples": 4000}),
    ("covariance", {**BOX, **TILTS, "method": "wave", "samples": 20}),
    ("covariance", {**SLAB, **TILTS, "samples": 4000, "gradient": True}),
    ("covariance", {**SLAB, **TILTS, "tolerance": 1e-3, "frequency_shifts": [0, 0.01]}),
    ("covariance", {**SLAB, "dimension": 3, "delays": [0, 0.01], "samples": 4000}),
    ("covariance", {**BOX, "scatterer": "two_term_hg", "count": None, "optical_depth": 2, "g": 0.8,
                    "g_back": -0.3, "forward_share": 0.9, "covariance": "tilt_shift",
                    "tilts": [0, 0.1], "shifts": [0, 0.2], "samples": 4000}),
    ("covariance", {**SLAB, "g": None, "scatterer": "phase_table", "phase_table": "phase.csv",
                    "samples": 4000}),
    ("flux", {**BOX, "samples": 4000}),
    ("flux", {**SLAB, "light_angles": [0, 0.8], "albedo": 0.9, "tolerance": 1e-3}),
    ("field", {**BOX, **VIEWS, "fields": 4}),
    ("field", {**BOX, "near_sensors": "sensors.csv", "fields": 4, "method": "covariance",
               "target_error": 0.1}),
    ("solve", {**BOX, "map": [-10, 10, 0, 10], "map_pixels": [20, 10]}),
    ("solve", {"placement": "disks.csv", "scatterer": "tm", "index": "1.5+0.1i", **VIEWS}),
    ("validate", {**BOX, **TILTS, "samples": 4000, "wave_samples": 20}),
    ("validate", {**SLAB, **TILTS, "samples": 4000, "tolerance": 1e-3}),
    ("sweep", {**GRID, "samples": 2000}),
    ("sweep", {**GRID, "method": "both", "samples": 2000, "tolerance": 1e-3}),
    ("sweep", {"domain": "box", "width": 10, "depth": 10, "scatterer": "point",
               "density": [0.2, 0.4], "tilts": [0, 0.1], "method": "wave", "samples": 20}),
    ("merge", {"shards": "points.h5.shards", "partial": True}),
    ("trace", {**FIBRE, "connect": [0, 0, 0, 0.3, 0, 3], "max_length": 5, "trials": 100}),
    ("trace", {"field": "fisheye", "light": "fan", "origin": [0, 0, -0.5], "half_angle": 1,
               **PLANE, "path_points": 11}),
    ("trace", {"field": ["sech", "ultrasound"], "index": 1.5, "alpha": 0.5, "amplitude": 1e-3,
               "sound_wavenumber": 4, **PLANE}),
    ("trace", {"field": "grid", "grid": "grid.h5", "rays": "rays.csv", "max_length": 5,
               "stop_sphere": [0, 0, 0, 0.9]}),
    ("render", {**STAGE, **AREA, "samples": 2000}),
    ("render", {**STAGE, **CAMERA, **FIBRE, "samples": 500, "path_bins": [3, 8, 5]}),
    ("render", {**STAGE, **AREA, "samples": 2000, "density": "density.h5", "phase":
                "henyey_greenstein", "g": 0.5, "method": "photon_map", "photon_radius": 0.4}),
    ("render", {**STAGE, **CAMERA, "body_sphere": [0, 0, 2, 0.5], "index": 1.5, "samples": 500}),
    ("place", {"width": 12, "depth": 8, "radii": [0.3, 0.6], "count": 30, "structure": "s.h5",
               "realizations": 4}),
    ("place", {"width": 12, "depth": 8, "radii": 0.4, "packing_fraction": 0.3,
               "placement": "equilibrium"}),
]

# The keys of a longer run, to be interrupted: some tenths of a second of one thread.
LONG = [
    ("covariance", {**BOX, **TILTS, "samples": 500_000}),
    ("covariance", {**BOX, **TILTS, "method": "wave", "samples": 4000}),
    ("covariance", {**SLAB, "dimension": 3, "samples": 400_000}),
    ("flux", {**SLAB, "samples": 800_000}),
    ("validate", {**BOX, "samples": 400_000, "wave_samples": 4000}),
    ("sweep", {**GRID, "samples": 50_000}),
    ("sweep", {**GRID, "method": "both", "samples": 50_000}),
    ("render", {**STAGE, **AREA, "samples": 200_000}),
    ("render", {**STAGE, **CAMERA, **FIBRE, "samples": 10_000}),
    ("field", {**BOX, **VIEWS, "fields": 2000}),
    ("solve", {"width": 60, "depth": 60, "count": 1200}),
    ("trace", {**FIBRE, "connect": [0, 0, 0, 0.3, 0, 3], "max_length": 5, "trials": 5000}),
]
OLDER = {**BOX, "samples": 4000}
STOPPED = {**OLDER, "target_error": 1e-9}
POINTS = {**GRID, "samples": 2000}
RESUMABLE = ("covariance", "flux", "validate", "sweep", "render")

NUMBERS = ["0", "-0.0", "-1", "1", "2", "0.5", "0.001", "1000", "1e9", "-1e9", "1e-9", "1e150",
           "1e308", "-1e308", "1e-308", "5e-324", "0.9999999999999999", "1.0000000000000002",
           "1.5707963267948966", "3.141592653589793", "nan", "inf", "-inf", "1e999"]
INTEGERS = ["0", "-1", "1", "2", "7", "1000", "2147483648", "9223372036854775807",
            "18446744073709551616", "1e3", "1.5", "nan"]
WORDS = ["", " ", "x", "1,5", "0x1p3", "1e", "--", "1 2", "\u00e4\u0661", "true", "1+1i", "-1i",
         "1.5+1e308i", "x" * 5000, "[1, 2]", "'", "%s%n", "-"]
FILES = ["absent.csv", ".", "/dev/null", "older.h5", "sensors.csv", "rays.csv", "disks.csv",
         "structure.h5", "grid.h5", "points.h5.shards", "/proc/self/mem", "sensors.csv/x", "x" * 300]


def write_files(folder):
    """What the scenes read: older.h5 is a finished result, stopped.h5 one that can be resumed,
    points.h5.shards holds the points of a sweep."""
    (folder / "sensors.csv").write_text("x,z\n0,14\n1,14\n-3,-2\n")
    (folder / "sources.csv").write_text("x,z\n0,-5\n1,-5\n")
    (folder / "rays.csv").write_text("x,y,z,dx,dy,dz\n0,0,-0.5,0,0,1\n0.1,0,-0.5,0.1,0,1\n")
    (folder / "phase.csv").write_text("angle,value\n0,3\n1,1\n3.141592653589793,0.5\n")
    (folder / "disks.csv").write_text("x,z,radius\n0,0,0.3\n1,0,0.2\n0,1,0.4\n-2,3,0.1\n")
    for name, dataset in (("grid.h5", "excess"), ("density.h5", "density")):
        with h5py.File(folder / name, "w") as file:
            data = file.create_dataset(dataset, data=np.linspace(0, 0.1, 8 * 8 * 8).reshape(8, 8, 8))
            data.attrs["origin"] = np.array([-1.0, -1, -1])
            data.attrs["spacing"] = np.array([0.3, 0.3, 0.8])
    for subcommand, out, status, keys in (
            ("place", "placed.csv", 0, {"width": 12, "depth": 8, "radii": 0.16, "count": 20,
                                        "structure": "structure.h5", "realizations": 10}),
            ("covariance", "older.h5", 0, OLDER),
            ("covariance", "stopped.h5", 3, STOPPED),
            ("sweep", "points.h5", 0, {**POINTS, "shard": "0/1"})):
        done = subprocess.run([PROGRAM, subcommand, *flags({**keys, "out": out})], cwd=folder,
                              capture_output=True)
        if done.returncode != status:
            raise RuntimeError(f"{subcommand}: {done.stderr.decode()}")


def rows_of_keys():
    """{subcommand: [row of a key]} as the program tells them."""
    told = subprocess.run([PROGRAM, "keys", "json"], check=True, capture_output=True)
    return json.loads(told.stdout)


def extreme_value(row, random):
    """A word or a list of words for a key."""
    usual = {"number": NUMBERS, "integer": INTEGERS, "text": (row["words"] or []) + FILES}
    pool = usual.get(row["type"], WORDS)
    if row["list"]:
        count = random.choice([0, 1, 2, 3, 6, 7, 8, 20_000 if random.random() < 0.1 else 4])
        if random.random() < 0.5:
            return [random.choice(pool)] * count
        return [repr(0.001 * i) for i in range(count)]
    return random.choice(WORDS if random.random() < 0.15 else pool)


def scaled(value, random):
    """A number, or one of a list, times a power of ten; anything else as it is."""
    if isinstance(value, list) and value:
        at = random.randrange(len(value))
        return [*value[:at], scaled(value[at], random), *value[at + 1:]]
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        changed = value * 10.0 ** random.choice([-9, -3, -2, -1, 1, 2, 3, 9]) * random.choice([1, 1, 1, -1])
        return round(changed) if isinstance(value, int) and random.random() < 0.8 else changed
    return value


def mutated(keys, rows, random):
    """The keys with one to three of them scaled, made extreme, added or left out."""
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
    """Bytes with some of them flipped, cut off, doubled or added."""
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
    """One number of a table is another one, or a word."""
    cells = re.split(r"([,\n])", text)
    cells[2 * random.randrange(len(cells) // 2)] = random.choice(NUMBERS + WORDS)
    return "".join(cells)


def change_a_number(path, random):
    """In a dataset or attribute of an HDF5 file, which stays well formed."""
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
    """In its bytes, or in one number of it."""
    if random.random() < 0.5:
        damage_bytes(path, random)
    elif path.suffix == ".csv":
        path.write_text(other_cell(path.read_text(), random))
    elif path.suffix == ".h5":
        change_a_number(path, random)
