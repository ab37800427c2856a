#include "flatland/request/request.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/numbers/address_space.h"
#include "core/numbers/complex.h"

namespace flatspeckle {

std::vector<Vec2> read_points(const std::string& key, const std::string& path) {
  const Table table = read_key_table(key, path, {"x", "z"});
  std::vector<Vec2> points;
  for (std::size_t row = 0; row < table.rows(); ++row)
    points.push_back({table.column("x")[row], table.column("z")[row]});
  return points;
}

namespace {

constexpr double pi = std::numbers::pi;

std::uint32_t as_index(std::size_t n) {
  return static_cast<std::uint32_t>(n);
}

CovarianceRequest every_channel(Lights lights, std::vector<View> views) {
  CovarianceRequest request;
  request.lights = std::move(lights);
  request.views = std::move(views);
  for (std::size_t light = 0; light < request.lights.size(); ++light)
    for (std::size_t view = 0; view < request.views.size(); ++view)
      request.channels.push_back({as_index(light), as_index(view)});
  return request;
}

/// Collects distinct things in a list, in the order in which they first appear. number() returns
/// the index of a thing in the list.
template <typename Thing, typename List>
class Numbering {
 public:
  explicit Numbering(List& list) : list_(list) {}

  std::uint32_t number(const Thing& thing) {
    const auto [known, is_new] = numbers_.emplace(thing, as_index(list_.size()));
    if (is_new) list_.push_back(thing);
    return known->second;
  }

 private:
  List& list_;
  std::map<Thing, std::uint32_t> numbers_;
};

/// Collects the lights, views and channels of a request, each once.
class ChannelList {
 public:
  explicit ChannelList(CovarianceRequest& request)
      : lights_(request.lights), views_(request.views), channels_(request.channels) {}

  std::uint32_t number(const Light& light, const View& view) {
    return channels_.number({lights_.number(light), views_.number(view)});
  }

 private:
  Numbering<Light, Lights> lights_;
  Numbering<View, std::vector<View>> views_;
  Numbering<Channel, std::vector<Channel>> channels_;
};

/// Builds a request that compares a reference field with moved fields, whose light or views are
/// tilted or shifted. Adds their channels; list_entries() then lists the entries in the order that
/// is documented at CovarianceRequest.
class Moves {
 public:
  Moves(CovarianceRequest& request, const Light& light, const std::vector<View>& views)
      : request_(request), channels_(request), views_(views) {
    for (const View& view : views) reference_.push_back(channels_.number(light, view));
    request.reference_views = views.size();
  }

  template <typename MovedView>
  void add(const Light& light, MovedView moved) {
    for (const View& view : views_) moved_.push_back(channels_.number(light, moved(view)));
    ++request_.moves;
  }

  void list_entries() {
    for (std::size_t i = 0; i < moved_.size(); ++i)
      request_.entries.push_back({reference_[i % reference_.size()], moved_[i]});
    for (auto channel : reference_) request_.entries.push_back({channel, channel});
    for (auto channel : moved_) request_.entries.push_back({channel, channel});
  }

 private:
  CovarianceRequest& request_;
  ChannelList channels_;
  const std::vector<View>& views_;
  std::vector<std::uint32_t> reference_, moved_;
};

Light tilted(Light light, double tilt) {
  const double angle = light.angle + tilt;
  if (std::cos(angle) * std::cos(light.angle) <= 0)
    throw InputError("tilts", tilt, "takes the light past the horizon");
  light.angle = angle;
  return light;
}

double tilt_over_k(const Light& light, double tilt) {
  return tilt == 0 ? 0 : std::sin(light.angle + tilt) - std::sin(light.angle);
}

/// Returns the far view on the same side of the medium for which sin(angle) is larger by q_over_k
/// than for `view`. key and value are used in error messages.
View deflected(const View& view, double q_over_k, const std::string& key, double value) {
  if (q_over_k == 0) return view;
  const double sine = std::sin(view.angle) + q_over_k;
  if (std::abs(sine) >= 1)
    throw InputError(key, value,
                     "takes view angle " + std::to_string(view.angle) + " past the horizon");
  const double forward = std::asin(sine);
  if (std::cos(view.angle) >= 0) return far_view(forward);
  return far_view(sine >= 0 ? pi - forward : -pi - forward);
}

Light translated(Light light, double shift) {
  light.point.x += shift;
  return light;
}

View translated(View view, double shift) {
  if (view.near) view.point.x += shift;
  return view;
}

/// For each tilt of the light, adds the fields in the matched views: k sin(view angle) changes by
/// as much as k sin(light angle) (C19).
void add_matched(CovarianceRequest& request, Moves& moves, const Light& light) {
  for (double tilt : request.tilts) {
    const double q_over_k = tilt_over_k(light, tilt);
    moves.add(tilted(light, tilt),
              [&](const View& view) { return deflected(view, q_over_k, "tilts", tilt); });
  }
}

void set_tilts(CovarianceRequest& request, double k, const Light& light,
               std::vector<double> tilts) {
  request.tilts = std::move(tilts);
  for (double tilt : request.tilts) request.tilt_q.push_back(k * tilt_over_k(light, tilt));
}

}  // namespace

bool CovarianceRequest::transmission_only() const {
  return std::all_of(views.begin(), views.end(),
                     [](const View& view) { return std::cos(view.angle) > 0; });
}

std::vector<double> CovarianceRequest::reference_angles() const {
  std::vector<double> angles;
  for (std::size_t v = 0; v < reference_views; ++v) angles.push_back(views[v].angle);
  return angles;
}

bool has_near_endpoints(const CovarianceRequest& request) {
  return !request.lights.all(Light::Kind::plane) || std::ranges::any_of(request.views, &View::near);
}

CovarianceRequest intensity_request(Lights lights, std::vector<View> views) {
  auto request = every_channel(std::move(lights), std::move(views));
  request.kind = CovarianceRequest::Kind::intensity;
  for (std::size_t c = 0; c < request.channels.size(); ++c)
    request.entries.push_back({as_index(c), as_index(c)});
  return request;
}

CovarianceRequest full_request(Lights lights, std::vector<View> views) {
  auto request = every_channel(std::move(lights), std::move(views));
  request.kind = CovarianceRequest::Kind::full;
  const std::size_t n = request.channels.size(), entries = n * (n + 1) / 2;
  // About twenty copies of the covariance sums are in memory at once: for the groups of batches
  // from which errors are estimated, and for the batches in progress.
  const double bytes = 20.0 * sizeof(Complex) * static_cast<double>(entries);
  const double memory = usable_memory();
  if (bytes > 0.8 * memory) {
    throw InputError("covariance", "full",
                     std::to_string(n) + " channels need " + std::to_string(bytes / 1e9) +
                         " GB of memory; available GB: " + std::to_string(memory / 1e9));
  }
  request.entries.reserve(entries);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b <= a; ++b) request.entries.push_back({as_index(a), as_index(b)});
  return request;
}

CovarianceRequest pairs_request(const std::vector<AnglePair>& pairs) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::pairs;
  ChannelList channels(request);
  for (const auto& pair : pairs) {
    const auto a = channels.number(plane_wave(pair.light1), far_view(pair.view1));
    request.entries.push_back({a, channels.number(plane_wave(pair.light2), far_view(pair.view2))});
  }
  return request;
}

CovarianceRequest memory_effect_request(double k, double light, const std::vector<double>& views,
                                        std::vector<double> tilts) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::memory_effect;
  const auto reference_views = far_views(views);
  set_tilts(request, k, plane_wave(light), std::move(tilts));
  Moves moves(request, plane_wave(light), reference_views);
  add_matched(request, moves, plane_wave(light));
  moves.list_entries();
  return request;
}

CovarianceRequest tilt_shift_request(double k, const Light& light, const std::vector<View>& views,
                                     std::vector<double> tilts, std::vector<double> shifts) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::tilt_shift;
  request.shifts = std::move(shifts);
  set_tilts(request, k, light, std::move(tilts));
  Moves moves(request, light, views);
  for (double tilt : request.tilts) {
    const Light moved = tilted(light, tilt);
    for (double shift : request.shifts)
      moves.add(moved, [&](const View& view) {
        return view.near ? translated(view, shift) : deflected(view, shift / k, "shifts", shift);
      });
  }
  if (!views.front().near) add_matched(request, moves, light);
  moves.list_entries();
  return request;
}

CovarianceRequest translation_request(const Light& light, const std::vector<View>& views,
                                      std::vector<double> shifts) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::translation;
  request.shifts = std::move(shifts);
  Moves moves(request, light, views);
  for (double shift : request.shifts)
    moves.add(translated(light, shift), [&](const View& view) { return translated(view, shift); });
  moves.list_entries();
  return request;
}

}  // namespace flatspeckle
