"""Tiny runs of every subcommand that between them meet every row of docs/format.md."""

import dataclasses
import math
import signal
import time

import h5py

from program import BOX, CYLINDERS, SLAB, ProgramTest
from test_interruption import catches

FAR = {"light_angles": [0, 0.3], "view_angles": [0.1, 0.5, 3.0]}
NEAR = {"near_sources": "sources.csv", "near_sensors": "sensors.csv"}
SENSORS = {"near_sensors": "sensors.csv"}
BEAMS = {"beam_waist": 2, "beam_positions": [0, 3], "beam_depth": 5}
SINES = [round(math.asin(0.02 * i), 9) for i in range(12)]
TILTS = {"covariance": "memory_effect", "tilts": [0, 0.04, 0.16]}
FULL = {"covariance": "full"}
PAIRS = {"covariance": "pairs", "pairs": [0, 0.1, 0.04, 0.14, 0, 0.5, 0, 0.5]}
MAP = {"covariance": "tilt_shift", "tilts": [0, 0.01, 0.03], "shifts": [-0.1, 0, 0.1]}
MOVED = {"covariance": "translation", "shifts": [0, 0.2, 0.5]}
HG = {"width": 20, "depth": 10, "scatterer": "hg", "optical_depth": 2, "g": 0.5, "albedo": 0.9}
DISKS = {"width": 12, "depth": 8, "radii": 0.4, "packing_fraction": 0.4, "realizations": 4}
CURVES = {"tilts": [0, 0.001, 0.002, 0.003], "samples": 2000}

FILES = {
    "sensors.csv": "x,z\n0,13\n3,15\n",
    "sources.csv": "x,z\n1,-3\n2,-4\n",
    "source.csv": "x,z\n1,-3\n",
    "line.csv": "x,z\n" + "".join(f"{0.5 * i},14\n" for i in range(10)),
    "disks.csv": "x,z,radius\n0,0,0.3\n1,2,0.2\n",
    "points.csv": "optical_depth,g,albedo\n1,0,1\n2,0.5,0.9\n3,0.5,1\n",
    "disk_points.csv": "density,radius,index,index_imaginary\n0.1,0.2,1.5,0\n0.2,0.1,1.4,0.01\n",
}


@dataclasses.dataclass
class Run:
    subcommand: str
    sections: list[str]
    keys: dict
    status: int = 0
    by_method: bool = False


def estimate(sections, keys, subcommand="covariance", status=0, **more):
    """Of covariance or validate; Monte Carlo by the thousand, placements by the dozen."""
    cost = {"samples": 2000} if keys.get("method", more.get("method")) != "wave" else {"samples": 4}
    return Run(subcommand, ["Axes", "Trace", *sections], {**cost, **keys, **more}, status,
               subcommand == "validate")


def request(name, *more):
    """The sections of a request's file."""
    mean = [] if name == "pairs" else ["Mean field"]
    return [f"Request {name}", *mean, *more]


def covariances():
    views = {"view_angles": [0.1, 0.5]}
    return {
        "intensity": estimate(request("intensity"), {**BOX, **FAR}),
        "intensity_wave": estimate(request("intensity"), {**CYLINDERS, **FAR}, method="wave"),
        "intensity_near": estimate(request("intensity"), {**BOX, **NEAR}, method="wave"),
        "intensity_slab": estimate(request("intensity"), {**SLAB, **FAR}),
        "intensity_hg": estimate(request("intensity"), {**HG, **FAR}),
        "full": estimate(request("full"), {**BOX, **FAR, **FULL}),
        "full_near": estimate(request("full"), {**BOX, **NEAR, **FULL}, method="wave"),
        "full_beams": estimate(request("full"), {**BOX, **BEAMS, **views, **FULL}),
        "pairs": estimate(request("pairs"), {**BOX, **PAIRS}),
        "pairs_slab": estimate(request("pairs"), {**SLAB, **PAIRS, "pairs": [0, 0.1, 0, 0.1]}),
        "curve": estimate(request("memory_effect"), {**BOX, **TILTS, **views}),
        "curve_slab": estimate(request("memory_effect"), {**SLAB, **TILTS, **views}),
        "curve_wave": estimate(request("memory_effect"), {**BOX, **TILTS}, method="wave"),
        "map": estimate(request("tilt_shift"), {**BOX, **MAP, **views}),
        "map_reflection": estimate(request("tilt_shift"), {**BOX, **MAP, "view_angles": [2.9]}),
        "map_beam": estimate(request("tilt_shift"), {**BOX, **MAP, "beam_waist": 2}),
        "map_near": estimate(request("tilt_shift"), {**BOX, **MAP, **SENSORS}, method="wave"),
        "moved": estimate(request("translation"), {**BOX, **MOVED, "near_sources": "source.csv",
                                                   **SENSORS}),
        "moved_beam": estimate(request("translation"), {**BOX, **MOVED, "beam_waist": 2},
                               method="wave"),
    }


def extras():
    gradient, delays = {"gradient": True}, {"delays": [0, 0.1, 1]}
    views = {"view_angles": [0.1, 0.5]}
    runs = {
        "gradient": (request("intensity"), {**HG, **FAR, **gradient}),
        "gradient_near": (request("intensity"), {**BOX, **SENSORS, **gradient}),
        "gradient_full": (request("full"), {**HG, **FAR, **FULL, **gradient}),
        "gradient_full_near": (request("full"), {**BOX, **SENSORS, **FULL, **gradient}),
        "gradient_pairs": (request("pairs"), {**HG, **PAIRS, **gradient}),
        "gradient_curve": (request("memory_effect"), {**SLAB, **TILTS, **views, **gradient}),
        "delays": (request("intensity"), {**HG, **FAR, **delays}),
        "delays_near": (request("intensity"), {**BOX, **SENSORS, **delays}),
        "delays_slab": (request("intensity"), {**SLAB, **delays}),
    }
    return {name: estimate([*sections, f"With {name.split('_')[0]}"], keys)
            for name, (sections, keys) in runs.items()}


def other_subcommands():
    box = {"width": 20, "depth": 10}
    both = {"subcommand": "validate", "wave_samples": 4}
    return {
        "validate": estimate([*request("intensity"), "validate"], {**BOX, **FAR}, **both),
        "validate_map": estimate([*request("tilt_shift"), "validate"],
                                 {**BOX, **MAP, "view_angles": [0.3]}, **both),
        "solve": Run("solve", ["Axes", "solve"], {**CYLINDERS, **FAR, "map": [-5, 5, 0, 4]}),
        "solve_near": Run("solve", ["Axes", "solve"], {"placement": "disks.csv", **SENSORS,
                                                       "scatterer": "tm"}),
        "flux": Run("flux", ["Axes", "Trace", "flux"], {**BOX, "samples": 4000, "angle_bins": 600}),
        "flux_slab": Run("flux", ["Axes", "Trace", "flux"], {**SLAB, "samples": 4000}),
        "field": Run("field", ["Axes", "field"],
                     {**box, "mean_free_path": 10, "view_angles": SINES, "fields": 4,
                      "tilts": [0, 0.1], "method": "paths"}),
        "field_near": Run("field", ["Axes", "field"], {**BOX, "near_sensors": "line.csv",
                                                       "fields": 4, "method": "covariance"}),
        "place": Run("place", ["place --structure"], {**DISKS, "placement": "equilibrium"}),
    }


def traces():
    rays = {"ray_count": 3, "max_length": 5}
    fields = {
        "ball": {"field": "luneburg", "origin": [0, 0, -2], "beam_radius": 0.5, "path_points": 5},
        "guide": {"field": "sech", "alpha": 1, "light": "fan", "across": [0, 1, 0],
                  "path_points": 5},
        "ramp": {"field": "linear", "slope": [0, 0, 0.1], "stop_plane": [0, 0, 2, 0, 0, 1]},
    }
    connect = {"connect": [0, 0, 0, 0.3, 0, 3], "max_length": 5, "trials": 100, "path_points": 5,
               "field": "parabolic", "alpha": 0.5, "index": 1.5}
    return {**{f"trace_{name}": Run("trace", ["trace"], {**rays, **keys})
               for name, keys in fields.items()},
            "trace_connect": Run("trace", ["trace"], connect)}


def renders():
    scene = {"field": "parabolic", "index": 1.5, "alpha": 0.5, "stage_box": [-1, -1, 0, 1, 1, 4],
             "mu_s": 0.5, "point_light": [0, 0, 1, 1], "samples": 2000}
    sensors = {
        "camera": {"sensor_at": [0.2, 0, 3.9], "sensor_direction": [0, 0, -1], "field_of_view": 1,
                   "pixels": [30, 20], "path_bins": [1, 9, 4]},
        "area": {"sensor": "area", "sensor_at": [0, 0, 4], "sensor_size": [1, 1], "pixels": [3, 2],
                 "path_bins": [4, 9, 5], "length_unit": 0.001},
        "directional": {"sensor": "directional", "pixels": [4, 3], "path_bins": [4, 9, 5]},
    }
    return {f"render_{name}": Run("render", ["Trace", "render"], {**scene, **keys})
            for name, keys in sensors.items()}


def benchmarks():
    return {f"bench_{kind}": Run(f"bench {kind}", [f"bench {kind}"], {"quick": True})
            for kind in ("error", "stability", "plan")}


def unfinished():
    never = {"target_error": 1e-9}
    state = "Unfinished results"
    return {
        "short": estimate([*request("intensity"), state], {**BOX, **FAR, **never}, status=3),
        "short_both": estimate([*request("intensity"), "validate", state], {**BOX, **FAR, **never},
                               subcommand="validate", status=3, wave_samples=4),
        "interrupted": estimate([state], {**BOX, **FAR, "samples": 10 ** 9}, status=75),
    }


def sweeps():
    sections = ["Axes", "Trace", "sweep"]
    disks = {**BOX, "count": None, "density": 0.1, "scatterer": "tm", **CURVES}
    both = {**BOX, "albedo": [1, 0.8], **CURVES, "scatterer": "point", "domain": "box",
            "method": "both", "wave_samples": 4}
    grid = {"depth": 100, "optical_depth": [1, 2], "albedo": [1, 0.9], "g": [0, 0.5], **CURVES}
    return {
        "sweep": Run("sweep", sections, grid),
        "sweep_partial": Run("merge", sections, grid, status=3),
        "sweep_disks": Run("sweep", sections, {**disks, "domain": "box", "density": [0.05, 0.1],
                                               "radius": [0.1, 0.2],
                                               "index": ["1.5+0.01i", "1.4"]}),
        "sweep_list": Run("sweep", sections, {"depth": 100, "points": "points.csv", **CURVES,
                                              "target_error": 0.9}),
        "sweep_disk_list": Run("sweep", sections, {**disks, "domain": "box", "density": None,
                                                   "points": "disk_points.csv"}),
        "sweep_both": Run("sweep", sections, both, by_method=True),
    }


def interrupt(test, run, keys):
    process = test.start(run.subcommand, **keys)
    while not catches(process, signal.SIGINT):
        time.sleep(0.002)
        test.assertIsNone(process.poll())
    time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    test.assertEqual(process.wait(timeout=60), run.status)


def make_file(test, name, run):
    keys = {"threads": 2, **run.keys, "out": f"{name}.h5"}
    if run.subcommand == "place":
        test.call("place", **run.keys, structure=f"{name}.h5", out=f"{name}.csv")
    elif run.subcommand == "merge":
        test.call("sweep", **keys, shard="1/2")
        test.call("merge", "--partial", out=keys["out"], status=run.status)
    elif run.status == 75:
        interrupt(test, run, keys)
    else:
        test.call(*run.subcommand.split(), **keys, status=run.status)


class ResultsTest(ProgramTest):
    """All tests of a class read the same files, made once."""

    @classmethod
    def setUpClass(cls):
        maker = ProgramTest("call")
        maker.setUp()
        cls.addClassCleanup(maker.doCleanups)
        cls.results = maker.folder
        cls.runs = {**covariances(), **extras(), **other_subcommands(), **traces(), **renders(),
                    **benchmarks(), **unfinished(), **sweeps()}
        for name, text in FILES.items():
            maker.write(name, text)
        for name, run in cls.runs.items():
            make_file(maker, name, run)

    def setUp(self):
        self.folder = self.results

    def on_each_file(self, check):
        """check(run, open h5py file)."""
        for name, run in self.runs.items():
            with self.subTest(file=name), h5py.File(self.folder / f"{name}.h5") as file:
                check(run, file)
