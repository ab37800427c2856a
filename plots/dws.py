#!/usr/bin/env python3
"""Diffusing-wave spectroscopy: correlation of light transmitted or reflected by slabs against delay, from any number of
`covariance --delays` results: g2 - 1 over microseconds if all results have delays in seconds, and otherwise the field
correlation over delays that are scaled as in diffusion theory."""

from lib import decay, script, theory

import numpy as np


def rate(result):
    """Returns k^2 D, by which delays are multiplied to give t = k^2 D tau."""
    return result.attribute("k2_diffusion", 1, "delay")


def scaled_delay(result, delay, reflected):
    """Returns Q l* = sqrt(2 dimension t) of diffusion theory without absorption; if no light is reflected, Q L."""
    root = np.sqrt(2 * theory.dimension(result) * rate(result) * delay)
    return root if reflected else root * result.attribute("depth") / result.attribute("transport_mean_free_path")


def scaled_label(dimension, reflected):
    root = {2: r"2\,k\sqrt{D\tau}", 3: r"\sqrt{6}\,k\sqrt{D\tau}", None: r"\sqrt{2d}\,k\sqrt{D\tau}"}[dimension]
    return rf"scaled delay $x = {root}" + ("$" if reflected else r"\,L/\ell^*$")


def microseconds(result):
    return 1e6 if result.unit("delay") == "s" else None


def beta(result):
    return result.attribute("beta", None, "intensity_correlation") if result.has("intensity_correlation") else None


def closed_form(curves):
    """Returns the limit of thick slabs: x/sinh x in transmission; exp(-gamma x) if all light is reflected alike; None
    for layers."""
    if any(curve.result.has("layer") for curve in curves):
        return None
    if not any(curve.reflected for curve in curves):
        return lambda x: x / np.sinh(x), r"$x/\sinh x$"
    factors = [1 + curve.result.attribute("extrapolation_length", np.nan) /
               curve.result.attribute("transport_mean_free_path") for curve in curves]
    if all(curve.reflected for curve in curves) and np.allclose(factors, factors[0], rtol=1e-3):
        return lambda x: np.exp(-factors[0] * x), rf"$e^{{-\gamma x}}$, $\gamma = {factors[0]:.3g}$"
    return None


DELAYS = decay.Decay("field_correlation", "--delays",
                     lambda reflected: "reflected_diffusion_theory" if reflected else "diffusion_theory",
                     theory.delayed_diffusion, rate, scaled_delay, microseconds, r"delay $\tau$ ($\mu$s)",
                     scaled_label, r"field correlation $g_1$", beta)


@script.plot(several=True)
def draw(results):
    return decay.draw(results, DELAYS, closed_form)
