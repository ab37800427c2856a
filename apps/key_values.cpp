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
  if (!(std::isfinite(value) && value > 0)) throw InputError(key, value, "must be positive");
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

}  // namespace flatspeckle::apps
