#include "mc/transport/slab_covariance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "core/numbers/blas.h"
#include "core/run/parallel.h"
#include "mc/estimators/single_scattering.h"
#include "mc/transport/chains.h"
#include "mc/transport/scattering_matrices.h"

namespace flatspeckle::mc {

namespace {

/// A scattering law as single_scattering() takes it.
struct Amplitudes {
  const ScatteringLaw& law;
  Complex amplitude(Vec2 from, Vec2 to) const {
    return law.amplitude(angle_of(to) - angle_of(from));
  }
};

/// What groups of one grid share.
struct Discrete {
  AngularGrid grid;
  ScatteringMatrices matrices;

  Discrete(const std::vector<Focus>& foci, int order, const ScatteringLaw& law, double albedo)
      : grid(foci, order, law.width()), matrices(grid, law, albedo) {}
  Discrete(const Discrete&) = delete;
};

DoubleScattering twice(const Scene& scene, const ChainGroup& group, const ChainGroup::Link& link) {
  return {scene, group.q, group.lights[static_cast<std::size_t>(link.light)],
          group.views[static_cast<std::size_t>(link.view)]};
}

/// Paths of three scatterings and more, one value per link of the group.
std::vector<Complex> solved(const Scene& scene, const ChainGroup& group,
                            const ScatteringMatrices& matrices) {
  const double optical_depth = scene.medium.mu_t * scene.domain.depth;
  std::vector<Complex> values(group.links.size());
  for (const auto parity : ScatteringMatrices::parities(group.q)) {
    const auto lights = matrices.lights(scene, group.lights, parity),
               views = matrices.views(scene, group.views, parity);
    const auto response =
        layer_response(matrices.transport(group.q, parity), optical_depth, lights, views);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& link = group.links[i];
      values[i] += response.collected(link.view, link.light) -
                   matrices.double_scattering(twice(scene, group, link), lights, link.light, views,
                                              link.view, parity);
    }
  }
  return values;
}

class Refiner {
 public:
  Refiner(const Scene& scene, bool reversed, const Refinement& refinement, double delay)
      : scene_(scene),
        refinement_(refinement),
        law_(scene, delay),
        few_(single_scattering(scene, Amplitudes{law_})) {
    for (std::size_t e = 0; e < few_.size(); ++e) {
      const auto [light, view] = scene.request.channels[scene.request.entries[e].b];
      few_[e] *= law_.decay(scene.request.views[view].angle - scene.request.lights[light].angle);
    }
    for (ChainGroup& group : grouped(scene, law_, chains(scene.request, reversed)))
      parts_.push_back({std::move(group), {}, {}, 0, false, false});
  }

  Refined refined() {
    int order = std::max(refinement_.first_order, law_.least_order());
    step(order);
    add_double_scattering();
    while (step(order = Refinement::next_order(order))) settle();
    return {sum(&Part::value), difference(), ordinates_};
  }

 private:
  struct Part {
    ChainGroup group;
    std::vector<Complex> value, before;  ///< per link, of the last two orders
    int size = 0;
    bool done = false, near = false;  ///< near: the last step came close to the tolerance
  };

  /// Solves what is not done with more ordinates; false if that is nothing.
  bool step(int order) {
    std::vector<Part*> open;
    std::map<std::vector<Focus>, std::unique_ptr<Discrete>> grids;
    for (Part& part : parts_) {
      if (part.done) continue;
      open.push_back(&part);
      auto& grid = grids[part.group.foci];
      if (!grid)
        grid = std::make_unique<Discrete>(part.group.foci, order, law_, scene_.medium.albedo);
    }
    parallel_for(open.size(), [&](std::size_t i) {
      Part& part = *open[i];
      const Discrete& discrete = *grids.at(part.group.foci);
      part.before = std::exchange(part.value, solved(scene_, part.group, discrete.matrices));
      part.size = static_cast<int>(2 * discrete.grid.size());
    });
    for (const Part* part : open) ordinates_ = std::max(ordinates_, part->size);
    return !open.empty();
  }

  /// Once how large the entries are is known.
  void add_double_scattering() {
    constexpr double part_of_tolerance = 0.01;
    const auto scale = scales(scene_.request.entries, sum(&Part::value));
    std::vector<std::vector<Complex>> found(parts_.size());
    parallel_for(parts_.size(), [&](std::size_t p) {
      for (const auto& link : parts_[p].group.links)
        found[p].push_back(
            twice(scene_, parts_[p].group, link)
                .total(law_, part_of_tolerance * refinement_.tolerance * scale[link.entry]));
    });
    const double albedo = scene_.medium.albedo;
    for (std::size_t p = 0; p < parts_.size(); ++p)
      for (std::size_t i = 0; i < found[p].size(); ++i)
        few_[parts_[p].group.links[i].entry] += albedo * albedo * found[p][i];
  }

  /// Parts whose last two orders agree, or that would become too large, are done.
  void settle() {
    const auto scale = scales(scene_.request.entries, sum(&Part::value));
    for (Part& part : parts_) {
      double worst = 0;
      for (std::size_t i = 0; i < part.value.size(); ++i)
        if (const double size = scale[part.group.links[i].entry]; size > 0)
          worst = std::max(worst, std::abs(part.value[i] - part.before[i]) / size);
      // One small difference may be chance: the one before must have been small too.
      const double tolerance = refinement_.tolerance / 2;
      part.done =
          (worst <= tolerance && part.near) || 4 * part.size > 3 * refinement_.most_ordinates;
      part.near = worst <= 100 * tolerance;
    }
  }

  std::vector<Complex> sum(std::vector<Complex> Part::*values) const {
    std::vector<Complex> entries = few_;
    for (const Part& part : parts_)
      for (std::size_t i = 0; i < part.group.links.size(); ++i)
        entries[part.group.links[i].entry] += (part.*values)[i];
    return entries;
  }

  std::vector<Complex> difference() const {
    auto fine = sum(&Part::value);
    const auto coarse = sum(&Part::before);
    for (std::size_t e = 0; e < fine.size(); ++e) fine[e] -= coarse[e];
    return fine;
  }

  const Scene& scene_;
  Refinement refinement_;
  ScatteringLaw law_;
  std::vector<Complex> few_;  ///< paths of one scattering and of two
  std::vector<Part> parts_;
  int ordinates_ = 0;
};

}  // namespace

Refined slab_covariance(const Scene& slab, bool reversed, const Refinement& refinement,
                        double delay) {
  const std::size_t entries = slab.request.entries.size();
  if (slab.medium.mu_s == 0)
    return {std::vector<Complex>(entries), std::vector<Complex>(entries), 0};
  blas_single_thread();
  return Refiner(slab, reversed, refinement, delay).refined();
}

FieldJob slab_covariance_job(const Scene& slab, bool reversed, const Refinement& refinement) {
  FieldJob job;
  job.covariance = sample_mean;
  job.batches = two_batches(slab.request.entries.size(),
                            [=] { return slab_covariance(slab, reversed, refinement); });
  return job;
}

}  // namespace flatspeckle::mc
