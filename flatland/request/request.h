#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "flatland/request/light.h"

namespace flatspeckle {

/// What records the field: a direction far away (amplitude A of C4) or a point (the scattered
/// field).
struct View {
  bool near = false;
  double angle = 0;  ///< far view
  Vec2 point;        ///< near sensor
  auto operator<=>(const View&) const = default;
};

inline View far_view(double angle) {
  return {false, angle, {}};
}
inline std::vector<View> far_views(const std::vector<double>& angles) {
  std::vector<View> views;
  for (double angle : angles) views.push_back(far_view(angle));
  return views;
}
inline View near_sensor(Vec2 point) {
  return {true, 0, point};
}

/// Reads columns x, z; at least one row. Throws InputError.
std::vector<Vec2> read_points(const std::string& key, const std::string& path);

/// Where the covariance of channels b <= a stands among the entries of a full_request().
inline std::size_t triangle_entry(std::size_t a, std::size_t b) {
  return a * (a + 1) / 2 + b;
}

/// The intensities of so many channels, of all covariances.
inline std::vector<Complex> diagonal(std::span<const Complex> triangle, std::size_t channels) {
  std::vector<Complex> found;
  for (std::size_t a = 0; a < channels; ++a) found.push_back(triangle[triangle_entry(a, a)]);
  return found;
}

/// One recorded field u: a light seen in a view, by their numbers in the scene.
struct Channel {
  std::uint32_t light = 0, view = 0;
  auto operator<=>(const Channel&) const = default;
};

/// One covariance entry E[u_a conj(u_b)] - E[u_a] conj(E[u_b]), by channel numbers.
struct Entry {
  std::uint32_t a = 0, b = 0;
};

/// Which lights, views and entries a run is asked for. The order of `entries` is that of the
/// result:
///  intensity      [light][view], a = b
///  full           the lower triangle of channels [light][view], row by row, b <= a
///  pairs          [pair]
///  memory_effect, tilt_shift, translation
///                 [move][view] reference against moved; then the reference's [view] and the moved
///                 [move][view] intensities. Moves are tilts with their matched views;
///                 [tilt][shift] and, for far views, [tilt] with their matched views; shifts
struct CovarianceRequest {
  enum class Kind { intensity, pairs, memory_effect, tilt_shift, translation, full };
  Kind kind = Kind::intensity;
  Lights lights;
  std::vector<View> views;
  std::vector<Channel> channels;
  std::vector<Entry> entries;
  // Of a moved light or view against a reference, which is light 0 and the first views.
  std::vector<double> tilts;   ///< rotation of the light, radians
  std::vector<double> tilt_q;  ///< k (sin tilted - sin reference), per tilt (C19)
  std::vector<double> shifts;  ///< of k sin(view), or along x
  std::size_t moves = 0, reference_views = 0;

  /// Whether all views are on the side that light is transmitted to.
  bool transmission_only() const;
  /// Of far views.
  std::vector<double> reference_angles() const;
  bool has_reference() const { return moves > 0; }
  std::size_t tilted_entry(std::size_t move, std::size_t view) const {
    return move * reference_views + view;
  }
  std::size_t reference_intensity(std::size_t view) const { return moves * reference_views + view; }
  std::size_t tilted_intensity(std::size_t move, std::size_t view) const {
    return (moves + 1 + move) * reference_views + view;
  }
};

/// As in scene files, by kind.
inline const std::vector<std::string> request_words = {"intensity",  "pairs",       "memory_effect",
                                                       "tilt_shift", "translation", "full"};

/// Whether it has beams, near sources or near sensors.
bool has_near_ends(const CovarianceRequest& request);

CovarianceRequest intensity_request(Lights lights, std::vector<View> views);
CovarianceRequest full_request(Lights lights, std::vector<View> views);
/// pairs: angles (light 1, view 1, light 2, view 2) of each.
struct AnglePair {
  double light1, view1, light2, view2;
};
CovarianceRequest pairs_request(const std::vector<AnglePair>& pairs);
/// Matched views keep k sin v - k sin i and the side of the medium (C19). Throws InputError for a
/// tilt that takes the light or a matched view past the horizon.
CovarianceRequest memory_effect_request(double k, double light, const std::vector<double>& views,
                                        std::vector<double> tilts);
/// Every tilt of the light (of a beam about its focus) with every shift of the views: of k
/// sin(view) on the same side for far views, along x for near sensors. Throws InputError for what
/// passes the horizon.
CovarianceRequest tilt_shift_request(double k, const Light& light, const std::vector<View>& views,
                                     std::vector<double> tilts, std::vector<double> shifts);
/// A beam or point source and the near sensors moved along x together. Far views stay: a
/// translation only turns their phase.
CovarianceRequest translation_request(const Light& light, const std::vector<View>& views,
                                      std::vector<double> shifts);

}  // namespace flatspeckle
