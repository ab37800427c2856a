#include "grin/media/geometry/vector_values.h"

#include <sstream>

#include "core/keys/number_text.h"

namespace flatspeckle::grin {

Key& add_vector(Keys& keys, const std::string& name, std::vector<double>& member,
                const std::string& help) {
  return keys.add(name, member, help).exactly(3, "three numbers x y z");
}

Vec3 vector_of(std::span<const double> values, std::size_t first) {
  return {values[first], values[first + 1], values[first + 2]};
}

Vec3 direction_of(const Keys& keys, const std::vector<double>& member) {
  return unit_direction(keys.name(member), vector_of(keys.read(member)));
}

std::vector<std::span<const double>> parts_of(const std::vector<double>& values, std::size_t size) {
  std::vector<std::span<const double>> parts;
  for (std::size_t i = 0; i < values.size(); i += size)
    parts.push_back(std::span(values).subspan(i, size));
  return parts;
}

std::vector<Sphere> spheres_of(const Keys& keys, const std::vector<double>& member) {
  std::vector<Sphere> spheres;
  for (const auto sphere : parts_of(keys.read(member), 4))
    spheres.push_back({vector_of(sphere), positive(keys.name(member) + ", radius", sphere[3])});
  return spheres;
}

std::vector<Box> boxes_of(const Keys& keys, const std::vector<double>& member) {
  std::vector<Box> boxes;
  for (const auto box : parts_of(keys.read(member), 6)) {
    boxes.push_back({vector_of(box), vector_of(box, 3)});
    if (!((boxes.back().high - boxes.back().low).minCoeff() > 0))
      throw InputError(keys.name(member), number_text({box.begin(), box.end()}),
                       "must have its low corner first");
  }
  return boxes;
}

Vec3 unit_direction(const std::string& key, const Vec3& direction) {
  if (direction.isZero(0)) throw InputError(key, listed(direction), "must not be 0");
  return direction.stableNormalized();
}

double positive(const std::string& key, double value) {
  if (!(value > 0)) throw InputError(key, value, "must be positive");
  if (!(value >= 1e-50 && value <= 1e50))
    throw InputError(key, value, "must be from 1e-50 to 1e50");
  return value;
}

std::string listed(const Vec3& x) {
  std::ostringstream text;
  text << x[0] << ' ' << x[1] << ' ' << x[2];
  return text.str();
}

}  // namespace flatspeckle::grin
