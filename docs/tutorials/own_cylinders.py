"""Your own cylinders: Monte Carlo against the exact solution

Fifty glass fibres at places that you know. The wave equation solved for just these places gives one speckle pattern; Monte
Carlo gives the mean intensity over all such boxes. They are not equal, but of a speckle pattern the intensity over its
mean has mean 1 and contrast 1, each to 1 over the root of the number of independent grains among the views. Then an
ensemble of placements, whose mean intensity is that of Monte Carlo view by view."""

import numpy as np

import flatspeckle as fs

radius = 1 / (2 * np.pi)
fibres = fs.Scene(domain="box", width=20, depth=10, scatterer="tm", radius=radius, index=1.5)
random, places = np.random.default_rng(1), []  # in their place yours: np.loadtxt("mine.csv", delimiter=",", skiprows=1)
while len(places) < 50:
    place = random.uniform([-10, 0], [10, 10])
    if all(np.hypot(*(place - other)) > 2.1 * radius for other in places):
        places.append(place)

# Several lights, far apart, see as many independent patterns.
seen = {"light_angles": [0, -0.4, -0.8, -1.2], "view_angles": np.linspace(0.3, 3.1, 121)}
own = fs.validate(fibres, placement=np.array(places), **seen, samples=20_000)
print(f"|u|^2 over the mean intensity: mean {float(own.mean_ratio):.3f} +- {float(own.mean_ratio_error):.2g}, contrast "
      f"{float(own.ratio_contrast):.3f} +- {float(own.ratio_contrast_error):.2g}, of {float(own.independent_grains):.0f} grains")
fs.plots.validation(own).savefig("own_cylinders.png", dpi=150)

# Both are 1, within four errors (and, of the mean, what Monte Carlo neglects).
assert abs(own.mean_ratio - 1) < 4 * own.mean_ratio_error + own.attrs["bias_allowance"]
assert abs(own.ratio_contrast - 1) < 4 * own.ratio_contrast_error

# The same by hand: `solve` knows the places, `covariance` how many there are.
one = fs.solve(placement=np.array(places), scatterer="tm", radius=radius, index=1.5, **seen)
mean = fs.covariance(fibres, count=50, **seen, samples=20_000)
np.testing.assert_allclose(np.mean(abs(one.far_field)**2 / mean.intensity), own.mean_ratio, rtol=0.03)

# Many placements, drawn anew for each. View 0 is in the light's own direction: a fixed number of fibres takes a
# fluctuation of the coherent field away there that Monte Carlo has; such entries are marked `forward` and not counted.
both = fs.validate(fibres, count=50, view_angles=[0, 0.4, 1.0, np.pi - 1, np.pi], wave_samples=400, samples=100_000)
mc, exact = fs.group(both, "mc"), fs.group(both, "wave")
for angle, ours, theirs in zip(both.view_angle.values, mc.intensity.values[0], exact.intensity.values[0]):
    print(f"view {angle:.2f} rad: {ours:.3f} by Monte Carlo, {theirs:.3f} exactly")
print(f"RMS difference but for view 0: {100 * float(both.rms_difference):.1f} %, of which errors "
      f"{100 * float(both.rms_difference_error):.1f} %")
assert list(both.forward) == [1, 0, 0, 0, 0] and both.share_within == 1
assert mc.intensity[0, 0] > 2 * exact.intensity[0, 0]

# A cylinder of k a = 1 and index 1.5: its cross section and mean cosine in closed form (Mie's series in the plane).
assert abs(both.attrs["sigma_s"] - 0.30014) < 5e-5 and abs(both.attrs["g"] - 0.3202) < 5e-4
