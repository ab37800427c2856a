#include "apps/experiments/experiment_family.h"

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
  throw InputError("of", of, "must be one of " + joined(names, " "));
}

}  // namespace

void add_run_keys_of_many(Keys& keys, RunSettings& run) {
  // tilt_count: results beside each other have one axis of tilts
  for (const char* const name :
       {"out", "seed", "seconds", "threads", "resume", "keep_state", "tilt_count"})
    if (keys.find(name) != nullptr) keys.remove(name);
  add_output_key(keys, run);
  add_seed_key(keys, run, "Seed; the same seed gives the same numbers");
  keys.add("seconds", run.seconds, "Stop after so many seconds").positive().unit("s").effort();
  add_thread_key(keys, run);
  keys.add("resume", run.resume, "Go on with what stands beside --out").effort();
}

ExperimentFamily::ExperimentFamily(const std::string& of) : of_(of), entry_(&entry_of(of)) {}

void ExperimentFamily::take_given(const Keys& keys, std::set<std::string> without) {
  for (const Key& key : keys.rows())
    if (key.given() && without.insert(key.name()).second)
      given_.emplace_back(key.name(), key.value());
}

void ExperimentFamily::set_given(const Keys& keys) const {
  for (const auto& [name, values] : given_) keys.set(name, values);
}

std::string ExperimentFamily::given() const {
  std::string text;
  for (const auto& [name, values] : given_) text += name + " = " + joined(values, " ") + '\n';
  return text;
}

std::unique_ptr<Experiment> ExperimentFamily::run(const std::function<void(const Keys&)>& set,
                                                  const std::vector<const Keys*>& joined,
                                                  std::uint64_t seed) const {
  auto experiment = unset();
  experiment->set_default_seed(seed);
  Keys keys;
  experiment->add_keys(keys);
  set_given(keys);
  set(keys);
  keys.check();
  experiment->read(keys);
  for (const Keys* const others : joined) others->join_reads(keys);
  return experiment;
}

}  // namespace flatspeckle::apps
