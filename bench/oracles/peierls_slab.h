#pragma once

namespace flatspeckle::oracles {

/// Exact transport in an infinite slab of matched index with isotropic scattering, by Peierls'
/// integral equation for the fluence,
///   phi(x) = exp(-x) + albedo/2 int_0^tau E1(|x - x'|) phi(x') dx',   x in optical depth,
/// in Galerkin form with constants on equal cells, and Richardson's extrapolation.

/// Fractions of the power of a beam along the normal; `transmitted` includes unscattered light.
struct SlabShares {
  double reflected, transmitted;
};
SlabShares isotropic_slab(double optical_depth, double albedo);

/// Returns the ratio of scattering to extinction, above 1, at which a slab is critical.
double critical_ratio(double optical_depth);

/// Returns the rate at which light in a slab of thickness `length` (n = 1) decays at late times, as
/// exp(-rate optical path). In the transport equation this decay replaces mu_t by mu_t - rate, with
/// which the slab must be critical.
double slab_decay_rate(double length, double mu_s, double mu_a);

/// Returns the same decay rate in diffusion theory, mu_a + D (pi / (length + 2 z_e))^2, with D =
/// 1/(3 mu_s') and Milne's extrapolation length z_e = 0.7104/mu_s' of a matched boundary.
double diffusion_decay_rate(double length, double mu_s_reduced, double mu_a);

/// Returns the fraction of a beam along the normal that a half-space reflects, 1 - sqrt(1 - albedo)
/// H(1), with Chandrasekhar's H function of isotropic scattering ([chandrasekhar1950], section 33).
double isotropic_half_space(double albedo);

}  // namespace flatspeckle::oracles
