#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/algebra/dense.h"
#include "core/numbers/complex.h"
#include "flatland/media/faces.h"

namespace flatspeckle::mc {

/// Conditions at a plane face of a medium whose radiance is expanded in RadianceHarmonics.
struct FaceConditions {
  /// Matrix Z of the condition odd = -Z flow at the face, with z into the medium. odd: coefficients
  /// of the functions that are odd in cos(theta). flow: those of cos(theta) times the radiance.
  Matrix admittance;
  /// Power that leaves through the face is the product of this vector and the flow.
  Eigen::VectorXd exit;
};

/// Spherical harmonics up to an odd degree, for radiance that is even in the azimuth phi about z:
///   Y_lm = P_lm(cos(theta)) cos(m phi) / sqrt((m == 0 ? 2 : 1) pi), 0 <= m <= l <= order,
/// with associated Legendre functions P_lm that are normalised to int P_lm(c)^2 dc = 1 and positive
/// towards the forward direction. Y_lm is even in cos(theta) if l + m is even, otherwise odd.
class RadianceHarmonics {
 public:
  struct Index {
    int l, m;
  };

  explicit RadianceHarmonics(int order);

  int order() const { return order_; }
  /// Returns the indices of the even and of the odd functions, by increasing m and then l.
  const std::vector<Index>& even() const { return even_; }
  const std::vector<Index>& odd() const { return odd_; }
  /// Returns the position of a function in even() or odd().
  std::size_t position(Index at) const { return position_[at.m * (order_ + 1) + at.l]; }
  /// Returns the coefficient by which cos(theta) couples Y_lm and Y_l+1,m.
  static double coupling(int l, int m);
  /// Returns the coefficients of the odd functions in cos(theta) times a sum of even functions.
  Eigen::VectorXcd flow(const Eigen::VectorXcd& even) const;
  /// Returns the matrix of i q sin(theta) cos(phi) - decay cos(theta) in the even functions,
  /// followed by the odd ones.
  Rows transport(Complex q, double decay) const;

  /// Returns the conditions at a face, seen from the medium. The radiance that leaves is a
  /// polynomial in cos(theta) > 0 times sin(theta)^m; that which enters is its reflection. The
  /// coefficients of both in the odd functions, without and with the factor cos(theta), give the
  /// admittance. Unlike Marshak's conditions, these converge fast for faces that reflect totally.
  /// sine_limit: largest sine of the polar angle, inside the medium, of light that is detected.
  FaceConditions face(const Face& face, double sine_limit = 1) const;

 private:
  int order_;
  std::vector<Index> even_, odd_;
  std::vector<std::size_t> position_;
};

/// Returns the normalised associated Legendre functions P_lm(cosine) for l = m .. last.
std::vector<double> legendre_functions(int m, int last, double cosine);

/// Rotates functions of the angle to an axis and of the azimuth about it into RadianceHarmonics.
/// The axis lies in the plane of z and x and may be complex, as that of an evanescent wave.
class HarmonicRotation {
 public:
  explicit HarmonicRotation(const RadianceHarmonics& harmonics);

  /// Returns the coefficients, in the even and in the odd functions, of the sum over l of
  /// coefficients[l - azimuth] Y_l,azimuth about the axis (sine, 0, cosine).
  struct Rotated {
    Eigen::VectorXcd even, odd;
  };
  Rotated operator()(int azimuth, std::span<const double> coefficients, Complex cosine,
                     Complex sine) const;

 private:
  /// Factors of the recurrence of the elements of Wigner's d-matrix in l [edmonds1957]: next =
  /// (cosine - shift) scale current - previous_scale previous.
  struct Step {
    double scale, shift, previous_scale;
  };
  /// Steps from l = the larger index, and the binomial factor of the first element, for the indices
  /// m >= 0 and -order <= n <= order.
  struct Column {
    double first;
    std::vector<Step> steps;
  };

  const Column& column(int m, int n) const { return columns_[m * (2 * order_ + 1) + n + order_]; }
  static Column made_column(int m, int n, int order);
  /// Calls f(l, d) for the elements d = d^l_mn, l = max(m, |n|) .. order. powers: those of the
  /// cosine and of the sine of half the angle.
  template <typename F>
  void each(int m, int n, Complex cosine, const std::vector<Complex>& cosines,
            const std::vector<Complex>& sines, const F& f) const;

  const RadianceHarmonics& harmonics_;
  int order_;
  std::vector<Column> columns_;
};

}  // namespace flatspeckle::mc
