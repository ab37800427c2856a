#!/usr/bin/env python3
"""Pictures recovered from frames (`flatspeckle recover` with frames that are pictures): autocorrelation of the first frame,
the picture with a scale bar, and the residual of phase retrieval; with --truth also the true picture."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np

BAR = (1, 2, 5, 10, 20, 50, 100, 200, 500)  # lengths of the scale bar, in pixels


def read_picture(path):
    """Returns a grey picture from an NPY file, a CSV file of numbers without names, or one that matplotlib reads, such
    as PNG."""
    if path.endswith(".csv"):
        lines = [line.rstrip(", \t\r\n") for line in open(path, encoding="utf-8")]
        return np.loadtxt([line for line in lines if line], delimiter=",", ndmin=2)
    picture = np.load(path) if path.endswith(".npy") else plt.imread(path)
    return picture if picture.ndim == 2 else picture[..., :3].mean(axis=-1)


def show(axis, picture, title, bar, size, width):
    """Draws a picture of this width in the middle of a black square. Size and width are in pixels of the camera."""
    half = np.array([width, width * picture.shape[0] / picture.shape[1]]) / 2
    axis.imshow(picture, cmap="gray", vmin=0,
                extent=(size / 2 - half[0], size / 2 + half[0], size / 2 + half[1], size / 2 - half[1]))
    axis.plot([1, 1 + bar], [size - 2] * 2, color="w", linewidth=2)
    axis.text(1, size - 3, f"{bar} pixels", color="w", fontsize=6, va="bottom")
    axis.set_title(title, fontsize=7)
    axis.set(xticks=[], yticks=[], facecolor="k", xlim=(0, size), ylim=(size, 0))


@script.plot(needs={"agreement": "run recover with frames that are pictures"}, dpi=150)
@script.option("--truth", metavar="PICTURE", help="NPY, PNG or CSV file of the true picture")
@script.option("--truth_width", type=float, metavar="PIXELS",
               help="width of the true picture in pixels of the camera (default: its own number of pixels)")
def draw(result, arguments):
    truth = read_picture(arguments.truth) if arguments.truth else None
    panels = 3 + (truth is not None)
    figure, axes = plt.subplots(1, panels, figsize=(style.PAGE, 2.1), layout="constrained")
    lag = result.values("lag_x")
    mesh = axes[0].imshow(result.dataset("autocorrelation")[0], cmap="inferno", origin="lower",
                          extent=(lag[0] - 0.5, lag[-1] + 0.5) * 2)
    axes[0].set(xlabel="lag along x [pixels]", ylabel="lag along y [pixels]")
    figure.colorbar(mesh, ax=axes[0], label=r"$\langle\delta I\,\delta I'\rangle/\langle I\rangle^2$")
    picture = result.dataset("phased_picture")[0]
    bar = max(length for length in BAR if length <= len(picture) / 3)
    agreement = result.values("agreement")[0]
    size = len(picture)
    show(axes[1], picture, f"recovered, agreement {agreement:.2f}", bar, size, size)
    if truth is not None:
        show(axes[2], truth, "truth", bar, size, arguments.truth_width or truth.shape[1])
    axes[-1].semilogy(result.values("phase_iteration"), result.dataset("phase_residual")[0], **style.line(0))
    axes[-1].set(xlabel="iteration", ylabel="residual")
    return figure
