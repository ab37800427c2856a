"""Theories of the memory effect of a slab, as curves: result files hold them at the tilts alone."""

import tomllib

import numpy as np


def log_sinh(a):
    return a + np.log(-np.expm1(-2 * a) / 2)


EXTRAPOLATION = {2: 0.818, 3: 0.7104}  # in transport mean free paths, by dimension


def slab_losses(depth, optical_depth, g, albedo, loss, dimension=2):
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


def slab_diffusion(depth, optical_depth, g, albedo, q, dimension=2):
    """C_E at transverse wavenumbers q."""
    return slab_losses(depth, optical_depth, g, albedo, q**2, dimension)


def diffusion_range(depth, optical_depth, g, albedo, dimension=2):
    """q L where C_I = C_E^2 of that is 1/2; arrays of one shape, or numbers."""
    low, high = np.broadcast_arrays(1e-3, 1e4, optical_depth, g, albedo)[:2]
    for _ in range(60):
        middle = np.sqrt(low * high)
        above = slab_diffusion(depth, optical_depth, g, albedo, middle / depth, dimension)**2 > 0.5
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.sqrt(low * high)


def delayed_diffusion(depth, optical_depth, g, albedo, delay, dimension=2):
    """Field correlation after delays t = k^2 D tau: what they take acts like a tilt's q^2."""
    mu_s = optical_depth / depth * albedo
    transport = 1 / (optical_depth / depth - g * mu_s)
    q = np.sqrt(2 * dimension * delay * (1 - g) * mu_s / transport)
    return slab_diffusion(depth, optical_depth, g, albedo, q, dimension)


def shifted_diffusion(depth, optical_depth, g, albedo, lag, dimension=2):
    """Magnitude of the correlation with a wavenumber larger by `lag`, which acts like i lag of
    absorption."""
    per_loss = dimension * optical_depth / depth * (1 - g * albedo)
    return np.abs(slab_losses(depth, optical_depth, g, albedo, 1j * per_loss * lag, dimension))


def dimension(result):
    """Of the space that light travels in."""
    return tomllib.loads(result.attribute("config", "")).get("dimension", 2)


def diffusion(sweep, row, q):
    point = (sweep.columns[name][row] for name in ("optical_depth", "g", "albedo"))
    return slab_diffusion(sweep.result.attribute("depth"), *point, q, dimension(sweep.result))


def single_scattering(sweep, row, q):
    """C_E of single scattering without attenuation, the same for all points (conventions, C21)."""
    light = sweep.result.values("light_angle")[0]
    phase = np.outer(sweep.result.attribute("depth") * q / 2,
                     np.tan(sweep.result.values("view_angle")) - np.tan(light))
    return np.abs(np.mean(np.exp(1j * phase) * np.sinc(phase / np.pi), axis=1))


def curve(sweep, formula, row, stored, tilt):
    """(tilts, C_E): the formula between the tilts too, or the stored values alone if they are not
    its own."""
    order = np.argsort(sweep.result.values("tilt"))
    known, q = sweep.result.values("tilt")[order], sweep.result.values("tilt_q")[order]
    if not np.allclose(formula(sweep, row, q), stored[order], rtol=1e-4, atol=1e-6):
        return known, stored[order]
    return tilt, formula(sweep, row, np.interp(tilt, known, q))
