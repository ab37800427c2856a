"""The picture of data/scenes/render_grin_fibre.toml by the ray picture alone, without the program: rays in
n^2 = n0^2 - alpha^2 rho^2 swing harmonically across the axis by cos(alpha L / beta), with beta = sqrt(n^2 - p^2) what
they keep along it and p their momentum across. Etendue d^2x d^2p is kept, so that points that fill it evenly at the front
face bring equal powers to the pixels where they end. The fibre is several swings long: rays that swing further than the
sides are meet them."""

import numpy as np

AXIS, ALPHA, HALF, LENGTH, SPOT, ACCEPTANCE = 1.6, 0.5, 0.9, 50.2654824574367, 0.1, 0.5
MOST_MOMENTUM = ALPHA * HALF * np.sqrt(2)  # of a ray to a corner


def even_points(first, count):
    """Of the unit cube in four dimensions, evenly spread: multiples of powers of the root of x^5 = x + 1."""
    root = 1.1673039782614187
    steps = root ** -np.arange(1.0, 5)
    return np.modf(np.arange(first + 1.0, first + count + 1)[:, None] * steps)[0].T


def on_disk(radius, share, turn):
    return radius * np.sqrt(share) * np.array([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)])


def index_squared(x):
    return AXIS**2 - ALPHA**2 * (x**2).sum(axis=0)


def ends(points):
    """Where rays meet the end face that come from the spot, do not touch the sides, and are accepted."""
    x, p = on_disk(SPOT, points[0], points[1]), on_disk(MOST_MOMENTUM, points[2], points[3])
    inside = (x**2 + (p / ALPHA) ** 2 < HALF**2).all(axis=0)
    x, p = x[:, inside], p[:, inside]
    swing = ALPHA * LENGTH / np.sqrt(index_squared(x) - (p**2).sum(axis=0))
    at_end = x * np.cos(swing) + p / ALPHA * np.sin(swing)
    p_end = p * np.cos(swing) - ALPHA * x * np.sin(swing)
    return at_end[:, (p_end**2).sum(axis=0) < index_squared(at_end) * np.sin(ACCEPTANCE) ** 2]


def fibre_picture(pixels, blocks=4):
    """Irradiance on pixels x pixels of the end face, alike in the eight turns and reflections of a square."""
    count, size = 1 << 20, 2 * HALF / pixels
    hits = np.zeros((pixels, pixels))
    for block in range(blocks):
        at = np.floor((ends(even_points(block * count, count)) + HALF) / size).astype(int)
        hits += np.bincount(at[1] * pixels + at[0], minlength=pixels**2).reshape(pixels, pixels)
    etendue = np.pi**2 * SPOT**2 * MOST_MOMENTUM**2
    alike = sum(np.rot90(turned, k) for k in range(4) for turned in (hits, hits.T)) / 8
    return alike * etendue / (blocks * count) / size**2
