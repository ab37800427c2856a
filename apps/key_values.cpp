#include "apps/key_values.h"

#include <cmath>
#include <sstream>

#include "core/error.h"

namespace flatspeckle::apps {

std::string listed(const std::vector<double>& values) {
  std::ostringstream text;
  for (std::size_t i = 0; i < values.size(); ++i) text << (i > 0 ? " " : "") << values[i];
  return text.str();
}

std::string listed(const grin::Vec3& x) {
  return listed(std::vector<double>{x[0], x[1], x[2]});
}

double positive(const std::string& key, double value) {
  if (!(std::isfinite(value) && value > 0))
    throw InputError(key, value, "must be positive and finite");
  return value;
}

std::vector<double> finite(const std::string& key, const std::vector<double>& values) {
  for (double value : values)
    if (!std::isfinite(value)) throw InputError(key, listed(values), "must be finite");
  return values;
}

grin::Vec3 vector_of(const std::string& key, const std::vector<double>& values) {
  if (values.size() != 3) throw InputError(key, listed(values), "must be three numbers x y z");
  finite(key, values);
  return {values[0], values[1], values[2]};
}

grin::Vec3 direction_of(const std::string& key, const std::vector<double>& values) {
  const grin::Vec3 direction = vector_of(key, values);
  if (direction.isZero(0)) throw InputError(key, listed(values), "must not be 0");
  return direction.stableNormalized();
}

grin::Vec3 three(const std::vector<double>& values, std::size_t first) {
  return {values[first], values[first + 1], values[first + 2]};
}

std::vector<std::vector<double>> parts_of(const std::string& key, const std::vector<double>& values,
                                          std::size_t size, const std::string& what) {
  finite(key, values);
  if (values.size() % size != 0)
    throw InputError(key, listed(values),
                     "must be " + std::to_string(size) + " numbers for each: " + what);
  std::vector<std::vector<double>> all;
  for (std::size_t i = 0; i < values.size(); i += size)
    all.emplace_back(values.begin() + i, values.begin() + i + size);
  return all;
}

std::vector<grin::Sphere> spheres_of(const std::string& key, const std::vector<double>& values) {
  std::vector<grin::Sphere> spheres;
  for (const auto& sphere : parts_of(key, values, 4, "centre and radius"))
    spheres.push_back({three(sphere, 0), positive(key + ", radius", sphere[3])});
  return spheres;
}

std::vector<grin::Box> boxes_of(const std::string& key, const std::vector<double>& values) {
  std::vector<grin::Box> boxes;
  for (const auto& box : parts_of(key, values, 6, "two opposite corners, the low one first")) {
    const grin::Box corners{three(box, 0), three(box, 3)};
    if (!((corners.high - corners.low).minCoeff() > 0))
      throw InputError(key, listed(box), "must have its low corner first");
    boxes.push_back(corners);
  }
  return boxes;
}

}  // namespace flatspeckle::apps
