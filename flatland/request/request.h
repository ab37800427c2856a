#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "flatland/request/light.h"

namespace flatspeckle {

/// Detector of the field: a far-field direction (amplitude A of C4) or a point (the scattered
/// field).
struct View {
  bool near = false;
  double angle = 0;    ///< direction of a far view, from +z (C2)
  Vec point;           ///< position of a near sensor
  double azimuth = 0;  ///< rotation of a far view about z, from x towards y (C55)

  Vec direction() const { return flatspeckle::direction(angle, azimuth); }
  auto operator<=>(const View&) const = default;
};

inline View far_view(double angle, double azimuth = 0) {
  return {false, angle, {}, azimuth};
}
inline std::vector<View> far_views(const std::vector<double>& angles) {
  std::vector<View> views;
  for (double angle : angles) views.push_back(far_view(angle));
  return views;
}
inline View near_sensor(Vec point) {
  return {true, 0, point};
}

/// Square grid of far views in space whose transverse direction cosines are equally spaced (C55),
/// in the order [y][x].
struct FarCamera {
  Vec axis;                ///< direction of the middle
  double aperture = 0;     ///< half the width, as a difference of direction cosines
  std::size_t pixels = 0;  ///< number of views along each side

  /// Returns the direction cosine of column or row i. axis: that of the axis.
  double cosine(double axis_cosine, std::size_t i) const {
    return axis_cosine +
           aperture * ((2 * static_cast<double>(i) + 1) / static_cast<double>(pixels) - 1);
  }
  /// Throws InputError if a corner of the grid is not a direction.
  std::vector<View> views() const;
  auto operator<=>(const FarCamera&) const = default;
};

/// Reads points from a CSV file with at least one row and with columns x, z and, in space, also y
/// (0 if it is missing). Throws InputError. key: name of the key in messages.
std::vector<Vec> read_points(const std::string& key, const std::string& path,
                             bool in_space = false);

/// Returns the index, in the entries of a full_request(), of the covariance of channels a and b.
/// Precondition: b <= a.
inline std::size_t triangle_entry(std::size_t a, std::size_t b) {
  return a * (a + 1) / 2 + b;
}

/// Returns the diagonal (the intensities of the channels) of the covariance matrix whose lower
/// triangle is given.
inline std::vector<Complex> diagonal(std::span<const Complex> triangle, std::size_t channels) {
  std::vector<Complex> found;
  for (std::size_t a = 0; a < channels; ++a) found.push_back(triangle[triangle_entry(a, a)]);
  return found;
}

/// One recorded field u, given by the indices of its illumination (light) and its detector (view)
/// in the request.
struct Channel {
  std::uint32_t light = 0, view = 0;
  auto operator<=>(const Channel&) const = default;
};

/// One covariance entry E[u_a conj(u_b)] - E[u_a] conj(E[u_b]), where a and b are indices of
/// channels.
struct Entry {
  std::uint32_t a = 0, b = 0;
};

/// Illuminations, detectors and covariance entries that a run computes. Results have the order of
/// `entries`, which depends on the kind:
///  intensity      [light][view]; both fields are the same (a = b)
///  full           the lower triangle of channels [light][view], row by row, b <= a
///  pairs          [pair]
///  memory_effect, tilt_shift, translation
///                 covariances of reference and moved fields, [move][view]; then intensities of the
///                 reference, [view]; then intensities of the moved fields, [move][view]
/// In these three kinds the light, the views or both are moved relative to the reference. The moves
/// are
///  memory_effect  tilts, with matched views
///  tilt_shift     [tilt][shift], followed for far views by the tilts with matched views
///  translation    shifts
struct CovarianceRequest {
  enum class Kind { intensity, pairs, memory_effect, tilt_shift, translation, full };
  Kind kind = Kind::intensity;
  Lights lights;
  std::vector<View> views;
  std::vector<Channel> channels;
  std::vector<Entry> entries;
  // Moves of the light or the views relative to the reference, which is light 0 with the first
  // reference_views views.
  std::vector<double> tilts;   ///< rotation of the light, radians
  std::vector<double> tilt_q;  ///< change of transverse momentum of the light (C19, C55)
  double tilt_azimuth = 0;     ///< azimuth of tilt_q
  /// tilt_shift of far views: change of k sin(view angle); otherwise: translation along x.
  std::vector<double> shifts;
  std::size_t moves = 0, reference_views = 0;
  std::optional<FarCamera> camera{};  ///< set if the views are those of a camera

  /// Whether all views are on the transmission side of the medium.
  bool transmission_only() const;
  /// Returns the angles of the reference views, which must be far-field views (directions, not near
  /// sensors).
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

/// Accepted values of the scene key `covariance`, in the order of CovarianceRequest::Kind.
inline const std::vector<std::string> request_words = {"intensity",  "pairs",       "memory_effect",
                                                       "tilt_shift", "translation", "full"};

/// Whether a request has beams, near sources or near sensors.
bool has_near_endpoints(const CovarianceRequest& request);

CovarianceRequest intensity_request(Lights lights, std::vector<View> views);
CovarianceRequest full_request(Lights lights, std::vector<View> views);
/// Angles, in radians, of a requested pair of fields: the first field has light1 and view1, the
/// second light2 and view2. azimuths: those of the four directions, in the same order.
struct AnglePair {
  double light1, view1, light2, view2;
  std::array<double, 4> azimuths{};
};
CovarianceRequest pairs_request(const std::vector<AnglePair>& pairs);
/// Returns the request for tilts of the light, each with matched views: with the light angle i, the
/// view angle v changes so that k sin v - k sin i stays the same, on the same side of the medium
/// (C19). Throws InputError if a tilt takes the light or a matched view past the horizon.
CovarianceRequest memory_effect_request(double k, double light, const std::vector<double>& views,
                                        std::vector<double> tilts);
/// Returns such a request in space. A tilt rotates the light about an axis parallel to the faces,
/// so that its transverse momentum changes along tilt_azimuth, and the transverse momentum of the
/// matched views changes by as much (C55).
CovarianceRequest memory_effect_request(double k, const Light& light,
                                        const std::vector<View>& views, std::vector<double> tilts,
                                        double tilt_azimuth);
/// Returns a light rotated by each of the tilts, as memory_effect_request() rotates it.
Lights tilted_lights(const Light& light, const std::vector<double>& tilts, double tilt_azimuth);
/// Returns the change of the transverse momentum of the light by each tilt.
std::vector<double> tilt_momenta(double k, const Light& light, const std::vector<double>& tilts,
                                 double tilt_azimuth);
/// Returns the request that combines every tilt of the light with every shift of the views. A beam
/// is tilted about its focus. Far views are shifted in k sin(view angle) on the same side of the
/// medium, near sensors along x; in space, both along tilt_azimuth. Throws InputError if a tilt or
/// shift takes a direction past the horizon.
CovarianceRequest tilt_shift_request(double k, const Light& light, const std::vector<View>& views,
                                     std::vector<double> tilts, std::vector<double> shifts,
                                     double tilt_azimuth = 0);
/// Returns the request for a beam or point source that moves along x, in space along the direction
/// with this azimuth, together with the near sensors. Far views do not move, because a translation
/// changes only their phase.
CovarianceRequest translation_request(const Light& light, const std::vector<View>& views,
                                      std::vector<double> shifts, double azimuth = 0);

}  // namespace flatspeckle
