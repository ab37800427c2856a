#include <algorithm>
#include <cstdio>

#include "apps/render_scene.h"
#include "apps/session.h"
#include "apps/subcommands.h"
#include "grin/estimators/render_datasets.h"

namespace flatspeckle::apps {

namespace {

/// What is missing from a picture is not passed over in silence.
void note_losses(const grin::TransportCounts& counts) {
  if (counts.lost_flights > 0)
    std::fprintf(
        stderr,
        "note: %.2g %% of the flights were longer than max_length, trapped in a body, or came to "
        "where the index is not positive; their light is missing\n",
        100 * static_cast<double>(counts.lost_flights) / static_cast<double>(counts.flights));
  if (counts.lost_values > 0)
    std::fprintf(stderr, "note: %llu contributions were not finite and are left out\n",
                 static_cast<unsigned long long>(counts.lost_values));
}

/// A dark picture is more often a mistake than a result.
void note_darkness(const grin::Stage& stage) {
  std::fputs("note: no light came to the sensor\n", stderr);
  if (stage.body)
    std::fputs(
        "note: points are not joined across the surface of a body: a pinhole does not see a point "
        "or beam through it, a camera with a lens or an area sensor does\n",
        stderr);
}

void print_row(const char* name, const Estimate& estimate, std::size_t entry,
               const std::string& units) {
  std::printf("%-16s %-13.6g %-10.2g %s\n", name, estimate.value[entry].real(),
              estimate.error[entry], units.c_str());
}

/// Total, mean, brightest pixel, and what the search for curves cost.
void print_render(const grin::RenderScene& scene, const grin::RenderJob& job,
                  const grin::RenderResult& result) {
  const std::string& units = row_of(grin::table_of(scene.sensor), "image").unit;
  const auto& image = result.picture.steady;
  const auto brightest =
      std::max_element(image.value.begin(), image.value.end(),
                       [](const Complex& a, const Complex& b) { return a.real() < b.real(); });
  std::printf("%-16s %-13s %-10s\n", "", "value", "error");
  if (result.total) print_row("total power", *result.total, 0, "");
  print_row("mean of pixels", result.mean, 0, units);
  print_row("brightest pixel", image, static_cast<std::size_t>(brightest - image.value.begin()),
            units);
  if (brightest->real() > 0)
    std::printf("pixels: relative error %.2g %%\n", 100 * relative_error(image));
  else
    note_darkness(scene.stage);
  if (job.counts) note_losses(*job.counts);
  if (!grin::has_trials(job)) return;
  const auto& curves = job.counts->connections;
  std::printf("curves: %llu pairs, %.3g %% of trials converged, %.3g further trials each\n",
              static_cast<unsigned long long>(curves.pairs), 100 * curves.success_rate(),
              curves.mean_refind());
}

}  // namespace

int render(const Arguments& arguments) {
  RenderSpec spec;
  RunSettings settings;
  Subcommand command("render",
                     "Pictures of scattering media with a gradient index, in space: radiance that "
                     "curves and scatters");
  add_render_options(command.options(), spec);
  add_run_options(command.options(), settings);
  if (!command.parse(arguments)) return ExitStatus::done;

  const grin::RenderScene scene = make_render_scene(command, spec);
  const auto length_unit = length_unit_of(spec);
  const grin::RenderJob job = render_job(scene, make_render_request(spec), seed_of(settings));
  Session session(command.command_line(), settings, "render: " + spec.method + ": " + job.plan,
                  {{"", "render", job.batches, stop_rule(settings)}}, inputs_text(spec));
  return session.run([&](ResultFile& file) {
    const grin::RenderResult result = grin::render_result(scene, job, session.state("").sums);
    print_render(scene, job, result);
    grin::write_render(file, scene, job, result, length_unit);
  });
}

}  // namespace flatspeckle::apps
