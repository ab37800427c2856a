#include "mc/varying/layer_gradient.h"

#include "core/error.h"
#include "flatland/media/layers.h"
#include "mc/estimators/scored_paths.h"
#include "mc/varying/layer_gradient_scorer.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

const Layers* layers_of(const Scene& scene) {
  return dynamic_cast<const Layers*>(scene.profile.get());
}

std::vector<LayerParameter> layer_parameters(const Scene& scene) {
  std::vector<LayerParameter> parameters;
  for (std::size_t layer = 0; layer < scene.profile->materials().size(); ++layer)
    for (const BulkParameter parameter : bulk_parameters(scene))
      if (parameter <= BulkParameter::albedo) parameters.push_back({layer, parameter});
  return parameters;
}

}  // namespace

void check_layer_gradient(const Scene& scene) {
  if (layers_of(scene) == nullptr) throw InputError("gradient: density maps have no derivatives");
  if (scene.profile->materials().size() > most_layers_with_derivatives)
    throw InputError("gradient: is of at most " + std::to_string(most_layers_with_derivatives) +
                     " layers");
  if (has_near_ends(scene.request))
    throw InputError("gradient: layers need plane waves and far views");
  for (const Material& material : scene.profile->materials())
    if (material.medium.albedo == 0)
      throw InputError("gradient: a layer that does not scatter has no derivatives");
}

GradientJob layer_gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  check_layer_gradient(scene);
  const auto parameters = layer_parameters(scene);
  const ScoredPaths paths{1 + parameters.size(),
                          [parameters](const PathWalks& walks, std::span<Complex> sums) {
                            return std::make_unique<LayerGradientScorer>(
                                walks, *layers_of(walks.scene()), parameters, sums);
                          }};
  GradientJob job{path_job(paths, scene, plan, seed), {}, {}};
  for (const auto& [layer, parameter] : parameters)
    job.parameters.push_back(name_of(parameter) + " of layer " + std::to_string(layer + 1));
  job.gradient = [all = job.all, entries = job.entries](double samples,
                                                        std::span<const Complex> sums) {
    Values values = all(samples, sums);
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(entries));
    return values;
  };
  return job;
}

}  // namespace flatspeckle::mc
