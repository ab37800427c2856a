#pragma once

#include <optional>

#include "core/result/dataset_row.h"
#include "grin/ends/boundary_patch.h"
#include "grin/ends/path_end.h"
#include "grin/ends/pixel_grid.h"

namespace flatspeckle::grin {

/// All light that leaves the stage through its boundary, by direction: power per solid angle in
/// pixels of the sines of the angles from `forward` (orthographic), averaged over each pixel:
/// column along forward x up.
struct DirectionalDetector {
  Vec3 forward, up;
  double half_angle;  ///< of the square's half side, its sine; up to pi/2
  PixelGrid pixels;
};

extern const DatasetTable directional_table;

/// Throws InputError for sizes that are not positive.
PixelRectangle picture_of(const DirectionalDetector& detector);

/// With u, v the components of the outward direction, du dv = cos(theta) dw, theta from forward:
/// W = cos(theta) / pixel area. Pixels beyond the horizon, in the corners, stay dark.
class DirectionalEnd {
 public:
  /// Throws InputError.
  DirectionalEnd(const DirectionalDetector& detector, const Stage& stage);

  const PixelGrid& pixels() const { return picture_.grid(); }
  EndPosition sample_position(double stratum, RandomStream& random) const;
  EndDirection sample_direction(const EndPosition& at, double stratum, RandomStream& random) const;
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;
  std::optional<EndPosition> position_at(const Vec3& x) const;

 private:
  EndDirection along(const EndPosition& at, const Vec3& direction, int pixel) const;
  EndPosition on_boundary(const BoundaryPoint& at) const;

  Orientation view_;
  PixelRectangle picture_;
  BoundaryPatch boundary_;
  std::optional<Surface> body_;
};

}  // namespace flatspeckle::grin
