#pragma once

#include <array>
#include <optional>
#include <vector>

namespace flatspeckle::oracles {

using Long3 = std::array<long double, 3>;

/// A body, defined by the inequalities that its interior satisfies.
struct SolidBody {
  enum class Kind { ball, block, lens };
  Kind kind = Kind::ball;
  /// Shape parameters. Ball: centre, radius. Block: low corner, high corner. Lens: vertex, radius,
  /// radii of curvature of front and back (0: plane), thickness.
  std::array<double, 7> shape{};
  double index = 1;
  double extinction = 0;

  bool holds(const Long3& x) const;
  long double volume() const;
  /// Adds the distances at which a line meets any of the bounding surfaces or their continuations.
  void add_crossings(const Long3& x, const Long3& d, std::vector<long double>& at) const;
  /// Unit normal of the bounding surface closest to x.
  Long3 normal(const Long3& x) const;
};

/// A set of bodies. Where several overlap, the medium is that of the body with the smallest volume;
/// of bodies with equal volume, the last.
struct SolidScene {
  std::vector<SolidBody> bodies;
  double index_around = 1, extinction_around = 0;
  SolidBody domain;  ///< rays end at its boundary
};

struct SolidRay {
  Long3 x, d;
  long double optical_path = 0, arc_length = 0, index = 1;
  /// Product over all crossings of the reflected or transmitted fraction of the power.
  long double fresnel = 1;
  /// Fraction of the power transmitted by absorbing or scattering media.
  long double transmitted = 1;
  int crossings = 0;  ///< number of index jumps crossed
};

/// Follows a ray to the boundary of the domain. It shares no code with the library and computes in
/// long double; the medium between two consecutive crossings is that at their midpoint. `reflects`:
/// whether the ray is reflected at each index jump in turn, total reflections included; without it,
/// a ray is refracted wherever possible. Crossings within 1e-14 of each other count as one. Returns
/// nullopt if the next crossings depend on rounding, or after `most_crossings` crossings.
std::optional<SolidRay> follow(const SolidScene& scene, const Long3& x, const Long3& d,
                               const std::vector<bool>* reflects = nullptr,
                               int most_crossings = 1000);

/// Follows a ray as `follow` does. Also returns nullopt if changing the start by 1e-13 changes the
/// result by 1e-10 or more.
std::optional<SolidRay> follow_decided(const SolidScene& scene, const Long3& x, const Long3& d,
                                       const std::vector<bool>* reflects = nullptr,
                                       int most_crossings = 1000);

}  // namespace flatspeckle::oracles
