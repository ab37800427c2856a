"""Keys that a scene accepts have an effect: for each scene of format_scenes.py and each key accepted there,
some other value changes the result. Words restrict it to scenes whose names begin with one of them."""

import json
import re
import subprocess
import sys
import unittest

from format_scenes import FILES, RUNS, cost
from program import PROGRAM, ProgramTest, bits_of, datasets, flags

RECOVERED = ("recover", "recover_sources", "recover_phases", "recover_reference", "recover_lucy")
TAGGED = [f"tagged_{sensor}" for sensor in ("area", "directional", "polar", "radial", "camera")]
# A key, or a subcommand or scene with its key.
WITHOUT_EFFECT = {
    "neglect_k_shift": "permits what these scenes do not do",
    "placement": "poisson is what points have without it",
    "smallest_feature": "a bound that coarse nodes meet",
    "seed": "transport draws nothing and records it",
    "wave_tolerance": "few scatterers are solved directly",
    "aperture tolerance": "all rays pass, which ends the search",
    "aspheric_image integrator": "rays between surfaces are straight",
    "solve tolerance": "few scatterers are solved directly",
    "solve wavelength": "with wavelengths, that at which a density would be meant",
    "delays wavelength": "the slab and its paths scale with the mean free path alone",
    "grains target_error": "of the covariance, but auto takes paths here",
    "field phase_shift": "the mean free path is given",
    "fit most_iterations": "the search ends before",
    "fit_paths model_share": "the least number of paths is enough",
    "fit_paths trust_paths": "the measurement's errors are much larger",
    "fit_plans g": "varied",
    "mesh body_mesh_crease": "the mesh has right angles",
    "mesh body_mesh_weld": "its vertices lie far apart",
    "space_solve min_gap": "few spheres lie far apart",
    "own_places min_gap": "the placement is given",
    "optimise target_error": "the first points meet it",
    "optimise starts": "a coarse search",
    **{f"{scene} frame_axes": "columns with names" for scene in RECOVERED},
    **{f"{scene} {key}": "the peaks found lie within" for scene in (*RECOVERED, "recover_points") for key in ("longest", "resolution")},
    "recover_picture recovery": "auto takes phases too",
    "spectra method": "auto takes paths too",
    "shifts_exact index_field": "exact waves contain the mean field",
    "space depth": "the mean free path is a fraction of it",
    "space wavelength": "all directions are angles",
    "sweep_of mu_a": "varied",
    "singlet integrator": "rays between surfaces are straight",
    **{f"{scene} {key}": "a bound that rays do not meet" for scene, key in (("ramp", "stop_box"), ("singlet", "stop_box"), ("singlet", "body_box"))},
    "fit_paths seconds": "the search ends before",
    "fit_distance method": "transport is the only model, mc is rejected",
    **{f"{camera} {key}": why for camera in ("camera_across", "far_camera", "lens_image")
       for key, why in (("view_azimuths", "the view is along the axis"), ("tolerance", "the fast sums reach less than these"))},
    **{f"{scene} {key}": why for scene in TAGGED
       for key, why in (("transducer_waves", "the transducer has no aperture"), ("length_unit", "recorded as an attribute"))},
    "lens_image method": "auto takes paths too, and covariance is rejected",
    "flux_faces wavelength": "the powers depend on the optical depth and the indices alone",
    "flux_faces depth": "the same, since the optical depth is given",
    "flux_faces tolerance": "the first solutions meet these",
    "display target": "one iteration is made",
    "display tolerance": "one iteration is made",
    "image resolution": "the points lie far apart",
    "reflectance wavelength": "layers have coefficients, and delays no unit",
}
UNUSED = re.compile("is not used here|is a key of|leave it out")
MOST_TRIED = 4


def texts_of(value):
    return [str(one).lower() if isinstance(one, bool) else str(one)
            for one in (value if isinstance(value, list) else [value])]


def numbers(row, now):
    """Yields numbers near those of the scene, then others."""
    whole = row["type"] == "integer"
    near = [[number + 1 if whole else 1.3 * number + 0.01 for number in now],
            [number - 1 if whole else 0.7 * number for number in now],
            [3 * number for number in now], now[:-1]]
    singles = [[number] for number in ((1, 2, 3, 10) if whole else (1, 0.5, 2, 0.1, 10))]
    lists = [[0.05 + 0.1 * i for i in range(count)] for count in (2, 3, 4, 6)]
    return [*filter(None, near), *singles, *(lists if row["list"] else [])]


def candidates(row, now):
    """Yields other values of a key, as texts."""
    if row["words"]:
        return [[word] for word in row["words"]]
    if row["type"] == "switch":
        return [["false" if now == ["true"] else "true"]]
    if row["type"] == "text":
        return [["1.5+0.2i"], ["1.4"], ["sensors.csv"], ["layers.csv"], ["blobs.csv"]]
    read = int if row["type"] == "integer" else float
    return [[str(read(number)) for number in values] for values in numbers(row, [read(text) for text in now])]


def is_checked(row, *contexts):
    excused = {row["name"], *(f"{context} {row['name']}" for context in contexts)} & WITHOUT_EFFECT.keys()
    return row["in_scene_files"] and not row["effort"] and not excused


class UsedKeys(ProgramTest):
    def setUp(self):
        super().setUp()
        for name, text in FILES.items():
            self.write(name, text)
        told = subprocess.run([PROGRAM, "keys", "json"], check=True, capture_output=True).stdout
        self.rows = {name: one["keys"] for name, one in json.loads(told)["subcommands"].items()}
        self.call("solve", **RUNS["motif"][1], out="motif.h5")

    def try_call(self, subcommand, keys, *words):
        return subprocess.run([PROGRAM, subcommand, *flags(keys), *words], cwd=self.folder,
                              capture_output=True, text=True, timeout=600)

    def result(self, subcommand, keys):
        """Returns the result, or None if the run fails."""
        out = self.folder / ("new.csv" if subcommand == "place" else "new.h5")
        out.unlink(missing_ok=True)
        done = self.try_call(subcommand, {**keys, "out": out})
        if done.returncode not in (0, 3):
            return None
        if subcommand == "place":
            return out.read_text()
        return {name: bits_of(values) for name, values in datasets(out).items()}

    def accepted(self, subcommand, scene, row):
        """Yields the scene with other values of the key that the program accepts as another scene."""
        config = self.try_call(subcommand, scene, "--print-config").stdout
        default = row["default"]
        now = texts_of(scene[row["name"]]) if row["name"] in scene else default
        for texts in candidates(row, now):
            value = texts[0] == "true" if row["type"] == "switch" else texts
            changed = {**scene, row["name"]: value}
            done = self.try_call(subcommand, changed, "--print-config")
            if done.returncode == 0 and done.stdout != config:
                yield changed
            elif UNUSED.search(done.stderr):
                return

    def has_effect(self, subcommand, scene, before, row):
        """Returns whether the key has an effect; a rejection is one."""
        tried = 0
        for changed in self.accepted(subcommand, scene, row):
            if self.result(subcommand, changed) != before:
                return True
            tried += 1
            if tried == MOST_TRIED:
                break
        return tried == 0

    def test_each_scene(self):
        for name, (subcommand, keys, *_) in RUNS.items():
            if subcommand not in self.rows or subcommand == "merge" or not name.startswith(PREFIXES):
                continue
            scene = {key: value for key, value in {**cost(subcommand, keys), **keys}.items() if value is not None}
            before = self.result(subcommand, scene)
            rows = [row for row in self.rows[subcommand] if is_checked(row, subcommand, name)]
            for row in {row["name"]: row for row in rows}.values():
                with self.subTest(scene=name, key=row["name"]):
                    self.assertTrue(self.has_effect(subcommand, scene, before, row))


PREFIXES = tuple(sys.argv[1:]) or ""

if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
