"""Theories of the memory effect of a slab, as curves: result files hold them at the tilts alone."""

import numpy as np

STEPS = 200  # of a line


def log_sinh(a):
    return a + np.log(-np.expm1(-2 * a) / 2)


EXTRAPOLATION = {2: 0.818, 3: 0.7104}  # in transport mean free paths, by dimension


def slab_losses(loss, depth, optical_depth, g, albedo, dimension=2):
    """What is left in diffusion theory (conventions, C20) where its kappa^2 grows by `loss`, which
    may be complex."""
    mu_t = optical_depth / depth
    mu_a = mu_t * (1 - albedo)
    transport = 1 / (mu_a + mu_t * albedo * (1 - g))
    source, extrapolation = np.minimum(transport, depth), EXTRAPOLATION[dimension] * transport

    def log_f(q2):
        root = np.sqrt(q2)  # close to 0 f has its limit there to rounding
        rate = np.where(np.abs(root) > 1e-5 / depth, root, 1e-5 / depth)
        return (log_sinh(rate * extrapolation) + log_sinh(rate * (source + extrapolation))
                - np.log(rate) - log_sinh(rate * (depth + 2 * extrapolation)))

    kappa2 = dimension * mu_a / transport
    return np.exp(log_f(loss + kappa2) - log_f(kappa2))


def slab_diffusion(q, depth, optical_depth, g, albedo, dimension=2):
    """C_E at transverse wavenumbers q."""
    return slab_losses(q**2, depth, optical_depth, g, albedo, dimension)


def diffusion_range(depth, optical_depth, g, albedo, dimension=2):
    """q L where C_I = C_E^2 of that is 1/2; arrays of one shape, or numbers."""
    low, high = np.broadcast_arrays(1e-3, 1e4, optical_depth, g, albedo)[:2]
    for _ in range(60):
        middle = np.sqrt(low * high)
        above = slab_diffusion(middle / depth, depth, optical_depth, g, albedo, dimension)**2 > 0.5
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.sqrt(low * high)


def delayed_diffusion(delay, depth, optical_depth, g, albedo, dimension=2):
    """Field correlation after delays t = k^2 D tau: what they take acts like a tilt's q^2."""
    mu_s = optical_depth / depth * albedo
    transport = 1 / (optical_depth / depth - g * mu_s)
    q = np.sqrt(2 * dimension * delay * (1 - g) * mu_s / transport)
    return slab_diffusion(q, depth, optical_depth, g, albedo, dimension)


def shifted_diffusion(lag, depth, optical_depth, g, albedo, dimension=2):
    """Magnitude of the correlation with a wavenumber larger by `lag`, which acts like i lag of
    absorption."""
    per_loss = dimension * optical_depth / depth * (1 - g * albedo)
    return np.abs(slab_losses(1j * per_loss * lag, depth, optical_depth, g, albedo, dimension))


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


def dimension(result):
    """Of the space that light travels in."""
    return result.scene.get("dimension", 2)


def medium(result):
    """Keyword arguments of the formulas above for the slab of a result."""
    keys = ("depth", "optical_depth", "g", "albedo")
    return {**{key: result.attribute(key) for key in keys}, "dimension": dimension(result)}


def single_scattering(result, q):
    """C_E of single scattering without attenuation (conventions, C21)."""
    light = result.values("light_angle")[0]
    phase = np.outer(result.attribute("depth") * q / 2,
                     np.tan(result.values("view_angle")) - np.tan(light))
    return np.abs(np.mean(np.exp(1j * phase) * np.sinc(phase / np.pi), axis=1))


def known_tilts(result):
    """Tilts of the file, rising, their q, and their order."""
    order = np.argsort(result.values("tilt"))
    return result.values("tilt")[order], result.values("tilt_q")[order], order


def fine_tilts(result):
    tilt = result.values("tilt")
    return np.linspace(tilt.min(), tilt.max(), STEPS)


def curve(result, formula, stored, tilt):
    """(tilts, C_E): the formula of q between the tilts too, or the stored values alone if they are not
    its own."""
    known, q, order = known_tilts(result)
    if not np.allclose(formula(q), stored[order], rtol=1e-4, atol=1e-6):
        return known, stored[order]
    return tilt, formula(np.interp(tilt, known, q))


def of_point(sweep, row, stored, tilt):
    """(tilts, C_E) of diffusion theory of a point of a sweep of slabs."""
    point = {name: sweep.columns[name][row] for name in ("optical_depth", "g", "albedo")}
    slab = {**medium(sweep.result), **point}
    return curve(sweep.result, lambda q: slab_diffusion(q, **slab), stored, tilt)


def transmitted(result):
    """(tilts, C_E) of light through a slab in diffusion theory; None of other scenes."""
    if result.scene.get("domain") != "slab" or not result.has("tilt_q"):
        return None
    (known, q, _), tilt = known_tilts(result), fine_tilts(result)
    return tilt, slab_diffusion(np.interp(tilt, known, q), **medium(result))


def reflected(result):
    """(tilts, C_E) of reflected light in theory, smooth between the tilts of the file; None where it
    has none."""
    if not result.has("reflection_theory") or len(result.values("tilt")) < 3:
        return None
    (known, _, order), tilt = known_tilts(result), fine_tilts(result)
    return tilt, cubic(known, result.values("reflection_theory")[order], tilt)
