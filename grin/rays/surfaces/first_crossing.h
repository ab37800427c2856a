#pragma once

#include <cmath>
#include <optional>

namespace flatspeckle::grin {

/// An interval of theta at whose start f is positive.
struct Bracket {
  double a, b, fa, fb;
};

/// The first piece of a bracket, down to 1/64 of [0, 1], at whose end f is not positive. f is
/// nowhere more than the arc that is left to a zero, and [0, 1] is `arc` long: where two ends are
/// farther from a zero than from each other, none is between them. NaN counts as beyond the zero.
template <class Function>
std::optional<Bracket> first_change(const Function& f, const Bracket& in, double arc) {
  const bool changes = !(in.fb > 0);
  if (!changes && in.fa + in.fb > arc * (in.b - in.a)) return std::nullopt;
  if (in.b - in.a < 1.5 / 64) return changes ? std::optional(in) : std::nullopt;
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
