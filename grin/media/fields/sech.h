#pragma once

#include <cmath>

#include "core/numbers/wide/functions.h"
#include "grin/media/index/guide.h"
#include "grin/media/index/radial_field.h"

namespace flatspeckle::grin {

/// Guide with n = n0 sech(alpha rho) at the distance rho from its axis. All meridional rays have
/// the same period and delay (conventions, C27).
struct SechProfile {
  static constexpr bool goes_in_lanes = true;
  double axis_excess, alpha;

  double excess(double u) const { return jet(u).excess; }
  RadialJet jet(double u) const {
    const double t = alpha * std::sqrt(u), t2 = t * t;
    const double e = wide_exp(-t), larger = 1 / (1 + e * e), sech = 2 * e * larger;
    const bool is_small = t < 0.3;  // use series where the closed forms cancel
    const double tanh_ratio = is_small ? 1 + t2 * tangent_series(t2) : (1 - e * e) * larger / t;
    const double bend = is_small ? bend_series(t2) : (sech * sech - tanh_ratio) / t2;
    const double tanh = t * tanh_ratio, fall = tanh * tanh / (1 + sech);  // 1 - sech
    const double scale = (1 + axis_excess) * sech * alpha * alpha / 2;
    return {axis_excess - (1 + axis_excess) * fall, -scale * tanh_ratio,
            scale * alpha * alpha / 2 * (tanh_ratio * tanh_ratio - bend)};
  }

 private:
  // tanh t = t - t^3/3 + 2/15 t^5 - ...

  /// Returns (tanh(t)/t - 1)/t^2 as a function of z = t^2.
  static double tangent_series(double z) {
    double sum = -443861162 / 1856156927625.;
    sum = sum * z + 6404582 / 10854718875.;
    sum = sum * z - 929569 / 638512875.;
    sum = sum * z + 21844 / 6081075.;
    sum = sum * z - 1382 / 155925.;
    sum = sum * z + 62 / 2835.;
    sum = sum * z - 17 / 315.;
    sum = sum * z + 2 / 15.;
    return sum * z - 1 / 3.;
  }
  /// Returns (sech^2 t - tanh(t)/t)/t^2 as a function of z = t^2. Its k-th term, k = 1, 2, ..., is
  /// 2 k times the k-th term of tangent_series().
  static double bend_series(double z) {
    double sum = 18 * (-443861162 / 1856156927625.);
    sum = sum * z + 16 * (6404582 / 10854718875.);
    sum = sum * z - 14 * (929569 / 638512875.);
    sum = sum * z + 12 * (21844 / 6081075.);
    sum = sum * z - 10 * (1382 / 155925.);
    sum = sum * z + 8 * (62 / 2835.);
    sum = sum * z - 6 * (17 / 315.);
    sum = sum * z + 4 * (2 / 15.);
    return sum * z - 2 / 3.;
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
