"""A lens designed from what it should do

Light from any direction is to meet at the point of the rim opposite. Nobody tells the search that Luneburg's lens,
n^2 = 2 - r^2, does that; rays through what it finds do."""

import matplotlib.pyplot as plt
import numpy as np

import flatspeckle as fs

lens = fs.design(design="radial", coefficients=8, directions=1, rays_per_direction=100)
rays = fs.trace(field=["radial"], radial_spline=lens, light="line", origin=[0, 0, -1.2], beam_radius=0.9, ray_count=15,
                stop_plane=[0, 0, 1.0, 0, 0, 1], max_length=6, path_points=101)
fs.plots.design(lens).savefig("lens.png", dpi=150)

# The index against Luneburg's, and where rays arrive: at (0, 0, 1).
miss = np.hypot(rays["exit/x"], rays["exit/y"])
print(f"rays miss the focus by at most {float(miss.max()):.1e} of the radius")
assert float(miss.max()) < 1e-4
# From the plane z = -1.2 the optical path to the focus is 0.2 + 1 + pi/2 for every ray (conventions, C27).
np.testing.assert_allclose(rays.optical_path, 0.2 + 1 + np.pi / 2, atol=1e-4)
