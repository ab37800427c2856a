#include "apps/sweep/point_finder.h"

#include "core/keys/number_text.h"

namespace flatspeckle::apps {

PointFinder::PointFinder(const SweepPoints& points) : points_(points) {
  if (points.is_list) {
    for (std::size_t row = 0; row < points.count(); ++row) rows_.emplace(points.name(row), row);
    return;
  }
  for (const SweepAxis& axis : points.axes) {
    Numbers& numbers = values_.emplace_back();
    if (axis.values.range() != nullptr) continue;
    for (std::size_t i = 0; i < axis.values.size(); ++i) numbers.emplace(axis.values[i], i);
  }
}

std::optional<std::size_t> PointFinder::find(const std::string& name) const {
  if (!points_.is_list) return on_grid(name);
  const auto found = rows_.find(name);
  return found == rows_.end() ? std::nullopt : std::optional(found->second);
}

/// What stands between the names of an axis and the next is its value.
std::optional<std::size_t> PointFinder::on_grid(const std::string& name) const {
  std::size_t point = 0, begin = 0;
  for (std::size_t i = 0; i < points_.axes.size(); ++i) {
    begin += points_.axes[i].key.size() + 1;
    const bool is_last = i + 1 == points_.axes.size();
    const std::size_t end =
        is_last ? name.size() : name.find('_' + points_.axes[i + 1].key + '=', begin);
    if (begin > name.size() || end == name.npos) return std::nullopt;
    const auto number = on_axis(i, name.substr(begin, end - begin));
    if (!number) return std::nullopt;
    point = point * points_.axes[i].values.size() + *number;
    begin = end + 1;
  }
  return points_.name(point) == name ? std::optional(point) : std::nullopt;
}

std::optional<std::size_t> PointFinder::on_axis(std::size_t axis, const std::string& value) const {
  if (const NumberRange* const range = points_.axes[axis].values.range()) {
    const auto number = read_number(value);
    return number ? range->find(*number) : std::nullopt;
  }
  const auto found = values_[axis].find(value);
  return found == values_[axis].end() ? std::nullopt : std::optional(found->second);
}

}  // namespace flatspeckle::apps
