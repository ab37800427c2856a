"""Theories of the memory effect of a slab, as curves: result files hold them at the tilts alone."""

import numpy as np


def log_sinh(a):
    return a + np.log(-np.expm1(-2 * a) / 2)


def slab_diffusion(depth, optical_depth, g, albedo, q):
    """C_E at transverse wavenumbers q in diffusion theory (conventions, C20)."""
    mu_t = optical_depth / depth
    mu_a = mu_t * (1 - albedo)
    transport = 1 / (mu_a + mu_t * albedo * (1 - g))
    source, extrapolation = min(transport, depth), 0.818 * transport

    def log_f(q2):
        rate = np.maximum(np.sqrt(q2), 1e-5 / depth)  # below, f has its limit at 0 to rounding
        return (log_sinh(rate * extrapolation) + log_sinh(rate * (source + extrapolation))
                - np.log(rate) - log_sinh(rate * (depth + 2 * extrapolation)))

    kappa2 = 2 * mu_a / transport
    return np.exp(log_f(q**2 + kappa2) - log_f(kappa2))


def diffusion(sweep, row, q):
    point = (sweep.columns[name][row] for name in ("optical_depth", "g", "albedo"))
    return slab_diffusion(sweep.result.attribute("depth"), *point, q)


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
