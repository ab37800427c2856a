#include "mc/slab/range_refinement.h"

#include <cmath>

#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

namespace {

/// By how much the differences move the range, relative to it; 0 of bounds.
double range_error(const CovarianceRequest& request, const Refined& refined) {
  auto moved = refined.value;
  for (std::size_t e = 0; e < moved.size(); ++e) moved[e] += refined.difference[e];
  const double range = correlation_and_ranges(request, refined.value).back().real(),
               other = correlation_and_ranges(request, moved).back().real();
  return std::abs(other / range - 1);
}

}  // namespace

Refined refined_range(const CovarianceRequest& request, const Refinement& refinement,
                      const std::function<Refined(const Refinement&)>& solve) {
  constexpr double step = 4, flattest = 256;  // curves move their range by so much more
  Refined refined = solve(refinement);
  if (request.kind != CovarianceRequest::Kind::memory_effect) return refined;
  for (double finer = step;
       finer <= flattest && range_error(request, refined) > refinement.tolerance; finer *= step) {
    Refinement next = refinement;
    next.tolerance /= finer;
    refined = solve(next);
  }
  return refined;
}

}  // namespace flatspeckle::mc
