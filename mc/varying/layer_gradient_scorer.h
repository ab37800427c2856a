#pragma once

#include <span>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/estimators/path_ends.h"
#include "mc/estimators/slope_sums.h"
#include "mc/varying/layer_tally.h"

namespace flatspeckle::mc {

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

}  // namespace flatspeckle::mc
