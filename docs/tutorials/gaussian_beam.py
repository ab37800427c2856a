"""A Gaussian beam that is moved

A beam moved sideways lights other scatterers: how far until the speckle is another one? As long as light is scattered once,
half of what the beams share: C_E = exp(-s^2 / (2 waist^2)). Multiple scattering changes little while it spreads the light by
less than the waist."""

import matplotlib.pyplot as plt
import numpy as np

import flatspeckle as fs

waist = 15.0
steps = np.linspace(0, 45, 10)
box = fs.Scene(domain="box", width=200, depth=5, scatterer="point", beam_waist=waist, covariance="translation",
               shifts=steps, view_angles=0.3)
thin = fs.covariance(box, optical_depth=0.02, samples=100_000)
thick = fs.covariance(box, optical_depth=2, samples=40_000)

figure, axis = plt.subplots(figsize=(5, 3.2), layout="constrained")
for name, curve in (("0.02", thin), ("2", thick)):
    axis.errorbar(steps, curve.field_correlation, curve.field_correlation_error, marker="o", markersize=3, linewidth=0.8, label=name)
s = np.linspace(0, 45, 200)
axis.plot(s, np.exp(-s**2 / (2 * waist**2)), color="0.5", label="shared light")
axis.set(xlabel="the beam has moved by (wavelengths)", ylabel="field correlation $C_E$", ylim=(0, 1.05))
axis.legend(title="optical depth")
figure.savefig("gaussian_beam.png", dpi=150)

pull = (thin.field_correlation - np.exp(-steps**2 / (2 * waist**2)))[1:] / thin.field_correlation_error[1:]
assert abs(pull).max() < 4 or abs(thin.field_correlation - np.exp(-steps**2 / (2 * waist**2))).max() < 0.01, pull.values
