#include "mc/slab/slab_covariance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "core/numbers/blas.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "mc/slab/finite_ends.h"
#include "mc/slab/range_refinement.h"
#include "mc/slab/transport_jobs.h"
#include "mc/transport/chains.h"
#include "mc/transport/scattering_matrices.h"

namespace flatspeckle::mc {

namespace {

/// A slab, and for Dual<double> what it is differentiated by.
template <typename Number>
struct Slab {
  const Scene& scene;
  const ScatteringLaw& resolved;  ///< what grids are made for
  const LawOf<Number>& law;
  RealOf<Number> albedo;
  Departure<Number> departure{};

  RealOf<Number> optical_depth() const {
    return scene.medium.mu_t * scene.domain.depth / departure.length;
  }
  DoubleScatteringOf<Number> twice(const ChainGroup& group, const ChainGroup::Link& link) const {
    return {scene, group.q, group.lights[static_cast<std::size_t>(link.light)],
            group.views[static_cast<std::size_t>(link.view)], departure};
  }
};

/// What groups of one grid share.
template <typename Number>
struct Discrete {
  AngularGrid grid;
  ScatteringMatricesOf<Number> matrices;

  Discrete(const std::vector<Focus>& foci, int order, const Slab<Number>& slab)
      : grid(foci, order, slab.resolved.width()),
        matrices(grid, slab.law, slab.albedo,
                 slab.departure.extinction(slab.scene.k / slab.scene.medium.mu_t), slab.departure) {
  }
  Discrete(const Discrete&) = delete;
};

/// Paths of one scattering, per entry.
template <typename Number>
std::vector<ComplexOf<Number>> scattered_once(const Slab<Number>& slab) {
  std::vector<ComplexOf<Number>> values;
  for (const auto& [lights, views, entry] :
       chains(slab.scene.request, false, slab.departure.shift)) {
    const DoubleScatteringOf<Number> pair(slab.scene, 0, lights, views, slab.departure);
    values.push_back(slab.albedo * (pair.once() * slab.law.pair(lights.first - views.first,
                                                                lights.second - views.second, 0)));
  }
  return values;
}

/// Paths of three scatterings and more, per link of the group.
template <typename Number>
std::vector<Complex> solved(const Slab<Number>& slab, const ChainGroup& group,
                            const ScatteringMatricesOf<Number>& matrices) {
  std::vector<ComplexOf<Number>> values(group.links.size());
  for (const auto parity : matrices.parities(group.q)) {
    const auto [lights, views] = matrices.ends(slab.scene, group.lights, group.views, parity);
    const auto response =
        layer_response(matrices.transport(group.q, parity), slab.optical_depth(), lights, views);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& link = group.links[i];
      values[i] += entry(response.collected, link.view, link.light) -
                   matrices.double_scattering(slab.twice(group, link), lights, link.light, views,
                                              link.view, parity);
    }
  }
  return flat(values);
}

/// Per entry or link: values, and for Dual<double> then derivatives.
template <typename Number>
class Refiner {
 public:
  Refiner(const Slab<Number>& slab, bool reversed, const Refinement& refinement)
      : slab_(slab),
        request_(slab.scene.request),
        refinement_(refinement),
        few_(flat(scattered_once(slab))) {
    for (ChainGroup& group :
         grouped(slab.scene, slab.resolved, chains(request_, reversed, slab.departure.shift),
                 slab.departure.shift))
      parts_.push_back({std::move(group), {}, {}, 0, false, false});
  }

  Refined refined() {
    int order = std::max(refinement_.first_order(), slab_.resolved.least_order());
    step(order);
    add_double_scattering();
    if (refinement_.most_ordinates == 0)
      return {sum(&Part::value), std::vector<Complex>(few_.size()), ordinates_};
    while (step(order = Refinement::next_order(order))) settle();
    return {sum(&Part::value), difference(), ordinates_};
  }

 private:
  struct Part {
    ChainGroup group;
    std::vector<Complex> value, before;  ///< of the last two orders
    int size = 0;
    bool done = false, near = false;  ///< near: the last step came close to the tolerance
  };

  /// Solves what is not done with more ordinates; false if that is nothing.
  bool step(int order) {
    std::vector<Part*> open;
    std::map<std::vector<Focus>, std::unique_ptr<Discrete<Number>>> grids;
    for (Part& part : parts_) {
      if (part.done) continue;
      open.push_back(&part);
      auto& grid = grids[part.group.foci];
      if (!grid) grid = std::make_unique<Discrete<Number>>(part.group.foci, order, slab_);
    }
    parallel_for(open.size(), [&](std::size_t i) {
      stop_if_interrupted();
      Part& part = *open[i];
      const auto& discrete = *grids.at(part.group.foci);
      part.before = std::exchange(part.value, solved(slab_, part.group, discrete.matrices));
      part.size = static_cast<int>(2 * discrete.grid.size());
    });
    for (const Part* part : open) ordinates_ = std::max(ordinates_, part->size);
    return !open.empty();
  }

  /// Once how large the entries are is known.
  void add_double_scattering() {
    constexpr double part_of_tolerance = 0.01;
    const auto scale = scales_with_slopes(request_.entries, sum(&Part::value));
    const auto scattered_twice = slab_.albedo * slab_.albedo;
    const double tolerance =
        part_of_tolerance * refinement_.tolerance / std::abs(value_of(scattered_twice));
    std::vector<std::vector<ComplexOf<Number>>> found(parts_.size());
    parallel_for(parts_.size(), [&](std::size_t p) {
      stop_if_interrupted();
      for (const auto& link : parts_[p].group.links)
        found[p].push_back(
            scattered_twice *
            slab_.twice(parts_[p].group, link).total(slab_.law, tolerance * scale[link.entry]));
    });
    for (std::size_t p = 0; p < parts_.size(); ++p) add(few_, parts_[p].group, flat(found[p]));
  }

  /// To entries what their links give.
  void add(std::vector<Complex>& entries, const ChainGroup& group,
           const std::vector<Complex>& values) const {
    for (std::size_t i = 0; i < values.size(); ++i) entries[entry_of(group, i)] += values[i];
  }

  std::size_t entry_of(const ChainGroup& group, std::size_t i) const {
    const std::size_t links = group.links.size();
    return i / links * request_.entries.size() + group.links[i % links].entry;
  }

  /// Parts whose last two orders agree, or that would become too large, are done.
  void settle() {
    const auto scale = scales_with_slopes(request_.entries, sum(&Part::value));
    for (Part& part : parts_) {
      double worst = 0;
      for (std::size_t i = 0; i < part.value.size(); ++i)
        if (const double size = scale[entry_of(part.group, i)]; size > 0)
          worst = std::max(worst, std::abs(part.value[i] - part.before[i]) / size);
      mc::settle(part, worst, refinement_);
    }
  }

  std::vector<Complex> sum(std::vector<Complex> Part::*values) const {
    std::vector<Complex> entries = few_;
    for (const Part& part : parts_) add(entries, part.group, part.*values);
    return entries;
  }

  std::vector<Complex> difference() const {
    auto fine = sum(&Part::value);
    const auto coarse = sum(&Part::before);
    for (std::size_t e = 0; e < fine.size(); ++e) fine[e] -= coarse[e];
    return fine;
  }

  const Slab<Number>& slab_;
  const CovarianceRequest& request_;
  Refinement refinement_;
  std::vector<Complex> few_;  ///< paths of one scattering and of two
  std::vector<Part> parts_;
  int ordinates_ = 0;
};

}  // namespace

Refined slab_covariance(const Scene& slab, bool reversed, const Refinement& refinement,
                        const FieldChange& change) {
  const std::size_t entries = slab.request.entries.size();
  if (slab.medium.mu_s == 0)
    return {std::vector<Complex>(entries), std::vector<Complex>(entries), 0};
  if (has_near_ends(slab.request))
    return finite_ends_covariance(slab, refinement, [&](const Scene& of_plane_waves) {
      return slab_covariance(of_plane_waves, reversed, refinement, change);
    });
  blas_single_thread();
  const ScatteringLaw law(slab, change.delay);
  const double albedo = slab.medium.albedo;
  if (change.shift == 0)
    return Refiner<double>({slab, law, law, albedo}, reversed, refinement).refined();
  return Refiner<Complex>({slab, law, law, albedo, {1, change.shift}}, reversed, refinement)
      .refined();
}

Refined slab_slopes(const Scene& slab, bool reversed, const Refinement& refinement,
                    BulkParameter parameter) {
  blas_single_thread();
  const ScatteringLaw law(slab);
  const BulkSlope slope = bulk_slope(slab, law, parameter);
  return by_parameter(
      Refiner<Dual<double>>(
          {slab, law, slope.law, {slab.medium.albedo, slope.albedo}, {{1, -slope.log_mu_t}}},
          reversed, refinement)
          .refined(),
      slope.unit);
}

FieldJob slab_covariance_job(const Scene& slab, bool reversed, const Refinement& refinement) {
  const auto solve = [=] {
    return refined_range(slab.request, refinement, [&](const Refinement& finer) {
      return slab_covariance(slab, reversed, finer);
    });
  };
  return two_batch_job(slab.request.entries.size(), 1, solve).field;
}

PathJob slab_change_job(const Scene& slab, bool reversed, const Refinement& refinement,
                        const std::vector<FieldChange>& changes) {
  return change_job(slab.request.entries.size(), changes, [=](const FieldChange& change) {
    return slab_covariance(slab, reversed, refinement, change);
  });
}

GradientJob slab_gradient_job(const Scene& slab, bool reversed, const Refinement& refinement) {
  return slope_job(slab, [=](BulkParameter parameter) {
    return slab_slopes(slab, reversed, refinement, parameter);
  });
}

}  // namespace flatspeckle::mc
