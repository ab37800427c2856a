#include "flatland/request.h"

#include <unistd.h>

#include <cmath>
#include <numbers>

#include "core/complex.h"
#include "core/error.h"

namespace flatspeckle {

namespace {

constexpr double pi = std::numbers::pi;

std::uint32_t as_index(std::size_t n) { return static_cast<std::uint32_t>(n); }

CovarianceRequest every_channel(std::vector<double> lights, std::vector<View> views) {
  CovarianceRequest request;
  request.lights = std::move(lights);
  request.views = std::move(views);
  for (std::size_t light = 0; light < request.lights.size(); ++light)
    for (std::size_t view = 0; view < request.views.size(); ++view)
      request.channels.push_back({as_index(light), as_index(view)});
  return request;
}

/// The number of a value in a list, to which it is added where it is new.
template <typename T>
std::uint32_t number_of(std::vector<T>& list, const T& value, bool (*same)(const T&, const T&)) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (same(list[i], value)) return as_index(i);
  list.push_back(value);
  return as_index(list.size() - 1);
}

std::uint32_t light_number(CovarianceRequest& request, double angle) {
  return number_of<double>(request.lights, angle, [](const double& a, const double& b) { return a == b; });
}

std::uint32_t view_number(CovarianceRequest& request, const View& view) {
  return number_of<View>(request.views, view, [](const View& a, const View& b) {
    return a.near == b.near && a.angle == b.angle && a.point.x == b.point.x &&
           a.point.z == b.point.z;
  });
}

std::uint32_t channel_number(CovarianceRequest& request, double light, double view) {
  const Channel channel{light_number(request, light), view_number(request, far_view(view))};
  return number_of<Channel>(request.channels, channel,
                            [](const Channel& a, const Channel& b) { return a == b; });
}

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
    throw InputError("tilts", tilt,
                     "takes the matched view of view angle " + std::to_string(view) +
                         " past the horizon");
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
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                        static_cast<double>(sysconf(_SC_PAGE_SIZE));
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
  for (const auto& pair : pairs) {
    const auto a = channel_number(request, pair.light1, pair.view1);
    request.entries.push_back({a, channel_number(request, pair.light2, pair.view2)});
  }
  return request;
}

CovarianceRequest memory_effect_request(double k, double light, std::vector<double> views,
                                        std::vector<double> tilts) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::memory_effect;
  request.tilts = std::move(tilts);
  request.reference_views = views.size();
  std::vector<std::uint32_t> reference, tilted;
  for (double view : views) reference.push_back(channel_number(request, light, view));
  for (double tilt : request.tilts) {
    const double light2 = tilted_light(light, tilt);
    const double q_over_k = tilt == 0 ? 0 : std::sin(light2) - std::sin(light);
    request.tilt_q.push_back(k * q_over_k);
    for (double view : views)
      tilted.push_back(channel_number(request, light2, matched_view(view, q_over_k, tilt)));
  }
  for (std::size_t i = 0; i < tilted.size(); ++i)
    request.entries.push_back({reference[i % views.size()], tilted[i]});
  for (auto channel : reference) request.entries.push_back({channel, channel});
  for (auto channel : tilted) request.entries.push_back({channel, channel});
  return request;
}

}  // namespace flatspeckle
