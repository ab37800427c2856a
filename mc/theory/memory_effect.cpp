#include "mc/theory/memory_effect.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace flatspeckle::mc {

namespace {

struct CurvePoint {
  double q, intensity_correlation;
};

/// Returns the points (q, C_I) of an intensity-correlation curve on one side of q = 0, in order of
/// |q|, beginning with C_I = 1 at q = 0. The side is q > 0 if there is a positive q.
std::vector<CurvePoint> one_side(const std::vector<double>& tilt_q,
                                 std::span<const Complex> correlation) {
  const bool positive = std::any_of(tilt_q.begin(), tilt_q.end(), [](double q) { return q > 0; });
  std::vector<CurvePoint> curve{{0, 1}};
  for (std::size_t t = 0; t < tilt_q.size(); ++t) {
    const double q = positive ? tilt_q[t] : -tilt_q[t];
    if (q > 0) curve.push_back({q, std::norm(correlation[t])});
  }
  std::sort(curve.begin(), curve.end(),
            [](const CurvePoint& a, const CurvePoint& b) { return a.q < b.q; });
  // A tilt given twice would lead to a division by 0 in the interpolation.
  curve.erase(std::unique(curve.begin(), curve.end(),
                          [](const CurvePoint& a, const CurvePoint& b) { return a.q == b.q; }),
              curve.end());
  return curve;
}

/// Returns C_I at q by Lagrange interpolation through up to six points around the interval [i, i +
/// 1].
double interpolate(const std::vector<CurvePoint>& curve, std::size_t i, double q) {
  const std::size_t first = i > 1 ? i - 2 : 0, last = std::min(i + 3, curve.size() - 1);
  double sum = 0;
  for (std::size_t a = first; a <= last; ++a) {
    double basis = curve[a].intensity_correlation;
    for (std::size_t b = first; b <= last; ++b)
      if (b != a) basis *= (q - curve[b].q) / (curve[a].q - curve[b].q);
    sum += basis;
  }
  return sum;
}

std::size_t place_of_zero(const std::vector<double>& steps) {
  return static_cast<std::size_t>(std::find(steps.begin(), steps.end(), 0.0) - steps.begin());
}

/// Returns the sum over views of the products of reference and moved intensity.
double intensity_products(const CovarianceRequest& request, std::span<const Complex> entries,
                          const std::vector<std::size_t>& views, std::size_t move) {
  double sum = 0;
  for (const std::size_t v : views)
    sum += entries[request.reference_intensity(v)].real() *
           entries[request.tilted_intensity(move, v)].real();
  return sum;
}

/// Returns by how much noise raises each C_E on average: the mean of an estimate of C_E^2 exceeds
/// C_E^2 by the variance of C. moves: C_E of every move.
std::vector<double> excess_by_noise(const GroupedSums& sums, const Estimator& correlation,
                                    std::span<const Complex> moves) {
  const auto bias = jackknife_bias(sums, [&](double samples, std::span<const Complex> total) {
    std::vector<Complex> squares = correlation(samples, total);
    for (Complex& square : squares) square = std::norm(square);
    return squares;
  });
  std::vector<double> excess;
  for (std::size_t move = 0; move < moves.size(); ++move) {
    const double raised = moves[move].real(), square = raised * raised;
    excess.push_back(raised - std::sqrt(std::clamp(square - bias[move].real(), 0.0, square)));
  }
  return excess;
}

/// Returns the ranges that Correlations describes. moves: C_E of every move.
std::vector<Range> ranges(const CovarianceRequest& request, std::span<const Complex> moves) {
  using Kind = CovarianceRequest::Kind;
  if (request.kind == Kind::translation) return {memory_effect_range(request.shifts, moves)};
  if (request.kind != Kind::tilt_shift) return {memory_effect_range(request.tilt_q, moves)};
  const std::size_t shifts = request.shifts.size(), no_tilt = place_of_zero(request.tilts),
                    no_shift = place_of_zero(request.shifts);
  std::vector<Complex> along_tilts;
  for (std::size_t t = 0; t < request.tilts.size(); ++t)
    along_tilts.push_back(moves[t * shifts + no_shift]);
  const auto along_shifts = moves.subspan(no_tilt * shifts, shifts),
             matched = moves.subspan(request.tilts.size() * shifts);
  std::vector<Range> found = {memory_effect_range(request.tilt_q, along_tilts),
                              memory_effect_range(request.shifts, along_shifts)};
  if (!matched.empty()) found.push_back(memory_effect_range(request.tilt_q, matched));
  return found;
}

std::vector<Complex> with_ranges(const CovarianceRequest& request, std::vector<Complex> moves) {
  for (const Range& range : ranges(request, std::span(moves))) moves.emplace_back(range.value);
  return moves;
}

}  // namespace

std::vector<std::vector<std::size_t>> view_groups(const CovarianceRequest& request) {
  std::vector<std::vector<std::size_t>> sides(2);
  for (std::size_t v = 0; v < request.reference_views; ++v) {
    const View& view = request.views[v];
    sides[!view.near && std::cos(view.angle) <= 0].push_back(v);
  }
  std::erase_if(sides, [](const auto& side) { return side.empty(); });
  return sides;
}

std::vector<Complex> field_correlation(const CovarianceRequest& request,
                                       std::span<const Complex> entries,
                                       const std::vector<std::size_t>& views) {
  std::vector<Complex> correlation;
  for (std::size_t move = 0; move < request.moves; ++move) {
    double square = 0;
    for (const std::size_t v : views) square += std::norm(entries[request.tilted_entry(move, v)]);
    const double product = intensity_products(request, entries, views, move);
    correlation.emplace_back(product > 0 ? std::sqrt(square / product) : 0);
  }
  return correlation;
}

std::vector<Complex> field_correlation(const CovarianceRequest& request,
                                       std::span<const Complex> entries) {
  return field_correlation(request, entries, view_groups(request).front());
}

Range memory_effect_range(const std::vector<double>& tilt_q, std::span<const Complex> correlation) {
  const auto curve = one_side(tilt_q, correlation);
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    if (curve[i + 1].intensity_correlation > 0.5) continue;
    if (i == 0) return {curve[1].q, Range::Censoring::below_value};
    double above = curve[i].q, below = curve[i + 1].q;
    for (int step = 0; step < 60; ++step) {
      const double middle = (above + below) / 2;
      (interpolate(curve, i, middle) > 0.5 ? above : below) = middle;
    }
    return {(above + below) / 2, Range::Censoring::none};
  }
  return {curve.back().q, Range::Censoring::above_value};
}

RangeTilt tilt_of_range(const CovarianceRequest& request, double k, double range) {
  constexpr double most = 1 - 1e-12;  // just above the horizon
  const Light& light = request.lights.front();
  const Vec w = light.direction();
  const double along = std::sin(light.angle) * std::cos(light.azimuth - request.tilt_azimuth),
               turning = std::hypot(along, w.z), from = std::atan2(along, w.z);
  const bool forward = w.z >= 0, positive = std::ranges::any_of(request.tilt_q, [](double q) {
    return q > 0;
  });
  const double sine = (along + (positive ? range : -range) / k) / turning,
               nearest = std::asin(std::clamp(sine, -most, most)),
               to = forward ? nearest : std::numbers::pi - nearest,
               rotation = std::abs(std::remainder(to - from, 2 * std::numbers::pi)),
               per_q = 1 / (k * turning * std::cos(nearest)),
               between = 2 * std::asin(turning * std::sin(rotation / 2));
  return {rotation, per_q, between,
          per_q * turning * std::cos(rotation / 2) / std::cos(between / 2)};
}

bool is_tilted_aside(const CovarianceRequest& request) {
  const Light& light = request.lights.front();
  return std::abs(std::sin(light.angle) * std::sin(light.azimuth - request.tilt_azimuth)) > 1e-9;
}

std::size_t steps_below(const std::vector<double>& steps, const Range& range) {
  return static_cast<std::size_t>(std::count_if(steps.begin(), steps.end(), [&](double step) {
    return std::abs(step) > 0 && std::abs(step) < range.value;
  }));
}

bool few_steps(const std::vector<double>& steps, const Range& range) {
  constexpr std::size_t enough = 4;
  return range.censored == Range::Censoring::none && steps_below(steps, range) < enough;
}

std::vector<Complex> correlation_and_ranges(const CovarianceRequest& request,
                                            std::span<const Complex> entries) {
  return with_ranges(request, field_correlation(request, entries));
}

Correlations correlations(const CovarianceRequest& request, const GroupedSums& sums,
                          const Estimator& covariance, const std::vector<std::size_t>& views) {
  const auto curve = [&](double samples, std::span<const Complex> total) {
    return field_correlation(request, covariance(samples, total), views);
  };
  const auto all = jackknife(sums, [&](double samples, std::span<const Complex> total) {
    return with_ranges(request, curve(samples, total));
  });
  Correlations found{part(all, 0, request.moves), {}};
  const auto excess = excess_by_noise(sums, curve, found.moves.value);
  for (std::size_t move = 0; move < request.moves; ++move)
    found.moves.error[move] = std::hypot(found.moves.error[move], excess[move]);
  for (const Range& range : ranges(request, found.moves.value)) {
    const std::size_t entry = request.moves + found.ranges.size();
    found.ranges.push_back({range, all.error[entry], all.rare[entry]});
  }
  return found;
}

MemoryEffect memory_effect(const CovarianceRequest& request, const GroupedSums& sums,
                           const Estimator& covariance) {
  const auto [moves, ranges] =
      correlations(request, sums, covariance, view_groups(request).front());
  return {real_parts(moves.value), moves.error, moves.rare, ranges.front()};
}

}  // namespace flatspeckle::mc
