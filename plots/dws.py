#!/usr/bin/env python3
"""Diffusing-wave spectroscopy: field correlation against delay in transmission through slabs, from
any number of `covariance --delays` results."""

from lib import decay, script, theory

import numpy as np

LABELS = {2: r"$x = 2\,k\sqrt{D\tau}\,L/\ell^*$", 3: r"$x = \sqrt{6}\,k\sqrt{D\tau}\,L/\ell^*$",
          None: r"$x = \sqrt{2d}\,k\sqrt{D\tau}\,L/\ell^*$"}  # by dimension d


def scaled_delay(result, delay):
    """Q L of diffusion theory without absorption: Q l* = sqrt(2 dimension t), t = k^2 D times the delay where `diffusion`
    is given, else the delay."""
    delay = result.scene.get("diffusion", 1) * delay
    transport = result.attribute("transport_mean_free_path")
    return np.sqrt(2 * theory.dimension(result) * delay) * result.attribute("depth") / transport


DELAYS = decay.Decay("field_correlation", "--delays", "diffusion_theory", theory.delayed_diffusion,
                     lambda result: 1, scaled_delay, LABELS, r"field correlation $g_1$")


@script.plot(several=True)
def draw(results):
    return decay.draw(results, DELAYS, (lambda x: x / np.sinh(x), r"$x/\sinh x$"))
