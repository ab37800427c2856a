"""Points recovered from the user's frames."""

import unittest

import numpy as np

from program import ProgramTest, datasets

PLACES = {"a": [0, 17, 60], "b": [0, 40, 51]}


def frame(places, random, pixels=6000, background=0.0):
    """Returns a frame of points with one shifted speckle pattern, under a smooth envelope."""
    u = random.normal(size=(2, pixels + 100))
    speckle = (u**2).sum(axis=0) / 2
    light = sum(speckle[x:x + pixels] for x in places) / len(places)
    return (light + background) * (1 + 0.5 * np.sin(np.arange(pixels) / 2000))


class Recover(ProgramTest):
    def setUp(self):
        super().setUp()
        random = np.random.default_rng(1)
        columns = [frame(places, random) for places in PLACES.values()]
        np.savetxt(self.folder / "frames.csv", np.transpose(columns), delimiter=",",
                   header=",".join(PLACES), comments="")

    def test_points(self):
        output = self.call("recover", frames="frames.csv", points=3, longest=80, out="r.h5").stdout
        found = datasets(self.folder / "r.h5")
        for number, (name, places) in enumerate(PLACES.items()):
            self.assertEqual(found["frame_name"][number].decode(), name)
            x = found["found_x"][number]
            mirrored = sorted(x[-1] - x)
            self.assertTrue(any(np.allclose(places, each, atol=0.3) for each in (x, mirrored)), x)
            self.assertGreater(found["explained"][number], 0.95)
            self.assertAlmostEqual(found["contrast"][number], 3**-0.5, delta=0.05)
        self.assertIn("points (pixels; mirrored or not)", output)

    def test_reference(self):
        """A reference gives the object neither shifted nor mirrored."""
        random = np.random.default_rng(2)
        speckle = random.exponential(size=6100)
        columns = [sum(b * speckle[50 - x:6050 - x] for x, b in points.items())
                   for points in ({-20: 1, 5: 3}, {30: 2, 12: 3})]
        np.savetxt(self.folder / "two.csv", np.transpose(columns), delimiter=",", header="a,b",
                   comments="")
        np.savetxt(self.folder / "one.csv", speckle[50:6050], header="speckle", comments="")
        for extra in {}, {"deconvolution": "richardson_lucy", "iterations": 30}:
            self.call("recover", frames="two.csv", reference="one.csv", points=2, longest=60,
                      out="r.h5", **extra)
            found = datasets(self.folder / "r.h5")
            for number, (bright, dim) in enumerate(((5, -20), (12, 30))):
                shift, picture = found["shift"], found["picture"][number]
                self.assertEqual(shift[picture.argmax()], bright)
                self.assertEqual(shift[np.where(abs(shift - bright) > 4, picture, 0).argmax()], dim)
        self.assertEqual(found["residual"].shape, (2, 30))
        (self.folder / "r.h5").unlink()
        both = {"frames": "two.csv", "points": 2, "longest": 60}
        self.write("short.csv", "a\n1\n2\n")
        self.refused("reference: has 2 pixels, the frames have 6000", **both,
                     reference="short.csv")
        np.savetxt(self.folder / "three.csv", np.ones((6000, 3)), delimiter=",", header="a,b,c",
                   comments="")
        self.refused("reference: has 3 columns", **both, reference="three.csv")
        self.refused("deconvolution = richardson_lucy: is not used here", **both,
                     deconvolution="richardson_lucy")

    def test_phases(self):
        """The largest values of the retrieved picture are at the points."""
        self.call("recover", frames="frames.csv", points=3, longest=80, out="r.h5",
                  recovery="phases", starts=30)
        found = datasets(self.folder / "r.h5")
        self.assertEqual(found["phase_residual"].shape, (2, 400))
        for number, places in enumerate(PLACES.values()):
            picture = found["phased_picture"][number]
            self.assertAlmostEqual(picture.sum(), 1)
            at = sorted(np.argsort(picture)[-3:])
            at = [x - at[0] for x in at]
            self.assertIn(places, [at, sorted(at[-1] - x for x in at)])
        (self.folder / "r.h5").unlink()
        self.refused("starts = 3: is a key of phase retrieval only", frames="frames.csv", points=3, longest=80, starts=3)

    def refused(self, words, status=2, **keys):
        line = self.call("recover", **keys, out="r.h5", status=status).stderr
        self.assertIn(words, line)
        self.assertEqual(line.count("\n"), 1)
        self.assertFalse((self.folder / "r.h5").exists())

    def test_bad_input(self):
        self.refused("frames", points=3)
        self.refused("points", frames="frames.csv")
        self.refused("points", frames="frames.csv", points=1)
        self.refused("longest = 1500: must be less than a quarter", frames="frames.csv", points=3,
                     longest=1500)
        self.refused("read_noise", frames="frames.csv", points=3, read_noise=1)
        self.write("nan.csv", "a\n1\nnan\n2\n")
        self.refused("nan.csv", frames="nan.csv", points=3)
        self.write("dark.csv", "a\n" + "0\n" * 100)
        self.refused("mean about pixel 0 is not positive", frames="dark.csv", points=3)
        self.write("short.csv", "a\n1\n2\n")
        self.refused("at least 64", frames="short.csv", points=3)
        self.refused("no.csv", frames="no.csv", points=3)


if __name__ == "__main__":
    unittest.main()
