#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>

namespace flatspeckle::grin {

/// Adjoints of the discrete eigenmodes of transport in an unbounded uniform medium [case1960], as
/// pairs of a mode that grows along an axis and one that decays. The slowest pair is the importance
/// of light at depth z, with cosine mu to the axis, for a detector far ahead and far behind; the
/// others describe layers near surfaces. Lengths are in mean free paths. A mode is a martingale
/// along a path, for any sampling of free flights: departing(z, mu) is its expectation after a free
/// flight, which is arriving(z', mu) if the flight ends in a collision at z' and departing(z', mu)
/// if it is cut short at z'. arriving(z, mu) is albedo times the expected departing(z, mu') after
/// scattering. The growing mode of rate kappa is
///   departing = exp(kappa z) psi(mu),  arriving = exp(kappa z) (1 - kappa mu) psi(mu),
/// with Legendre moments psi_l from
///   (2l+1) (1 - albedo g^l) psi_l = kappa [(l+1) psi_(l+1) + l psi_(l-1)].
/// The decaying mode has -z and -mu for z and mu. Without absorption the slowest growing mode is
/// departing = z + mu / (1 - g), arriving = z + g mu / (1 - g), and the decaying one, a constant,
/// is left out.
class CaseModes {
 public:
  static constexpr int most_pairs = 4;
  /// Values of the growing modes, and then of the decaying ones; 0 for those that do not exist.
  using Values = Eigen::Array<double, 2 * most_pairs, 1>;

  /// Computes up to `pairs` pairs of modes for Henyey-Greenstein scattering with mean cosine g: the
  /// slowest pair, and the next ones with rates up to `highest`, from which on modes are not
  /// smooth.
  CaseModes(double albedo, double g, int pairs = most_pairs, double highest = 0.95);

  /// Rates of the pairs in ascending order; the first is diffusion_rate() in 3D.
  const std::vector<double>& rates() const { return rates_; }

  /// Returns exp(kappa z) of each mode, or z for the slowest growing one without absorption.
  Values growth(double z) const {
    Values growth = exists_ * (signed_rates_ * z).exp();
    if (transport_length_ > 0) growth[0] = z;
    return growth;
  }
  /// Values that depend on the direction alone.
  struct Angle {
    double mu;
    Values scattered;  ///< (1 - kappa mu) psi(mu), with a negative kappa for decaying modes
  };
  /// Evaluates the modes by cubic interpolation, with an error below 1e-7.
  Angle angle(double mu) const {
    const double at = std::abs(mu) * static_cast<double>(cubics_.size());
    const auto i = std::min(static_cast<std::size_t>(at), cubics_.size() - 1);
    const double t = at - static_cast<double>(i);
    const std::array<Values, 4>& c = cubics_[i];
    const Values parts = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    const auto even = parts.head<most_pairs>();
    const Eigen::Array<double, most_pairs, 1> odd =
        std::copysign(1.0, mu) * parts.tail<most_pairs>();
    Angle angle{mu, {}};
    angle.scattered << even + odd, even - odd;
    return angle;
  }

  /// Returns the modes before a free flight. `growth` is growth(z) at the start of the flight.
  Values departing(const Values& growth, const Angle& of) const {
    Values modes = growth * of.scattered / (1 - signed_rates_ * of.mu);
    modes[0] += transport_length_ * of.mu;
    return modes;
  }
  /// Returns the modes before a collision. `growth` is growth(z) at the collision.
  Values arriving(const Values& growth, const Angle& of) const {
    Values modes = growth * of.scattered;
    modes[0] += g_ * transport_length_ * of.mu;
    return modes;
  }

 private:
  void tabulate(double albedo);

  double g_, transport_length_;  ///< 1 / (1 - g) without absorption, else 0
  std::vector<double> rates_;
  Values signed_rates_ = Values::Zero(), exists_ = Values::Zero();
  /// Coefficients of the even and the odd parts of the modes, in equal intervals of |mu|.
  std::vector<std::array<Values, 4>> cubics_;
};

}  // namespace flatspeckle::grin
