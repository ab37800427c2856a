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
#include "mc/slab/layer_stack.h"
#include "mc/slab/range_refinement.h"
#include "mc/slab/transport_jobs.h"
#include "mc/transport/chains.h"
#include "mc/transport/double_scattering.h"
#include "mc/transport/scattering_matrices.h"

namespace flatspeckle::mc {

namespace {

class Stack {
 public:
  Stack(const Scene& slab, double delay) : slab_(slab), layers_(layers_of(slab, delay)) {}

  const ScatteringLaw& narrowest() const { return narrowest_law(layers_); }
  int least_order() const { return mc::least_order(layers_); }

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
    LayerMatrices matrices;
  };
  std::unique_ptr<Discrete> discrete(const std::vector<Focus>& foci, int order) const {
    auto made =
        std::make_unique<Discrete>(Discrete{AngularGrid(foci, order, narrowest().width()), {}});
    made->matrices = layer_matrices(layers_, made->grid);
    return made;
  }

  /// Paths of two scatterings and more, per link of the group.
  std::vector<Complex> solved(const ChainGroup& group, const Discrete& discrete) const {
    std::vector<Complex> values(group.links.size());
    for (const auto parity : ScatteringMatrices::parities(group.q)) {
      const Rows collected =
          stack_response(stacked(layers_, discrete.matrices, group.q * slab_.medium.mu_t,
                                 group.lights, group.views, parity))
              .collected;
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] += collected(group.links[i].view, group.links[i].light);
    }
    return values;
  }

 private:
  const Scene& slab_;
  std::vector<OneLayer> layers_;
};

class StackRefiner {
 public:
  StackRefiner(const Scene& slab, bool reversed, const Refinement& refinement, double delay)
      : request_(slab.request), refinement_(refinement), stack_(slab, delay), once_(stack_.once()) {
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

Refined layered_covariance(const Scene& slab, bool reversed, const Refinement& refinement,
                           double delay) {
  const std::size_t entries = slab.request.entries.size();
  if (slab.medium.mu_s == 0)
    return {std::vector<Complex>(entries), std::vector<Complex>(entries), 0};
  blas_single_thread();
  return StackRefiner(slab, reversed, refinement, delay).refined();
}

namespace {

void require_layers(const Scene& slab) {
  if (dynamic_cast<const Layers*>(slab.profile.get()) == nullptr)
    throw InputError("method", "transport", "of a medium that varies takes layers alone");
  if (has_near_ends(slab.request))
    throw InputError("layers: by transport take plane waves and far views");
}

}  // namespace

FieldJob layered_covariance_job(const Scene& slab, bool reversed, const Refinement& refinement) {
  require_layers(slab);
  const auto solve = [=] {
    return refined_range(slab.request, refinement, [&](const Refinement& finer) {
      return layered_covariance(slab, reversed, finer);
    });
  };
  return two_batch_job(slab.request.entries.size(), 1, solve).field;
}

PathJob layered_change_job(const Scene& slab, bool reversed, const Refinement& refinement,
                           const std::vector<FieldChange>& changes) {
  require_layers(slab);
  return change_job(slab.request.entries.size(), changes, [=](const FieldChange& change) {
    return layered_covariance(slab, reversed, refinement, change.delay);
  });
}

}  // namespace flatspeckle::mc
