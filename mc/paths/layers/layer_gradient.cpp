#include "mc/paths/layers/layer_gradient.h"

#include <array>
#include <span>
#include <vector>

#include "core/error.h"
#include "flatland/media/layers.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/paths/endpoint_factors/space_direction.h"
#include "mc/paths/estimators/path_ends.h"
#include "mc/paths/estimators/scored_paths.h"
#include "mc/paths/estimators/slope_sums.h"

namespace flatspeckle::mc {

namespace {

/// More than these have no derivatives.
constexpr std::size_t most_layers_with_derivatives = 8;

/// A number for each layer.
using PerLayer = std::array<double, most_layers_with_derivatives>;

/// What the logarithm of a path's integrand depends on, layer by layer: prod mu_s over its
/// scatterers, exp(-mu_t length) of its flights, and its phase functions.
struct LayerTally {
  const Layers* layers = nullptr;
  PerLayer scatterers{}, length{};
  PerLayer phase_slope{};  ///< sum of d log p / d g over the inner scatterers

  void flight(Vec2 x, const SpaceDirection& to, double r) {
    const Vec2 w = to;
    layers->each_part(x, w, r, [this](std::size_t layer, double part) { length[layer] += part; });
    ++scatterers[layers->material_at(x + r * w)];
  }
  void scattering(Vec2 x, const SpaceDirection& from, const SpaceDirection& to) {
    const std::size_t layer = layers->material_at(x);
    phase_slope[layer] +=
        henyey_greenstein_slope(layers->materials()[layer].medium.g, one_minus_cosine(from, to));
  }
};

struct LayerParameter {
  std::size_t layer;
  BulkParameter parameter;
};

/// As GradientScorer, of layers seen from far.
class LayerGradientScorer : public TallyScorer<LayerTally> {
 public:
  LayerGradientScorer(const PathWalks& walks, const Layers& layers,
                      std::span<const LayerParameter> parameters, std::span<Complex> sums)
      : TallyScorer(LayerTally{&layers}),
        channels_(walks.scene().request.channels),
        domain_(walks.scene().domain),
        scattering_(walks.scattering()),
        layers_(layers),
        parameters_(parameters),
        path_slopes_(parameters.size()),
        sums_(channels_.size(), walks.scene().request.entries, parameters.size(), sums),
        ends_(walks, [&](std::size_t ends) { return EndValues(ends, parameters.size()); }) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) override {
    EndFactors &lights = ends_.lights(), &views = ends_.views();
    EndValues &light = ends_.light_last, &view = ends_.view_last;
    attenuate(lights, x, light);
    attenuate(views, x, view);
    sums_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      const Vec2 from = -lights.direction(i), to = views.direction(v);
      LayerTally tally{&layers_};
      tally.scattering(x, from, to);
      find_path_slopes(tally, x);
      add_term(c, light, view, scattering_.amplitude(x, from, to));
    }
    sums_.accumulate(weight);
  }

  void multiple(const Path& path) override {
    ends_.find(path,
               [this](EndFactors& ends, Vec2 x, const SpaceDirection& arrival, EndValues& out) {
                 attenuate(ends, x, out);
                 scattering_.towards(x, arrival, ends.directions(), out.value);
                 turn(ends, x, arrival, out);
               });
    find_path_slopes(tally(), path.first);
    sums_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      add_term(c, ends_.light_first, ends_.view_last, 1.0);
      if (ends_.reversed()) add_term(c, ends_.light_last, ends_.view_first, 1.0);
    }
    sums_.accumulate(path.weight);
  }

 private:
  /// A e of every end and its logarithmic derivatives, [end][parameter].
  struct EndValues {
    std::vector<Complex> value;
    std::vector<double> slope;

    EndValues(std::size_t ends, std::size_t parameters) : value(ends), slope(ends * parameters) {}
  };

  void attenuate(EndFactors& ends, Vec2 x, EndValues& out) const {
    ends.attenuate(x, out.value);
    for (std::size_t j = 0; j < ends.size(); ++j) {
      const Vec2 w = ends.direction(j);
      PerLayer length{};
      layers_.each_part(x, w, domain_.distance_to_edge(x, w),
                        [&](std::size_t layer, double part) { length[layer] += part; });
      for (std::size_t p = 0; p < parameters_.size(); ++p) {
        const auto [layer, parameter] = parameters_[p];
        out.slope[j * parameters_.size() + p] =
            parameter == BulkParameter::mu_t ? -length[layer] / 2 : 0;
      }
    }
  }

  /// Towards the ends, by g.
  void turn(const EndFactors& ends, Vec2 x, const SpaceDirection& arrival, EndValues& out) const {
    const std::size_t here = layers_.material_at(x);
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const auto [layer, parameter] = parameters_[p];
      if (layer != here || parameter != BulkParameter::g) continue;
      for (std::size_t j = 0; j < ends.size(); ++j)
        out.slope[j * parameters_.size() + p] +=
            henyey_greenstein_slope(layers_.materials()[layer].medium.g,
                                    one_minus_cosine(arrival, SpaceDirection(ends.direction(j)))) /
            2;
    }
  }

  /// Half of what a path with its first scatterer has, as of each of two fields.
  void find_path_slopes(const LayerTally& tally, Vec2 first) {
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const auto [layer, parameter] = parameters_[p];
      const BulkMedium& medium = layers_.materials()[layer].medium;
      const double scatterers =
          tally.scatterers[layer] + (layer == layers_.material_at(first) ? 1 : 0);
      double slope = tally.phase_slope[layer];
      if (parameter == BulkParameter::mu_t) slope = scatterers / medium.mu_t - tally.length[layer];
      if (parameter == BulkParameter::albedo) slope = scatterers / medium.albedo;
      path_slopes_[p] = slope / 2;
    }
  }

  template <typename Amplitude>
  void add_term(std::size_t c, const EndValues& lights, const EndValues& views,
                Amplitude amplitude) {
    const auto [i, v] = channels_[c];
    const std::size_t count = parameters_.size();
    const double *light = &lights.slope[i * count], *view = &views.slope[v * count];
    sums_.add_term(c, product(product(lights.value[i], views.value[v]), amplitude),
                   [&](std::size_t p) { return path_slopes_[p] + light[p] + view[p]; });
  }

  const std::vector<Channel>& channels_;
  Domain domain_;
  const EndScattering& scattering_;
  const Layers& layers_;
  std::span<const LayerParameter> parameters_;
  std::vector<double> path_slopes_;
  SlopeSums sums_;
  PathEnds<EndValues> ends_;
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
