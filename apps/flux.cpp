#include "mc/estimators/flux.h"

#include <cstdio>
#include <numbers>

#include "apps/estimate_output.h"
#include "apps/moments_output.h"
#include "apps/subcommands.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

namespace {

std::vector<double> bin_centres(std::size_t bins) {
  std::vector<double> centres;
  for (std::size_t bin = 0; bin < bins; ++bin)
    centres.push_back(std::numbers::pi *
                      (static_cast<double>(2 * bin + 1) / static_cast<double>(bins) - 1));
  return centres;
}

std::vector<double> direct_transmittances(const Scene& scene) {
  std::vector<double> shares;
  for (double light : scene.request.lights.angles())
    shares.push_back(mc::direct_transmittance(scene, light));
  return shares;
}

void print_table(const Scene& scene, const mc::FluxEstimates& flux) {
  const bool box = scene.domain.kind == Domain::Kind::box;
  const auto direct = direct_transmittances(scene);
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

void write_flux(ResultFile& file, const Scene& scene, std::size_t bins,
                const mc::FluxEstimates& flux) {
  file.scale("light_angle", scene.request.lights.angles(), "rad",
             "direction of the light, from +z towards +x");
  file.scale("exit_angle", bin_centres(bins), "rad", "middle of the bin of exit directions");
  const auto share = [&](const std::string& name, const Estimate& estimate,
                         const std::string& long_name) {
    write_estimate(file, name, estimate, {"light_angle"}, "1", long_name);
  };
  share("reflectance", flux.reflectance, "share of the light scattered out through z = 0");
  share("transmittance", flux.transmittance, "share of the light scattered out through z = depth");
  share("absorptance", flux.absorptance, "share of the light that is absorbed");
  if (scene.domain.kind == Domain::Kind::box)
    share("side_loss", flux.side_loss, "share of the light scattered out through the sides");
  const auto direct = direct_transmittances(scene);
  share("direct_transmittance",
        {{direct.begin(), direct.end()}, std::vector<double>(direct.size(), 0.0)},
        "share of the light that meets no scatterer");
  write_estimate(file, "exit_radiance", flux.exit_radiance, {"light_angle", "exit_angle"}, "1/rad",
                 "share of the light scattered out per radian of exit direction");
}

}  // namespace

int flux(const Arguments& arguments) {
  SceneSpec spec;
  RunSettings run;
  std::int64_t angle_bins = 90;
  Subcommand command("flux",
                     "Reflected, transmitted and absorbed power of a scene: intensity only");
  Keys& keys = command.keys();
  add_scatterer_keys(keys, spec);
  add_bulk_keys(keys, spec);
  add_medium_keys(keys, spec);
  keys.group("Lights and views");
  keys.add("light_angles", spec.light_angles, "Directions of the plane waves, from +z").unit("rad");
  keys.add("angle_bins", angle_bins, "Equal bins of the exit angle over (-pi, pi]").from(1, 100000);
  add_run_keys(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;

  Session session(command.text(), keys, run, command.only_prints());
  const StopRule stop = stop_rule(keys, run);
  const auto bins = static_cast<std::size_t>(keys.read(angle_bins));
  const Scene scene = make_scene(keys, spec);
  const mc::FluxJob job = mc::flux_job(scene, bins, session.seed());
  if (!command.settle()) return ExitStatus::done;
  return session.run("mc: " + job.plan, {{"", "flux", job.batches, stop}}, "",
                     [&](ResultFile& file) {
                       const auto estimates = mc::flux_estimates(job, session.sums(""));
                       print_table(scene, estimates);
                       write_medium(file, scene);
                       write_flux(file, scene, bins, estimates);
                     });
}

}  // namespace flatspeckle::apps
