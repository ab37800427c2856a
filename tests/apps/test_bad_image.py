"""Rejected pictures and frames: one line, status 2, nothing written."""

import unittest

import numpy as np

from refusing import RefusingTest

SCENE = {"domain": "box", "width": 100, "depth": 20, "scatterer": "hg", "g": 0.9, "optical_depth": 5,
         "object_x": [0, 40, 130], "object_depth": -4000, "camera": [-0.4, 0.4], "pixels": 512,
         "repeats": 2}
DISKS = {**SCENE, "scatterer": "tm", "radius": 0.5, "index": 1.3, "density": 0.05, "g": None,
         "optical_depth": None}


class BadScene(RefusingTest):
    def refused(self, words, scene=None, **keys):
        merged = {**(scene or SCENE), **keys}
        self.assert_refused(words, "image", **{k: v for k, v in merged.items() if v is not None})

    def test_objects_inside(self):
        for z in 0, 1e-9, 10, 20:
            self.refused(["object_depth", "outside of the box"], object_depth=z)
        for z in -0.4, 20.4:  # disks extend this far
            self.refused(["object_depth", "scatterer's radius"], DISKS, object_depth=z)
        self.refused(["camera_depth", "outside of the box"], camera_depth=20, camera=[-50, 50])

    def test_objects_outside_of_the_window(self):
        self.refused(["object_extent", "more than a quarter"], object_x=[0, 40, 1000])
        self.refused(["object_extent", "more than a quarter"], reference_x=3000)
        self.refused(["object_extent = 1000", "more than a quarter"], object_extent=1000)

        self.refused(["object_extent", "more than a quarter"], object_scale=9)
        self.refused(["object_count = 4", "at most 3"], object_count=4)

    def test_numbers(self):
        for bad in "nan", "inf":
            self.refused(["object_x"], object_x=[0, bad])
            self.refused(["object_depth"], object_depth=bad)
            self.refused(["photons"], photons=bad)
        self.refused(["object_brightness"], object_brightness=[1, 0, 1])
        self.refused(["repeats"], repeats=-1)
        self.refused(["average"], average=0)
        self.refused(["average = 2", "not averaged"], average=2, reference_x=20)
        self.refused(["repeats = 0"], repeats=0, method="wave")


    def test_blinking(self):
        subsets = {**SCENE, "object_x": [0, 40, 90], "blinking": "subsets"}
        speckle = {**subsets, "blinking": "speckle"}
        self.refused(["blinking_frames = 1"], subsets, blinking_frames=1)
        self.refused(["lit"], subsets, lit=1.5)
        self.refused(["lit"], speckle, lit=0.6)  # not used
        self.refused(["blinking_frames"], blinking_frames=9)
        self.refused(["sources = 9", "blinking_frames"], subsets, sources=9, blinking_frames=8)
        self.refused(["average = 2", "one medium"], subsets, average=2)
        self.refused(["reference_x", "must not be given with blinking"], subsets, reference_x=10)
        self.refused(["excitation_wavelength"], subsets, excitation_wavelength=0.8)
        self.refused(["excitation_wavelength"], speckle, excitation_wavelength=-1)
        self.refused(["excitation_optical_depth"], speckle, optical_depth=None, mean_free_path=5,
                     excitation_optical_depth=3)
        self.refused(["repeats", "GB"], subsets, blinking_frames=100000, pixels=1 << 20)
        self.refused(["lit = 0"], subsets, lit=0)
        self.refused(["blinking = subsets", "repeats"], subsets, repeats=0)

    def test_so_far_away_that_phases_are_lost(self):
        far = {"object_x": [0, 40], "repeats": 0}
        for depth in -1e18, -1e45, 1e13:
            self.refused(["object_depth", "too far away"], object_depth=depth, **far)
        self.refused(["object_depth", "too far away"], object_depth=-8e12, object_x=[0, 6e10, 1.5e11])
        self.refused(["camera_depth", "too far away"], camera_depth=1e14, camera=[-50, 50])

    def test_nothing_of_the_object_in_the_picture(self):
        self.refused(["reference_x = 300", "object_extent"], reference_x=300, object_extent=50)


class BadFrames(RefusingTest):
    def refused(self, words, text, **keys):
        self.write("frames.csv", text)
        self.assert_refused(words, "recover", frames="frames.csv", **{"points": 3, **keys})

    def frames(self, pixels=200, columns=("a", "b")):
        values = np.random.default_rng(1).exponential(size=(pixels, len(columns)))
        return ",".join(columns) + "\n" + "".join(",".join(map(repr, map(float, row))) + "\n"
                                                  for row in values)

    def test_windows_longer_than_frames(self):
        for longest in 50, 200, 1e9:
            self.refused(["longest", "less than a quarter"], self.frames(), longest=longest)

    def test_empty_frames(self):
        self.refused(["frames.csv"], "")
        self.refused(["frames"], "a\n")
        self.refused(["at least 64"], self.frames(63))
        self.refused(["mean about pixel"], "a\n" + "0\n" * 200)
        self.refused(["mean about pixel"], "a\n" + "-1\n" * 200)

    def test_numbers(self):
        good = self.frames().splitlines()
        for bad in "nan", "inf", "x", "":
            self.refused(["frames.csv", "line 6"],
                         "\n".join(good[:5] + [f"1,{bad}"] + good[5:]) + "\n")
        self.refused(["frames.csv"], "\n".join([*good, "1"]) + "\n")

    def test_sources(self):
        sources = {"recovery": "sources"}
        self.refused(["columns", "at least 2 frames"], self.frames(columns=("a",)), **sources)
        self.refused(["points = 3", "number of frames"], self.frames(), **sources)
        self.refused(["mean is not positive"], "a,b\n" + "0,0\n" * 200, points=2, **sources)
        self.refused(["average"], self.frames(), points=2, average=2, **sources)
        self.refused(["longest", "less than a quarter"], self.frames(), points=2, longest=50,
                     **sources)

    def test_average(self):
        self.refused(["average = 3", "must divide"], self.frames(), average=3)


if __name__ == "__main__":
    unittest.main()
