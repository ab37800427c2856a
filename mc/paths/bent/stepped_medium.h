#pragma once

#include <vector>

#include "grin/media/geometry/vec3.h"
#include "mc/paths/bent/bent_chords.h"
#include "mc/paths/bent/graded_medium.h"
#include "mc/paths/bent/ray_tube.h"
#include "mc/paths/bent/wave_table.h"

namespace flatspeckle::mc {

/// Any index field of grin in the plane y = 0, by steps along rays. Waves of ends are tables over
/// the box; a point in it, or close by, finds the ray to each place anew.
template <class Field>
class SteppedMedium : public GradedMedium {
 public:
  /// scale: over which the field varies.
  SteppedMedium(const Scene& scene, Field field, double scale);

  double square(Vec2 x) const override { return bend(x).square; }
  double inside(Vec2 x, Vec2 w) const override;
  std::optional<RayPlace> flown(Vec2 x, Vec2 w, double sigma) const override;

  /// The ray from a source to a place; guess: of its launch.
  std::optional<WaveTable::Node> arrival(Vec2 source, Vec2 x, std::optional<double> guess) const;

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec2 source) const override;
  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override;
  Bend bend(Vec2 x) const;
  BentBend bent_bend(Vec2 x) const;
  BentRay begun(Vec2 x, Vec2 w) const { return {x, std::sqrt(std::max(square(x), 0.0)) * w}; }
  bool in_window(Vec2 x) const;
  /// sigma of a step that is in the domain, as a parabola.
  BentChords chords(const BentRay& from, const BentRay& to, double h) const;

  struct End {
    RayTube tube;
    double inside;
  };
  /// Along a ray to where `left`, which is positive before, is 0; none beyond a caustic, if that
  /// counts, or out of the window.
  template <typename Left>
  std::optional<End> followed(Vec2 x, Vec2 w, bool to_caustic, const Left& left) const;
  std::optional<WaveTable::Node> plane_arrival(double angle, Vec2 x,
                                               const WaveTable::Node* guess) const;

  Domain domain_;
  Field field_;
  double step_, spacing_;
  Vec2 low_, high_;  ///< of the window
};

}  // namespace flatspeckle::mc
