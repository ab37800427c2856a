#pragma once

#include <cmath>
#include <optional>

namespace flatspeckle::grin {

/// An interval [a, b] of the parameter theta of a step, and the values fa and fb of a function f at
/// its ends, with fa > 0.
struct Bracket {
  double a, b, fa, fb;
};

/// Searches a short interval, at whose ends f is positive, for a minimum of f that is not positive.
/// Such a minimum occurs where a line passes through a thin film or grazes a surface. If there is
/// one, returns the part of the interval up to the minimum. f must have one minimum in the
/// interval, which is found by golden-section search, and must satisfy the conditions of
/// first_change().
template <class Function>
std::optional<Bracket> dip(const Function& f, const Bracket& in, double arc) {
  constexpr double golden = 0.38196601125010515, beside = 1e-3;
  constexpr int most_sections = 100;
  const double apart = beside * (in.b - in.a);
  if (!(f(in.a + apart) < in.fa) || !(f(in.b - apart) < in.fb)) return std::nullopt;
  double a = in.a, b = in.b, fa = in.fa, fb = in.fb;
  double middle = a + golden * (b - a), least = f(middle);
  for (int i = 0; i < most_sections && least > 0; ++i) {
    if (fa + least > arc * (middle - a) && least + fb > arc * (b - middle)) return std::nullopt;
    const bool is_after = b - middle > middle - a;
    const double theta = middle + golden * (is_after ? b - middle : a - middle), value = f(theta);
    const bool is_lower = !(value >= least);
    (is_after == is_lower ? a : b) = is_lower ? middle : theta;
    (is_after == is_lower ? fa : fb) = is_lower ? least : value;
    if (is_lower) {
      middle = theta;
      least = value;
    }
  }
  return least > 0 ? std::nullopt : std::optional(Bracket{in.a, middle, in.fa, least});
}

/// Returns the first part of an interval at whose end f is not positive. The interval is halved
/// repeatedly, down to 1/64 of [0, 1]. f must never exceed the arc length that remains to its next
/// zero; `arc` is the arc length of [0, 1]. A part is therefore free of zeros if the sum of f at
/// its two ends exceeds its arc length. NaN counts as beyond the zero.
template <class Function>
std::optional<Bracket> first_change(const Function& f, const Bracket& in, double arc) {
  const bool changes = !(in.fb > 0);
  if (!changes && in.fa + in.fb > arc * (in.b - in.a)) return std::nullopt;
  if (in.b - in.a < 1.5 / 64) return changes ? std::optional(in) : dip(f, in, arc);
  const double middle = (in.a + in.b) / 2, value = f(middle);
  if (const auto first = first_change(f, Bracket{in.a, middle, in.fa, value}, arc)) return first;
  if (!(value > 0)) return std::nullopt;
  return first_change(f, Bracket{middle, in.b, value, in.fb}, arc);
}

/// Returns a point of an interval just before the zero of f, where 0 < f <= tolerance. Uses regula
/// falsi with Illinois weights, and bisection where f is NaN. If there is no such point, returns
/// the last point at which f was found positive.
template <class Function>
double zero(const Function& f, Bracket in, double tolerance) {
  const double aim = tolerance / 2;
  double ga = in.fa - aim, gb = in.fb - aim;
  int side = 0;
  for (int i = 0; i < 200 && in.fa > tolerance; ++i) {
    const double part = ga / (ga - gb);
    const double theta = in.a + (in.b - in.a) * (part > 0 && part < 1 ? part : 0.5);
    if (theta == in.a || theta == in.b) break;
    const double value = f(theta);
    if (value > 0) {
      if (side == 1) gb /= 2;
      side = 1;
      in.a = theta;
      in.fa = value;
      ga = value - aim;
    } else {
      if (side == -1) ga /= 2;
      side = -1;
      in.b = theta;
      gb = value - aim;
    }
  }
  return in.a;
}

}  // namespace flatspeckle::grin
