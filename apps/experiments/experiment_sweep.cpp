#include "apps/experiments/experiment_sweep.h"

#include <algorithm>

#include "apps/sweep/curve_sweep.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/version.h"

namespace flatspeckle::apps {

namespace {

/// Keys that apply to the sweep as a whole, not to the run at each point.
const std::set<std::string> keys_of_the_sweep{"of",      "vary",    "shard", "out",
                                              "threads", "seconds", "resume"};

std::string line(const std::string& key, const std::vector<std::string>& values) {
  return key + " = " + join_texts(values, " ") + '\n';
}

/// Returns a short text that identifies a list of values, which may be long: their number and a
/// checksum (FNV-1a) of their texts.
std::string digest(const AxisValues& values) {
  std::uint64_t sum = 0xcbf29ce484222325;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (const char letter : values[i] + ' ')
      sum = (sum ^ static_cast<unsigned char>(letter)) * 0x100000001b3;
  return std::to_string(values.size()) + " values " + std::to_string(sum);
}

/// Checks that all values of an axis are accepted by the key that it varies.
void check_values(const SweepPoints& points, std::size_t number, const Keys& keys) {
  const SweepAxis& axis = points.axes[number];
  SweepPoints alone{{axis}, points.is_list};
  for (std::size_t i = 0; i < axis.values.size(); ++i) {
    set_point(alone, i, keys);
    for (const Key& key : keys.rows())
      if (key.name() == key_of(axis)) key.check();
  }
}

/// Whether a point is a corner of the grid: it has the first or last value of every axis.
bool is_corner(const SweepPoints& points, std::size_t point) {
  for (std::size_t axis = 0; axis < points.axes.size(); ++axis) {
    const AxisValues& values = points.axes[axis].values;
    const std::string value = points.value(axis, point);
    if (value != values.front() && value != values.back()) return false;
  }
  return true;
}

}  // namespace

ExperimentSweep::ExperimentSweep(const std::string& of)
    : Sweep(std::string("A sweep of: ") + ExperimentKind(of).purpose()),
      kind_(of),
      base_(kind_.unset()) {
  of_ = of;
  Keys& keys = this->keys();
  base_->add_keys(keys);
  add_run_keys_of_many(keys, run_);
  keys.group("Sweep");
  keys.add("of", of_, "Subcommand whose results are swept");
  add_keys(keys, vary_);
  add_share_key();
}

void ExperimentSweep::check() {
  const Keys& keys = this->keys();
  keys.read(of_);
  keys.read(run_.seconds);
  points_ = varied_points(keys, vary_, keys);
  // Keys that the runs do not share: the keys of the sweep itself, and the keys that an axis
  // varies.
  std::set<std::string> noted = keys_of_the_sweep;
  noted.insert(keys.name(vary_.points));
  for (const SweepAxis& axis : points_.axes) noted.insert(axis.key);
  kind_.take_given(keys, noted);
  check_points();
}

/// Checks all values of each axis, and the scenes of a limited number of points.
void ExperimentSweep::check_points() {
  const auto scratch = kind_.unset();
  Keys all;
  scratch->add_keys(all);
  kind_.set_given(all);
  for (std::size_t axis = 0; axis < points_.axes.size(); ++axis) check_values(points_, axis, all);
  set_point(points_, points_.count() - 1, all);
  for (const std::size_t point : points_to_check()) experiment(point, {&all, &keys()});
  all.merge_reads(keys());  // includes keys that only the sweep itself has read, such as the seed
  all.refuse_unread();
  inputs_ = experiment(0)->inputs();
}

std::vector<std::size_t> ExperimentSweep::points_to_check() const {
  constexpr std::size_t few = 64, scattered_few = 48;
  const ScatteredRuns all(points_.count());
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < (all.size() <= few ? all.size() : scattered_few); ++i)
    some.push_back(all[i]);
  if (all.size() <= few || points_.is_list) return some;
  for (std::size_t point = 0; point < points_.count() && some.size() < few; ++point)
    if (is_corner(points_, point)) some.push_back(point);
  return some;
}

std::unique_ptr<Experiment> ExperimentSweep::experiment(
    std::size_t point, const std::vector<const Keys*>& also_marked) const {
  return at_point(points_, point, [&] {
    return kind_.run([&](const Keys& keys) { set_point(points_, point, keys); }, also_marked);
  });
}

SweepRun ExperimentSweep::open(std::size_t point) const {
  const std::shared_ptr<const Experiment> experiment = this->experiment(point);
  PlannedExperiment planned = plan_at(points_, point, *experiment);
  return {planned.plan, std::move(planned.batches), experiment->stop(),
          [experiment, write = std::move(planned.write)](ResultFile& file, const RunState& state) {
            write(file, state.sums, false);
          }};
}

std::string ExperimentSweep::identity_of_points() const {
  std::string text = "flatspeckle " + version() + ", sweep of " + of_ + ", format 1\n";
  text += kind_.given();
  std::vector<std::string> axes;
  for (const SweepAxis& axis : points_.axes) axes.push_back(axis.key);
  return text + line("varied", axes) + inputs_;
}

std::string ExperimentSweep::identity() const {
  std::string text = identity_of_points() + (points_.is_list ? "a list\n" : "");
  for (const SweepAxis& axis : points_.axes) text += line(axis.key, {digest(axis.values)});
  return text;
}

std::unique_ptr<Sweep> make_sweep(const std::string& of) {
  if (of.empty()) return std::make_unique<CurveSweep>();
  return std::make_unique<ExperimentSweep>(of);
}

std::unique_ptr<Call> sweep(const std::string& of) {
  return make_sweep(of);
}

}  // namespace flatspeckle::apps
