#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "grin/design/adjoint/design_ray.h"
#include "grin/design/adjoint/reading.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/system/ray_rows.h"

namespace flatspeckle::grin::design {

/// What is read off all rays as a function of the coefficients of the field.
class RaySystem {
 public:
  virtual ~RaySystem() = default;

  virtual std::size_t rays() const = 0;
  virtual int readings() const = 0;  ///< of each ray

  /// All readings; nothing where a ray is lost. parts: of a step, of which so many take its place.
  virtual std::optional<std::vector<double>> trace(const FieldForm& form,
                                                   std::span<const double> coefficients,
                                                   int parts = 1) = 0;
  /// Their derivatives, along the rays that were traced last.
  virtual RayRows linearised() const = 0;
  /// The sum of those derivatives, each times a weight of its reading.
  virtual std::vector<double> gradient(std::span<const double> weights) const = 0;
};

/// One kind of reading, of each ray.
using Readings = std::variant<std::vector<ScreenReading>, std::vector<SurfaceReading>,
                              std::vector<DirectionReading>, std::vector<PathReading>,
                              std::vector<PathPerLengthReading>>;

std::unique_ptr<RaySystem> make_ray_system(std::vector<DesignRay> rays, Readings readings,
                                           const RayWalk& walk);

}  // namespace flatspeckle::grin::design
