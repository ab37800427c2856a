"""Keys that a scene accepts have an effect: for each scene of format_scenes.py and each key accepted there,
some other value changes the result. Words restrict it to scenes whose names begin with one of them."""

import json
import re
import subprocess
import sys
import unittest

from format_scenes import FILES, RUNS, cost
from program import PROGRAM, ProgramTest, bits_of, datasets, flags

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
