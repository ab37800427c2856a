#!/usr/bin/env python3
"""Spectral correlation of speckle: correlation of the fields at two frequencies against the frequency shift, from any
number of `covariance --frequency_shifts` results (first illumination). Shifts are in Hz if the optical frequency of all
results is known, and otherwise scaled as in diffusion theory."""

from lib import decay, script, theory

import numpy as np


def wavenumber(result):
    return 2 * np.pi / result.attribute("wavelength")


def scaled_shift(result, shift, _):
    """Returns |Q| L of diffusion theory without absorption, with Q^2 = dimension i (k2 - k1) / l*."""
    per_lag = theory.dimension(result) / result.attribute("transport_mean_free_path")
    return result.attribute("depth") * np.sqrt(per_lag * wavenumber(result) * np.abs(shift))


def scaled_label(dimension, _):
    return rf"scaled frequency shift $L\sqrt{{{dimension or 'd'}\,|k_2 - k_1|/\ell^*}}$"


SHIFTS = decay.Decay("frequency_correlation", "--frequency_shifts", lambda reflected: "frequency_diffusion_theory",
                     theory.shifted_diffusion, wavenumber, scaled_shift,
                     lambda result: result.attribute("optical_frequency", None, "frequency_shift"),
                     "frequency shift (Hz)", scaled_label, r"field correlation $|C_E|$")


@script.plot(several=True)
def draw(results):
    return decay.draw(results, SHIFTS)
