#include "bench/error/error_paths.h"

#include <cmath>

#include "bench/oracles/textbook.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::bench {

namespace {

Trial textbook(const Scene& scene, std::uint64_t seed) {
  constexpr std::uint64_t paths = 50;
  return trial_of(oracles::textbook_job(scene, plan_of(scene).reversed, paths, seed));
}

Trial ours(const Scene& scene, std::uint64_t seed) {
  mc::Plan plan = plan_of(scene);
  plan.paths_per_batch = 50;
  return trial_of(mc::covariance_job(scene, plan, seed));
}

/// Products of drawn fields: E[u_a u_b*] = C_ab for any number of paths in a field.
Trial fields(const Scene& scene, std::uint64_t seed) {
  constexpr std::uint64_t paths = 100;
  Trial trial{{}, sample_mean};
  trial.batches.size = scene.request.entries.size();
  trial.batches.run = [draw = mc::fields_by_paths(scene, plan_of(scene), seed, paths),
                       request = scene.request](std::uint64_t number, std::span<Complex> sums) {
    std::vector<Complex> field(request.channels.size());
    std::vector<double> intensity(field.size());
    draw(number, field, intensity);
    for (std::size_t i = 0; i < sums.size(); ++i)
      sums[i] += product_with_conjugate(field[request.entries[i].a], field[request.entries[i].b]);
  };
  return trial;
}

std::function<Trial(std::uint64_t seed)> by(const std::shared_ptr<const Scene>& scene,
                                            Trial (*trial)(const Scene&, std::uint64_t)) {
  return [scene, trial](std::uint64_t seed) { return trial(*scene, seed); };
}

}  // namespace

std::vector<double> seven_tilts(double largest_sine) {
  constexpr int count = 7;
  std::vector<double> angles;
  for (int t = 0; t < count; ++t) angles.push_back(std::asin(largest_sine * t / (count - 1)));
  return angles;
}

mc::Plan plan_of(const Scene& scene) {
  return mc::make_plan(scene, mc::ReversedPaths::automatic);
}

Trial trial_of(const FieldJob& job) {
  return {job.batches, job.covariance};
}

std::function<Trial(std::uint64_t seed)> our_paths(const std::shared_ptr<const Scene>& scene) {
  return by(scene, ours);
}

std::vector<Method> path_methods(const FlatScene& flat) {
  return {{flat.name, "textbook Monte Carlo", by(flat.scene, textbook)},
          {flat.name, "ours", our_paths(flat.scene)},
          {flat.name, "fields", by(flat.scene, fields)}};
}

}  // namespace flatspeckle::bench
