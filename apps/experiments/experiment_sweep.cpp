#include "apps/experiments/experiment_sweep.h"

#include <algorithm>

#include "apps/sweep/curve_sweep.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/version.h"

namespace flatspeckle::apps {

namespace {

/// Of the sweep as a whole, not of its points.
const std::set<std::string> keys_of_the_sweep{"of",      "vary",    "shard", "out",
                                              "threads", "seconds", "resume"};

std::string line(const std::string& key, const std::vector<std::string>& values) {
  return key + " = " + joined(values, " ") + '\n';
}

/// Of the values, which may be very many: how many, and a checksum of their texts (FNV-1a).
std::string digest(const AxisValues& values) {
  std::uint64_t sum = 0xcbf29ce484222325;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (const char letter : values[i] + ' ')
      sum = (sum ^ static_cast<unsigned char>(letter)) * 0x100000001b3;
  return std::to_string(values.size()) + " values " + std::to_string(sum);
}

/// By the rows of its key alone.
void check_values(const SweepPoints& points, std::size_t number, const Keys& keys) {
  const SweepAxis& axis = points.axes[number];
  SweepPoints alone{{axis}, points.is_list};
  for (std::size_t i = 0; i < axis.values.size(); ++i) {
    set_point(alone, i, keys);
    for (const Key& key : keys.rows())
      if (key.name() == key_of(axis)) key.check();
  }
}

/// The first and the last values of all axes.
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
    : Sweep(std::string("A sweep of: ") + ExperimentFamily(of).purpose()),
      family_(of),
      base_(family_.unset()) {
  of_ = of;
  Keys& keys = this->keys();
  base_->add_keys(keys);
  add_run_keys_of_many(keys, run_);
  keys.group("Sweep");
  keys.add("of", of_, "The subcommand whose results these are");
  add_keys(keys, vary_);
  add_share_key();
}

void ExperimentSweep::check() {
  const Keys& keys = this->keys();
  keys.read(of_);
  keys.read(run_.seconds);
  points_ = varied_points(keys, vary_, keys);
  std::set<std::string> noted = keys_of_the_sweep;  // of a key that is varied as a whole, nothing
  noted.insert(keys.name(vary_.points));
  for (const SweepAxis& axis : points_.axes) noted.insert(axis.key);
  family_.take_given(keys, noted);
  check_points();
}

/// Values one by one, and scenes of as many points as can soon be made.
void ExperimentSweep::check_points() {
  const auto scratch = family_.unset();
  Keys all;
  scratch->add_keys(all);
  family_.set_given(all);
  for (std::size_t axis = 0; axis < points_.axes.size(); ++axis) check_values(points_, axis, all);
  set_point(points_, points_.count() - 1, all);
  for (const std::size_t point : points_to_check()) experiment(point, {&all, &keys()});
  all.join_reads(keys());  // the seed
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
    std::size_t point, const std::vector<const Keys*>& joined) const {
  return at_point(points_, point, [&] {
    return family_.run([&](const Keys& keys) { set_point(points_, point, keys); }, joined);
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
  text += family_.given();
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
