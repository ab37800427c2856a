#include "apps/experiments/experiment.h"

#include <algorithm>

#include "core/result/collected_result.h"
#include "core/run/interrupt.h"

namespace flatspeckle::apps {

std::unique_ptr<Experiment> covariance_experiment();
std::unique_ptr<Experiment> field_experiment();
std::unique_ptr<Experiment> flux_experiment();
std::unique_ptr<Experiment> image_experiment();
std::unique_ptr<Experiment> render_experiment();
std::unique_ptr<Experiment> solve_experiment();
std::unique_ptr<Experiment> trace_experiment();

namespace {

constexpr ExperimentEntry entries[] = {
    {"covariance", "Covariance and intensity of the speckle field of a scene",
     covariance_experiment},
    {"flux", "Reflected, transmitted and absorbed power of a scene: intensity only",
     flux_experiment},
    {"field", "Speckle fields of a scene, drawn with its covariance", field_experiment},
    {"image",
     "Pictures of hidden points through a scattering medium, and the points found in the "
     "autocorrelation of each",
     image_experiment},
    {"solve", "Exact fields of one placement of scatterers", solve_experiment},
    {"trace", "Rays and the curves between two points in a gradient-index field", trace_experiment},
    {"render",
     "Pictures of scattering media with a gradient index, in space: radiance that curves and "
     "scatters",
     render_experiment}};

}  // namespace

int Experiment::run_alone(Session& session, const std::string& label) const {
  const PlannedExperiment planned = plan();
  const auto& write = planned.write_and_tell ? planned.write_and_tell : planned.write;
  return session.run(planned.plan, {{"", label, planned.batches, stop_}}, inputs_,
                     [&](ResultFile& file) { write(file, session.sums("")); });
}

PlannedExperiment OneShot::plan() const {
  const auto made = std::make_shared<CollectedResult>();
  BatchJob job;
  job.size = 1;
  job.one_by_one = true;
  job.relative_error = [](const GroupedSums&) { return 0.0; };
  job.run = [this, made](std::uint64_t batch, std::span<Complex>) {
    if (batch > 0) return;
    ResultFile collecting(*made);
    if (!make(collecting, false)) throw Interrupted{};
  };
  return {.plan = "at once", .batches = job, .write = [made](ResultFile& file, const GroupedSums&) {
            put(file, *made);
          }};
}

int OneShot::run_alone(Session& session, const std::string&) const {
  if (looks_for_signals()) catch_interrupts();
  return session.once(ResultFile(session.out(), storage()),
                      [&](ResultFile& file) { return make(file, true); });
}

const ExperimentEntry* experiment_entry(const std::string& name) {
  const auto found = std::ranges::find_if(
      entries, [&](const ExperimentEntry& entry) { return name == entry.name; });
  return found == std::end(entries) ? nullptr : found;
}

std::vector<std::string> experiment_names() {
  std::vector<std::string> names;
  for (const ExperimentEntry& entry : entries) names.emplace_back(entry.name);
  return names;
}

int single_run(const std::string& name, const Arguments& arguments) {
  const ExperimentEntry& entry = *experiment_entry(name);
  const auto experiment = entry.make();
  Subcommand command(name, entry.purpose);
  experiment->add_keys(command.keys());
  if (!command.parse(arguments)) return ExitStatus::done;

  Session session(command.text(), command.keys(), experiment->run(), command.only_prints());
  experiment->read(command.keys());
  if (!command.settle()) return ExitStatus::done;
  experiment->note();
  return experiment->run_alone(session, name);
}

}  // namespace flatspeckle::apps
