#include <algorithm>
#include <functional>
#include <iostream>
#include <map>
#include <utility>

#include "apps/experiments/experiment_sweep.h"
#include "apps/results/datasets.h"
#include "apps/sweep/point_store.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"

namespace flatspeckle::apps {

const DatasetTable stacked_table{
    .name = "sweep of results",
    .rows = {{"relative_error", Data::real, "SWEPT", "1",
              "RMS error relative to the RMS value; 1e300 if unknown"},
             {"samples", Data::real, "SWEPT", "1", "number of samples"},
             {"cpu_s", Data::real, "SWEPT", "s", "processor time, all threads"},
             {"wall_s", Data::real, "SWEPT", "s",
              "time from the first batch of the point to the last, including time spent on other "
              "points"}},
    .attributes = {
        {"", "of", "text", "the subcommand whose results were swept"},
        {"", "complete", "bool", "whether all points are finished"},
        {"", "ranks", "int64", "number of processes (MPI)"},
        {"", "swept", "texts", "swept keys, in the order of their axes"},
        {"", "left_out", "texts", "datasets that some points lack or have in another shape"}}};

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

/// Returns the extents of a chunk of at most `most` consecutive points. Beginning with the last
/// axis, axes are covered in full as long as possible; the next axis is covered in part.
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

/// Writes a dataset that combines one dataset of all points of a sweep; the axes of the sweep
/// precede its own axes. The values are added point by point, in order, and written in chunks of
/// about 64 kB. At most one chunk or one point is in memory.
class StackedDataset {
 public:
  using Held = CollectedDataset::Held;

  /// of_point: the dataset of one point, from which axes, type and number of values are taken.
  /// grid: axes of the sweep, whose scales are already written. extents: lengths of these axes.
  StackedDataset(ResultFile& file, const CollectedDataset& of_point, const std::vector<Axis>& grid,
                 const Extents& extents)
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
    file.begin_dataset(name_, values_of(waiting_), axes, chunk_, of_point.units,
                       of_point.long_name);
  }

  /// Adds the values of the next point.
  void add(const Held& values) {
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

  void add(double value) { add(std::vector{value}); }
  /// Adds zeros for the next point, which has no values.
  void add_none() {
    Held none = waiting_;
    std::visit([&](auto& held) { held.assign(of_each_, {}); }, none);
    add(none);
  }

 private:
  /// Returns the index along each axis of the sweep of the first point that is not yet written.
  Extents start() const {
    Extents start(extents_.size());
    std::size_t rest = points_;
    for (std::size_t axis = extents_.size(); axis-- > 0; rest /= extents_[axis])
      start[axis] = rest % extents_[axis];
    return start;
  }

  /// Returns the number of points along each axis in the chunk that begins at `start`; smaller
  /// chunks at the ends of the axes.
  Extents count(const Extents& start) const {
    Extents count = chunk_;
    for (std::size_t axis = 0; axis < count.size(); ++axis)
      count[axis] = std::min(count[axis], extents_[axis] - start[axis]);
    return count;
  }

  ResultFile& file_;
  std::string name_;
  std::vector<std::size_t> extents_, chunk_;
  std::size_t of_each_;
  /// Number of points that are already written, and number of points in `waiting_`.
  std::size_t points_ = 0, waiting_points_ = 0;
  Held waiting_;
};

bool is_mark(const std::string& name) {
  return name.ends_with("_rare");
}

std::string unit_of(const Key& key) {
  return key.unit().empty() ? "1" : key.unit();
}

/// Comparison of one dataset (by name) between all points of the sweep.
struct Surveyed {
  CollectedDataset first;
  std::size_t points = 0;  ///< number of points that have the dataset
  bool fits = true, same = true;
  std::uint64_t marks = 0;  ///< for a dataset of marks (NAME_rare): number of marks that are 1

  void add(const CollectedDataset& of_point) {
    ++points;
    fits = fits && of_point.values.index() == first.values.index() &&
           of_point.count() == first.count() && of_point.axes == first.axes;
    same = same && of_point.values == first.values;
    if (!is_mark(first.name)) return;
    const auto& own = std::get<std::vector<std::uint64_t>>(of_point.values);
    marks += static_cast<std::uint64_t>(std::ranges::count(own, std::uint64_t{1}));
  }
};

struct SurveyedAttribute {
  CollectedAttribute first;
  std::size_t points = 0;
  bool same = true;

  void add(const Attribute& value) {
    ++points;
    same = same && value == first.value;
  }
};

double number_of(const Attribute& value) {
  return std::visit(
      []<typename Value>(const Value& held) -> double {
        if constexpr (std::is_arithmetic_v<Value>) return static_cast<double>(held);
        return 0;
      },
      value);
}

bool is_number(const Attribute& value) {
  // the first four types of the variant are bool, int64, uint64 and double
  return value.index() < 4;
}

/// Combines the results of all points in two passes over the points: the first determines which
/// datasets the points have, the second copies the values. Only one point is in memory at a time,
/// besides the chunks of StackedDataset.
class Stack {
 public:
  Stack(ResultFile& file, const ExperimentSweep& sweep, const PointStore& store)
      : file_(file), sweep_(sweep), store_(store) {
    store.for_each([&](std::size_t, const FinishedPoint& point) { survey(point.result); });
  }

  void write() {
    write_axes();
    begin_costs();
    select();
    for (const Surveyed* const set : stacked_) begin(*set);
    begin_attributes();
    store_.for_each([&](std::size_t number, const FinishedPoint& point) {
      for (const auto& [dataset, value] : columns_) value(*dataset, number, point);
    });
  }

 private:
  /// Function that adds the values of one point to a combined dataset. number: index of the point.
  using Column = std::function<void(StackedDataset&, std::size_t number, const FinishedPoint&)>;

  void survey(const CollectedResult& result) {
    for (const CollectedDataset& set : result.datasets) {
      const auto [found, is_new] = sets_.try_emplace(set.name, Surveyed{set});
      if (is_new) order_.push_back(set.name);
      found->second.add(set);
    }
    for (const CollectedAttribute& attribute : result.attributes)
      attributes_.try_emplace({attribute.object, attribute.name}, SurveyedAttribute{attribute})
          .first->second.add(attribute.value);
  }

  void add_column(const CollectedDataset& of_point, const Column& column) {
    columns_.emplace_back(std::make_unique<StackedDataset>(file_, of_point, grid_, extents_),
                          column);
  }

  /// Whether the results have a dataset or a group of this name.
  bool has(const std::string& name) const {
    const auto inside = sets_.lower_bound(name + '/');
    return sets_.contains(name) || (inside != sets_.end() && inside->first.starts_with(name + '/'));
  }

  /// Returns the name of the dataset of a swept axis, with the prefix swept_ if the results have a
  /// dataset or group of the same name.
  std::string name_of(const SweepAxis& axis) const {
    const std::string name = axis_name(axis);
    const bool taken = has(name) || has_row(stacked_table, name) || name == "point";
    return taken ? "swept_" + name : name;
  }

  void write_axes() {
    const SweepPoints& points = sweep_.points();
    const bool as_list = points.is_list || store_.finished() < points.count();
    std::vector<std::string> keys;
    if (as_list) {
      const std::string name = has("point") ? "swept_point" : "point";
      ResultGroup(file_, sweep_axes_table).number(name, store_.finished());
      add_axis(name, store_.finished());
    }
    for (std::size_t i = 0; i < points.axes.size(); ++i) {
      keys.push_back(points.axes[i].key);
      as_list ? begin_column(i) : write_axis(points.axes[i]);
    }
    file_.bind("SWEPT", grid_);
    ResultGroup(file_, stacked_table).attribute("swept", keys);
  }

  void add_axis(const std::string& name, std::size_t extent) {
    grid_.emplace_back(name);
    extents_.push_back(extent);
  }

  /// Writes the scale of an axis. If the values are numbers, the scale contains them. If they are
  /// words, it contains 0, 1, ..., and the words are written to a separate dataset.
  void write_axis(const SweepAxis& axis) {
    const Key& key = sweep_.key(axis);
    const std::string name = name_of(axis);
    const std::size_t count = axis.values.size();
    file_.scale(
        name, count,
        [&](std::size_t i) {
          return key.is_number() ? *read_number(axis.values[i]) : static_cast<double>(i);
        },
        unit_of(key), key.help());
    add_axis(name, count);
    if (!key.is_number())
      file_.dataset(name + "_word", std::span<const std::string>(axis.values.texts()), {Axis(name)},
                    "", key.help());
  }

  /// Begins a dataset with the value of a swept key at each point, for sweeps whose points are
  /// written as a list instead of a grid.
  void begin_column(std::size_t axis) {
    const Key& key = sweep_.key(sweep_.points().axes[axis]);
    const std::string name = name_of(sweep_.points().axes[axis]);
    const auto text = [this, axis](std::size_t point) {
      return sweep_.points().value(axis, point);
    };
    if (key.is_number())
      add_column({name, false, {}, unit_of(key), key.help(), std::vector<double>(1)},
                 [text](StackedDataset& all, std::size_t number, const FinishedPoint&) {
                   all.add(*read_number(text(number)));
                 });
    else
      add_column({name + "_word", false, {}, "", key.help(), std::vector<std::string>(1)},
                 [text](StackedDataset& all, std::size_t number, const FinishedPoint&) {
                   all.add(std::vector{text(number)});
                 });
  }

  void begin_costs() {
    const auto begin = [&](const std::string& name, double FinishedPoint::*cost) {
      const DatasetRow& row = row_of(stacked_table, name);
      add_column({name, false, {}, row.unit, row.long_name, std::vector<double>(1)},
                 [cost](StackedDataset& all, std::size_t, const FinishedPoint& point) {
                   all.add(point.*cost);
                 });
    };
    begin("relative_error", &FinishedPoint::relative_error);
    begin("samples", &FinishedPoint::samples);
    begin("cpu_s", &FinishedPoint::cpu_s);
    begin("wall_s", &FinishedPoint::wall_s);
  }

  /// Selects the datasets that all points have in the same shape, and puts scales first.
  void select() {
    std::vector<std::string> left_out;
    for (const std::string& name : order_) {
      const Surveyed& set = sets_.at(name);
      const bool of_all = set.points == store_.finished() || is_mark(name);
      if (of_all && set.fits && !has_row(stacked_table, name))
        stacked_.push_back(&set);
      else
        left_out.push_back(name);
    }
    const auto hangs = [&](const Surveyed* set) {  // whether a dataset has an axis that is left out
      return std::ranges::any_of(set->first.axes, [&](const Axis& axis) {
        const auto* name = std::get_if<std::string>(&axis);
        return name != nullptr && std::ranges::count(left_out, *name) > 0;
      });
    };
    for (const Surveyed* const set : stacked_)
      if (hangs(set)) left_out.push_back(set->first.name);
    std::erase_if(stacked_, hangs);
    std::stable_partition(stacked_.begin(), stacked_.end(),
                          [](const Surveyed* set) { return set->first.is_scale; });
    if (left_out.empty()) return;
    ResultGroup(file_, stacked_table).attribute("left_out", left_out);
    std::erase_if(left_out, [](const std::string& name) { return has_row(stacked_table, name); });
    if (left_out.empty()) return;
    std::cerr << "note: left out, because points lack them or have them in other shapes:";
    for (const std::string& name : left_out) std::cerr << ' ' << name;
    std::cerr << '\n';
  }

  void begin(const Surveyed& set) {
    const CollectedDataset& first = set.first;
    if (first.is_scale) write_scale(set);
    if (first.is_scale && set.same) return;
    CollectedDataset of_point = first;
    if (first.is_scale) {
      of_point.name += "_of_point";
      of_point.axes.emplace_back(first.name);
    }
    add_column(of_point,
               [name = first.name](StackedDataset& all, std::size_t, const FinishedPoint& point) {
                 const CollectedDataset* const own = point.result.find(name);
                 own != nullptr ? all.add(own->values) : all.add_none();
               });
    if (is_mark(first.name))
      file_.note_rare(first.name.substr(0, first.name.size() - 5) + ": " +
                      std::to_string(set.marks) + " of " +
                      std::to_string(store_.finished() * first.count()));
  }

  /// Writes a scale of the results. If its values differ between points, the scale contains 0, 1,
  /// ..., and the values are written to a separate dataset.
  void write_scale(const Surveyed& set) const {
    const auto& [name, is_scale, axes, units, long_name, values] = set.first;
    std::vector<double> numbers = std::get<0>(values);
    if (!set.same)
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<double>(i);
    file_.scale(
        name, numbers, set.same ? units : "1",
        set.same ? long_name : "index of a value that differs between points: " + long_name);
  }

  void begin_attributes() {
    for (const auto& [place, found] : attributes_) {
      const auto& [object, name] = place;
      if (found.points < store_.finished() || (object != "/" && !file_.has(object))) continue;
      const std::string dataset = object == "/" ? name : object + '_' + name;
      if (found.same)
        file_.attribute(object, name, found.first.value);
      else if (is_number(found.first.value) && !file_.has(dataset))
        begin_attribute(object, name, dataset);
    }
  }

  /// Begins a dataset with the value at each point of an attribute, of the root or of a dataset,
  /// that differs between points, such as `censored` of a range.
  void begin_attribute(const std::string& object, const std::string& name,
                       const std::string& dataset) {
    const std::string long_name =
        object == "/" ? "attribute of each point" : "attribute " + name + " of " + object;
    add_column({dataset, false, {}, "", long_name, std::vector<double>(1)},
               [object, name](StackedDataset& all, std::size_t, const FinishedPoint& point) {
                 const auto own = std::ranges::find_if(
                     point.result.attributes, [&](const CollectedAttribute& attribute) {
                       return attribute.object == object && attribute.name == name;
                     });
                 all.add(number_of(own->value));
               });
  }

  ResultFile& file_;
  const ExperimentSweep& sweep_;
  const PointStore& store_;
  std::vector<Axis> grid_;
  std::vector<std::size_t> extents_;
  std::map<std::string, Surveyed> sets_;
  std::vector<std::string> order_;
  std::vector<const Surveyed*> stacked_;
  std::map<std::pair<std::string, std::string>, SurveyedAttribute> attributes_;
  std::vector<std::pair<std::unique_ptr<StackedDataset>, Column>> columns_;
};

}  // namespace

void ExperimentSweep::write(ResultFile& file, const PointStore& store) const {
  ResultGroup(file, stacked_table).attribute("of", of_);
  Stack(file, *this, store).write();
}

}  // namespace flatspeckle::apps
