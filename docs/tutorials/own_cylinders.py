"""Your own cylinders: Monte Carlo against the exact solution

Glass fibres in a box: what the Monte Carlo method says of their speckle, and what the wave equation says, solved for one
placement of the fibres after another."""

import numpy as np

import flatspeckle as fs

fibres = fs.Scene(domain="box", width=20, depth=10, scatterer="tm", radius=1 / (2 * np.pi), index=1.5, count=67)
both = fs.validate(fibres, view_angles=[0.4, 1.0, np.pi - 1, np.pi], wave_samples=400, samples=200_000)
mc, exact = fs.group(both, "mc"), fs.group(both, "wave")
for angle, ours, theirs in zip(both.view_angle.values, mc.intensity.values[0], exact.intensity.values[0]):
    print(f"view {angle:.2f} rad: {ours:.3f} by Monte Carlo, {theirs:.3f} exactly")
fs.plots.validation(both).savefig("own_cylinders.png", dpi=150)

# A cylinder of k a = 1 and index 1.5: its cross section and mean cosine in closed form (Mie's series in the plane).
assert abs(both.attrs["sigma_s"] - 0.30014) < 5e-5 and abs(both.attrs["g"] - 0.3202) < 5e-4

# Monte Carlo neglects what is of the order of 1/(k mean free path); beside that, four standard errors.
error = np.hypot(mc.intensity_error, exact.intensity_error)
allowed = 4 * error + both.attrs["bias_allowance"] * exact.intensity
assert (abs(mc.intensity - exact.intensity) < allowed).all()
