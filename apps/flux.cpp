#include "mc/estimators/flux.h"

#include <cstdio>

#include "apps/scene_options.h"
#include "apps/session.h"
#include "apps/subcommands.h"
#include "core/error.h"
#include "flatland/scene/scene_datasets.h"

namespace flatspeckle::apps {

namespace {

constexpr std::int64_t most_bins = 100000;

std::size_t checked_bins(std::int64_t bins) {
  if (bins < 1 || bins > most_bins)
    throw InputError("angle_bins", bins, "must be from 1 to " + std::to_string(most_bins));
  return static_cast<std::size_t>(bins);
}

void print_table(const Scene& scene, const mc::FluxEstimates& flux) {
  const bool box = scene.domain.kind == Domain::Kind::box;
  const auto direct = mc::direct_transmittances(scene);
  std::printf("%8s  %-22s %-22s %-12s %s%s\n", "light", "reflectance", "transmittance", "direct",
              box ? "side_loss              " : "", "absorptance");
  const auto print = [](const Estimate& share, std::size_t light) {
    std::printf("%-12.6g %-9.2g ", share.value[light].real(), share.error[light]);
  };
  for (std::size_t light = 0; light < direct.size(); ++light) {
    std::printf("%8.4f  ", scene.request.lights[light].angle);
    print(flux.reflectance, light);
    print(flux.transmittance, light);
    std::printf("%-12.6g ", direct[light]);
    if (box) print(flux.side_loss, light);
    print(flux.absorptance, light);
    std::printf("\n");
  }
}

}  // namespace

int flux(const Arguments& arguments) {
  SceneSpec spec;
  RunSettings settings;
  std::int64_t angle_bins = 90;
  Subcommand command("flux",
                     "Reflected, transmitted and absorbed power of a scene: intensity only");
  add_scatterer_options(command.options(), spec);
  add_bulk_options(command.options(), spec);
  add_medium_options(command.options(), spec);
  command.options().add("--light_angles", spec.light_angles,
                        "Directions of the plane waves, radians from +z (default 0)");
  command.options().add_with_default("--angle_bins", angle_bins,
                                     "Equal bins of the exit angle over (-pi, pi]");
  add_run_options(command.options(), settings);
  if (!command.parse(arguments)) return ExitStatus::done;

  const std::size_t bins = checked_bins(angle_bins);
  const Scene scene = make_scene(spec);
  const mc::FluxJob job = mc::flux_job(scene, bins, seed_of(settings));
  Session session(command.command_line(), settings, "mc: " + job.plan,
                  {{"", "flux", job.batches, stop_rule(settings)}});
  return session.run([&](ResultFile& file) {
    const auto estimates = mc::flux_estimates(job, session.state("").sums);
    print_table(scene, estimates);
    write_medium(file, scene);
    mc::write_flux(file, scene, estimates);
  });
}

}  // namespace flatspeckle::apps
