#pragma once

#include <cmath>
#include <optional>

namespace flatspeckle::grin {

/// An interval of theta at whose start f is positive.
struct Bracket {
  double a, b, fa, fb;
};

/// The start of a short piece, to its least value, where that is not positive although both ends
/// are, as where a line goes through a thin film or grazes a surface. f has one minimum there,
/// found by golden sections, and is as in first_change().
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

/// The first piece of a bracket, down to 1/64 of [0, 1], at whose end f is not positive. f is
/// nowhere more than the arc that is left to a zero, and [0, 1] is `arc` long: where two ends are
/// farther from a zero than from each other, none is between them. NaN counts as beyond the zero.
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

/// The zero in a bracket, from the positive side, to 0 < f <= tolerance: regula falsi with the
/// Illinois weights, halving where f is NaN. Where nothing is as close, the last positive point.
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
