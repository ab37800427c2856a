#include "apps/experiments/experiment_kind.h"

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

const SubcommandEntry& entry_of(const std::string& of) {
  std::vector<std::string> names;
  for (const SubcommandEntry& entry : subcommands()) {
    if (entry.experiment == nullptr) continue;
    if (of == entry.name) return entry;
    names.emplace_back(entry.name);
  }
  throw InputError("of", of, "must be one of " + join_texts(names, " "));
}

}  // namespace

void add_run_keys_of_many(Keys& keys, RunSettings& run) {
  // tilt_count is removed, because all runs must have the same tilts, which are one axis of the
  // combined result
  for (const char* const name :
       {"out", "seed", "seconds", "threads", "resume", "keep_state", "tilt_count"})
    if (keys.find(name) != nullptr) keys.remove(name);
  add_output_key(keys, run);
  add_seed_key(keys, run, "Random seed; the same seed gives the same numbers");
  keys.add("seconds", run.seconds, "Stop after this time").positive().unit("s").effort();
  add_thread_key(keys, run);
  keys.add("resume", run.resume,
           "Continue an interrupted call from the files that it left beside --out")
      .effort();
}

ExperimentKind::ExperimentKind(const std::string& of) : of_(of), entry_(&entry_of(of)) {}

void ExperimentKind::take_given(const Keys& keys, std::set<std::string> without) {
  for (const Key& key : keys.rows())
    if (key.given() && without.insert(key.name()).second)
      given_.emplace_back(key.name(), key.value());
}

void ExperimentKind::set_given(const Keys& keys) const {
  for (const auto& [name, values] : given_) keys.set(name, values);
}

std::string ExperimentKind::given() const {
  std::string text;
  for (const auto& [name, values] : given_) text += name + " = " + join_texts(values, " ") + '\n';
  return text;
}

std::unique_ptr<Experiment> ExperimentKind::run(const std::function<void(const Keys&)>& set,
                                                const std::vector<const Keys*>& also_marked,
                                                std::uint64_t seed) const {
  auto experiment = unset();
  experiment->set_default_seed(seed);
  Keys keys;
  experiment->add_keys(keys);
  set_given(keys);
  set(keys);
  keys.check();
  experiment->read(keys);
  for (const Keys* const others : also_marked) others->merge_reads(keys);
  return experiment;
}

}  // namespace flatspeckle::apps
