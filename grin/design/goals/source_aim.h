#pragma once

#include <vector>

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/goals/goal.h"

namespace flatspeckle::grin::design {

/// Points outside of the field that shine towards its centre, each into a cone.
struct SourceValues {
  std::vector<double> sources{};
  double half_angle = 0.3;
  std::int64_t rays_per_source = 200;
};

/// Each source's light is to leave parallel, along the line from it through the centre.
struct CollimationValues : SourceValues {
  static constexpr const char* word = "collimation";
};

/// It is to pass through a round aperture on that line, behind the field.
struct ThroughputValues : SourceValues {
  static constexpr const char* word = "throughput";
  std::optional<double> aperture_radius = {}, aperture_distance = {};
};

void add_keys(Keys& keys, CollimationValues& values);
void add_keys(Keys& keys, ThroughputValues& values);

/// Both throw InputError for no source, one within the field, a cone that the field does not fill,
/// or a field that is endless.
std::unique_ptr<Aim> make_aim(const Keys& keys, const CollimationValues& values,
                              const FieldForm& form);
std::unique_ptr<Aim> make_aim(const Keys& keys, const ThroughputValues& values,
                              const FieldForm& form);

}  // namespace flatspeckle::grin::design
