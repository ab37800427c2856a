"""Curves between values that a file has at a few places."""

import numpy as np


def cubic(x, y, at):
    """Cubic pieces through (x, y), x rising, with the slopes of parabolas through three neighbours."""
    step, rise = np.diff(x), np.diff(y) / np.diff(x)
    inner = (rise[:-1] * step[1:] + rise[1:] * step[:-1]) / (step[:-1] + step[1:])
    slope = np.concatenate([[2 * rise[0] - inner[0]], inner, [2 * rise[-1] - inner[-1]]])
    piece = np.clip(np.searchsorted(x, at) - 1, 0, len(step) - 1)
    t, h = (at - x[piece]) / step[piece], step[piece]
    left, right = y[piece], y[piece + 1]
    return (left * (1 + 2 * t) * (1 - t)**2 + right * t**2 * (3 - 2 * t)
            + h * t * (1 - t) * (slope[piece] * (1 - t) - slope[piece + 1] * t))
