#pragma once

#include <cmath>

namespace flatspeckle::grin {

/// Returns the fraction of the intensity that is left after a length, for the attenuation
/// coefficient mu_t.
inline double transmittance(double mu_t, double length) {
  return std::exp(-mu_t * length);
}

/// Samples the distance s to the next collision, whose density is mu_t exp(-mu_t s). u: uniform in
/// (0, 1).
inline double sample_free_flight(double mu_t, double u) {
  return -std::log(u) / mu_t;
}

/// Biased free flights, for light whose importance grows along the flight as exp(growth_rate mu_t
/// s). Half of the flights use the exponential transform [dwivedi1982]; without it, rare long
/// flights of high importance would dominate the result. weight(s) is the ratio of the unbiased to
/// the sampled density of a collision at s. weight_beyond(s) is the ratio of the unbiased to the
/// sampled probability that the flight is longer than s.
class BiasedFlight {
 public:
  static constexpr double largest_bias = 0.9;

  BiasedFlight(double mu_t, double growth_rate)
      : mu_t_(mu_t), share_(1 - std::fmin(growth_rate, largest_bias)) {}

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

/// A free flight of light whose importance grows along the flight as exp(growth_rate s), with s in
/// mean free paths, up to s = depth. Flights shorter than depth are sampled in proportion to their
/// importance, longer flights with the unbiased density. at() computes the flight from a number
/// `place`, which is uniform in (0, 1).
struct ImportanceSampledFlight {
  double u;       ///< random number u for which sample_free_flight() returns this flight
  double weight;  ///< unbiased density divided by sampled density

  static ImportanceSampledFlight at(double place, double depth, double growth_rate) {
    const double longer = std::exp(-depth), shorter = -std::expm1(-depth);
    if (!(place > longer)) return {place, 1};
    const double share = 1 - growth_rate, all = -std::expm1(-share * depth) / share;
    const double decay = 1 - share * all * (place - longer) / shorter;  // equals exp(-share s)
    const double u = std::pow(decay, 1 / share);
    return {u, all / shorter * u / decay};
  }
};

/// A free flight under the condition that it is no longer than `longest`. Formulas keep their
/// accuracy if mu_t * longest is tiny.
struct BoundedFlight {
  double mu_t, longest;

  /// Probability that an unconditioned flight is no longer than `longest`.
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
