#include "flatland/request.h"

#include <cmath>
#include <map>
#include <numbers>

#include "core/complex.h"
#include "core/error.h"
#include "core/memory.h"

namespace flatspeckle {

namespace {

constexpr double pi = std::numbers::pi;

std::uint32_t as_index(std::size_t n) {
  return static_cast<std::uint32_t>(n);
}

CovarianceRequest every_channel(std::vector<double> lights, std::vector<View> views) {
  CovarianceRequest request;
  request.lights = std::move(lights);
  request.views = std::move(views);
  for (std::size_t light = 0; light < request.lights.size(); ++light)
    for (std::size_t view = 0; view < request.views.size(); ++view)
      request.channels.push_back({as_index(light), as_index(view)});
  return request;
}

/// Numbers things as they come; equal ones share a number.
template <typename Key>
class Numbering {
 public:
  /// The number of `key`, and whether it is new.
  std::pair<std::uint32_t, bool> number(const Key& key) {
    const auto [known, is_new] = numbers_.emplace(key, as_index(numbers_.size()));
    return {known->second, is_new};
  }

 private:
  std::map<Key, std::uint32_t> numbers_;
};

double tilted_light(double light, double tilt) {
  const double tilted = light + tilt;
  if (std::cos(tilted) * std::cos(light) <= 0)
    throw InputError("tilts", tilt, "takes the light past the horizon");
  return tilted;
}

/// The view on the same side whose sine is larger by q/k.
double matched_view(double view, double q_over_k, double tilt) {
  if (q_over_k == 0) return view;
  const double sine = std::sin(view) + q_over_k;
  if (std::abs(sine) >= 1) {
    throw InputError(
        "tilts", tilt,
        "takes the matched view of view angle " + std::to_string(view) + " past the horizon");
  }
  const double forward = std::asin(sine);
  if (std::cos(view) >= 0) return forward;
  return sine >= 0 ? pi - forward : -pi - forward;
}

}  // namespace

CovarianceRequest intensity_request(std::vector<double> lights, std::vector<View> views) {
  auto request = every_channel(std::move(lights), std::move(views));
  request.kind = CovarianceRequest::Kind::intensity;
  for (std::size_t c = 0; c < request.channels.size(); ++c)
    request.entries.push_back({as_index(c), as_index(c)});
  return request;
}

CovarianceRequest full_request(std::vector<double> lights, std::vector<View> views) {
  auto request = every_channel(std::move(lights), std::move(views));
  request.kind = CovarianceRequest::Kind::full;
  const std::size_t n = request.channels.size(), entries = n * (n + 1) / 2;
  // About twenty copies of the sums are held: the groups and the batches in hand.
  const double bytes = 20.0 * sizeof(Complex) * static_cast<double>(entries);
  const double memory = physical_memory();
  if (bytes > 0.8 * memory) {
    throw InputError("covariance", "full",
                     std::to_string(n) + " channels need " + std::to_string(bytes / 1e9) +
                         " GB, this machine has " + std::to_string(memory / 1e9));
  }
  request.entries.reserve(entries);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b <= a; ++b) request.entries.push_back({as_index(a), as_index(b)});
  return request;
}

CovarianceRequest pairs_request(const std::vector<AnglePair>& pairs) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::pairs;
  Numbering<double> lights, views;
  Numbering<std::pair<std::uint32_t, std::uint32_t>> channels;
  const auto channel = [&](double light_angle, double view_angle) {
    const auto [light, new_light] = lights.number(light_angle);
    const auto [view, new_view] = views.number(view_angle);
    if (new_light) request.lights.push_back(light_angle);
    if (new_view) request.views.push_back(far_view(view_angle));
    const auto [number, is_new] = channels.number({light, view});
    if (is_new) request.channels.push_back({light, view});
    return number;
  };
  for (const auto& pair : pairs) {
    const auto a = channel(pair.light1, pair.view1);
    request.entries.push_back({a, channel(pair.light2, pair.view2)});
  }
  return request;
}

CovarianceRequest memory_effect_request(double k, double light, std::vector<double> views,
                                        std::vector<double> tilts) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::memory_effect;
  request.tilts = std::move(tilts);
  request.reference_views = views.size();
  std::vector<std::uint32_t> tilted;  // channels [tilt][view]
  const auto add_light = [&](double angle, double q_over_k, double tilt) {
    request.lights.push_back(angle);
    for (double view : views) {
      request.views.push_back(far_view(matched_view(view, q_over_k, tilt)));
      request.channels.push_back(
          {as_index(request.lights.size() - 1), as_index(request.views.size() - 1)});
    }
  };
  add_light(light, 0, 0);
  for (double tilt : request.tilts) {
    const double angle = tilted_light(light, tilt);
    const double q_over_k = tilt == 0 ? 0 : std::sin(angle) - std::sin(light);
    request.tilt_q.push_back(k * q_over_k);
    const std::size_t first = tilt == 0 ? 0 : request.channels.size();
    if (tilt != 0) add_light(angle, q_over_k, tilt);
    for (std::size_t v = 0; v < views.size(); ++v) tilted.push_back(as_index(first + v));
  }
  for (std::size_t i = 0; i < tilted.size(); ++i)
    request.entries.push_back({as_index(i % views.size()), tilted[i]});
  for (std::size_t v = 0; v < views.size(); ++v)
    request.entries.push_back({as_index(v), as_index(v)});
  for (auto channel : tilted) request.entries.push_back({channel, channel});
  return request;
}

}  // namespace flatspeckle
