#!/usr/bin/env python3
"""Diffusing-wave spectroscopy: field correlation of light transmitted through slabs against delay, from any number of
`covariance --delays` results."""

from lib import decay, script, theory

import numpy as np

# By dimension d; None for results of different dimensions.
LABELS = {2: r"scaled delay $x = 2\,k\sqrt{D\tau}\,L/\ell^*$",
          3: r"scaled delay $x = \sqrt{6}\,k\sqrt{D\tau}\,L/\ell^*$",
          None: r"scaled delay $x = \sqrt{2d}\,k\sqrt{D\tau}\,L/\ell^*$"}


def scaled_delay(result, delay):
    """Returns Q L of diffusion theory without absorption: Q l* = sqrt(2 dimension t), with t = k^2 D tau. If
    `diffusion` is given, it multiplies the delays; otherwise the delays are t."""
    delay = result.scene.get("diffusion", 1) * delay
    transport = result.attribute("transport_mean_free_path")
    return np.sqrt(2 * theory.dimension(result) * delay) * result.attribute("depth") / transport


DELAYS = decay.Decay("field_correlation", "--delays", "diffusion_theory", theory.delayed_diffusion,
                     lambda result: 1, scaled_delay, LABELS, r"field correlation $g_1$")


@script.plot(several=True)
def draw(results):
    return decay.draw(results, DELAYS, (lambda x: x / np.sinh(x), r"$x/\sinh x$"))
