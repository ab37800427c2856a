"""A camera close to the medium

Speckle grains grow with the distance. Beside a lit box they are as fine as waves can be, far from it they are as wide as a
slit of the box's width makes them: wavelength x distance / width (van Cittert and Zernike)."""

import matplotlib.pyplot as plt
import numpy as np

import flatspeckle as fs

fog = fs.Scene(domain="box", width=40, depth=10, scatterer="point", count=62, covariance="full", samples=40_000)


def coherence(distance, across):
    """|C| of the field at (0, z) and (x, z) over the root of their intensities, with its error."""
    seen = fs.covariance(fog, near_sensors={"x": across, "z": np.full_like(across, 10 + distance)})
    c, error = seen.covariance.values[0, :, 0, :], seen.covariance_error.values[0, :, 0, :]
    intensity = np.diag(c).real
    return abs(c[0]) / np.sqrt(intensity[0] * intensity), error[0] / np.sqrt(intensity[0] * intensity)


figure, (close, away) = plt.subplots(1, 2, figsize=(7, 3), sharey=True, layout="constrained")
across = np.linspace(0, 2, 17)
value, error = coherence(1, across)
close.errorbar(across, value, error, marker="o", markersize=3, linewidth=0.8, label="at 1")
close.set(xlabel="separation (wavelengths)", ylabel="correlation of the fields", ylim=(0, 1.05))
for distance in (40, 4000):
    scale = distance / 40  # wavelength x distance / width
    across = np.linspace(0, 2.4 * scale, 13)
    value, error = coherence(distance, across)
    away.errorbar(across / scale, value, error, marker="o", markersize=3, linewidth=0.8, label=f"at {distance}")
x = np.linspace(0, 2.4, 200)
away.plot(x, abs(np.sinc(x)), color="0.5", label="even slit, far away")
away.set(xlabel="separation x width / (wavelength x distance)")
for axis in (close, away):
    axis.legend(title="distance (wavelengths)")
figure.savefig("near_field.png", dpi=150)

# Far away the box is a slit lit nearly evenly: the last curve follows sinc until the edges' fall in brightness tells.
assert abs(value - abs(np.sinc(across / scale)))[:5].max() < 0.1, value

# And there an intensity times its distance is that of a far view.
far = fs.covariance(fog, covariance="intensity", view_angles=[0.0])
near = fs.covariance(fog, covariance="intensity", near_sensors={"x": [0.0], "z": [1e5]})
ratio = float(near.intensity.values[0, 0] * 1e5 / far.intensity.values[0, 0])
error = np.hypot(near.intensity_error / near.intensity, far.intensity_error / far.intensity).max()
assert abs(ratio - 1) < 4 * error + 1e-3, (ratio, error)
