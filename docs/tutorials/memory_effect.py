"""Memory effect of tissue, transmitted and reflected

How far may light be tilted before its speckle is another one? A slab of tissue-like scatterers, g = 0.9, ten mean
free paths thick (one transport mean free path), seen behind the slab and in front of it."""

import matplotlib.pyplot as plt
import numpy as np

import flatspeckle as fs

k = 2 * np.pi  # lengths are in wavelengths
tissue = fs.Scene(domain="slab", depth=1000, scatterer="hg", g=0.9, optical_depth=10, covariance="memory_effect",
                  method="mc", samples=60_000)
behind = fs.covariance(tissue, view_angles=0, tilts=np.linspace(0, 1e-3, 9))
before = fs.covariance(tissue, view_angles=np.pi - 0.2, tilts=np.linspace(0, 5e-4, 11))
for name, curve in (("transmitted", behind), ("reflected", before)):
    print(f"{name}: the correlation C_I falls to 1/2 at q L = {float(curve.memory_effect_range):.2f}"
          f" +- {float(curve.memory_effect_range_error):.2f}")

figure, axis = plt.subplots(figsize=(5, 3.2), layout="constrained")
for name, curve in (("transmitted", behind), ("reflected", before)):
    q_depth = k * np.sin(curve.tilt) * tissue["depth"]
    axis.errorbar(q_depth, curve.field_correlation**2, 2 * curve.field_correlation * curve.field_correlation_error,
                  marker="o", markersize=3, linewidth=0.8, label=name)

# Diffusion theory of thick slabs without absorption: C_E = qL / sinh(qL). It knows nothing of g = 0.9 at this depth.
x = np.linspace(1e-6, 6, 100)
axis.plot(x, (x / np.sinh(x))**2, color="0.5", label=r"$(qL / \sinh qL)^2$, thick slabs")
axis.set(xlabel="q L", ylabel="intensity correlation $C_I$", ylim=(0, 1.05))
axis.legend()
figure.savefig("memory_effect.png", dpi=150)

# A thick isotropic slab does come near to theory, with the distances z0 = 0.818 l* to where light would be zero
# and l* to where it is first scattered: by transport, without noise.
optical_depth = 40
thick = fs.covariance(tissue, g=0, optical_depth=optical_depth, method="transport", samples=None, view_angles=0,
                      tilts=np.linspace(0, 3e-4, 9))
L, z0, zs = 1, 0.818 / optical_depth, 1 / optical_depth
q = k * np.sin(thick.tilt.values[1:]) * 1000
theory = np.sinh(q * z0) * np.sinh(q * (zs + z0)) / (q * np.sinh(q * (L + 2 * z0)))
theory /= z0 * (zs + z0) / (L + 2 * z0)
np.testing.assert_allclose(thick.field_correlation[1:], theory, atol=0.02)

# And chance agrees with transport: every tilt within four standard errors.
exact = fs.covariance(tissue, method="transport", samples=None, view_angles=0, tilts=behind.tilt)
pull = (behind.field_correlation - exact.field_correlation)[1:] / behind.field_correlation_error[1:]
assert abs(pull).max() < 4, pull.values
