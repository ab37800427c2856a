#include "apps/command/subcommands.h"

#include "apps/command/experiment.h"

namespace flatspeckle::apps {

std::unique_ptr<Experiment> solve_experiment();
std::unique_ptr<Experiment> covariance_experiment();
std::unique_ptr<Experiment> flux_experiment();
std::unique_ptr<Experiment> field_experiment();
std::unique_ptr<Experiment> image_experiment();
std::unique_ptr<Experiment> trace_experiment();
std::unique_ptr<Experiment> render_experiment();
std::unique_ptr<Call> place(const std::string& of);
std::unique_ptr<Call> validate(const std::string& of);
std::unique_ptr<Call> sweep(const std::string& of);
std::unique_ptr<Call> merge(const std::string& of);
std::unique_ptr<Call> optimise(const std::string& of);
std::unique_ptr<Call> recover(const std::string& of);
std::unique_ptr<Call> fit(const std::string& of);
std::unique_ptr<Call> design(const std::string& of);
std::unique_ptr<Call> bench(const std::string& of);
std::unique_ptr<Call> list_keys(const std::string& of);
std::unique_ptr<Call> new_scene(const std::string& of);
std::unique_ptr<Call> explain(const std::string& of);
std::unique_ptr<Call> datasets(const std::string& of);

std::span<const SubcommandEntry> subcommands() {
  static constexpr SubcommandEntry entries[] = {
      {"place", "a placement of scatterers, drawn and written as CSV", place},
      {"solve", "exact fields of one placement of scatterers", nullptr,
       "Exact fields of one placement of scatterers", solve_experiment},
      {"covariance",
       "covariance and intensity of the speckle of a scene, by Monte Carlo or exactly", nullptr,
       "Covariance and intensity of the speckle field of a scene", covariance_experiment},
      {"validate", "both methods on one scene, compared entry by entry", validate},
      {"flux", "reflected, transmitted and absorbed power, intensity only", nullptr,
       "Reflected, transmitted and absorbed power of a scene: intensity only", flux_experiment},
      {"sweep",
       "memory-effect curves over g, albedo, optical depth, radius, index; any result by --of",
       sweep, nullptr, nullptr, ""},
      {"merge", "the points of a sweep that ran in shares, as one result", merge},
      {"optimise", "the values of keys that make a number of a result as large as can be, or small",
       optimise, nullptr, nullptr, "render"},
      {"field", "speckle fields drawn with the covariance of a scene, also over tilts of the light",
       nullptr, "Speckle fields of a scene, drawn with its covariance", field_experiment},
      {"image",
       "pictures of hidden points through a medium, and what the memory effect finds in them",
       nullptr,
       "Pictures of hidden points through a scattering medium, and the points found in the "
       "autocorrelation of each",
       image_experiment},
      {"recover", "points found in the autocorrelation of measured frames", recover},
      {"fit", "the medium that gave measured curves and fluxes, with errors", fit},
      {"trace", "rays and the curves between two points in a gradient-index field", nullptr,
       "Rays and the curves between two points in a gradient-index field", trace_experiment},
      {"render", "pictures of scattering media with a gradient index: 3D refractive path tracing",
       nullptr,
       "Pictures of scattering media with a gradient index, in space: radiance that curves and "
       "scatters",
       render_experiment},
      {"design", "an index field from what its light should do: inverse design by rays", design},
#ifdef FLATSPECKLE_BENCH
      {"bench",
       "what accuracy costs, where it breaks, what plans leave out: error, stability, plan", bench},
#endif
      {"keys", "the keys of all subcommands, for programs: json, markdown, man, completion",
       list_keys},
      {"new", "a commented scene to begin with, for a purpose", new_scene},
      {"explain", "what a result file holds, in words: its medium, sizes, and what draws it",
       explain},
      {"datasets", "what result files hold, as in docs/format.md", datasets},
  };
  return entries;
}

namespace {

class ExperimentCall : public Call {
 public:
  explicit ExperimentCall(const SubcommandEntry& entry)
      : name_(entry.name), experiment_(entry.experiment()), command_(entry.name, entry.title) {
    experiment_->add_keys(command_.keys());
  }
  Subcommand& command() override { return command_; }
  int run() override {
    Session session(command_.text(), command_.keys(), experiment_->run(), command_.only_prints());
    if (command_.only_prints()) experiment_->only_print();
    experiment_->read(command_.keys());
    if (!command_.settle()) return ExitStatus::done;
    experiment_->note();
    return experiment_->run_alone(session, name_);
  }

 private:
  std::string name_;
  std::unique_ptr<Experiment> experiment_;
  Subcommand command_;
};

}  // namespace

std::unique_ptr<Call> make_call(const SubcommandEntry& entry, const std::string& of) {
  if (entry.make != nullptr) return entry.make(of);
  return std::make_unique<ExperimentCall>(entry);
}

CallEnd run_subcommand(const SubcommandEntry& entry, const Arguments& arguments) {
  std::string of;
  if (entry.of != nullptr) of = value_ahead("of", arguments);
  if (entry.of != nullptr && of.empty()) of = entry.of;
  const auto call = make_call(entry, of);
  Subcommand& command = call->command();
  if (!command.parse(arguments)) return {};
  const bool has_result = command.keys().find("out") != nullptr && !command.only_prints();
  return {call->run(), has_result};
}

std::map<std::string, std::vector<std::string>> key_owners() {
  std::map<std::string, std::vector<std::string>> owners;
  for (const SubcommandEntry& entry : subcommands()) {
    const auto call = make_call(entry);
    for (const Key& key : call->command().all_keys().rows()) {
      auto& names = owners[key.name()];
      if (names.empty() || names.back() != entry.name) names.emplace_back(entry.name);
    }
  }
  return owners;
}

}  // namespace flatspeckle::apps
