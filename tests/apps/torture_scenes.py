"""Small scenes of every subcommand for torture.py, and the files that they read."""

import json
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
    ("covariance", {**CYLINDERS, "width": 12, "depth": 8, "structure": "structure.h5",
                    "samples": 3000}),
    ("covariance", {**BOX, "near_sensors": "sensors.csv", "near_sources": "sources.csv",
                    "covariance": "full", "samples": 4000}),
    ("covariance", {**BOX, "beam_waist": 2, "beam_positions": [0, 1], "beam_depth": 5,
                    "covariance": "full", "samples": 4000}),
    ("covariance", {**BOX, **TILTS, "method": "wave", "samples": 20}),
    ("covariance", {**SLAB, **TILTS, "samples": 4000, "gradient": True}),
    ("covariance", {**SLAB, **TILTS, "tolerance": 1e-3, "frequency_shifts": [0, 0.01]}),
    ("covariance", {**BOX, "method": "wave", "frequency_shifts": [0, 0.01], "samples": 20}),
    ("validate", {**BOX, "samples": 4000, "wave_samples": 20, "frequency_shifts": [0, 0.01]}),
    ("covariance", {**SLAB, "dimension": 3, "delays": [0, 0.01], "samples": 4000}),
    ("covariance", {**BOX, "scatterer": "two_term_hg", "count": None, "optical_depth": 2, "g": 0.8,
                    "g_back": -0.3, "forward_share": 0.9, "covariance": "tilt_shift",
                    "tilts": [0, 0.1], "shifts": [0, 0.2], "samples": 4000}),
    ("covariance", {**SLAB, "g": None, "scatterer": "phase_table", "phase_table": "phase.csv",
                    "samples": 4000}),
    ("covariance", {"domain": "box", "width": 20, "layers": "layers.csv", "samples": 4000}),
    ("covariance", {**BOX, "count": None, "density": 0.1, "density_blobs": "blobs.csv",
                    "samples": 4000}),
    ("covariance", {**SLAB, "delays": [0, 0.1, 0.2, 0.4, 0.6, 1], "velocity": [1, 0],
                    "exposures": [0.9, 1], "samples": 4000}),
    ("flux", {**BOX, "samples": 4000}),
    ("flux", {**SLAB, "light_angles": [0, 0.8], "albedo": 0.9, "tolerance": 1e-3}),
    ("field", {**BOX, **VIEWS, "fields": 4}),
    ("field", {**BOX, "near_sensors": "sensors.csv", "fields": 4, "method": "covariance",
               "target_error": 0.1}),
    ("solve", {**BOX, "map": [-10, 10, 0, 10], "map_pixels": [20, 10]}),
    ("solve", {**BOX, "wavelengths": [0.9, 1.1], "wavelength_count": 3}),
    ("solve", {**BOX, "t_matrix_gap": 5}),
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
    ("design", {"nodes": [3, 5], "directions": 4, "rays_per_direction": 9, "iterations": 4}),
    ("design", {"design": "radial", "directions": 1, "rays_per_direction": 20, "focus": 0.8}),
    ("design", {"design": "guide", "goal": "equal_path", "delta": 0.01, "coefficients": 0, "ray_count": 20}),
    ("render", {**STAGE, **AREA, "samples": 2000}),
    ("render", {**STAGE, **CAMERA, **FIBRE, "samples": 500, "path_bins": [3, 8, 5]}),
    ("render", {**STAGE, **AREA, "samples": 2000, "density": "density.h5", "phase":
                "henyey_greenstein", "g": 0.5, "method": "path"}),
    ("render", {**STAGE, **CAMERA, "body_sphere": [0, 0, 2, 0.5], "index": 1.5, "samples": 500}),
    ("fit", {"free": ["g=0:0.8"], "depth": 100, "optical_depth": 2, "measurement": "curve.csv"}),
    ("fit", {"free": ["g=0:0.8"], "depth": 100, "optical_depth": 2, "measurement": "curve.csv", "method": "mc"}),
    ("fit", {"plan": True, "free": ["g=0:0.8"], "depth": 100, "g": 0.5, "optical_depth": 2, "tilts": [0.002, 0.004]}),
    ("place", {"width": 12, "depth": 8, "radii": [0.3, 0.6], "count": 30, "structure": "s.h5",
               "realizations": 4}),
    ("place", {"width": 12, "depth": 8, "radii": 0.4, "packing_fraction": 0.3,
               "placement": "equilibrium"}),
]

IMAGE = {"domain": "box", "width": 60, "depth": 10, "scatterer": "hg", "g": 0.8, "object_x": [0, 6, 15],
         "object_depth": -200, "camera": [-0.3, 0.3], "pixels": 256, "prediction_paths": 400,
         "paths_per_field": 400, "repeats": 2}
# Sweeps of every subcommand that can be swept: points of some hundredths of a second.
SWEPT = [
    ("solve", {"width": 30, "depth": 30, "vary": ["count=100,150,200"], "map": [-10, 10, 0, 10],
               "map_pixels": [20, 10]}),
    ("covariance", {**BOX, **TILTS, "count": None, "samples": 60_000, "vary": ["density=0.1:0.2:4"]}),
    ("covariance", {**SLAB, **TILTS, "method": "transport", "tolerance": 1e-3, "g": None,
                    "vary": ["g=0:0.8:4"]}),
    ("flux", {**SLAB, "samples": 80_000, "g": None, "vary": ["g=0:0.8:4"]}),
    ("field", {**BOX, **VIEWS, "count": None, "fields": 200, "vary": ["density=0.1:0.2:4"]}),
    ("image", {**IMAGE, "vary": ["optical_depth=1:3:4"]}),
    ("trace", {**FIBRE, "alpha": None, "connect": [0, 0, 0, 0.3, 0, 3], "max_length": 5, "trials": 500,
               "vary": ["alpha=0.4:0.6:5"]}),
    ("render", {**STAGE, **AREA, "samples": 30_000, "vary": ["g=0:0.8:4"], "phase": "henyey_greenstein"}),
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
    ("optimise", {"of": "flux", **SLAB, "g": None, "vary": ["g=0.1:0.9"], "maximise": "transmittance[0]",
                  "scattered": 8, "starts": 1, "samples": 4000, "target_error": 0.05, "method": "mc"}),
    ("design", {"nodes": [3, 5], "directions": 8, "rays_per_direction": 25, "iterations": 12}),
    ("fit", {"free": ["g=0:0.8"], "depth": 100, "optical_depth": 2, "measurement": "curve.csv",
             "method": "mc", "model_share": 0.02}),
    *(("sweep", {"of": of, **keys}) for of, keys in SWEPT),
]
OLDER = {**BOX, "samples": 4000}
STOPPED = {**OLDER, "target_error": 1e-9}
POINTS = {**GRID, "samples": 2000}
RESUMABLE = ("covariance", "flux", "validate", "sweep", "render")
GOES_ON = RESUMABLE + ("optimise", "design", "fit")  # resumed from a separate file next to the result


def write_files(folder):
    """Writes the files that the scenes read: older.h5 is a finished result, stopped.h5 one that can be resumed,
    points.h5.shards holds the points of a sweep."""
    (folder / "sensors.csv").write_text("x,z\n0,14\n1,14\n-3,-2\n")
    (folder / "curve.csv").write_text("tilt,field_correlation,error\n0.002,0.8,0.05\n0.004,0.6,0.05\n")
    (folder / "sources.csv").write_text("x,z\n0,-5\n1,-5\n")
    (folder / "rays.csv").write_text("x,y,z,dx,dy,dz\n0,0,-0.5,0,0,1\n0.1,0,-0.5,0.1,0,1\n")
    (folder / "phase.csv").write_text("angle,value\n0,3\n1,1\n3.141592653589793,0.5\n")
    (folder / "layers.csv").write_text("thickness,density\n3,0.05\n3,0.25\n4,0.15\n")
    (folder / "blobs.csv").write_text("x,z,radius,amplitude\n-2,4,2,-1\n5,7,1.5,2\n")
    (folder / "disks.csv").write_text("x,z,radius\n0,0,0.3\n1,0,0.2\n0,1,0.4\n-2,3,0.1\n")
    for name, dataset in (("grid.h5", "excess"), ("density.h5", "density")):
        with h5py.File(folder / name, "w") as file:
            values = np.linspace(0, 0.1, 8 * 8 * 8).reshape(8, 8, 8)
            data = file.create_dataset(dataset, data=values)
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
    """Returns {subcommand: [entry of a key]} as printed by the program."""
    told = subprocess.run([PROGRAM, "keys", "json"], check=True, capture_output=True)
    subcommands = json.loads(told.stdout)["subcommands"]
    return {name: one["keys"] for name, one in subcommands.items()}
