#pragma once

namespace flatspeckle::oracles {

/// Exact transport in an infinite slab of matched index that scatters isotropically, by Peierls'
/// integral equation for the fluence,
///   phi(x) = exp(-x) + albedo/2 int_0^tau E1(|x - x'|) phi(x') dx',   x in optical depth,
/// in Galerkin form with constants on equal cells, and Richardson's extrapolation.

struct SlabShares {
  double reflected, transmitted;  ///< of a beam along the normal; transmitted includes unscattered
};
SlabShares isotropic_slab(double optical_depth, double albedo);

/// Scatterings per extinction, > 1, that keep a slab critical.
double critical_ratio(double optical_depth);

/// Light of late times falls as exp(-rate optical path) in a slab of thickness `length` (n = 1):
/// exp(-rate t) turns mu_t into mu_t - rate, which must be critical.
double slab_decay_rate(double length, double mu_s, double mu_a);

/// The same by diffusion: mu_a + D (pi / (length + 2 z_e))^2, D = 1/(3 mu_s'), z_e = 0.7104/mu_s'
/// (Milne's extrapolation length of a matched boundary).
double diffusion_decay_rate(double length, double mu_s_reduced, double mu_a);

/// Share of a beam along the normal that a half-space reflects: 1 - sqrt(1 - albedo) H(1), with
/// Chandrasekhar's H function of isotropic scattering (Radiative Transfer, 1950, section 33).
double isotropic_half_space(double albedo);

}  // namespace flatspeckle::oracles
