#include "apps/sweep/sweep.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "apps/sweep/point_store.h"
#include "core/error.h"
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

SweepShare share_of(const std::string& text) {
  SweepShare share;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, share.number);
  const bool slash = number.ec == std::errc{} && number.ptr != end && *number.ptr == '/';
  const auto count = slash ? std::from_chars(number.ptr + 1, end, share.count) : number;
  if (!slash || count.ec != std::errc{} || count.ptr != end || share.number >= share.count)
    throw InputError("shard", text, "must be i/n with 0 <= i < n");
  return share;
}

ScatteredRuns::ScatteredRuns(std::size_t runs, const SweepShare& share)
    : runs_(runs), stride_(std::max<std::size_t>(1, runs * 618 / 1000)), share_(share) {
  while (std::gcd(stride_, runs_) != 1) ++stride_;
}

std::size_t ScatteredRuns::size() const {
  return (runs_ + share_.count - 1 - share_.number) / share_.count;
}

std::size_t ScatteredRuns::operator[](std::size_t number) const {
  return (share_.number + number * share_.count) * stride_ % runs_;
}

/// False if there is nothing to run (--print-config).
bool Sweep::read() {
  session_.emplace(command_.text(), keys(), run_, command_.only_prints(), Session::Out::shared);
  take_points();
  return command_.settle();
}

void Sweep::parse_config(const std::string& config, const std::string& command_line) {
  command_.parse_config(config);
  session_.emplace(command_line, keys(), run_, true);
  take_points();
}

void Sweep::take_points() {
  if (!keys().read(share_text_).empty()) share_ = share_of(share_text_);
  check();
}

void Sweep::add_share_key() {
  keys()
      .add("shard", share_text_,
           "i/n: work on every nth point only, from number i = 0 .. n - 1 on; then merge")
      .no_file();
}

std::size_t Sweep::finished_points(const PointStore& store) const {
  return store.finished();
}

}  // namespace flatspeckle::apps
