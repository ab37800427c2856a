#pragma once

#include <cmath>

namespace flatspeckle::grin {

/// Attenuation of intensity over a length, in any number of dimensions.
inline double transmittance(double mu_t, double length) {
  return std::exp(-mu_t * length);
}

/// Distance to the next scattering event of density mu_t exp(-mu_t s), from a uniform u in (0, 1).
inline double sample_free_flight(double mu_t, double u) {
  return -std::log(u) / mu_t;
}

/// Where the worth of light grows along a flight as exp(pull mu_t s): half of the flights are
/// stretched (Dwivedi 1982), else long ones, rare and worth all the more, would carry the result.
/// weight(): the density of plain flights over that of these, of one that ends in a collision;
/// weight_beyond(): that of the chance to come so far.
class StretchedFlight {
 public:
  static constexpr double most_pull = 0.9;

  StretchedFlight(double mu_t, double pull) : mu_t_(mu_t), share_(1 - std::fmin(pull, most_pull)) {}

  double sample(double u) const {
    return u < 0.5 ? sample_free_flight(share_ * mu_t_, 2 * u)
                   : sample_free_flight(mu_t_, 2 * u - 1);
  }
  double weight(double s) const { return 2 / (1 + share_ * gain(s)); }
  double weight_beyond(double s) const { return 2 / (1 + gain(s)); }

 private:
  double gain(double s) const { return std::exp((1 - share_) * mu_t_ * s); }

  double mu_t_, share_;
};

/// A flight by a place in (0, 1), where the worth of light grows along it as exp(pull s), s in mean
/// free paths, up to a depth: shorter flights are drawn in proportion to what is worth there,
/// longer ones as often as plain ones are.
struct PulledFlight {
  double u;       ///< of sample_free_flight()
  double weight;  ///< the density of plain flights over that of these

  static PulledFlight at(double place, double depth, double pull) {
    const double longer = std::exp(-depth), shorter = -std::expm1(-depth);
    if (!(place > longer)) return {place, 1};
    const double share = 1 - pull, all = -std::expm1(-share * depth) / share;
    const double pulled = 1 - share * all * (place - longer) / shorter;  // exp(-share s)
    const double u = std::pow(pulled, 1 / share);
    return {u, all / shorter * u / pulled};
  }
};

/// The same as sample_free_flight() on condition that it is no longer than `longest`: exact also
/// where mu_t longest is tiny.
struct BoundedFlight {
  double mu_t, longest;

  /// Of a flight no longer than that.
  double probability() const { return -std::expm1(-mu_t * longest); }
  double sample(double u) const {
    if (mu_t * longest == 0) return u * longest;
    return -std::log1p(u * std::expm1(-mu_t * longest)) / mu_t;
  }
  double density(double distance) const {
    if (mu_t * longest == 0) return 1 / longest;
    return mu_t * std::exp(-mu_t * distance) / probability();
  }
};

}  // namespace flatspeckle::grin
