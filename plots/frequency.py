#!/usr/bin/env python3
"""Spectral correlation of speckle: the correlation with the field at another frequency against the
shift, from any number of `covariance --frequency_shifts` results (first light and view)."""

from lib import style, theory

import matplotlib.pyplot as plt
import numpy as np


STEPS = 300  # of a line
LABELS = {2: r"$L\sqrt{2\,|k_2 - k_1|/\ell^*}$", 3: r"$L\sqrt{3\,|k_2 - k_1|/\ell^*}$",
          None: r"$L\sqrt{d\,|k_2 - k_1|/\ell^*}$"}  # by dimension d


def wavenumber(result):
    return 2 * np.pi / result.attribute("wavelength")


def scaled_shift(result, shift):
    """|Q| L of diffusion theory without absorption: Q^2 = dimension i (k2 - k1) / l*."""
    per_lag = theory.dimension(result) / result.attribute("transport_mean_free_path")
    return result.attribute("depth") * np.sqrt(per_lag * wavenumber(result) * np.abs(shift))


def diffusion_line(result, shift, stored):
    """(shifts, |C_E|) of diffusion theory between the shifts too."""
    medium = [result.attribute(name) for name in ("depth", "optical_depth", "g", "albedo")]
    space, k = theory.dimension(result), wavenumber(result)
    if not np.allclose(theory.shifted_diffusion(*medium, k * shift, space), stored, rtol=1e-4):
        return shift, stored
    fine = np.linspace(0, np.sqrt(np.abs(shift[-1])), STEPS)**2
    return fine, theory.shifted_diffusion(*medium, k * fine, space)


def label(result):
    values = {name: result.attribute(name) for name in ("optical_depth", "g", "albedo")}
    text = rf"OD {values['optical_depth']:.3g}, $g$ = {values['g']:.3g}"
    return text if values["albedo"] == 1 else text + f", albedo {values['albedo']:.3g}"


def read(result):
    """Shift, magnitude and error [shift], of the first light and view."""
    name = "frequency_correlation"
    if not result.has(name):
        raise style.Unusable(f"{result.path} has no {name}; needs --frequency_shifts")
    shift, values, error = (result.axis(name, 0), np.abs(result.values(name)[:, 0, 0]),
                            result.values(f"{name}_error")[:, 0, 0])
    order = np.argsort(np.abs(shift))
    return shift[order], values[order], error[order], order


def draw(results):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    with_theory = False
    for number, result in enumerate(results):
        look = style.look(number)
        shift, values, error, order = read(result)
        x = scaled_shift(result, shift)
        axis.errorbar(x, values, error, linestyle="none", elinewidth=0.7, color=look["color"],
                      marker=look["marker"], markersize=3, label=label(result))
        if result.has("frequency_diffusion_theory"):
            with_theory = True
            fine, line = diffusion_line(result, shift,
                                        result.values("frequency_diffusion_theory")[order])
            axis.plot(scaled_shift(result, fine), line, color=look["color"], linewidth=0.7,
                      linestyle=look["linestyle"], zorder=1)
    spaces = {theory.dimension(result) for result in results}
    axis.set_yscale("log")
    axis.set_xlim(left=0)
    axis.set_xlabel(LABELS[spaces.pop() if len(spaces) == 1 else None])
    axis.set_ylabel(r"field correlation $|C_E|$")
    axis.legend(title="lines: diffusion theory" if with_theory else None, title_fontsize=7)
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
