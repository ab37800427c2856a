"""Keys and files of scattering media that render rejects, in one line each."""

import unittest

import h5py
import numpy as np

from renders import AREA, BEAM, BOX, CAMERA, FIBRE, FOG, RenderTest, write_density


class Refused(RenderTest):
    GOOD = {**BOX, **BEAM, **FOG, **AREA, "samples": 100}

    def refuse(self, *words, **keys):
        """Checks one line that contains the words, status 2, and nothing written."""
        before = self.listing()
        done = self.call("render", status=2, **{"out": "bad.h5", **self.GOOD, **keys})
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(str(word), done.stderr)
        self.assertEqual(self.listing(), before)

    def test_the_scene_itself_is_good(self):
        self.render(**self.GOOD)

    def test_stages(self):
        self.refuse("stage is not given", "boundary", stage_box=None)
        self.refuse("stage is not given", "boundary", stage_box=None, **FIBRE)
        self.refuse("give one stage", stage_sphere=[0, 0, 0, 9])
        self.refuse("stage_box = 1 1 1 0 0 0", stage_box=[1, 1, 1, 0, 0, 0])
        self.refuse("stage_box", "6 numbers", stage_box=[1, 1, 1])
        self.refuse("stage_sphere, radius = 0", stage_box=None, stage_sphere=[0, 0, 0, 0])
        self.refuse("body", "inside of the stage", body_sphere=[0, 0, 2, 1.5])
        self.refuse("give one body", body_sphere=[0, 0, 2, 0.5], body_box=[0, 0, 1, 0.1, 0.1, 2])
        self.refuse("body_sphere, radius = -1", body_sphere=[0, 0, 2, -1])
        self.refuse("index_around", "a body", index_around=1.3)
        self.refuse("index_around = 0", index_around=0, body_sphere=[0, 0, 2, 0.5])
        self.refuse("body_mu_s", "a body", body_mu_s=1)
        self.refuse("max_length = 0", max_length=0, **FIBRE)
        self.refuse("max_length", "is a key of", max_length=9)
        self.refuse("step = -1", step=-1, **FIBRE)
        self.refuse("step = 1e-09", "at least", step=1e-9, **FIBRE)
        self.refuse("step = 7", "the field varies over 2", step=7, **FIBRE)
        self.refuse("step", "is a key of", step=0.1)
        self.refuse("length_unit = 0", length_unit=0)

    def test_gradients(self):
        curved = {**FIBRE, "gradient": True, "method": "forward"}
        self.refuse("gradient", "method = forward", **{**curved, "method": "light"})
        self.refuse("gradient", "method = forward", gradient=True)
        self.refuse("gradient", "must have a medium", **{**curved, "mu_s": None, "mu_a": None, "phase": None, "g": None})
        self.refuse("gradient", "bodies", ball=[0, 0, 2, 0.5, 1.5, 0, 0, 0], **curved)
        write_density(self.folder / "cloud.h5", np.ones((3, 3, 3)), origin=[-1, -1, 0], spacing=[1, 1, 2])
        self.refuse("gradient", "uniform", density="cloud.h5", **curved)

    def test_gradients_by_the_field(self):
        disk = {"sensor": "radial", "radii": [0.3], "sensor_size": None, "pixels": None}
        curved = {**FIBRE, **disk, "gradient_by": "alpha", "method": "forward"}
        self.refuse("gradient_by", "method = forward", **{**curved, "method": "light"})
        self.refuse("gradient_by = beta", "amplitude", **{**curved, "gradient_by": "beta"})
        self.refuse("gradient_by = mu_s", "index field", **{**curved, "gradient_by": "mu_s"})
        self.refuse("gradient_by = alpha.1", "alpha.0", **{**curved, "gradient_by": "alpha.1"})
        self.refuse("gradient_by = centre", "3 numbers", **{**curved, "gradient_by": "centre"})
        self.refuse("slope", "is a key of", **{**curved, "slope": [0, 0, 1]})
        self.refuse("gradient_by", "bend rays", **{**curved, "field": None, "index": None, "alpha": None})
        self.refuse("gradient_by", "radial or area", **{**curved, "sensor": "polar", "sensor_at": None, "radii": None,
                                                       "sensor_direction": [0, 0, 1], "rings": 4})
        self.refuse("gradient_by", "all directions", acceptance=0.5, **curved)
        self.refuse("gradient_by", "edges of the stage", **{**curved, "radii": [0.95]})
        self.refuse("gradient_by", "bodies", ball=[0, 0, 2, 0.5, 1.5, 0, 0, 0], **curved)
        self.refuse("gradient_by", "a box", **{**curved, "stage_box": None, "stage_sphere": [0, 0, 2, 2]})

    def test_fields(self):
        self.refuse("index", "must be positive", field="linear", slope=[0, 0, -0.5])
        self.refuse("index", "in all of the body", field="linear", slope=[0, 0, -0.5],
                    body_box=[-1, -1, 1, 1, 1, 3])
        self.refuse("index", "positive", **{**FIBRE, "alpha": 2})
        self.refuse("index = 0", index=0)
        self.refuse("luneburg", "rim", field="luneburg", centre=[0, 0, 2],
                    body_sphere=[0, 0, 2, 1.01], stage_box=[-2, -2, 0, 2, 2, 4])
        self.refuse("must be inside of the stage; for luneburg", field="luneburg")
        self.refuse("luneburg in a sum", field=["luneburg", "linear"], centre=[0, 0, 2],
                    slope=[0, 0, 0.01])
        self.refuse("alpha", "is a key of", alpha=1)
        self.refuse("random_phase", "ultrasound", random_phase=True)
        self.refuse("sound_phase", "is a key of", field="ultrasound", amplitude=1e-3, sound_phase=1,
                    sound_wavenumber=1, random_phase=True)
        with h5py.File(self.folder / "small.h5", "w") as file:
            data = file.create_dataset("excess", data=np.zeros((5, 5, 5)))
            data.attrs["origin"], data.attrs["spacing"] = np.array([-1.0, -1, 0]), np.full(3, 0.5)
        self.refuse("grid", "must cover all of the stage", field="grid", grid="small.h5")

    def test_media(self):
        self.refuse("mu_s = -1", "negative", mu_s=-1)
        self.refuse("mu_a = -0.1", "negative", mu_a=-0.1)
        self.refuse("mu_s = nan", mu_s="nan")
        self.refuse("mu_s = 1e+07", "too dense", mu_s=1e7, mu_a=None)
        self.refuse("body_mu_s = 1e+07", "too dense", body_mu_s=1e7, body_sphere=[0, 0, 2, 0.5])
        self.refuse("body_mu_s = -1", body_mu_s=-1, body_sphere=[0, 0, 2, 0.5])
        self.refuse("body_g = 2", body_mu_s=1, body_phase="henyey_greenstein", body_g=2,
                    body_sphere=[0, 0, 2, 0.5])
        self.refuse("phase = schlick", phase="schlick")
        self.refuse("size_parameter is not given", phase="mie", sphere_index="1.33")
        self.refuse("size_parameter = 1e+05", "from 1e-06 to 10000", phase="mie", sphere_index="1.33",
                    size_parameter=1e5)
        for index, why in (("1-1i", "amplify"), ("1", "does not scatter"), ('"x"', "a number such as")):
            self.refuse(f"sphere_index = {index}", why, phase="mie", size_parameter=2,
                        sphere_index=index.strip('"'))
        self.refuse("g = 1", "in (-1, 1)", phase="henyey_greenstein", g=1)
        self.refuse("g", "is a key of", g=0.5)
        self.refuse("phase", "is a key of", mu_s=None, mu_a=None, phase="rayleigh")

    def test_densities(self):
        write_density(self.folder / "flat.h5", np.ones((5, 5)))
        write_density(self.folder / "thin.h5", np.ones((5, 5, 1)))
        write_density(self.folder / "low.h5", np.full((5, 5, 5), -1.0))
        write_density(self.folder / "nan.h5", np.full((5, 5, 5), np.nan))
        write_density(self.folder / "still.h5", np.ones((5, 5, 5)), spacing=np.zeros(3))
        write_density(self.folder / "odd.h5", np.ones((5, 5, 5)), origin=np.zeros(2))
        with h5py.File(self.folder / "empty.h5", "w"):
            pass
        for name, what in (("flat", "axes"), ("thin", ""), ("low", "-1"), ("nan", "nan"),
                           ("still", "spacing"), ("odd", "origin"), ("empty", "density")):
            self.refuse(f"density: {name}.h5", what, density=f"{name}.h5")
        self.refuse("density = absent.h5: no such file", density="absent.h5")
        write_density(self.folder / "far.h5", np.ones((5, 5, 5)), origin=np.array([2.0, 0, 0]))
        self.refuse("density: the grid, from 2 0 0", "outside of the stage", density="far.h5")
        # most of the stage is outside the grid, so that almost all collisions are tentative
        write_density(self.folder / "speck.h5", np.ones((2, 2, 2)),
                      origin=np.array([0, 0, 1.0]), spacing=np.full(3, 1e-3))
        for limit in (None, 2):
            self.refuse("mu_s = 1e+14", "too dense", "tentative", density="speck.h5", mu_s=1e14,
                        max_scatterings=limit)
        self.refuse("body_mu_a = 1e+14", "tentative", body_density="speck.h5", body_mu_a=1e14,
                    body_box=[-0.5, -0.5, 0.5, 0.5, 0.5, 1.5])

    def test_lights(self):
        self.refuse("light is not given", beam_light=None)
        self.refuse("point_light", "4 numbers", point_light=[0, 0, 1])
        self.refuse("point_light, power = 0", point_light=[0, 0, 1, 0])
        self.refuse("point_light = 1e+200", point_light=[0, 0, 1, 1e200])
        self.refuse("point_light, position = 0.25 0 5", "inside the stage",
                    point_light=[0.25, 0, 5, 1])
        self.refuse("beam_light", "8 numbers", beam_light=[0, 0, 0, 0, 0, 1])
        self.refuse("beam_light, direction = 0 0 0", beam_light=[0, 0, 0, 0, 0, 0, 0.1, 1])
        self.refuse("beam_light, radius = 1.1", "inside the stage",
                    beam_light=[0, 0, 0, 0, 0, 1, 1.1, 1])
        self.refuse("beam_light", "into the stage", beam_light=[0, 0, 0, 0, 0, -1, 0.1, 1])
        self.refuse("beam_light, radius = 0", beam_light=[0, 0, 0, 0, 0, 1, 0, 1])
        self.refuse("gaussian_beam, radius = 0.4: the light, a disk of radius 1.2", "inside the stage",
                    gaussian_beam=[0, 0, 0, 0, 0, 1, 0.4, 1])
        self.refuse("fibre_light", "9 numbers", fibre_light=[0, 0, 0, 0, 0, 1, 0.1, 1])
        self.refuse("fibre_light, aperture = 1.1", "at most the index",
                    fibre_light=[0, 0, 0, 0, 0, 1, 0.1, 1.1, 1])
        self.refuse("fibre_light, aperture = 0", fibre_light=[0, 0, 0, 0, 0, 1, 0.1, 0, 1])
        self.refuse("gaussian_fibre, direction = 0 0 -1", "into the stage",
                    gaussian_fibre=[0, 0, 0, 0, 0, -1, 0.1, 0.1, 1])
        self.refuse("face_light", face_light=[0, 0, 1, 0.1, 1])
        self.refuse("face_light, radiance = -1", face_light=[0, 0, 0, 0.1, -1])
        self.refuse("environment = 0", environment=0)
        self.refuse("environment = 1e+200", environment=1e200)

    def test_sensors(self):
        camera = {**{key: None for key in AREA}, **CAMERA}
        directional = {**{key: None for key in AREA}, "sensor": "directional", "pixels": [2, 2]}
        self.refuse("sensor = eye", sensor="eye")
        self.refuse("sensor_at is not given", sensor_at=None)
        self.refuse("sensor_at = 0 0 3", "boundary", sensor_at=[0, 0, 3])
        self.refuse("sensor_size = 3 1:", sensor_size=[3, 1])
        self.refuse("sensor_size = 1", "2 numbers for each: width height", sensor_size=[1])
        self.refuse("sensor_size is not given", sensor_size=None)
        self.refuse("sensor_up", sensor_up=[0, 0, 1])
        self.refuse("acceptance = 2", acceptance=2)
        radial = {**{key: None for key in AREA}, "sensor": "radial", "sensor_at": [0, 0, 4]}
        self.refuse("rings is not given", **radial, sensor_radius=0.5)
        self.refuse("rings = 0", **radial, sensor_radius=0.5, rings=0)
        self.refuse("sensor_radius = 1.1", "within one face", **radial, sensor_radius=1.1, rings=2)
        self.refuse("pixels", **{**radial, "pixels": [2, 2]}, sensor_radius=0.5, rings=2)
        self.refuse("rings", "is a key of", rings=3)
        self.refuse("pixels = 0", pixels=[0, 3])
        self.refuse("pixels = 4", "columns rows", pixels=[4])
        self.refuse("field_of_view", "is a key of", field_of_view=1)
        self.refuse("field_of_view is not given", **{**camera, "field_of_view": None})
        self.refuse("field_of_view = 4", "40deg", **{**camera, "field_of_view": 4})
        self.refuse("sensor_at", "inside the stage", **{**camera, "sensor_at": [0, 0, 5]})
        self.refuse("sensor_up", "must not be parallel", **camera, sensor_up=[0, 0, 1])
        self.refuse("focus_distance", "is a key of", **camera, focus_distance=1)
        self.refuse("focus_distance is not given", **camera, lens_radius=0.1)
        self.refuse("sensor_at", "boundary", **camera, lens_radius=0.1, focus_distance=2)
        self.refuse("half_angle = 0", **directional, half_angle=0)
        self.refuse("sensor_at", "is a key of", **{**directional, "sensor_at": [0, 0, 4]})

    def test_maps(self):
        box = {"map_box": [-1, -1, 0, 1, 1, 4]}
        rings = {"map_cylinder": [0, 0, 0, 0, 0, 4, 1]}
        self.refuse("map_cells is not given", **box)
        self.refuse("map_cells", "x, y and z", **box, map_cells=[2, 3])
        self.refuse("map_cells", "radius and axis", **rings, map_cells=[2, 3, 4])
        self.refuse("map_cells = 0", **box, map_cells=[2, 3, 0])
        self.refuse("map_cells = 2.5e+06", **box, map_cells=[1000, 500, 5])
        self.refuse("map_cells", "is a key of", map_cells=[2, 3, 4])
        self.refuse("map_box, map_cylinder", **box, **rings, map_cells=[2, 3])
        self.refuse("map_box", "low corner first", map_box=[1, 1, 4, -1, -1, 0], map_cells=[2, 3, 4])
        self.refuse("map_box", "outside of the stage", map_box=[1, 1, 4, 2, 2, 5], map_cells=[2, 3, 4])
        self.refuse("map_cylinder", "radius", map_cylinder=[0, 0, 0, 0, 0, 0, 1], map_cells=[2, 3])
        self.refuse("map_cylinder", "outside of the stage", map_cylinder=[0, 0, 9, 0, 0, 8, 1],
                    map_cells=[2, 3])
        none = {"sensor": "none", "sensor_at": None, "sensor_size": None, "pixels": None}
        self.refuse("sensor = none", "map_box", **none)
        self.refuse("sensor = none", "only value", sensor=["none", "area"])
        self.refuse("method = path", "map", **none, **rings, map_cells=[2, 3], method="path")
        self.refuse("pixels", **{**none, "pixels": [2, 2]}, **rings, map_cells=[2, 3])

    def test_bins_and_methods(self):
        self.refuse("path_bins = 1 2", path_bins=[1, 2])
        self.refuse("path_bins = 2 1 5", path_bins=[2, 1, 5])
        self.refuse("path_bins = 1 2 1.5", path_bins=[1, 2, 1.5])
        self.refuse("path_bins = 1 2 1", path_bins=[1, 2, 1])
        self.refuse("pixels x path_bins", path_bins=[1, 2, 90_000], pixels=[10, 10])
        self.refuse("method = magic", method="magic")
        self.refuse("method = photon_map", "is a baseline of `bench error`", method="photon_map")
        self.refuse("photon_radius", "is a baseline of `bench error`", photon_radius=0.1)
        self.refuse("max_scatterings = -1", max_scatterings=-1)
        self.refuse("samples = 0", samples=0)
        self.refuse("target_error", target_error=2)
        self.refuse("mu_z", mu_z=1)
        self.refuse("out is not given", out=None)


if __name__ == "__main__":
    unittest.main()
