#include "apps/experiments/stacked_result.h"

#include <algorithm>
#include <map>
#include <set>

#include "apps/results/datasets.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"

namespace flatspeckle::apps {

const DatasetTable stacked_table{
    .name = "sweep of results",
    .rows = {{"relative_error", Data::real, "SWEPT", "1", "RMS error relative to the RMS value"},
             {"samples", Data::real, "SWEPT", "1", "samples"},
             {"cpu_s", Data::real, "SWEPT", "s", "processor time, all threads"},
             {"wall_s", Data::real, "SWEPT", "s",
              "time from the first batch to the last, other points' included"}},
    .attributes = {{"", "of", "text", "the subcommand whose results these are"},
                   {"", "complete", "bool", "0: points are missing"},
                   {"", "ranks", "int64", "processes that worked on it (MPI)"},
                   {"", "swept", "texts", "keys that were swept, in the order of their axes"},
                   {"", "left_out", "texts",
                    "datasets of some points that others have not, or in another shape"}}};

namespace {

using Held = CollectedDataset::Held;

bool is_mark(const std::string& name) {
  return name.ends_with("_rare");
}

std::size_t value_bytes(const Held& values) {
  return std::visit([](const auto& held) { return sizeof(held.front()); }, values);
}

/// What is known of a dataset of all points.
struct Surveyed {
  CollectedDataset first;
  std::size_t points = 0;  ///< that have it
  bool fits = true, same = true;

  void add(const CollectedDataset& of_point) {
    ++points;
    fits = fits && of_point.values.index() == first.values.index() &&
           of_point.count() == first.count() && of_point.axes == first.axes;
    same = same && of_point.values == first.values;
  }
};

struct SurveyedAttribute {
  CollectedAttribute first;
  std::size_t points = 0;
  bool same = true;
  std::vector<double> numbers = {};  ///< of all points, where it is one and not the same

  void add(const Attribute& value);
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
  return value.index() < 4;  // bool, int64, uint64, double
}

void SurveyedAttribute::add(const Attribute& value) {
  if (same && !(value == first.value)) {
    same = false;
    numbers.assign(points, number_of(first.value));
  }
  ++points;
  if (!same) numbers.push_back(number_of(value));
}

class Stack {
 public:
  Stack(ResultFile& file, const ExperimentSweep& sweep, const PointStore& store,
        const std::vector<std::size_t>& points)
      : file_(file), sweep_(sweep), store_(store), points_(points) {
    for (const std::size_t point : points) survey(read(point));
  }

  void write() {
    write_axes();
    write_costs();
    for (const Surveyed* const set : stacked_)
      if (set->first.is_scale) write_scale(*set);
    std::vector<const Surveyed*> group;
    double bytes = 0;
    for (const Surveyed* const set : stacked_) {
      if (set->first.is_scale && set->same) continue;
      const double own = bytes_of(*set);
      if (!group.empty() && bytes + own > most_bytes) write_group(std::exchange(group, {}));
      bytes = group.empty() ? own : bytes + own;
      group.push_back(set);
    }
    write_group(group);
    write_attributes();
  }

 private:
  static constexpr double most_bytes = 256e6;  // of values in memory at once

  FinishedPoint read(std::size_t point) const { return store_.read(sweep_.points().name(point)); }
  double bytes_of(const Surveyed& set) const {
    return static_cast<double>(points_.size() * set.first.count() * value_bytes(set.first.values));
  }

  void survey(const FinishedPoint& point) {
    for (const CollectedDataset& set : point.result.datasets) {
      const auto [found, is_new] = sets_.try_emplace(set.name, Surveyed{set});
      if (is_new) order_.push_back(set.name);
      found->second.add(set);
    }
    for (const CollectedAttribute& attribute : point.result.attributes) {
      attributes_.try_emplace({attribute.object, attribute.name}, SurveyedAttribute{attribute})
          .first->second.add(attribute.value);
    }
    samples_.push_back(point.samples);
    cpu_s_.push_back(point.cpu_s);
    wall_s_.push_back(point.wall_s);
    relative_error_.push_back(point.relative_error);
  }

  /// Of a sweep: the swept ones, but where a result has that name itself.
  std::string name_of(const SweepAxis& axis) const {
    const std::string name = axis_name(axis);
    const bool taken = sets_.contains(name) || has_row(stacked_table, name) || name == "point";
    return taken ? "swept_" + name : name;
  }

  void write_axes() {
    const SweepPoints& points = sweep_.points();
    const bool as_list = points.is_list || points_.size() < points.count();
    std::vector<std::string> keys;
    if (as_list) {
      ResultGroup(file_, sweep_axes_table).number("point", points_.size());
      grid_ = {Axis("point")};
    }
    for (std::size_t i = 0; i < points.axes.size(); ++i) {
      keys.push_back(points.axes[i].key);
      as_list ? write_column(i) : write_axis(points.axes[i]);
    }
    file_.bind("SWEPT", grid_);
    ResultGroup(file_, stacked_table).attribute("swept", keys);
    select();
  }

  void write_axis(const SweepAxis& axis) {
    const Key& key = sweep_.key(axis);
    const std::string name = name_of(axis);
    std::vector<double> values;
    for (const std::string& text : axis.values)
      values.push_back(key.is_number() ? *read_number(text) : static_cast<double>(values.size()));
    file_.scale(name, values, unit_of(key), key.help());
    grid_.emplace_back(name);
    if (!key.is_number())
      file_.dataset(name + "_word", std::span<const std::string>(axis.values), {Axis(name)}, "",
                    key.help());
  }

  /// Of an axis as a list: a value for each point.
  void write_column(std::size_t number) {
    const SweepAxis& axis = sweep_.points().axes[number];
    const Key& key = sweep_.key(axis);
    std::vector<std::string> texts;
    std::vector<double> values;
    for (const std::size_t point : points_) {
      texts.push_back(sweep_.points().value(number, point));
      values.push_back(key.is_number() ? *read_number(texts.back()) : 0);
    }
    if (key.is_number())
      file_.dataset(name_of(axis), std::span<const double>(values), grid_, unit_of(key),
                    key.help());
    else
      file_.dataset(name_of(axis) + "_word", std::span<const std::string>(texts), grid_, "",
                    key.help());
  }

  static std::string unit_of(const Key& key) { return key.unit().empty() ? "1" : key.unit(); }

  /// Which datasets are of all points, in the same shape.
  void select() {
    std::vector<std::string> left_out;
    for (const std::string& name : order_) {
      const Surveyed& set = sets_.at(name);
      const bool of_all = set.points == points_.size() || is_mark(name);
      if (of_all && set.fits && !has_row(stacked_table, name))
        stacked_.push_back(&set);
      else
        left_out.push_back(name);
    }
    const auto hangs = [&](const Surveyed* set) {  // on an axis that is left out
      return std::ranges::any_of(set->first.axes, [&](const Axis& axis) {
        const auto* name = std::get_if<std::string>(&axis);
        return name != nullptr && std::ranges::count(left_out, *name) > 0;
      });
    };
    for (const Surveyed* const set : stacked_)
      if (hangs(set)) left_out.push_back(set->first.name);
    std::erase_if(stacked_, hangs);
    if (!left_out.empty()) ResultGroup(file_, stacked_table).attribute("left_out", left_out);
  }

  void write_costs() const {
    const ResultGroup root(file_, stacked_table);
    root.put("relative_error", relative_error_);
    root.put("samples", samples_);
    root.put("cpu_s", cpu_s_);
    root.put("wall_s", wall_s_);
  }

  /// One that differs from point to point only counts; its values stand beside it.
  void write_scale(const Surveyed& set) const {
    const auto& [name, is_scale, axes, units, long_name, values] = set.first;
    std::vector<double> numbers = std::get<0>(values);
    if (!set.same)
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<double>(i);
    file_.scale(name, numbers, set.same ? units : "1",
                set.same ? long_name : "number of what differs from point to point: " + long_name);
  }

  void write_group(const std::vector<const Surveyed*>& group) const {
    std::vector<Held> all;
    for (const Surveyed* const set : group) all.push_back(empty_like(*set));
    for (const std::size_t point : points_) {
      const CollectedResult result = read(point).result;
      for (std::size_t i = 0; i < group.size(); ++i) append(all[i], *group[i], result);
    }
    for (std::size_t i = 0; i < group.size(); ++i) write_one(*group[i], all[i]);
  }

  Held empty_like(const Surveyed& set) const {
    Held like = set.first.values;
    std::visit(
        [&](auto& held) {
          held.clear();
          held.reserve(points_.size() * set.first.count());
        },
        like);
    return like;
  }

  static void append(Held& all, const Surveyed& set, const CollectedResult& result) {
    const CollectedDataset* const of_point = result.find(set.first.name);
    std::visit(
        [&]<typename Value>(std::vector<Value>& held) {
          if (of_point == nullptr) return held.resize(held.size() + set.first.count());
          const auto& own = std::get<std::vector<Value>>(of_point->values);
          held.insert(held.end(), own.begin(), own.end());
        },
        all);
  }

  void write_one(const Surveyed& set, const Held& values) const {
    std::vector<Axis> axes = grid_;
    const auto& own = set.first.axes;
    axes.insert(axes.end(), own.begin(), own.end());
    if (set.first.is_scale) axes.emplace_back(set.first.name);
    const std::string name = set.first.name + (set.first.is_scale ? "_of_point" : "");
    std::visit(
        [&]<typename Value>(const std::vector<Value>& held) {
          file_.dataset(name, std::span<const Value>(held), axes, set.first.units,
                        set.first.long_name);
        },
        values);
    if (is_mark(name)) note_marks(name, std::get<std::vector<std::uint64_t>>(values));
  }

  void note_marks(const std::string& name, const std::vector<std::uint64_t>& marks) const {
    const auto few = std::ranges::count(marks, std::uint64_t{1});
    file_.note_rare(name.substr(0, name.size() - 5) + ": " + std::to_string(few) + " of " +
                    std::to_string(marks.size()));
  }

  void write_attributes() const {
    for (const auto& [place, found] : attributes_) {
      const auto& [object, name] = place;
      const std::string path = (object == "/" ? "" : object + '/') + name;
      if (found.points < points_.size() || (object != "/" && !file_.has(object))) continue;
      if (found.same)
        file_.attribute(object, name, found.first.value);
      else if (is_number(found.first.value) && object == "/" && !file_.has(path))
        file_.dataset(path, std::span<const double>(found.numbers), grid_, "",
                      "attribute of each point");
    }
  }

  ResultFile& file_;
  const ExperimentSweep& sweep_;
  const PointStore& store_;
  const std::vector<std::size_t>& points_;
  std::vector<Axis> grid_;
  std::map<std::string, Surveyed> sets_;
  std::vector<std::string> order_;
  std::vector<const Surveyed*> stacked_;
  std::map<std::pair<std::string, std::string>, SurveyedAttribute> attributes_;
  std::vector<double> samples_, cpu_s_, wall_s_, relative_error_;
};

}  // namespace

void write_stacked(ResultFile& file, const ExperimentSweep& sweep, const PointStore& store,
                   const std::vector<std::size_t>& points) {
  Stack(file, sweep, store, points).write();
}

}  // namespace flatspeckle::apps
