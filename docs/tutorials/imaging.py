"""Hidden points, seen through fog

Four points behind five mean free paths: the frame is nothing but speckle, but its autocorrelation is that of the object."""

import numpy as np

import flatspeckle as fs

scene = fs.Scene(domain="box", width=4000, depth=20, scatterer="hg", g=0.9, optical_depth=5,
                 object_x=[0, 60, 150, 310], object_depth=-40000, camera=[-0.5, 0.5], pixels=8192, repeats=2)
seen = fs.image(scene)
print("points found, from the first:", np.sort(np.abs(seen.found_x.values), axis=1).round(1))
fs.plots.image(seen).savefig("imaging.png", dpi=150)

# All are found, to a pixel of the camera: mirrored or not, which an autocorrelation cannot tell.
np.testing.assert_array_equal(seen.found_share, 1)
pixel = 1 / abs(seen.frame.attrs["magnification"])
truth = np.array(scene["object_x"]) - scene["object_x"][0]
mirrored = np.sort(truth.max() - truth)
for found in seen.found_x.values:
    places = np.sort(found - found.min())
    assert min(abs(places - truth).max(), abs(places - mirrored).max()) < pixel

# N equal points, each with fully developed speckle: contrast 1/sqrt(N).
np.testing.assert_allclose(seen.gaussian_contrast, 1 / np.sqrt(len(truth)), rtol=1e-6)
