#include "mc/theory/tilt_shift.h"

#include <algorithm>
#include <array>

namespace flatspeckle::mc {

namespace {

std::size_t place_of_zero(const std::vector<double>& steps) {
  return static_cast<std::size_t>(std::find(steps.begin(), steps.end(), 0.0) - steps.begin());
}

/// Half-widths of the correlations of every move.
std::array<Range, 3> ranges(const CovarianceRequest& request, std::span<const Complex> moves) {
  const std::size_t shifts = request.shifts.size();
  const std::size_t no_tilt = place_of_zero(request.tilts),
                    no_shift = place_of_zero(request.shifts);
  std::vector<Complex> along_tilts;
  for (std::size_t t = 0; t < request.tilts.size(); ++t)
    along_tilts.push_back(moves[t * shifts + no_shift]);
  const auto matched = moves.subspan(request.tilts.size() * shifts);
  return {memory_effect_range(request.tilt_q, along_tilts),
          memory_effect_range(request.shifts, moves.subspan(no_tilt * shifts, shifts)),
          matched.empty() ? Range{} : memory_effect_range(request.tilt_q, matched)};
}

}  // namespace

TiltShift tilt_shift(const CovarianceRequest& request, const GroupedSums& sums,
                     const Estimator& covariance) {
  // One jackknife for all: the correlations, then the ranges.
  const auto estimate = jackknife(sums, [&](double samples, std::span<const Complex> total) {
    auto values = field_correlation(request, covariance(samples, total));
    for (const Range& range : ranges(request, values)) values.emplace_back(range.value);
    return values;
  });
  const std::span moves(estimate.value.data(), request.moves);
  const std::size_t map = request.tilts.size() * request.shifts.size();
  const auto error = estimate.error.begin();
  const auto split = error + static_cast<std::ptrdiff_t>(map),
             end = error + static_cast<std::ptrdiff_t>(request.moves);
  TiltShift result;
  result.correlation = real_parts(moves.first(map));
  result.correlation_error.assign(error, split);
  result.matched = real_parts(moves.subspan(map));
  result.matched_error.assign(split, end);
  const auto found = ranges(request, moves);
  result.along_tilts = {found[0], end[0]};
  result.along_shifts = {found[1], end[1]};
  result.along_matched = {found[2], end[2]};
  return result;
}

}  // namespace flatspeckle::mc
