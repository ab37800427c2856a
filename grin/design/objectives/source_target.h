#pragma once

#include <vector>

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/objectives/design_objective.h"

namespace flatspeckle::grin::design {

/// Scene keys of point sources outside the field. Each source emits a cone of light towards the
/// centre of the field.
struct SourceValues {
  std::vector<double> sources{};
  double half_angle = 0.3;
  std::int64_t rays_per_source = 200;
};

/// Scene keys of the goal `collimation`: the light of each source should leave the field parallel
/// to the line from the source to the centre of the field.
struct CollimationValues : SourceValues {
  static constexpr const char* word = "collimation";
};

/// Scene keys of the goal `throughput`: the light of each source should pass through a round
/// aperture behind the field, on the line from the source through the centre of the field.
struct ThroughputValues : SourceValues {
  static constexpr const char* word = "throughput";
  std::optional<double> aperture_radius = {}, aperture_distance = {};
};

void add_keys(Keys& keys, CollimationValues& values);
void add_keys(Keys& keys, ThroughputValues& values);

/// Makes the design target. Throws InputError if there is no source, a source is inside the field,
/// a cone of light is wider than the field, or the field is a guide, which is infinitely long.
std::unique_ptr<DesignTarget> make_target(const Keys& keys, const CollimationValues& values,
                                          const FieldForm& form);
std::unique_ptr<DesignTarget> make_target(const Keys& keys, const ThroughputValues& values,
                                          const FieldForm& form);

}  // namespace flatspeckle::grin::design
