#include "mc/fit/task/curve_values.h"

#include <algorithm>
#include <cmath>

#include "mc/jobs/contrast.h"
#include "mc/slab/adding/space.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

Scene scene_of(const SceneSpec& spec) {
  const Scene scene = make_scene(spec);
  return spec.dimension == 3 ? in_space(scene, spec) : scene;
}

bool is_flux(Observable observable) {
  return observable == Observable::reflectance || observable == Observable::transmittance;
}

bool needs_reversed(const Scene& scene) {
  constexpr double negligible = 1e-3;
  const double width = 1 / (scene.k * scene.medium.transport_mean_free_path());
  for (const Channel& channel : scene.request.channels) {
    const View& view = scene.request.views[channel.view];
    const Light& light = scene.request.lights[channel.light];
    if (view.near || light.kind != Light::Kind::plane) return true;
    if (std::cos(view.angle) > 0) continue;
    const double angle = std::abs(std::sin(light.angle) + std::sin(view.angle));
    if (angle * negligible < width) return true;
  }
  return false;
}

namespace {

/// Returns the index of `one` in a list. If it is missing, it is appended.
template <typename List, typename One>
std::uint32_t place_in(List& list, const One& one) {
  const auto found = std::ranges::find(list, one);
  const auto place = static_cast<std::uint32_t>(found - list.begin());
  if (found == list.end()) list.push_back(one);
  return place;
}

/// Adds the channels and entries of another request to a request of kind pairs.
void append_pairs(CovarianceRequest& all, const CovarianceRequest& more) {
  const auto channels = static_cast<std::uint32_t>(all.channels.size());
  all.kind = CovarianceRequest::Kind::pairs;
  for (const Channel& channel : more.channels)
    all.channels.push_back({place_in(all.lights, more.lights[channel.light]),
                            place_in(all.views, more.views[channel.view])});
  for (const Entry& entry : more.entries)
    all.entries.push_back({entry.a + channels, entry.b + channels});
}

/// Computes observables from covariances: intensities of all channels, [light][view], then the
/// covariance of the fields at time 0 and after each delay, [delay][light][view].
class Decays {
 public:
  Decays(const Curve& curve, double beta, std::size_t channels, std::span<const Complex> entries)
      : curve_(curve), beta_(beta), channels_(channels), entries_(entries) {}

  double value(std::size_t time, std::size_t channel) const {
    if (curve_.observable == Observable::squared_contrast) return contrast(time, channel);
    const Complex now = correlation(time, channel);
    const double value = curve_.flows ? std::abs(now) : now.real();
    return curve_.observable == Observable::intensity_correlation ? value * value : value;
  }

 private:
  Complex correlation(std::size_t delay, std::size_t channel) const {
    const double intensity = entries_[channel].real();
    return intensity > 0 ? entries_[(1 + delay) * channels_ + channel] / intensity : 0;
  }

  double contrast(std::size_t time, std::size_t channel) const {
    std::vector<double> squares;
    for (std::size_t t = 0; t < curve_.delays.size(); ++t)
      squares.push_back(std::norm(correlation(t, channel)));
    return beta_ * exposed(curve_.delays, squares, curve_.times[time]);
  }

  const Curve& curve_;
  double beta_;
  std::size_t channels_;
  std::span<const Complex> entries_;
};

}  // namespace

Scene joint_scene(const Media& media, const std::vector<std::size_t>& curves) {
  Scene joint = media[curves.front()].scene;
  joint.request = {};
  for (const std::size_t i : curves) append_pairs(joint.request, media[i].scene.request);
  return joint;
}

std::vector<double> observed(const Curve& curve, double beta, const CovarianceRequest& request,
                             std::span<const Complex> entries) {
  std::vector<double> values;
  if (curve.moving()) {
    const std::size_t channels = request.entries.size();
    const Decays decays(curve, beta, channels, entries);
    for (const std::size_t entry : curve.entries)
      values.push_back(decays.value(entry / channels, entry % channels));
    return values;
  }
  if (curve.observable == Observable::field_covariance) return packed(entries);
  const bool intensity = curve.observable == Observable::intensity;
  const auto all = intensity ? std::vector<Complex>(entries.begin(), entries.end())
                             : field_correlation(request, entries);
  for (const std::size_t entry : curve.entries) {
    const double value = all[entry].real();
    values.push_back(curve.observable == Observable::intensity_correlation ? value * value : value);
  }
  return values;
}

}  // namespace flatspeckle::mc
