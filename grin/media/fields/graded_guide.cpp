#include "grin/media/fields/graded_guide.h"

#include <utility>

#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "grin/media/index/field_file.h"

namespace flatspeckle::grin {

namespace {

GradedProfile read_graded(const std::string& path) {
  return guarded_read(path, [&] {
    const ResultReader file(path);
    const auto number = [&](const char* name) {
      return file.attribute<double>("graded_spline", name);
    };
    return GradedProfile(
        {number("index") - 1, number("delta"), number("radius"), number("exponent")},
        file.dataset<double>("graded_spline"));
  });
}

void check(const GradedProfile::Core& core) {
  positive("radius", core.radius);
  if (!(core.axis_excess > -1 && std::isfinite(core.axis_excess)))
    throw InputError("index", 1 + core.axis_excess, "must be positive");
  if (!(core.delta > 0 && core.delta < 0.5))
    throw InputError("delta", core.delta, "must be above 0 and below 0.5");
  if (!(core.exponent >= 1 && core.exponent <= 100))
    throw InputError("exponent", core.exponent, "must be from 1 to 100");
}

}  // namespace

GradedProfile::GradedProfile(const Core& core, std::vector<double> correction)
    : core_(core),
      is_corrected_(!correction.empty()),
      correction_(is_corrected_ ? std::move(correction) : std::vector<double>(4, 0.0)) {
  check(core);
}

FieldFacts facts(const GradedGuide& field) {
  const GradedProfile& profile = field.profile();
  const double cells = static_cast<double>(profile.correction().size() - 3);
  return {.scale = profile.core().radius / std::max(1.0, cells / 4),
          .symmetry = Symmetry::round_guide,
          .centre = field.centre()};
}

void add_keys(Keys& keys, GradedValues& values) {
  add_index_key(keys, values.index, "n0 on the axis");
  keys.add("delta", values.delta, "Contrast in n^2 = n0^2 (1 - 2 delta (rho/core_radius)^exponent)")
      .positive_to(0.499);
  keys.add("core_radius", values.core_radius,
           "Radius at which n^2 has fallen by the fraction 2 delta")
      .positive()
      .unit("length");
  keys.add("exponent", values.exponent,
           "Exponent in n^2 = n0^2 (1 - 2 delta (rho/core_radius)^exponent)")
      .from(1, 100);
  keys.add("graded_spline", values.graded,
           "Result of design, or HDF5 with its dataset graded_spline, instead of index, delta, "
           "core_radius and exponent")
      .file();
  add_vector(keys, "centre", values.centre, "A point on the axis, which is along z").unit("length");
}

GradedGuide make_field(const Keys& keys, const GradedValues& values, const FieldUse&) {
  const Vec3 centre = vector_of(keys.read(values.centre));
  const std::string& path = keys.read(values.graded);
  if (path.empty())
    return GradedGuide(
        GradedProfile({keys.read(values.index) - 1, keys.required(values.delta),
                       keys.required(values.core_radius), keys.read(values.exponent)}),
        centre);
  return GradedGuide(read_field(keys, path, read_graded), centre);
}

}  // namespace flatspeckle::grin
