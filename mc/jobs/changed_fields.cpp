#include "mc/jobs/changed_fields.h"

#include <algorithm>

#include "flatland/scene/frequency_shift.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// Returns the covariances after each change, [change][entry < changing_entries()], from all
/// quantities of the job, [1 + change][entry]. The first quantity is the covariance without change.
Values changed(const CovarianceRequest& request, const Values& all) {
  const std::size_t entries = request.entries.size();
  Values covariance;
  for (std::size_t i = entries; i < all.size(); ++i)
    if (i % entries < changing_entries(request)) covariance.push_back(all[i]);
  return covariance;
}

/// Returns ChangeEstimates::correlation from all quantities of the job, [1 + change][entry].
Values correlation(const CovarianceRequest& request, const Values& all) {
  const std::size_t entries = request.entries.size(), count = changing_entries(request);
  const Values covariance = changed(request, all);
  Values correlation, now(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(entries));
  for (std::size_t first = 0; first < covariance.size(); first += count) {
    if (request.has_reference()) {
      std::copy_n(covariance.begin() + static_cast<std::ptrdiff_t>(first), count, now.begin());
      const Values tilted = field_correlation(request, now);
      correlation.insert(correlation.end(), tilted.begin(), tilted.end());
      continue;
    }
    for (std::size_t c = 0; c < count; ++c)
      correlation.push_back(now[c].real() > 0 ? covariance[first + c] / now[c].real() : 0);
  }
  return correlation;
}

Values magnitude(const CovarianceRequest& request, const Values& all) {
  Values sizes = correlation(request, all);
  for (Complex& value : sizes) value = std::abs(value);
  return sizes;
}

}  // namespace

ChangeEstimates change_estimates(const CovarianceRequest& request, const PathJob& job,
                                 const GroupedSums& sums) {
  const auto estimate = [&](const auto& f) {
    return jackknife(sums, [&](double samples, std::span<const Complex> total) {
      return f(request, job.all(samples, total));
    });
  };
  return {estimate(changed), estimate(correlation), estimate(magnitude)};
}

}  // namespace flatspeckle::mc
