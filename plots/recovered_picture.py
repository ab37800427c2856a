#!/usr/bin/env python3
"""Pictures recovered from frames (`flatspeckle recover` with frames that are pictures): autocorrelation of the first frame,
the picture with a scale bar, and the residual of phase retrieval; with --truth also the true picture."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np

BAR = (1, 2, 5, 10, 20, 50, 100, 200, 500)  # lengths of the scale bar, in pixels


def read_picture(path):
    """Returns a grey picture from an NPY file or one that matplotlib reads, such as PNG."""
    picture = np.load(path) if path.endswith(".npy") else plt.imread(path)
    return picture if picture.ndim == 2 else picture[..., :3].mean(axis=-1)


def show(axis, picture, title, bar):
    axis.imshow(picture, cmap="gray", vmin=0)
    axis.plot([1, 1 + bar], [len(picture) - 2] * 2, color="w", linewidth=2)
    axis.text(1, len(picture) - 3, f"{bar} pixels", color="w", fontsize=6, va="bottom")
    axis.set_title(title, fontsize=7)
    axis.set(xticks=[], yticks=[])


@script.plot(needs={"agreement": "run recover with frames that are pictures"}, dpi=150)
@script.option("--truth", metavar="PICTURE", help="NPY or PNG file of the true picture")
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
    show(axes[1], picture, f"recovered, agreement {agreement:.2f}", bar)
    if truth is not None:
        margin = max(0, len(picture) - len(truth))  # so that both pictures have the same scale
        show(axes[2], np.pad(truth, margin // 2), "truth", bar)
    axes[-1].semilogy(result.values("phase_iteration"), result.dataset("phase_residual")[0], **style.line(0))
    axes[-1].set(xlabel="iteration", ylabel="residual")
    return figure
