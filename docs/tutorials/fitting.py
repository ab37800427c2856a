"""Which g made this speckle?

A measured curve, here one made by light paths with their noise, is handed over as the result that it is, which knows how
its errors are correlated; a curve from a laboratory would be a table with a column of errors. The answer has an error."""

import numpy as np

import flatspeckle as fs

g = 0.9
slab = fs.Scene(depth=1000, scatterer="hg", optical_depth=4)
fs.covariance(slab, domain="slab", g=g, covariance="memory_effect", tilts=np.linspace(0, 1e-3, 11),
             method="mc", samples=50_000, seed=7, out="curve.h5")
found = fs.fit(slab, free={"g": (0.5, 0.98)}, measurement="curve.h5")
estimate, error = float(found.estimate[0]), float(found.estimate_error[0])
print(f"g = {estimate:.4f} +- {error:.4f}; the curve was made with {g}")
fs.plots.fit(found).savefig("fitting.png", dpi=150)

assert abs(estimate - g) < 4 * error and error < 0.02
