#include "apps/experiments/stacked_dataset.h"

#include <algorithm>
#include <utility>

namespace flatspeckle::apps {

namespace {

using Extents = std::vector<std::size_t>;

std::size_t product(const Extents& extents) {
  std::size_t product = 1;
  for (const std::size_t extent : extents) product *= extent;
  return product;
}

std::size_t value_bytes(const CollectedDataset::Held& values) {
  return std::visit([](const auto& held) { return sizeof(held.front()); }, values);
}

/// At most so many points that follow each other: the last axes whole, a part of the one before.
Extents chunk_of(const Extents& extents, std::size_t most) {
  Extents chunk(extents.size(), 1);
  for (std::size_t axis = extents.size(); axis-- > 0 && most > 1;) {
    chunk[axis] = std::min(extents[axis], most);
    most = chunk[axis] == extents[axis] ? most / extents[axis] : 1;
  }
  return chunk;
}

Values values_of(const CollectedDataset::Held& held) {
  return std::visit(
      []<typename Value>(const std::vector<Value>& values) -> Values {
        return std::span<const Value>(values);
      },
      held);
}

}  // namespace

StackedDataset::StackedDataset(ResultFile& file, const CollectedDataset& of_point,
                               const std::vector<Axis>& grid, const Extents& extents)
    : file_(file),
      name_(of_point.name),
      extents_(extents),
      of_each_(of_point.count()),
      waiting_(of_point.values) {
  constexpr std::size_t most_bytes = std::size_t{1} << 16;
  const std::size_t bytes = std::max<std::size_t>(1, of_each_ * value_bytes(waiting_));
  chunk_ = chunk_of(extents, std::max<std::size_t>(1, most_bytes / bytes));
  std::visit([](auto& held) { held.clear(); }, waiting_);
  std::vector<Axis> axes = grid;
  axes.insert(axes.end(), of_point.axes.begin(), of_point.axes.end());
  file.begin_dataset(name_, values_of(waiting_), axes, chunk_, of_point.units, of_point.long_name);
}

void StackedDataset::add(const Held& values) {
  std::visit(
      [&]<typename Value>(std::vector<Value>& held) {
        const auto& own = std::get<std::vector<Value>>(values);
        held.insert(held.end(), own.begin(), own.end());
      },
      waiting_);
  ++waiting_points_;
  const Extents from = start(), count = this->count(from);
  if (waiting_points_ < product(count)) return;
  file_.write_block(name_, values_of(waiting_), from, count);
  std::visit([](auto& held) { held.clear(); }, waiting_);
  points_ += std::exchange(waiting_points_, 0);
}

void StackedDataset::add_none() {
  Held none = waiting_;
  std::visit([&](auto& held) { held.assign(of_each_, {}); }, none);
  add(none);
}

/// The first point that waits.
Extents StackedDataset::start() const {
  Extents start(extents_.size());
  std::size_t rest = points_;
  for (std::size_t axis = extents_.size(); axis-- > 0; rest /= extents_[axis])
    start[axis] = rest % extents_[axis];
  return start;
}

/// Of the chunk there, what is not beyond the end.
Extents StackedDataset::count(const Extents& start) const {
  Extents count = chunk_;
  for (std::size_t axis = 0; axis < count.size(); ++axis)
    count[axis] = std::min(count[axis], extents_[axis] - start[axis]);
  return count;
}

}  // namespace flatspeckle::apps
