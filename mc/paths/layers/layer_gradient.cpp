#include "mc/paths/layers/layer_gradient.h"

#include <array>
#include <span>
#include <vector>

#include "core/error.h"
#include "flatland/media/layers.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/derivative_sums.h"

namespace flatspeckle::mc {

namespace {

/// Largest number of layers of a medium with derivatives.
constexpr std::size_t most_layers_with_derivatives = 8;

/// A number for each layer.
using PerLayer = std::array<double, most_layers_with_derivatives>;

/// Tally of what determines the integrand of a path in each layer: the number of scatterers (each a
/// factor mu_s), the length of the flights (a factor exp(-mu_t length)), and the phase functions.
struct LayerTally {
  const Layers* layers = nullptr;
  PerLayer scatterers{}, length{};
  PerLayer phase_derivative{};  ///< sum of d log p / d g over the inner scatterers

  void flight(Vec x, Vec to, double r) {
    const Vec w = to;
    layers->each_part(x, w, r, [this](std::size_t layer, double part) { length[layer] += part; });
    ++scatterers[layers->material_at(x + r * w)];
  }
  void scattering(Vec x, Vec from, Vec to) {
    const std::size_t layer = layers->material_at(x);
    phase_derivative[layer] += henyey_greenstein_derivative(layers->materials()[layer].medium.g,
                                                            one_minus_cosine(from, to));
  }
};

struct LayerParameter {
  std::size_t layer;
  BulkParameter parameter;
};

/// The product A e of C14 (amplitude and endpoint factor) for every endpoint, and the logarithmic
/// derivatives of this product, [endpoint][parameter].
struct LayerEndpoints {
  std::vector<Complex> value;
  std::vector<double> log_derivatives;
};

/// The class Terms of DerivativeScorer for layered media and far endpoints.
class LayerTerms : public DerivativeSums {
 public:
  using Tally = LayerTally;
  using Endpoints = LayerEndpoints;

  LayerTerms(const PathWalks& walks, const Layers& layers,
             std::span<const LayerParameter> parameters, std::span<Complex> sums)
      : DerivativeSums(walks.scene().request.channels.size(), walks.scene().request.entries,
                       parameters.size(), sums),
        domain_(walks.scene().domain),
        layers_(layers),
        parameters_(parameters),
        path_derivatives_(parameters.size()) {}

  LayerEndpoints endpoints(std::size_t count) const {
    return {std::vector<Complex>(count), std::vector<double>(count * parameters_.size())};
  }

  void attenuate(EndpointFactors& endpoints, Vec x, LayerEndpoints& out) const {
    endpoints.attenuate(x, out.value);
    for (std::size_t j = 0; j < endpoints.size(); ++j) {
      const Vec w = endpoints.direction(j);
      PerLayer length{};
      layers_.each_part(x, w, domain_.distance_to_edge(x, w),
                        [&](std::size_t layer, double part) { length[layer] += part; });
      for (std::size_t p = 0; p < parameters_.size(); ++p) {
        const auto [layer, parameter] = parameters_[p];
        out.log_derivatives[j * parameters_.size() + p] =
            parameter == BulkParameter::mu_t ? -length[layer] / 2 : 0;
      }
    }
  }

  /// Adds the derivatives with respect to g of scattering at x towards the endpoints.
  void turn(const EndpointFactors& endpoints, Vec x, Vec arrival, LayerEndpoints& out) const {
    const std::size_t here = layers_.material_at(x);
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const auto [layer, parameter] = parameters_[p];
      if (layer != here || parameter != BulkParameter::g) continue;
      for (std::size_t j = 0; j < endpoints.size(); ++j)
        out.log_derivatives[j * parameters_.size() + p] +=
            henyey_greenstein_derivative(layers_.materials()[layer].medium.g,
                                         one_minus_cosine(arrival, endpoints.direction(j))) /
            2;
    }
  }

  /// Returns half of the logarithmic derivatives of a path, including its first scatterer: each of
  /// the two fields of a covariance entry contributes one half.
  const std::vector<double>& inner(const LayerTally& tally, Vec first) {
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const auto [layer, parameter] = parameters_[p];
      const BulkMedium& medium = layers_.materials()[layer].medium;
      const double scatterers =
          tally.scatterers[layer] + (layer == layers_.material_at(first) ? 1 : 0);
      double log_derivative = tally.phase_derivative[layer];
      if (parameter == BulkParameter::mu_t)
        log_derivative = scatterers / medium.mu_t - tally.length[layer];
      if (parameter == BulkParameter::albedo) log_derivative = scatterers / medium.albedo;
      path_derivatives_[p] = log_derivative / 2;
    }
    return path_derivatives_;
  }
  const std::vector<double>& one(Vec x, Vec from, Vec to) {
    LayerTally tally{&layers_};
    tally.scattering(x, from, to);
    return inner(tally, x);
  }

  void add_term(std::size_t c, Complex term, const std::vector<double>& inner,
                const LayerEndpoints& lights, std::size_t i, const LayerEndpoints& views,
                std::size_t v) {
    const std::size_t count = parameters_.size();
    const double *light = &lights.log_derivatives[i * count],
                 *view = &views.log_derivatives[v * count];
    DerivativeSums::add_term(c, term, [&](std::size_t p) { return inner[p] + light[p] + view[p]; });
  }

 private:
  Domain domain_;
  const Layers& layers_;
  std::span<const LayerParameter> parameters_;
  std::vector<double> path_derivatives_;
};

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
    throw InputError("gradient: requires at most " + std::to_string(most_layers_with_derivatives) +
                     " layers");
  if (has_near_endpoints(scene.request))
    throw InputError("gradient: layers require plane waves and far views");
  for (const Material& material : scene.profile->materials())
    if (material.medium.albedo == 0)
      throw InputError("gradient: a layer that does not scatter has no derivatives");
}

GradientJob layer_gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  check_layer_gradient(scene);
  const auto parameters = layer_parameters(scene);
  const ScoredPaths paths{
      1 + parameters.size(), [parameters](const PathWalks& walks, std::span<Complex> sums) {
        const Layers& layers = *layers_of(walks.scene());
        return std::make_unique<DerivativeScorer<LayerTerms>>(
            walks, LayerTally{&layers}, LayerTerms(walks, layers, parameters, sums));
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
