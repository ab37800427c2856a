#pragma once

#include <cmath>
#include <functional>
#include <vector>

namespace flatspeckle::mc {

/// Moments of a phase function that the solution on discrete ordinates uses (the kept moments). The
/// omitted moments describe a forward peak that is too narrow for the kept moments to resolve.
/// Light scattered into this peak is treated as unscattered (the delta-M method of Wiscombe
/// [wiscombe1977]).
struct KeptMoments {
  std::vector<double> list;  ///< kept moments, without the contribution of the peak
  double peak = 0;      ///< fraction of the scattered light in the peak; 0 if all moments are kept
  int peak_degree = 0;  ///< index l of the moment that equals `peak`
  double tail = 0;      ///< largest modulus of the first two omitted moments
  double width = 0;     ///< smallest angle over which a function with these moments varies

  /// Whether the omitted moments are so large that the kept ones must be tapered (less_peak()).
  bool is_sharp() const { return tail > 1e-4; }
  /// Returns the kept value of moment l: the moment minus the fraction in the peak. If the peak is
  /// sharp, the values also decrease smoothly to 0 towards the last moment, because abrupt
  /// truncation would make the rest of the phase function oscillate.
  double less_peak(std::size_t l, double moment, double share_of_peak) const;
};

/// Returns the first `count` moments of a phase function, normalised.
using FirstMoments = std::function<std::vector<double>(int count)>;

/// Moments of a phase function: the kept moments, and a function that computes any number of
/// moments.
class PhaseMoments {
 public:
  PhaseMoments() = default;
  /// Keeps all moments above rounding error, but not more than `most`.
  PhaseMoments(FirstMoments source, int most);

  /// Returns a copy that keeps at most the first `count` moments, by the delta-M method.
  PhaseMoments truncated(int count) const;
  const KeptMoments& kept() const { return kept_; }

 private:
  void keep(int count);
  void set_width();

  FirstMoments source_;
  KeptMoments kept_;
};

/// Number of moments that are kept if there are `order` ordinates per panel. It grows faster than
/// the order. The difference between two successive solutions therefore exceeds the error of the
/// finer one.
int kept_moments(int order);
/// Number of ordinates per panel at which refinement ends if phase functions have sharp peaks. The
/// next larger number would already use the maximum of kept_moments().
constexpr int most_order_of_moments = 26;

/// Moments g^l of the Henyey-Greenstein function, both in the plane and in space.
inline std::vector<double> henyey_greenstein_moments(double g, int count) {
  std::vector<double> moments;
  for (int l = 0; l < count; ++l) moments.push_back(std::pow(g, l));
  return moments;
}

/// Computes the first `count` moments of a phase function p by adaptive quadrature. Moment l is the
/// integral of p decay cos(l theta) in the plane, or of p decay P_l(cos(theta)) in space, divided
/// by the integral of p. p need not be normalised. decay: an additional factor; an empty function
/// means 1.
std::vector<double> first_moments(int dimension, const std::function<double(double angle)>& p,
                                  const std::function<double(double angle)>& decay, int count);

/// Integrates a function of the angle to an axis over the sphere.
double sphere_integral(const std::function<double(double angle)>& p);

/// Returns the angular half-width of the forward or the backward peak of p, whichever is smaller:
/// the angle from the centre of the peak within which p falls to half. Accurate to a factor of 2.
double peak_width(const std::function<double(double angle)>& p);

}  // namespace flatspeckle::mc
