"""A waveguide in a scattering medium

An index that falls off from the axis, n^2 = n0^2 - alpha^2 r^2, brings light back to the axis again and again. How much of a
narrow beam arrives, with and without the guide, and what the scatterers around it take away."""

import numpy as np

import flatspeckle as fs

depth = 20
guide = fs.Scene(field=["parabolic"], index=1.33, alpha=0.15, stage_box=[-6, -6, 0, 6, 6, depth],
                 beam_light=[0, 0, 0, 0, 0, 1, 0.3, 1], sensor="area", sensor_at=[0, 0, depth], sensor_size=[6, 6],
                 pixels=[48, 48], phase="henyey_greenstein", g=0.9, samples=60_000)
scattering = {"mu_s": 0.15}
on = fs.render(guide, **scattering, out="guide.h5")
off = fs.render(guide, field=None, index=None, alpha=None, **scattering, out="no_guide.h5")
print(f"through the whole detector: {float(on.total):.4f} with the guide, {float(off.total):.4f} without")
fs.plots.render(on, off).savefig("waveguide.png", dpi=150)

# All that is absorbed of a beam along the axis, where no ray is longer than the slab by more than a few parts in a
# thousand: exp(-mu_a depth), Beer and Lambert's law.
clear, dark = (fs.render(guide, mu_s=None, phase=None, g=None, mu_a=mu_a) for mu_a in (1e-12, 0.05))
ratio = float(dark.total / clear.total)
print(f"absorption leaves {ratio:.4f}, the law says {np.exp(-0.05 * depth):.4f}")
np.testing.assert_allclose(ratio, np.exp(-0.05 * depth), rtol=5e-3)

# The guide holds light together: more arrives on the axis, by far more than the errors.
gain = float(on.total - off.total)
assert gain > 4 * np.hypot(float(on.total_error), float(off.total_error))
