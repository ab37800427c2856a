#pragma once

#include <array>
#include <optional>
#include <vector>

namespace flatspeckle::oracles {

using Long3 = std::array<long double, 3>;

/// A body by the inequalities that its inside satisfies.
struct SolidBody {
  enum class Kind { ball, block, lens };
  Kind kind = Kind::ball;
  /// centre, radius; low corner, high corner; vertex, radius, radii of curvature (0: plane) of the
  /// front and the back, thickness.
  std::array<double, 7> shape{};
  double index = 1;
  double extinction = 0;

  bool holds(const Long3& x) const;
  long double volume() const;
  /// Where a line meets any of the surfaces that bound it or their continuations.
  void add_crossings(const Long3& x, const Long3& d, std::vector<long double>& at) const;
  /// The unit normal of the one of these surfaces that a place is closest to.
  Long3 normal(const Long3& x) const;
};

/// A ray through bodies, of which the smallest is where several are; of equal ones the last.
struct SolidScene {
  std::vector<SolidBody> bodies;
  double index_around = 1, extinction_around = 0;
  SolidBody room;  ///< where rays end
};

struct SolidRay {
  Long3 x, d;
  long double optical_path = 0, arc_length = 0, index = 1;
  long double fresnel = 1;      ///< product of the fractions of power, reflected or transmitted
  long double transmitted = 1;  ///< by the media
  int crossings = 0;            ///< where the index jumps
};

/// Follows a ray to the end of the room, independently of the product: in long double, by the
/// media at the midpoints between consecutive crossings of a line. `reflects`: what becomes of it
/// at one index jump after the other, total reflections included; without it a ray is refracted
/// wherever that is possible. Crossings within 1e-14 of each other count as one. Returns nothing
/// for a ray that it cannot decide: one whose next crossings depend on that, or of more than
/// `most_crossings`.
std::optional<SolidRay> follow(const SolidScene& scene, const Long3& x, const Long3& d,
                               const std::vector<bool>* reflects = nullptr,
                               int most_crossings = 1000);

/// Follows a ray; nullopt where a change of its start by 1e-13 changes it by 1e-10 or more.
std::optional<SolidRay> follow_decided(const SolidScene& scene, const Long3& x, const Long3& d,
                                       const std::vector<bool>* reflects = nullptr,
                                       int most_crossings = 1000);

}  // namespace flatspeckle::oracles
