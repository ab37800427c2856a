#include "core/keys/angle_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"

namespace flatspeckle {

AngleTable::AngleTable(const std::string& key, const std::string& path) {
  const Table table = read_key_table(key, path);
  const auto angles = table.column("angle"), values = table.column("value");
  angles_.assign(angles.begin(), angles.end());
  values_.assign(values.begin(), values.end());
  const auto refuse = [&](const char* accepted) { throw InputError(key, path, accepted); };
  // tolerance of the last angle, because pi may be written with few digits
  constexpr double rounding = 1e-4;
  if (angles_.size() < 2 || std::abs(angles_.front()) > rounding ||
      std::abs(angles_.back() - std::numbers::pi) > rounding)
    refuse("column angle must go from 0 to pi (radians), or angle_deg from 0 to 180");
  if (std::adjacent_find(angles_.begin(), angles_.end(), std::greater_equal<>()) != angles_.end())
    refuse("column angle must increase");
  if (*std::min_element(values_.begin(), values_.end()) < 0)
    refuse("column value must not be negative");
  const double largest = *std::max_element(values_.begin(), values_.end());
  if (largest == 0) refuse("column value must not be 0 everywhere");
  if (!(largest > 1e-100 && largest < 1e100))
    refuse("the maximum of column value must be from 1e-100 to 1e100");
  angles_.front() = 0;
  angles_.back() = std::numbers::pi;
}

double AngleTable::operator()(double angle) const {
  const auto above = std::upper_bound(angles_.begin() + 1, angles_.end() - 1, angle);
  const auto i = static_cast<std::size_t>(above - angles_.begin());
  const double t = (angle - angles_[i - 1]) / (angles_[i] - angles_[i - 1]);
  return (1 - t) * values_[i - 1] + t * values_[i];
}

std::string AngleTable::text() const {
  return number_text(angles_) + '\n' + number_text(values_) + '\n';
}

}  // namespace flatspeckle
