#pragma once

#include <cmath>

#include "grin/index/guide.h"
#include "grin/index/radial_field.h"

namespace flatspeckle::grin {

/// n = n0 sech(alpha rho): no dispersion among meridional rays (conventions, C27).
struct SechProfile {
  double axis_excess, alpha;

  double excess(double u) const { return excess_at(alpha * std::sqrt(u)); }
  RadialJet jet(double u) const {
    const double t = alpha * std::sqrt(u), sech = 1 / std::cosh(t);
    const double slope = t < small ? 1 + t * t * tangent_series(t) : std::tanh(t) / t;
    const double bend = t < small ? bend_series(t) : (sech * sech - slope) / (t * t);
    const double scale = (1 + axis_excess) * sech * alpha * alpha / 2;
    return {excess_at(t), -scale * slope, scale * alpha * alpha / 2 * (slope * slope - bend)};
  }

 private:
  static constexpr double small = 0.3;
  /// tanh t = sum of these t^(2k+1)
  static constexpr double tanh_terms[] = {1,
                                          -1 / 3.,
                                          2 / 15.,
                                          -17 / 315.,
                                          62 / 2835.,
                                          -1382 / 155925.,
                                          21844 / 6081075.,
                                          -929569 / 638512875.,
                                          6404582 / 10854718875.,
                                          -443861162 / 1856156927625.};

  double excess_at(double t) const {
    const double s = std::sinh(t / 2);
    return axis_excess - (1 + axis_excess) * 2 * s * s / std::cosh(t);
  }
  /// (tanh(t)/t - 1)/t^2
  static double tangent_series(double t) {
    double sum = 0;
    for (int k = 9; k >= 1; --k) sum = sum * t * t + tanh_terms[k];
    return sum;
  }
  /// (sech^2 t - tanh(t)/t)/t^2
  static double bend_series(double t) {
    double sum = 0;
    for (int k = 9; k >= 1; --k) sum = sum * t * t + 2 * k * tanh_terms[k];
    return sum;
  }
};
using SechGuide = RadialField<SechProfile, 2>;

inline FieldFacts facts(const SechGuide& field) {
  return guide_facts(field.profile().alpha, field.centre());
}

struct SechValues : GuideValues {
  using Field = SechGuide;
  static constexpr const char* word = "sech";
};

inline SechGuide make_field(const Keys& keys, const SechValues& values, const FieldUse&) {
  return SechGuide({keys.read(values.index) - 1, keys.required(values.alpha)},
                   vector_of(keys.read(values.centre)));
}

}  // namespace flatspeckle::grin
