#!/usr/bin/env python3
"""Spectral correlation of speckle: correlation of the fields at two frequencies against the frequency shift, from any
number of `covariance --frequency_shifts` results (first illumination and detection direction)."""

from lib import decay, script, theory

import numpy as np

# By dimension d; None for results of different dimensions.
LABELS = {2: r"scaled frequency shift $L\sqrt{2\,|k_2 - k_1|/\ell^*}$",
          3: r"scaled frequency shift $L\sqrt{3\,|k_2 - k_1|/\ell^*}$",
          None: r"scaled frequency shift $L\sqrt{d\,|k_2 - k_1|/\ell^*}$"}


def wavenumber(result):
    return 2 * np.pi / result.attribute("wavelength")


def scaled_shift(result, shift):
    """Returns |Q| L of diffusion theory without absorption, with Q^2 = dimension i (k2 - k1) / l*."""
    per_lag = theory.dimension(result) / result.attribute("transport_mean_free_path")
    return result.attribute("depth") * np.sqrt(per_lag * wavenumber(result) * np.abs(shift))


SHIFTS = decay.Decay("frequency_correlation", "--frequency_shifts", "frequency_diffusion_theory",
                     theory.shifted_diffusion, wavenumber, scaled_shift, LABELS,
                     r"field correlation $|C_E|$")


@script.plot(several=True)
def draw(results):
    return decay.draw(results, SHIFTS)
