#include "apps/command/subcommands.h"

#include "apps/command/experiment.h"

namespace flatspeckle::apps {

std::unique_ptr<Experiment> solve_experiment();
std::unique_ptr<Experiment> covariance_experiment();
std::unique_ptr<Experiment> matrix_experiment();
std::unique_ptr<Experiment> flux_experiment();
std::unique_ptr<Experiment> reflectance_experiment();
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
std::unique_ptr<Call> contrast(const std::string& of);
std::unique_ptr<Call> fit(const std::string& of);
std::unique_ptr<Call> design(const std::string& of);
std::unique_ptr<Call> bench(const std::string& of);
std::unique_ptr<Call> list_keys(const std::string& of);
std::unique_ptr<Call> new_scene(const std::string& of);
std::unique_ptr<Call> explain(const std::string& of);
std::unique_ptr<Call> export_csv(const std::string& of);
std::unique_ptr<Call> datasets(const std::string& of);

std::span<const SubcommandEntry> subcommands() {
  static constexpr SubcommandEntry entries[] = {
      {"place", "draw a placement of scatterers and write it as CSV", place},
      {"solve", "exact fields of one placement of scatterers", nullptr,
       "Exact fields of one placement of scatterers", solve_experiment},
      {"covariance",
       "covariance and intensity of speckle, by Monte Carlo, transport or exact solutions", nullptr,
       "Covariance and intensity of the speckle field of a scene", covariance_experiment},
      {"validate", "Monte Carlo and a reference method on one scene, compared entry by entry",
       validate},
      {"matrix", "transmission matrices of random slabs with a period: eigenchannels, correlations",
       nullptr,
       "Transmission matrices of random slabs with a period: eigenchannels, conductance, tilt "
       "correlations and focusing",
       matrix_experiment},
      {"flux", "reflected, transmitted and absorbed power, intensity only", nullptr,
       "Reflected, transmitted and absorbed power of a scene: intensity only", flux_experiment},
      {"reflectance", "diffuse light at distances from a beam, and its field correlation", nullptr,
       "Diffuse reflectance of layers at distances from a beam, and its field correlation",
       reflectance_experiment},
      {"sweep", "memory-effect curves over medium parameters; with --of any result over any keys",
       sweep, nullptr, nullptr, ""},
      {"merge", "combine the shards of a sweep into one result", merge},
      {"optimise", "maximise or minimise a number of a result over values of keys", optimise,
       nullptr, nullptr, "render"},
      {"field",
       "random speckle fields with the covariance of a scene, also under tilts of the light",
       nullptr, "Random speckle fields with the covariance of a scene", field_experiment},
      {"image", "images of hidden points through a medium, and their recovery by the memory effect",
       nullptr,
       "Images of hidden points through a scattering medium, and the points recovered from the "
       "autocorrelation of each image",
       image_experiment},
      {"recover", "recover points from the autocorrelation of measured frames", recover},
      {"contrast", "maps of speckle contrast and of decay rates from frames of a camera", contrast},
      {"fit", "estimate medium parameters, with errors, from measured curves and fluxes", fit},
      {"trace", "rays in a gradient-index field, and the curved rays that connect two points",
       nullptr, "Rays in a gradient-index field, and the curved rays that connect two points",
       trace_experiment},
      {"render", "images of scattering gradient-index media: 3D refractive path tracing", nullptr,
       "Images of scattering gradient-index media in 3D: radiance along curved rays with "
       "scattering",
       render_experiment},
      {"design", "inverse design of an index field by ray tracing", design},
#ifdef FLATSPECKLE_BENCH
      {"bench", "benchmarks of error over time, stability and plans: error, stability, plan",
       bench},
#endif
      {"keys", "list the keys of all subcommands: json, markdown, man, completion", list_keys},
      {"new", "print a commented example scene for a purpose", new_scene},
      {"explain", "describe a result file: its medium, datasets and plot scripts", explain},
      {"export", "print datasets of a result file with their axes as CSV", export_csv},
      {"datasets", "list the datasets of result files, as in docs/format.md", datasets},
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
