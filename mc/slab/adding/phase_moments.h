#pragma once

#include <cmath>
#include <functional>
#include <vector>

namespace flatspeckle::mc {

/// The moments of a phase function that transport on ordinates keeps. What the moments left out
/// describe is a peak about the forward direction, narrower than the moments kept resolve. It is
/// treated as light that is not scattered at all (the delta-M method of Wiscombe 1977).
struct KeptMoments {
  std::vector<double> list;  ///< less the peak
  double peak = 0;           ///< its share of what is scattered; 0 where all moments are kept
  int peak_degree = 0;       ///< the number of the moment that the peak's share is
  double tail = 0;           ///< the largest modulus among the first two moments left out
  double width = 0;          ///< the angle within which functions of these moments change

  /// Whether the moments left out matter where the peak is not treated with care.
  bool is_sharp() const { return tail > 1e-4; }
  /// What is kept of moment l, less the peak. Where the peak is sharp, moments fade out towards the
  /// last one: cut off all at once they would make the rest of the phase function oscillate.
  double less_peak(std::size_t l, double moment, double share_of_peak) const;
};

/// Returns the first `count` moments of a phase function, normalised.
using FirstMoments = std::function<std::vector<double>(int count)>;

/// What is known of a phase function's moments: those that transport keeps, and how to get others.
class PhaseMoments {
 public:
  PhaseMoments() = default;
  /// Keeps the moments above rounding, or `most` of them where there are more.
  PhaseMoments(FirstMoments source, int most);

  /// Keeps the first `count` moments at most, by the delta-M method.
  PhaseMoments truncated(int count) const;
  const KeptMoments& kept() const { return kept_; }

 private:
  void keep(int count);
  void set_width();

  FirstMoments source_;
  KeptMoments kept_;
};

/// The number of moments that transport keeps with so many ordinates of a panel. It grows so much
/// faster than the order that the difference of two solutions is more than the error of the finer.
int kept_moments(int order);
/// The order of which the next one has all moments that are ever kept.
constexpr int most_order_of_moments = 26;

/// Moments of Henyey-Greenstein's function, in the plane and in space.
inline std::vector<double> henyey_greenstein_moments(double g, int count) {
  std::vector<double> moments;
  for (int l = 0; l < count; ++l) moments.push_back(std::pow(g, l));
  return moments;
}

/// Computes the first moments of a phase function p, by quadrature that is refined where p changes.
/// In the plane they are the integrals of p decay cos(l theta), in space those of p decay
/// P_l(cos(theta)), over the integral of p, which may be in any unit. decay: empty for 1.
std::vector<double> first_moments(int dimension, const std::function<double(double angle)>& p,
                                  const std::function<double(double angle)>& decay, int count);

/// Integrates a function of the angle to an axis over the sphere.
double sphere_integral(const std::function<double(double angle)>& p);

/// Returns the angle from the forward or the backward direction within which p falls to a half of
/// its value there, whichever is less, to a factor of 2.
double peak_width(const std::function<double(double angle)>& p);

}  // namespace flatspeckle::mc
