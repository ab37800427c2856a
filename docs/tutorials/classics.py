"""Four classical curves

The memory effect of a thick slab (Feng et al. 1988, Freund et al. 1988), what forward scattering does to it (Bar et al. 2019),
the cone of coherent backscattering (Akkermans and Montambaux 2007), and diffusing-wave spectroscopy (Pine et al. 1988), each
beside its formula, without chance, by transport."""

import matplotlib.pyplot as plt
import numpy as np

import flatspeckle as fs

k = 2 * np.pi  # lengths are in wavelengths
slab = fs.Scene(domain="slab", depth=1000, scatterer="hg", method="transport")


def thick(x):
    """x / sinh(x), 1 at 0."""
    return np.where(x > 0, x / np.sinh(np.maximum(x, 1e-9)), 1)


figure, axes = plt.subplots(2, 2, figsize=(7, 5.2), layout="constrained")

# The memory effect: C_I = (qL / sinh qL)^2.
deep = fs.covariance(slab, g=0, optical_depth=100, covariance="memory_effect", view_angles=0, q_depths=np.linspace(0, 4, 17))
q_depth = deep.tilt_q * slab["depth"]
axes[0, 0].plot(q_depth, deep.field_correlation**2, "o", markersize=3, label="optical depth 100")
axes[0, 0].plot(q_depth, thick(q_depth.values)**2, color="0.5", label=r"$(qL / \sinh qL)^2$")
axes[0, 0].set(xlabel="q L", ylabel="$C_I$", title="memory effect")
assert abs(deep.field_correlation - thick(q_depth.values)).max() < 0.015

# Forward scattering widens it where the slab is thin against the transport mean free path.
ranges = []
for g in (0, 0.8, 0.9, 0.95):
    curve = fs.covariance(slab, g=g, optical_depth=10, covariance="memory_effect", view_angles=0, q_depths=np.linspace(0, 16, 41))
    axes[0, 1].plot(curve.tilt_q * slab["depth"], curve.field_correlation**2, label=f"g = {g}")
    ranges.append(float(curve.memory_effect_range))
axes[0, 1].set(xlabel="q L", ylabel="$C_I$", title="optical depth 10")
np.testing.assert_allclose(ranges, [1.360, 1.383, 2.587, 7.89], rtol=0.01)  # 2e5 walks each, long ago

# The cone: twice the light in exact backscattering, as wide as 1 / (k l*). In the plane z0 = 0.818 l*.
l = 1000 / 40
angles = np.linspace(0, 0.03, 16)
cone = fs.covariance(slab, g=0, optical_depth=40, view_angles=np.pi - angles)
ladder = fs.covariance(slab, g=0, optical_depth=40, view_angles=np.pi - angles, reversed_paths="no")
crossed = (cone.intensity - ladder.intensity).values[0]
Q = k * np.sin(np.maximum(angles, 1e-6))
bistatic = (1 + (1 - np.exp(-2 * Q * 0.818 * l)) / (Q * l)) / (1 + Q * l)**2
axes[1, 0].plot(1000 * angles, crossed / crossed[0], "o", markersize=3, label="optical depth 40")
axes[1, 0].plot(1000 * angles, bistatic / bistatic[0], color="0.5", label="diffusion, endless depth")
axes[1, 0].set(xlabel="angle from backscattering (mrad)", ylabel="crossed over its peak", title="coherent backscattering")
once = 1 / (4 * np.pi)  # single scattering has no partner: the peak is below 2 by its share
np.testing.assert_allclose(cone.intensity.values[0, 0] / ladder.intensity.values[0, 0],
                           2 - once / ladder.intensity.values[0, 0], rtol=1e-3)

# Diffusing scatterers: g1 = x / sinh(x), x = (L / l*) sqrt(2 dimension k^2 D tau).
delays = np.linspace(0, 2.5e-3, 16)
decay = fs.covariance(slab, g=0, optical_depth=40, view_angles=0, delays=delays)
x = 40 * np.sqrt(4 * delays)
g1 = decay.field_correlation.values.reshape(len(delays), -1)[:, 0]
axes[1, 1].plot(x, g1, "o", markersize=3, label="optical depth 40")
axes[1, 1].plot(x, thick(x), color="0.5", label=r"$x / \sinh x$")
axes[1, 1].set(xlabel=r"$x = (L / l^*) \sqrt{4 k^2 D \tau}$", ylabel="$g_1$", title="diffusing-wave spectroscopy", yscale="log")

for axis in axes.flat:
    axis.legend(fontsize=7)
figure.savefig("classics.png", dpi=150)
