"""MCX scenes: published energy balances, layers against reflectance, labelled voxels, and what has no counterpart."""

import copy
import json
import re
import struct
import unittest

import h5py
import numpy as np

from program import DATA, WHOLE
from refusing import RefusingTest

TISSUE = {"mua": 0.005, "mus": 1, "g": 0.01, "n": 1.37}
AIR = {"mua": 0, "mus": 0, "g": 1, "n": 1}


def cube(*media, mismatch=False, shapes=(), source=None, **domain):
    """Returns a cube of 60 mm, lit by a pencil beam."""
    scene = {"Session": {"ID": "cube", "Photons": 4000, "RNGSeed": 7, "DoMismatch": mismatch},
             "Domain": {"Dim": [60, 60, 60], "OriginType": 1, "Media": [AIR, *(media or [TISSUE])], **domain},
             "Shapes": [{"Grid": {"Tag": 1, "Size": [60, 60, 60]}}, *shapes],
             "Optode": {"Source": source or {"Type": "pencil", "Pos": [29, 29, 0], "Dir": [0, 0, 1]}}}
    return copy.deepcopy(scene)


class Mcx(RefusingTest):
    def write_scene(self, scene, name="scene.json"):
        (self.folder / name).write_text(json.dumps(scene))
        return name

    def absorbed(self, scene, samples=4000):
        """Returns the absorbed fraction of the light and its error."""
        self.call("render", config=self.write_scene(scene), samples=samples, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            part = "energy/absorbed_body" if "energy/absorbed_body" in file else "energy/absorbed_stage"
            return file[part][()], file[f"{part}_error"][()]

    def test_published_absorption(self):
        """MCX's own tests require 17 % in a cube, 27 % with reflections at its faces, and 10 or 11 % with a ball in it."""
        ball = {"Sphere": {"Tag": 2, "O": [30, 30, 30], "R": 10}}
        scenes = [(cube(), 0.170, 0.180), (cube(mismatch=True), 0.270, 0.280),
                  (cube({**TISSUE, "mua": 0.002}, {"mua": 0.05, "mus": 5, "g": 0.9, "n": 1.37}, shapes=[ball],
                        source={"Type": "pencil", "Pos": [29.5, 29.5, 0], "Dir": [0, 0, 1, 0]}), 0.10, 0.12)]
        for scene, low, high in scenes if WHOLE else scenes[:2]:
            samples = 200_000 if WHOLE else 2000
            value, error = self.absorbed(scene, samples)
            spread = 0.3 / samples**0.5  # of the absorbed fractions of single paths
            with self.subTest(low=low, value=value, error=error):
                self.assertTrue(low - 3 * spread < value < high + 3 * spread)

    def test_absorbed_in_each_label(self):
        """Powers of labels are the sums of the map over their voxels, and together the absorbed power."""
        ball = {"Sphere": {"Tag": 2, "O": [30, 30, 30], "R": 10}}
        scene = cube({**TISSUE, "mua": 0.002}, {"mua": 0.05, "mus": 5, "g": 0.9, "n": 1.37}, shapes=[ball])
        said = self.call("render", config=self.write_scene(scene), samples=2000, out="x.h5").stdout
        middles = np.arange(60) + 0.5 - 30
        inside = sum(np.meshgrid(*3 * [middles**2], indexing="ij")) <= 100
        with h5py.File(self.folder / "x.h5") as file:
            cells, powers = file["map/absorbed"][()], file["map/label_absorbed"][()]
            np.testing.assert_allclose(powers, [0, cells[~inside].sum(), cells[inside].sum()], rtol=1e-6)
            self.assertLess(abs(powers.sum() - file["energy/absorbed_stage"][()]), 4 * file["energy/absorbed_stage_error"][()])
        for label in (1, 2):
            self.assertRegex(said, rf"absorbed in {label} +{powers[label]:.6g} ")

    def test_layers_against_reflectance(self):
        """Power on two disks beside a beam in layers under air, from voxels and without random numbers."""
        (self.folder / "layers.csv").write_text("thickness,mu_s,mu_a,g\n3,9,0.018,0.8\n1000,6,0.036,0.8\n")
        self.call("reflectance", layers="layers.csv", distances=[5, 10], detector_radius=2, medium_index=1.4, out="exact.h5")
        self.call("render", config=DATA / "scenes" / "mcx_layers.json", samples=2_000_000 if WHOLE else 20_000, out="paths.h5")
        with h5py.File(self.folder / "exact.h5") as exact, h5py.File(self.folder / "paths.h5") as paths:
            entered = 1 - (0.4 / 2.4)**2  # the beam of the MCX scene starts within the tissue
            for number, power in enumerate(exact["detected_power"][()] / entered, 1):
                total, error = (paths[f"sensors/{number}/total{name}"][()] for name in ("", "_error"))
                with self.subTest(number=number, total=total, error=error, power=power):
                    self.assertLess(abs(total - power), 4 * error + 0.004 * power)
                    self.assertLess(error, 0.2 * power if number == 1 else power)

    def test_translation(self):
        """The keys of a scene, and lengths in its unit."""
        scene = cube(LengthUnit=0.5, source={"Type": "disk", "Pos": [30, 30, 0], "Dir": [0, 0, 1, 0], "Param1": [4, 0, 0, 0]})
        scene["Domain"]["OriginType"] = 0
        scene["Forward"] = {"T0": 0, "T1": 1e-9, "Dt": 1e-10}
        scene["Optode"]["Source"]["Pos"] = [31, 31, 1]
        scene["Optode"]["Detector"] = [{"Pos": [31, 21, 1], "R": 2}]
        shown = self.call("render", "--print-config", config=self.write_scene(scene)).stdout
        for line in ("beam_light = [15, 15, 0, 0, 0, 1, 2, 1]", "sensor_at = [15, 10, 0]", "sensor_radius = [1]", "seed = 7",
                     "label_media = [0, 0, 1, 1, 0.005, 0.01]", "stage_box = [0, 0, 0, 30, 30, 30]", "samples = 4000"):
            self.assertIn(line, shown)
        last, count = map(float, re.search(r"path_bins = \[0, ([0-9.]+), ([0-9]+)\]", shown).groups())
        self.assertAlmostEqual(last, 299.792458)
        self.assertEqual(count, 10)

    def test_no_counterpart(self):
        """Members without counterpart are named."""
        ball = {"Sphere": {"Tag": 2, "O": [30, 30, 30], "R": 15}}
        changes = [
            (lambda s: s.update(Extra=1), ["Extra: has no counterpart"]),
            (lambda s: s["Session"].update(BCFlags="aarraa"), ["Session.BCFlags: has no counterpart"]),
            (lambda s: s["Domain"].update(VolumeFile="x.bin"), ["Domain.VolumeFile: has no counterpart"]),
            (lambda s: s["Optode"]["Source"].update(Type="planar"), ["Optode.Source.Type", "pencil, isotropic, disk"]),
            (lambda s: s["Optode"].update(Detector=[{"Pos": [30, 30, 30], "R": 1}]), ["Optode.Detector[0].Pos", "on a face"]),
            (lambda s: s["Domain"]["Media"].pop(), ["label_media", "6 numbers"]),
            (lambda s: s["Domain"]["Media"][1].pop("n"), ["Domain.Media[1].n: is missing"]),
            (lambda s: (s["Shapes"].append(ball), s["Domain"]["Media"].append({**TISSUE, "n": 1})),
             ["Domain.Media[2].n = 1", "same in all voxels: 1.37"]),
            (lambda s: s["Shapes"].append({"Subgrid": {}}), ["Shapes[1].Subgrid: has no counterpart"]),
            (lambda s: s.update(Shapes={"_ArraySize_": [1]}), ["Shapes", "HDF5 or NIfTI-1"])]
        changes.append((lambda s: (s.pop("Shapes"), s["Domain"].update(VolumeFile="x.bin")),
                        ["Domain.VolumeFile", "labels = FILE", "label_media"]))
        for change, words in changes:
            scene = cube()
            change(scene)
            self.assert_refused(words, "render", config=self.write_scene(scene))
        (self.folder / "scene.json").write_text('{"Session": ')
        self.assert_refused(["scene.json", "JSON"], "render", config="scene.json")
        self.assert_refused(["key of render"], "covariance", config=self.write_scene(cube()))

    def test_voxel_files(self):
        """Labels from HDF5 and NIfTI-1 give the same result to the last bit; bad numbers are rejected."""
        labels = np.random.default_rng(1).integers(0, 3, (4, 5, 6), dtype=np.uint8)
        with h5py.File(self.folder / "labels.h5", "w") as file:
            data = file.create_dataset("labels", data=labels)
            data.attrs["origin"], data.attrs["spacing"] = np.zeros(3), np.array([0.5, 1, 2])
        header = bytearray(352)
        struct.pack_into("<i", header, 0, 348)
        struct.pack_into("<8h", header, 40, 3, 4, 5, 6, 1, 1, 1, 1)
        struct.pack_into("<h", header, 70, 2)
        struct.pack_into("<4f", header, 76, 1, 0.5, 1, 2)
        struct.pack_into("<f", header, 108, 352)
        header[344:348] = b"n+1\0"
        (self.folder / "labels.nii").write_bytes(bytes(header) + labels.tobytes(order="F"))
        keys = {"stage_box": [0, 0, 0, 2, 5, 12], "beam_light": [1, 2.5, 0, 0, 0, 1, 0.5, 1], "sensor": "area", "pixels": [4, 4],
                "sensor_at": [1, 2.5, 12], "sensor_size": [2, 5], "samples": 2000, "method": "forward",
                "label_media": [0, 0.1, 0, 1, 0.2, 0.5, 3, 0, 0]}
        images = []
        for name in ("labels.h5", "labels.nii"):
            self.call("render", labels=name, **keys, out="x.h5")
            with h5py.File(self.folder / "x.h5") as file:
                images.append(file["image"][()])
        np.testing.assert_array_equal(*images)
        self.assert_refused(["label_media", "9 numbers"], "render", **{**keys, "label_media": [0, 0, 0]}, labels="labels.h5")
        self.assert_refused(["label_media"], "render", **{**keys, "label_media": None}, labels="labels.h5")
        self.assert_refused(["mu_s"], "render", **keys, labels="labels.h5", mu_s=1)
        self.assert_refused(["label_media"], "render", **keys, mu_s=1)
        self.assert_refused(["labels", "none.nii"], "render", **keys, labels="none.nii")


if __name__ == "__main__":
    unittest.main()
