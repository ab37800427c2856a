"""Computes the picture of data/scenes/render_grin_fibre.toml by ray optics, without the program. In
n^2 = n0^2 - alpha^2 rho^2 rays oscillate about the axis as cos(alpha L / beta); p is their transverse momentum and
beta = sqrt(n^2 - p^2) the conserved axial one. Etendue d^2x d^2p is conserved, so points that fill it evenly at the
front face carry equal powers to the pixels where they end. The fibre is several periods long: rays whose amplitude
exceeds the half width hit the sides."""

import numpy as np

AXIS, ALPHA, HALF, LENGTH, SPOT, ACCEPTANCE = 1.6, 0.5, 0.9, 50.2654824574367, 0.1, 0.5
MOST_MOMENTUM = ALPHA * HALF * np.sqrt(2)  # of a ray that reaches a corner


def even_points(first, count):
    """Returns points evenly spread in the 4D unit cube: multiples of powers of the root of x^5 = x + 1."""
    root = 1.1673039782614187
    steps = root ** -np.arange(1.0, 5)
    return np.modf(np.arange(first + 1.0, first + count + 1)[:, None] * steps)[0].T


def on_disk(radius, share, turn):
    return radius * np.sqrt(share) * np.array([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)])


def index_squared(x):
    return AXIS**2 - ALPHA**2 * (x**2).sum(axis=0)


def ends(points):
    """Returns where rays from the spot that miss the sides and are accepted meet the end face."""
    x, p = on_disk(SPOT, points[0], points[1]), on_disk(MOST_MOMENTUM, points[2], points[3])
    inside = (x**2 + (p / ALPHA) ** 2 < HALF**2).all(axis=0)
    x, p = x[:, inside], p[:, inside]
    swing = ALPHA * LENGTH / np.sqrt(index_squared(x) - (p**2).sum(axis=0))
    at_end = x * np.cos(swing) + p / ALPHA * np.sin(swing)
    p_end = p * np.cos(swing) - ALPHA * x * np.sin(swing)
    return at_end[:, (p_end**2).sum(axis=0) < index_squared(at_end) * np.sin(ACCEPTANCE) ** 2]


def fibre_picture(pixels, blocks=4):
    """Returns the irradiance on pixels x pixels of the end face, symmetric under the eight symmetries of a square."""
    count, size = 1 << 20, 2 * HALF / pixels
    hits = np.zeros((pixels, pixels))
    for block in range(blocks):
        at = np.floor((ends(even_points(block * count, count)) + HALF) / size).astype(int)
        hits += np.bincount(at[1] * pixels + at[0], minlength=pixels**2).reshape(pixels, pixels)
    etendue = np.pi**2 * SPOT**2 * MOST_MOMENTUM**2
    alike = sum(np.rot90(turned, k) for k in range(4) for turned in (hits, hits.T)) / 8
    return alike * etendue / (blocks * count) / size**2
