#include "grin/media/fields/radial_spline.h"

#include <utility>

#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "grin/media/index/field_file.h"
#include "grin/media/index/sample_grid.h"

namespace flatspeckle::grin {

namespace {

std::vector<double> numbers(const ResultReader& file, const char* attribute, std::size_t count) {
  const auto values = file.attribute<std::vector<double>>("radial_spline", attribute);
  if (values.size() != count)
    throw InputError(std::string(attribute) + ": has " + std::to_string(values.size()) +
                     " numbers, must have " + std::to_string(count));
  return values;
}

RadialSpline read_radial_spline(const std::string& path) {
  return guarded_read(path, [&] {
    const ResultReader file(path);
    const auto centre = numbers(file, "centre", 3);
    const double radius = file.attribute<double>("radial_spline", "radius");
    const double host = host_index_in(path, "radial_spline");
    return RadialSpline(
        RadialSplineProfile(radius, file.dataset<double>("radial_spline"), host - 1),
        Vec3(centre[0], centre[1], centre[2]));
  });
}

}  // namespace

RadialSplineProfile::RadialSplineProfile(double radius, std::vector<double> coefficients,
                                         double host_excess)
    : radius_(positive("radius", radius)),
      host_excess_(host_excess),
      spline_(std::move(coefficients)) {
  for (const double c : spline_.coefficients())
    if (!(c > -1 - host_excess))
      throw InputError("coefficient of a radial spline", c, "must be above -host_index");
}

FieldFacts facts(const RadialSpline& field) {
  const RadialSplineProfile& profile = field.profile();
  const double cells = static_cast<double>(profile.coefficients().size() - 3);
  return {.scale = 2 * profile.radius() / std::max(2.0, cells),
          .symmetry = Symmetry::sphere,
          .centre = field.centre(),
          .rim = Sphere{field.centre(), profile.radius()},
          .excess_beyond_rim = profile.host_excess()};
}

void add_keys(Keys& keys, RadialSplineValues& values) {
  keys.add("radial_spline", values.radial,
           "Result of design, or HDF5 with its dataset radial_spline")
      .file();
}

RadialSpline make_field(const Keys& keys, const RadialSplineValues& values, const FieldUse&) {
  return read_field(keys, keys.required(values.radial), read_radial_spline);
}

}  // namespace flatspeckle::grin
