#!/usr/bin/env python3
"""Spectral correlation of speckle: the correlation with the field at another frequency against the
shift, from any number of `covariance --frequency_shifts` results (first light and view)."""

from lib import decay, script, theory

import numpy as np

LABELS = {2: r"$L\sqrt{2\,|k_2 - k_1|/\ell^*}$", 3: r"$L\sqrt{3\,|k_2 - k_1|/\ell^*}$",
          None: r"$L\sqrt{d\,|k_2 - k_1|/\ell^*}$"}  # by dimension d


def wavenumber(result):
    return 2 * np.pi / result.attribute("wavelength")


def scaled_shift(result, shift):
    """|Q| L of diffusion theory without absorption: Q^2 = dimension i (k2 - k1) / l*."""
    per_lag = theory.dimension(result) / result.attribute("transport_mean_free_path")
    return result.attribute("depth") * np.sqrt(per_lag * wavenumber(result) * np.abs(shift))


SHIFTS = decay.Decay("frequency_correlation", "--frequency_shifts", "frequency_diffusion_theory",
                     theory.shifted_diffusion, wavenumber, scaled_shift, LABELS,
                     r"field correlation $|C_E|$")


@script.plot(several=True)
def draw(results):
    return decay.draw(results, SHIFTS)
