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

std::vector<View> FarCamera::views() const {
  const double x = std::abs(axis.x) + aperture, y = std::abs(axis.y) + aperture;
  if (x * x + y * y >= 1)
    throw InputError(
        "camera_aperture", aperture,
        "must be smaller: a corner of the camera would see directions past the horizon");
  std::vector<View> list;
  for (std::size_t row = 0; row < pixels; ++row)
    for (std::size_t column = 0; column < pixels; ++column) {
      const double vx = cosine(axis.x, column), vy = cosine(axis.y, row),
                   z = std::copysign(std::sqrt(1 - vx * vx - vy * vy), axis.z);
      list.push_back(far_view(std::atan2(std::hypot(vx, vy), z), std::atan2(vy, vx)));
    }
  return list;
}

std::vector<Vec> read_points(const std::string& key, const std::string& path, bool in_space) {
  std::vector<std::string> columns{"x", "z"};
  if (in_space) columns.emplace_back("y");
  const Table table = read_key_table(key, path, columns);
  std::vector<Vec> points;
  for (std::size_t row = 0; row < table.rows(); ++row)
    points.push_back({table.column("x")[row], table.column("z")[row],
                      table.has("y") ? table.column("y")[row] : 0});
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

/// Direction in which transverse momenta change: x in the plane, any azimuth in space.
class Across {
 public:
  explicit Across(double azimuth) : azimuth_(azimuth), along_(direction(pi / 2, azimuth)) {
    along_.z = 0;
  }

  Light tilted(Light light, double tilt) const {
    const double before = light.direction().z;
    if (light.azimuth == azimuth_)
      light.angle += tilt;
    else if (tilt != 0)
      point(light, rotated(light.direction(), tilt));
    if (light.direction().z * before <= 0)
      throw InputError("tilts", tilt, "takes the light past the horizon (tilts are in radians)");
    return light;
  }

  double tilt_over_k(const Light& light, double tilt) const {
    if (tilt == 0) return 0;
    if (light.azimuth == azimuth_) return std::sin(light.angle + tilt) - std::sin(light.angle);
    return dot(along_, rotated(light.direction(), tilt) - light.direction());
  }

  /// Returns the far view on the same side of the medium whose transverse momentum is larger by
  /// q_over_k than that of `view`, in units of k. key and value are used in error messages.
  View deflected(View view, double q_over_k, const std::string& key, double value) const {
    if (q_over_k == 0) return view;
    if (view.azimuth == azimuth_) return deflected_in_plane(view, q_over_k, key, value);
    Vec w = view.direction() + q_over_k * along_;
    const double transverse = w.x * w.x + w.y * w.y;
    if (transverse >= 1) refuse(view, key, value);
    w.z = std::copysign(std::sqrt(1 - transverse), w.z);
    point(view, w);
    return view;
  }

  template <typename End>
  End translated(End end, double shift) const {
    end.point = end.point + shift * along_;
    return end;
  }

 private:
  /// Rotates w about the axis that is parallel to the faces and perpendicular to along_.
  Vec rotated(Vec w, double tilt) const {
    const double across = dot(along_, w), deep = w.z;
    const Vec rest = w - across * along_ - Vec{0, deep};
    return rest + (std::cos(tilt) * across + std::sin(tilt) * deep) * along_ +
           Vec{0, std::cos(tilt) * deep - std::sin(tilt) * across};
  }

  template <typename End>
  static void point(End& end, Vec w) {
    end.angle = std::atan2(std::hypot(w.x, w.y), w.z);
    end.azimuth = std::atan2(w.y, w.x);
  }

  [[noreturn]] static void refuse(const View& view, const std::string& key, double value) {
    throw InputError(key, value,
                     "takes view angle " + std::to_string(view.angle) + " past the horizon");
  }

  static View deflected_in_plane(const View& view, double q_over_k, const std::string& key,
                                 double value) {
    const double sine = std::sin(view.angle) + q_over_k;
    if (std::abs(sine) >= 1) refuse(view, key, value);
    const double forward = std::asin(sine);
    if (std::cos(view.angle) >= 0) return far_view(forward, view.azimuth);
    return far_view(sine >= 0 ? pi - forward : -pi - forward, view.azimuth);
  }

  double azimuth_;
  Vec along_;
};

/// For each tilt of the light, adds the fields in the matched views: k sin(view angle) changes by
/// as much as k sin(light angle) (C19).
void add_matched(CovarianceRequest& request, Moves& moves, const Light& light) {
  const Across across(request.tilt_azimuth);
  for (double tilt : request.tilts) {
    const double q_over_k = across.tilt_over_k(light, tilt);
    moves.add(across.tilted(light, tilt),
              [&](const View& view) { return across.deflected(view, q_over_k, "tilts", tilt); });
  }
}

void set_tilts(CovarianceRequest& request, double k, const Light& light, std::vector<double> tilts,
               double azimuth) {
  request.tilts = std::move(tilts);
  request.tilt_azimuth = azimuth;
  request.tilt_q = tilt_momenta(k, light, request.tilts, azimuth);
}

}  // namespace

Lights tilted_lights(const Light& light, const std::vector<double>& tilts, double tilt_azimuth) {
  Lights lights;
  for (const double tilt : tilts) lights.push_back(Across(tilt_azimuth).tilted(light, tilt));
  return lights;
}

std::vector<double> tilt_momenta(double k, const Light& light, const std::vector<double>& tilts,
                                 double tilt_azimuth) {
  std::vector<double> momenta;
  for (const double tilt : tilts)
    momenta.push_back(k * Across(tilt_azimuth).tilt_over_k(light, tilt));
  return momenta;
}

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
    const auto& azimuths = pair.azimuths;
    const auto a = channels.number(plane_wave(pair.light1, azimuths[0]),
                                   far_view(pair.view1, azimuths[1])),
               b = channels.number(plane_wave(pair.light2, azimuths[2]),
                                   far_view(pair.view2, azimuths[3]));
    request.entries.push_back({a, b});
  }
  return request;
}

CovarianceRequest memory_effect_request(double k, double light, const std::vector<double>& views,
                                        std::vector<double> tilts) {
  return memory_effect_request(k, plane_wave(light), far_views(views), std::move(tilts), 0);
}

CovarianceRequest memory_effect_request(double k, const Light& light,
                                        const std::vector<View>& views, std::vector<double> tilts,
                                        double tilt_azimuth) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::memory_effect;
  set_tilts(request, k, light, std::move(tilts), tilt_azimuth);
  Moves moves(request, light, views);
  add_matched(request, moves, light);
  moves.list_entries();
  return request;
}

CovarianceRequest tilt_shift_request(double k, const Light& light, const std::vector<View>& views,
                                     std::vector<double> tilts, std::vector<double> shifts,
                                     double tilt_azimuth) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::tilt_shift;
  request.shifts = std::move(shifts);
  set_tilts(request, k, light, std::move(tilts), tilt_azimuth);
  const Across across(tilt_azimuth);
  Moves moves(request, light, views);
  for (double tilt : request.tilts) {
    const Light moved = across.tilted(light, tilt);
    for (double shift : request.shifts)
      moves.add(moved, [&](const View& view) {
        return view.near ? across.translated(view, shift)
                         : across.deflected(view, shift / k, "shifts", shift);
      });
  }
  if (!views.front().near) add_matched(request, moves, light);
  moves.list_entries();
  return request;
}

CovarianceRequest translation_request(const Light& light, const std::vector<View>& views,
                                      std::vector<double> shifts, double azimuth) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::translation;
  request.shifts = std::move(shifts);
  request.tilt_azimuth = azimuth;
  const Across across(azimuth);
  Moves moves(request, light, views);
  for (double shift : request.shifts)
    moves.add(across.translated(light, shift),
              [&](const View& view) { return view.near ? across.translated(view, shift) : view; });
  moves.list_entries();
  return request;
}

}  // namespace flatspeckle
