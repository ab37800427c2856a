"""Speckle contrast and flow

A camera that exposes for a time T sees less contrast where scatterers move. Diffusing scatterers blur by their own time
scale; a medium that moves as one whole does not blur at all, but shear does."""

import matplotlib.pyplot as plt
import numpy as np

import flatspeckle as fs

view = 2.5  # backwards
slab = fs.Scene(domain="slab", depth=1000, scatterer="hg", g=0, view_angles=view, method="mc", samples=50_000)
times = np.geomspace(1e-2, 30, 40)
exposures = np.geomspace(0.1, 25, 12)

# One scattering by the angle theta leaves exp(-2 t (1 - cos theta)), t = k^2 D tau: a very thin slab shows that alone.
thin = fs.covariance(slab, optical_depth=1e-4, delays=[0, *times], exposures=exposures)
rate = 2 * (1 - np.cos(view))
decay = np.exp(-rate * times)
np.testing.assert_allclose(thin.field_correlation.squeeze()[1:], decay, atol=1e-3)
x = rate * exposures
closed = (np.expm1(-2 * x) + 2 * x) / (2 * x**2)  # its squared contrast
np.testing.assert_allclose(thin.squared_contrast.squeeze(), closed, rtol=0.02)  # of sums over these delays

# Long paths lose correlation sooner: the same exposures behind ten mean free paths.
deep = fs.covariance(slab, optical_depth=10, delays=[0, *times], exposures=exposures)
assert (deep.squared_contrast < thin.squared_contrast).all()

# A medium that moves as a whole only changes the field's phase, whatever the paths; a flow that grows with depth decorrelates.
flow = {"optical_depth": 10, "delays": np.linspace(0, 1, 9), "diffusion": 0}
whole = fs.covariance(slab, velocity=[0.3, 0], **flow)
sheared = fs.covariance(slab, velocity=[0, 0], shear=1e-3, **flow)
np.testing.assert_allclose(whole.field_correlation, 1, atol=1e-9)
assert float(sheared.field_correlation[-1].squeeze()) < 0.9

figure, axes = plt.subplots(1, 2, figsize=(7, 3), layout="constrained")
axes[0].loglog(exposures, closed, color="0.5", label="one scattering, closed form")
axes[0].loglog(exposures, thin.squared_contrast.squeeze(), "o", markersize=4, label="optical depth 0.0001")
axes[0].loglog(exposures, deep.squared_contrast.squeeze(), "s", markersize=4, label="optical depth 10")
axes[0].set(xlabel=r"exposure, in $1/(k^2 D)$", ylabel="squared contrast $K^2$")
axes[0].legend(loc="upper right", fontsize=8)
for name, result in (("moves as a whole", whole), ("shear", sheared)):
    axes[1].errorbar(result.delay, result.field_correlation.squeeze(), result.field_correlation_error.squeeze(),
                     marker="o", markersize=3, label=name)
axes[1].set(xlabel="delay", ylabel="$|g_1|$", ylim=(0, 1.05))
axes[1].legend()
figure.savefig("contrast_and_flow.png", dpi=150)
