#!/usr/bin/env python3
"""Draws all figures of the guides on one sheet, docs/contact_sheet.jpg, in colour and in grey, to check that
each is readable at column width."""

import pathlib

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

DOCS = pathlib.Path(__file__).resolve().parent.parent / "docs"
SHEET = DOCS / "contact_sheet.jpg"
ACROSS = 6
GREY = np.array([0.299, 0.587, 0.114])  # luma of Rec. 601


def reduced(picture, most=420):
    """Returns the picture averaged over blocks, so that the longer side has about `most` pixels."""
    factor = max(1, max(picture.shape[:2]) // most)
    down, across = (size // factor for size in picture.shape[:2])
    blocks = picture[:down * factor, :across * factor, :3].reshape(down, factor, across, factor, 3)
    return blocks.mean((1, 3))


def draw(figures):
    """Draws each figure in colour and in grey."""
    down = -(-2 * len(figures) // ACROSS)
    sheet, axes = plt.subplots(down, ACROSS, figsize=(2.2 * ACROSS, 2 * down), squeeze=False)
    for axis in axes.flat:
        axis.axis("off")
    for number, path in enumerate(figures):
        picture = reduced(plt.imread(path))
        colour, grey = axes.flat[2 * number], axes.flat[2 * number + 1]
        colour.imshow(picture)
        colour.set_title(str(path.relative_to(DOCS)), fontsize=6)
        grey.imshow(picture @ GREY, cmap="gray", vmin=0, vmax=1)
    sheet.tight_layout(pad=0.3)
    sheet.savefig(SHEET, dpi=110, pil_kwargs={"quality": 80})


if __name__ == "__main__":
    draw(sorted(path for path in DOCS.rglob("*.png")))
