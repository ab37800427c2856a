"""Theories of the memory effect of a slab as smooth curves; result files contain them only at the tilts."""

import numpy as np

STEPS = 200  # points of a line


def log_sinh(a):
    return a + np.log(-np.expm1(-2 * a) / 2)


EXTRAPOLATION = {2: 0.818, 3: 0.7104}  # in transport mean free paths, by dimension, without reflecting faces


def slab_lengths(depth, optical_depth, g, albedo, dimension, extrapolation):
    """Returns transport mean free path, depth of the source, extrapolation length (by default without reflecting faces)
    and kappa^2."""
    mu_t = optical_depth / depth
    mu_a = mu_t * (1 - albedo)
    transport = 1 / (mu_a + mu_t * albedo * (1 - g))
    beyond = EXTRAPOLATION[dimension] * transport if extrapolation is None else extrapolation
    return transport, np.minimum(transport, depth), beyond, dimension * mu_a / transport


def slab_losses(loss, depth, optical_depth, g, albedo, dimension=2, extrapolation=None):
    """Returns the correlation in diffusion theory (conventions, C20) if `loss`, which may be complex, is added to its
    kappa^2."""
    _, source, extrapolation, kappa2 = slab_lengths(depth, optical_depth, g, albedo, dimension, extrapolation)

    def log_f(q2):
        root = np.sqrt(q2)  # very close to 0, f equals its limit to rounding
        rate = np.where(np.abs(root) > 1e-5 / depth, root, 1e-5 / depth)
        return (log_sinh(rate * extrapolation) + log_sinh(rate * (source + extrapolation))
                - np.log(rate) - log_sinh(rate * (depth + 2 * extrapolation)))

    return np.exp(log_f(loss + kappa2) - log_f(kappa2))


def slab_diffusion(q, depth, optical_depth, g, albedo, dimension=2, extrapolation=None):
    """Returns C_E at transverse wavenumbers q."""
    return slab_losses(q**2, depth, optical_depth, g, albedo, dimension, extrapolation)


def diffusion_range(depth, optical_depth, g, albedo, dimension=2):
    """Returns q L at which C_I = C_E^2 of diffusion theory is 1/2. Arguments are arrays of equal shape, or
    numbers."""
    low, high = np.broadcast_arrays(1e-3, 1e4, optical_depth, g, albedo)[:2]
    for _ in range(60):
        middle = np.sqrt(low * high)
        above = slab_diffusion(middle / depth, depth, optical_depth, g, albedo, dimension)**2 > 0.5
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.sqrt(low * high)


def delayed_diffusion(delay, reflected, depth, optical_depth, g, albedo, dimension=2, extrapolation=None):
    """Returns the field correlation of transmitted or reflected light after delays t = k^2 D tau (conventions, C53)."""
    transport, source, z0, kappa2 = slab_lengths(depth, optical_depth, g, albedo, dimension, extrapolation)
    height = depth - source if reflected else source

    def log_f(q2):
        q = np.maximum(np.sqrt(q2), 1e-5 / depth)
        h = q * z0
        return (np.log(2 * h - (1 - h) * np.expm1(-2 * q * height))
                - np.log(4 * h - (1 - h)**2 * np.expm1(-2 * q * depth)) - q * (depth - height))

    loss = 2 * delay * (1 - g) * albedo * optical_depth / depth
    return np.exp(log_f(kappa2 + dimension * loss / transport) - log_f(kappa2))


def shifted_diffusion(lag, _, depth, optical_depth, g, albedo, dimension=2, extrapolation=None):
    """Returns the magnitude of the correlation with the field at a wavenumber larger by `lag`, which acts like an
    absorption coefficient i lag."""
    per_loss = dimension * optical_depth / depth * (1 - g * albedo)
    return np.abs(slab_losses(1j * per_loss * lag, depth, optical_depth, g, albedo, dimension, extrapolation))


def cubic(x, y, at):
    """Interpolates (x, y), x ascending, by piecewise cubics, whose derivatives at the points are those of parabolas
    through three neighbours."""
    step, rise = np.diff(x), np.diff(y) / np.diff(x)
    inner = (rise[:-1] * step[1:] + rise[1:] * step[:-1]) / (step[:-1] + step[1:])
    slope = np.concatenate([[2 * rise[0] - inner[0]], inner, [2 * rise[-1] - inner[-1]]])
    piece = np.clip(np.searchsorted(x, at) - 1, 0, len(step) - 1)
    t, h = (at - x[piece]) / step[piece], step[piece]
    left, right = y[piece], y[piece + 1]
    return (left * (1 + 2 * t) * (1 - t)**2 + right * t**2 * (3 - 2 * t)
            + h * t * (1 - t) * (slope[piece] * (1 - t) - slope[piece + 1] * t))


def dimension(result):
    """Returns the dimension of space in a result, 2 or 3."""
    return result.scene.get("dimension", 2)


def medium(result):
    """Returns the keyword arguments of the formulas above for the slab of a result."""
    keys = ("depth", "optical_depth", "g", "albedo")
    return {**{key: result.attribute(key) for key in keys}, "dimension": dimension(result),
            "extrapolation": result.attribute("extrapolation_length")}


def single_scattering(result, q):
    """Returns C_E of single scattering without attenuation (conventions, C21)."""
    light = result.values("light_angle")[0]
    phase = np.outer(result.attribute("depth") * q / 2,
                     np.tan(result.values("view_angle")) - np.tan(light))
    return np.abs(np.mean(np.exp(1j * phase) * np.sinc(phase / np.pi), axis=1))


def known_tilts(result):
    """Returns the tilts of the file in ascending order, their q, and the order that sorts them."""
    order = np.argsort(result.values("tilt"))
    return result.values("tilt")[order], result.values("tilt_q")[order], order


def fine_tilts(result):
    tilt = result.values("tilt")
    return np.linspace(tilt.min(), tilt.max(), STEPS)


def curve(result, formula, stored, tilt):
    """Returns (tilts, C_E): the formula as a function of q on a fine grid of tilts, or the stored values if the
    formula does not reproduce them."""
    known, q, order = known_tilts(result)
    if not np.allclose(formula(q), stored[order], rtol=1e-4, atol=1e-6):
        return known, stored[order]
    return tilt, formula(np.interp(tilt, known, q))


def of_point(sweep, row, stored, tilt):
    """Returns (tilts, C_E) of diffusion theory for one point of a sweep of slabs."""
    point = {name: sweep.columns[name][row] for name in ("optical_depth", "g", "albedo")}
    slab = {**medium(sweep.result), **point}
    return curve(sweep.result, lambda q: slab_diffusion(q, **slab), stored, tilt)


def transmitted(result):
    """Returns (tilts, C_E) of light transmitted through a homogeneous slab in diffusion theory; None for other
    scenes."""
    if result.scene.get("domain") != "slab" or result.has("layer") or not result.has("tilt_q"):
        return None
    (known, q, _), tilt = known_tilts(result), fine_tilts(result)
    return tilt, slab_diffusion(np.interp(tilt, known, q), **medium(result))


def reflected(result):
    """Returns (tilts, C_E) of reflected light in theory, interpolated between the tilts of the file; None if the file
    lacks it."""
    if not result.has("reflection_theory") or len(result.values("tilt")) < 3:
        return None
    (known, _, order), tilt = known_tilts(result), fine_tilts(result)
    return tilt, cubic(known, result.values("reflection_theory")[order], tilt)
