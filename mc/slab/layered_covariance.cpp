#include "mc/slab/layered_covariance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "core/error.h"
#include "core/numbers/blas.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "flatland/media/layers.h"
#include "mc/slab/range_refinement.h"
#include "mc/transport/chains.h"
#include "mc/transport/double_scattering.h"
#include "mc/transport/scattering_matrices.h"

namespace flatspeckle::mc {

namespace {

/// A layer as a slab of its own.
struct OneLayer {
  Scene scene;
  std::shared_ptr<const ScatteringLaw> law;

  double depth() const { return scene.medium.mu_t * scene.domain.depth; }
};

Scene slab_of(const Scene& whole, const Layers& layers, std::size_t layer) {
  Scene own = whole;
  own.profile.reset();
  own.scatterer = layers.materials()[layer].scatterer;
  own.medium = layers.materials()[layer].medium;
  own.domain.depth = layers.thickness(layer);
  return own;
}

/// One at the least scatters; the law of those that do not is that of one that does.
std::vector<OneLayer> layers_of(const Scene& slab) {
  const auto& layers = dynamic_cast<const Layers&>(*slab.profile);
  std::vector<OneLayer> list;
  std::shared_ptr<const ScatteringLaw> any;
  for (std::size_t l = 0; l < layers.materials().size(); ++l) {
    list.push_back({slab_of(slab, layers, l), nullptr});
    if (list[l].scene.medium.mu_s > 0)
      any = list[l].law = std::make_shared<const ScatteringLaw>(list[l].scene);
  }
  for (OneLayer& layer : list)
    if (!layer.law) layer.law = any;
  return list;
}

/// What the layers above and below leave of waves where they enter each layer: of [layer][wave].
template <typename TopOf, typename BottomOf>
std::vector<std::vector<Complex>> entering(std::size_t layers, std::size_t waves, const TopOf& top,
                                           const BottomOf& bottom) {
  std::vector<std::vector<Complex>> factors(layers, std::vector<Complex>(waves));
  for (std::size_t w = 0; w < waves; ++w)
    for (std::size_t l = 0; l < layers; ++l) {
      Complex exponent = 0;
      for (std::size_t m = 0; m < layers; ++m)
        if (m != l) exponent += m < l ? top(m, w) : bottom(m, w);
      factors[l][w] = std::exp(exponent);
    }
  return factors;
}

class Stack {
 public:
  explicit Stack(const Scene& slab) : slab_(slab), layers_(layers_of(slab)) {}

  const ScatteringLaw& narrowest() const {
    return *std::ranges::min_element(layers_, {}, [](const OneLayer& layer) {
              return layer.law->width();
            })->law;
  }
  int least_order() const {
    int order = 0;
    for (const OneLayer& layer : layers_) order = std::max(order, layer.law->least_order());
    return order;
  }

  /// Paths of one scattering, per entry.
  std::vector<Complex> once() const {
    std::vector<Complex> values;
    for (const auto& [lights, views, entry] : chains(slab_.request, false, 0)) {
      const auto part = [&](std::size_t layer, Pair pair) {
        const PairWave wave = pair_wave(layers_[layer].scene, pair, Departure<double>{});
        return std::pair(layers_[layer].depth() * wave.top, layers_[layer].depth() * wave.bottom);
      };
      const Pair ends[] = {lights, turned_round(views)};
      const auto factors = entering(
          layers_.size(), 2, [&](std::size_t l, std::size_t w) { return part(l, ends[w]).first; },
          [&](std::size_t l, std::size_t w) { return part(l, ends[w]).second; });
      Complex sum = 0;
      for (std::size_t l = 0; l < layers_.size(); ++l) {
        const OneLayer& layer = layers_[l];
        const DoubleScattering pair(layer.scene, 0, lights, views, {});
        sum += layer.scene.medium.albedo * factors[l][0] * factors[l][1] * pair.once() *
               layer.law->pair(lights.first - views.first, lights.second - views.second, 0);
      }
      values.push_back(sum);
    }
    return values;
  }

  /// What layers of one grid share.
  struct Discrete {
    AngularGrid grid;
    std::vector<std::unique_ptr<ScatteringMatrices>> matrices;
  };
  std::unique_ptr<Discrete> discrete(const std::vector<Focus>& foci, int order) const {
    auto made =
        std::make_unique<Discrete>(Discrete{AngularGrid(foci, order, narrowest().width()), {}});
    for (const OneLayer& layer : layers_)
      made->matrices.push_back(
          std::make_unique<ScatteringMatrices>(made->grid, *layer.law, layer.scene.medium.albedo));
    return made;
  }

  /// Paths of two scatterings and more, per link of the group.
  std::vector<Complex> solved(const ChainGroup& group, const Discrete& discrete) const {
    std::vector<Complex> values(group.links.size());
    for (const auto parity : ScatteringMatrices::parities(group.q)) {
      const Rows collected = stack_response(parts(group, discrete, parity));
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] += collected(group.links[i].view, group.links[i].light);
    }
    return values;
  }

 private:
  std::vector<StackedLayer> parts(const ChainGroup& group, const Discrete& discrete,
                                  Parity parity) const {
    std::vector<StackedLayer> parts;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      const Scene& scene = layers_[l].scene;
      const auto& matrices = *discrete.matrices[l];
      auto [lights, views] = matrices.ends(scene, group.lights, group.views, parity);
      parts.push_back({matrices.transport(group.q * slab_.medium.mu_t / scene.medium.mu_t, parity),
                       layers_[l].depth(),
                       std::move(lights),
                       std::move(views),
                       {},
                       {}});
    }
    const auto factors = [&](auto ends) {
      return entering(
          parts.size(), (parts.front().*ends).top.size(),
          [&](std::size_t l, std::size_t w) { return parts[l].depth * (parts[l].*ends).top[w]; },
          [&](std::size_t l, std::size_t w) {
            return parts[l].depth * (parts[l].*ends).bottom[w];
          });
    };
    const auto of_lights = factors(&StackedLayer::lights), of_views = factors(&StackedLayer::views);
    for (std::size_t l = 0; l < parts.size(); ++l) {
      parts[l].light_factors = of_lights[l];
      parts[l].view_factors = of_views[l];
    }
    return parts;
  }

  const Scene& slab_;
  std::vector<OneLayer> layers_;
};

class StackRefiner {
 public:
  StackRefiner(const Scene& slab, bool reversed, const Refinement& refinement)
      : request_(slab.request), refinement_(refinement), stack_(slab), once_(stack_.once()) {
    for (ChainGroup& group : grouped(slab, stack_.narrowest(), chains(request_, reversed, 0), 0))
      parts_.push_back({std::move(group), {}, {}, false, false});
  }

  Refined refined() {
    int order = std::max(refinement_.first_order(), stack_.least_order());
    step(order);
    while (step(order = Refinement::next_order(order))) settle();
    auto fine = sum(&Part::value);
    auto difference = fine;
    const auto coarse = sum(&Part::before);
    for (std::size_t e = 0; e < fine.size(); ++e) difference[e] -= coarse[e];
    return {fine, difference, ordinates_};
  }

 private:
  struct Part {
    ChainGroup group;
    std::vector<Complex> value, before;  ///< of the last two orders
    bool done = false, near = false;     ///< near: the last step came close to the tolerance
    int size = 0;
  };

  bool step(int order) {
    std::vector<Part*> open;
    std::map<std::vector<Focus>, std::unique_ptr<Stack::Discrete>> grids;
    for (Part& part : parts_) {
      if (part.done) continue;
      open.push_back(&part);
      auto& grid = grids[part.group.foci];
      if (!grid) grid = stack_.discrete(part.group.foci, order);
    }
    parallel_for(open.size(), [&](std::size_t i) {
      stop_if_interrupted();
      Part& part = *open[i];
      const auto& discrete = *grids.at(part.group.foci);
      part.before = std::exchange(part.value, stack_.solved(part.group, discrete));
      part.size = static_cast<int>(2 * discrete.grid.size());
    });
    for (const Part* part : open) ordinates_ = std::max(ordinates_, part->size);
    return !open.empty();
  }

  /// Parts whose last two orders agree twice, or that would become too large, are done.
  void settle() {
    const auto scale = scales(request_.entries, sum(&Part::value));
    for (Part& part : parts_) {
      double worst = 0;
      for (std::size_t i = 0; i < part.value.size(); ++i)
        if (const double size = scale[part.group.links[i].entry]; size > 0)
          worst = std::max(worst, std::abs(part.value[i] - part.before[i]) / size);
      mc::settle(part, worst, refinement_);
    }
  }

  std::vector<Complex> sum(std::vector<Complex> Part::*values) const {
    std::vector<Complex> entries = once_;
    for (const Part& part : parts_)
      for (std::size_t i = 0; i < part.group.links.size(); ++i)
        entries[part.group.links[i].entry] += (part.*values)[i];
    return entries;
  }

  const CovarianceRequest& request_;
  Refinement refinement_;
  Stack stack_;
  std::vector<Complex> once_;
  std::vector<Part> parts_;
  int ordinates_ = 0;
};

}  // namespace

Refined layered_covariance(const Scene& slab, bool reversed, const Refinement& refinement) {
  const std::size_t entries = slab.request.entries.size();
  if (slab.medium.mu_s == 0)
    return {std::vector<Complex>(entries), std::vector<Complex>(entries), 0};
  blas_single_thread();
  return StackRefiner(slab, reversed, refinement).refined();
}

FieldJob layered_covariance_job(const Scene& slab, bool reversed, const Refinement& refinement) {
  if (dynamic_cast<const Layers*>(slab.profile.get()) == nullptr)
    throw InputError("method", "transport", "of a medium that varies takes layers alone");
  if (has_near_ends(slab.request))
    throw InputError("layers: by transport take plane waves and far views");
  const auto solve = [=] {
    return refined_range(slab.request, refinement, [&](const Refinement& finer) {
      return layered_covariance(slab, reversed, finer);
    });
  };
  return two_batch_job(slab.request.entries.size(), 1, solve).field;
}

}  // namespace flatspeckle::mc
