"""Draws the speckle pattern of a placement given by the user, and its ratio to the mean intensity by Monte Carlo."""

from lib import page, style

import matplotlib.pyplot as plt
import numpy as np

FORWARD = {"color": "#E69F00", "alpha": 0.25, "linewidth": 0}  # background of directions in the forward lobe


def draw_pattern(axis, result):
    """Draws |u|^2 and its mean over placements for the first illumination."""
    order = np.argsort(result.values("view_angle"))
    view = result.values("view_angle")[order]
    mean, error = (values[0][order] for values in result.measured("mc/intensity"))
    axis.plot(view, np.abs(result.values("far_field")[0][order])**2, color=style.COLOURS[1],
              label="given placement, exact: $|u|^2$")
    axis.fill_between(view, mean - error, mean + error, color=style.COLOURS[0], alpha=0.3, linewidth=0)
    axis.plot(view, mean, color=style.COLOURS[0], linestyle="--", label="mean over placements, Monte Carlo")
    forward = view[result.values("forward")[0][order] > 0]
    if len(forward):
        axis.axvspan(forward.min(), forward.max(), label="forward lobe (excluded)", zorder=-1, **FORWARD)
    axis.set(yscale="log", ylim=(mean.min() / 100, None),
             ylabel=f"intensity ({result.dataset('mc/intensity').attrs['units']})")
    style.angle_axis(axis, view, "detection angle")


def draw_distribution(axis, result):
    """Draws the fraction of ratios above a value, and the law exp(-r) of fully developed speckle."""
    counted = result.values("forward") == 0
    ratio = np.sort(result.values("intensity_ratio")[counted])
    axis.step(ratio, 1 - np.arange(len(ratio)) / len(ratio), where="pre", color=style.COLOURS[1])
    fine = np.linspace(0, ratio[-1], 200)
    axis.plot(fine, np.exp(-fine), color="black", linestyle=":", label=r"$\exp(-r)$, Gaussian fields")
    axis.set(yscale="log", xlabel=r"$r = |u|^2$ / mean intensity", ylabel="fraction of directions above $r$",
             ylim=(0.5 / len(ratio), 1.3))


def draw(result):
    figure, (pattern, distribution) = plt.subplots(2, 1, figsize=(1.3 * style.COLUMN, 4.2), height_ratios=[1.5, 1])
    draw_pattern(pattern, result)
    draw_distribution(distribution, result)
    numbers = [f"{word} {result.values(name):.3f} $\\pm$ {result.values(name + '_error'):.2g}"
               for word, name in (("mean", "mean_ratio"), ("contrast", "ratio_contrast"))]
    distribution.text(0.97, 0.93, "\n".join([*numbers, f"{float(result.values('independent_grains')):.0f} grains"]),
                      transform=distribution.transAxes, ha="right", va="top")
    page.legend_above(figure, page.labelled([pattern, distribution]), 2)
    style.caption(figure, ["errors of mean and contrast are 1 / sqrt(number of independent speckle grains)"])
    return figure
