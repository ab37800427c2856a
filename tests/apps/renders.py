"""Shared by tests of render: small scenes, a density file, a call that reads its result."""

import h5py
import numpy as np

from program import DATA, ProgramTest, datasets

COST = ("wall_s", "cpu_s", "state", "trials", "transport")
SCENES = DATA / "scenes"
BOX = {"stage_box": [-1, -1, 0, 1, 1, 4]}
BEAM = {"beam_light": [0, 0, 0, 0, 0, 1, 0.3, 2]}
FOG = {"mu_s": 0.4, "mu_a": 0.1}
AREA = {"sensor": "area", "sensor_at": [0, 0, 4], "sensor_size": [1, 0.8], "pixels": [4, 3]}
CAMERA = {"sensor_at": [0.2, 0, 3.9], "sensor_direction": [0, 0, -1], "field_of_view": 1,
          "pixels": [6, 4]}
NAMES = ["luneburg", "fisheye", "grin_fibre", "waveguide", "glass_ball", "luneburg_pulse", "slab"]
METHODS = ["path", "light", "bidirectional"]
FIBRE = {"field": "parabolic", "index": 1.5, "alpha": 0.5}


def write_density(path, density, **attributes):
    with h5py.File(path, "w") as file:
        data = file.create_dataset("density", data=density)
        data.attrs["origin"] = attributes.get("origin", np.array([-1.0, -1, 0]))
        data.attrs["spacing"] = attributes.get("spacing", np.array([0.5, 0.5, 1]))


class RenderTest(ProgramTest):
    def render(self, name="render.h5", **keys):
        """Returns the datasets of a run by a given method, as choosing one costs more than these pictures. In
        shipped scenes (config) the program chooses."""
        choice = "config" in keys or keys.get("sensor") == "none"
        keys = {"samples": 4000, "threads": 2, "method": None if choice else "bidirectional", **keys}
        status = 3 if "target_error" in keys else 0
        self.output = self.call("render", **keys, out=name, status=status).stdout
        return datasets(self.folder / name)

    def scene(self, scene, **keys):
        return self.render(config=SCENES / f"render_{scene}.toml", **keys)

    def assert_same(self, first, second):
        """Checks that all but the costs are equal, which a resumed run counts in another way."""
        first, second = (datasets(self.folder / name, COST) for name in (first, second))
        self.assertEqual(first.keys(), second.keys())
        for name, values in first.items():
            self.assertEqual(np.asarray(values).tobytes(), np.asarray(second[name]).tobytes(), name)

    def assert_within(self, value, error, expected, count=4):
        np.testing.assert_array_less(np.abs(value - expected), count * error + 1e-12)
