#include "flatland/scene/frequency_shift.h"

#include <cmath>
#include <numbers>

#include "core/error.h"

namespace flatspeckle {

std::size_t changing_entries(const CovarianceRequest& request) {
  return request.has_reference() ? request.reference_intensity(0) : request.entries.size();
}

double matched_view(double light1, double view1, double light2, double view2, double shift) {
  if (shift == 0) return view2;
  const double turned =
      std::asin(std::sin(light2) - (std::sin(light1) - std::sin(view1)) / (1 + shift));
  return std::cos(view2) > 0 ? turned : std::numbers::pi - turned;
}

double matched_view(const CovarianceRequest& request, const Entry& entry, double shift) {
  const Channel a = request.channels[entry.a], b = request.channels[entry.b];
  return matched_view(request.lights[a.light].angle, request.views[a.view].angle,
                      request.lights[b.light].angle, request.views[b.view].angle, shift);
}

Scene at_frequency(const Scene& scene, double shift) {
  Scene shifted = scene;
  shifted.k *= 1 + shift;
  shifted.wavelength /= 1 + shift;
  const CovarianceRequest& request = scene.request;
  CovarianceRequest& matched = shifted.request = {};
  matched.lights = request.lights;
  for (std::uint32_t e = 0; e < changing_entries(request); ++e) {
    matched.views.push_back(far_view(matched_view(request, request.entries[e], shift)));
    matched.channels.push_back({request.channels[request.entries[e].b].light, e});
    matched.entries.push_back({e, e});
  }
  return shifted;
}

void require_changing(const std::string& key, const CovarianceRequest& request) {
  using Kind = CovarianceRequest::Kind;
  if (request.kind != Kind::intensity && request.kind != Kind::memory_effect)
    throw InputError(key + ": requires covariance = intensity or memory_effect");
}

void check_frequency_shifts(const CovarianceRequest& request, const std::vector<double>& shifts) {
  if (has_near_endpoints(request))
    throw InputError("frequency_shifts: requires plane waves and far views");
  require_changing("frequency_shifts", request);
  for (const double shift : shifts) {
    if (!(std::abs(shift) <= 0.1))
      throw InputError("frequency_shifts", shift, "must be from -0.1 to 0.1");
    for (const Entry& entry : request.entries)
      if (!std::isfinite(matched_view(request, entry, shift)))
        throw InputError("frequency_shifts", shift, "takes the matched view past the horizon");
  }
}

}  // namespace flatspeckle
