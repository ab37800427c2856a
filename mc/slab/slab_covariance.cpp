#include "mc/slab/slab_covariance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/algebra/dual.h"
#include "core/numbers/blas.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "mc/slab/adding/angular_grid.h"
#include "mc/slab/adding/direction_modes.h"
#include "mc/slab/adding/plane.h"
#include "mc/slab/adding/slab.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/covariance_chains.h"
#include "mc/slab/near_endpoints.h"
#include "mc/slab/scene_slab.h"

namespace flatspeckle::mc {

namespace {

/// Contribution of each link of a ChainGroup, followed by their derivatives for Dual<double>.
struct Solution {
  std::vector<Complex> value;
  /// Number of unknowns: ordinates, downward and upward, times coupled azimuthal functions.
  int ordinates = 0;
};

double largest_change(const std::vector<Complex>& a, const std::vector<Complex>& b,
                      const std::vector<double>& scale) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (scale[i] > 0) largest = std::max(largest, std::abs(a[i] - b[i]) / scale[i]);
  return largest;
}

/// Refines each group of chains until it has converged.
template <typename Geometry, typename Number>
class CovarianceRefiner {
 public:
  using Slab = SlabOf<Geometry, Number>;
  using Request = RequestOf<typename Geometry::Direction>;
  using Group = ChainGroup<Geometry>;
  using Discrete = DiscreteSlabOf<Geometry, Number>;
  using C = ComplexOf<Number>;

  CovarianceRefiner(const Slab& slab, const Request& request, bool reversed,
                    const Refinement& refinement)
      : slab_(slab), request_(request), refinement_(refinement), few_(flat(scattered_once())) {
    Resolution first = refinement.fixed.value_or(
        Resolution{refinement.first_order(slab.has_faces()), Geometry::first_modes});
    first.order = std::max(first.order, slab.least_order());
    if (!Geometry::refines_modes) first.modes = Geometry::first_modes;
    for (Group& group : grouped(slab, chains(slab, request, reversed)))
      parts_.push_back({std::move(group), first, {}, {}, {}, {}});
  }

  Refined refined() {
    solve([this](Part& part) { part.coarse = solved(part.group, part.at); });
    for (Part& part : parts_) part.value = part.coarse.value;
    if (scatters_twice_apart()) add_double_scattering();
    if (refinement_.fixed)
      return {values(), std::vector<Complex>(few_.size()), ordinates_, *refinement_.fixed};
    refine_to_tolerance();
    constexpr double step = 4,
                     smallest = 1.0 / 256;  // factors by which the tolerance is decreased
    const double tolerance = refinement_.tolerance;
    Refined found = solution();
    while (refinement_.suffices && !refinement_.suffices(found) &&
           refinement_.tolerance > tolerance * smallest) {
      refinement_.tolerance /= step;
      settle();
      refine_to_tolerance();
      found = solution();
    }
    return found;
  }

 private:
  struct Part {
    Group group;
    Resolution at;
    /// Solutions with the resolutions `at`, at.finer_order() and at.finer_modes().
    Solution coarse, finer, wider;
    std::vector<Complex> value;
    Changes by_order{}, by_modes{};  ///< changes relative to the scales of the entries
    bool done = false;     ///< whether the part has converged or has reached the largest size
    bool moved = false;    ///< whether no solution at the resolution `at` exists yet
    double imbalance = 0;  ///< relative error of the power scattered to the ordinates (imbalance())
  };

  /// Whether paths with two scatterings are computed separately. This is possible in the plane, for
  /// a single layer.
  bool scatters_twice_apart() const {
    return Geometry::has_double_scattering && slab_.layers.size() == 1;
  }

  /// Returns the contribution of paths with one scattering to each entry.
  std::vector<C> scattered_once() const {
    std::vector<C> values;
    for (const auto& [lights, views, entry] : chains(slab_, request_, false)) {
      const PairInLayersOf<Geometry, Number> light(slab_, lights), view(slab_, turned_round(views));
      C value{};
      for (std::size_t l = 0; l < slab_.layers.size(); ++l) {
        const auto& layer = slab_.layers[l];
        const auto depth = slab_.optical_depth(layer);
        for (const auto& in : light.layers()[l])
          for (const auto& out : view.layers()[l])
            value += in.factor * out.factor *
                     (layer.albedo * depth *
                      divided_difference(C(depth * (in.wave.top + out.wave.top)),
                                         C(depth * (in.wave.bottom + out.wave.bottom))) *
                      as_complex(Geometry::turned(layer.law, in.pair, turned_round(out.pair))));
      }
      values.push_back(value);
    }
    return values;
  }

  Refined solution() const {
    Refined found{values(), errors(), ordinates_};
    for (const Part& part : parts_) {
      found.resolution.order = std::max(found.resolution.order, part.at.finer_order().order);
      found.resolution.modes = std::max(found.resolution.modes, part.at.finer_modes().modes);
    }
    return found;
  }

  void refine_to_tolerance() {
    while (std::ranges::any_of(parts_, [](const Part& part) { return !part.done; })) {
      solve([this](Part& part) { refine(part); });
      add_changes();
      settle();
    }
  }

  /// Calls solve_part for the parts that are not done. Parts with equal foci share one
  /// angular grid for each order, the number of nodes per panel.
  template <typename Solve>
  void solve(const Solve& solve_part) {
    std::vector<Part*> open;
    std::map<GridKey, std::unique_ptr<Discrete>> grids;
    for (Part& part : parts_) {
      if (part.done) continue;
      open.push_back(&part);
      for (const int order : {part.at.order, part.at.finer_order().order}) {
        if (refinement_.fixed && order != part.at.order) continue;
        auto& grid = grids[{part.group.foci, order}];
        if (!grid) grid = std::move(grids_[{part.group.foci, order}]);
        if (!grid) grid = std::make_unique<Discrete>(slab_, part.group.foci, order);
      }
    }
    grids_ = std::move(grids);
    parallel_for(open.size(), [&](std::size_t i) {
      stop_if_interrupted();
      solve_part(*open[i]);
    });
    for (const Part* part : open)
      for (const Solution* one : {&part->coarse, &part->finer, &part->wider})
        ordinates_ = std::max(ordinates_, one->ordinates);
  }

  void refine(Part& part) const {
    if (part.moved) part.coarse = solved(part.group, part.at);
    part.finer = solved(part.group, part.at.finer_order());
    part.value = part.finer.value;
    part.imbalance = imbalance(part.group, part.at.finer_order().order);
    if (!Geometry::refines_modes) return;
    part.wider = solved(part.group, part.at.finer_modes());
    for (std::size_t i = 0; i < part.value.size(); ++i)
      part.value[i] += part.wider.value[i] - part.coarse.value[i];
  }

  /// Returns the largest relative error of the power that an illumination, or a reversed view,
  /// scatters to all ordinates together, compared with the exact scattered power. It is evaluated
  /// only for laws with a sharp peak, which the ordinates may not resolve.
  double imbalance(const Group& group, int order) const {
    double worst = 0;
    const Discrete& discrete = *grids_.at({group.foci, order});
    for (std::size_t l = 0; l < slab_.layers.size(); ++l) {
      const auto& ordinates = discrete.layers()[l];
      if (!ordinates.law().has_sharp_peak()) continue;
      const double refraction = slab_.outside_index / slab_.layers[l].index;
      for (const auto* pairs : {&group.lights, &group.views})
        for (const auto& pair : *pairs) {
          const auto direction = refracted(pair.first, refraction);
          const auto fed = Geometry::template fed<Number>(ordinates, group.momentum, 0,
                                                          {{direction, direction}});
          const Rows both = value_of(fed.down) + value_of(fed.up);
          const double power =
              Geometry::all_directions() *
              (both.leftCols(ordinates.root().size()).real() * ordinates.root())(0);
          worst = std::max(worst, std::abs(power / value_of(ordinates.albedo()) - 1));
        }
    }
    return worst;
  }

  /// Returns the contribution of paths with two or more scatterings, or with three or more if paths
  /// with two scatterings are computed separately.
  Solution solved(const Group& group, Resolution at) const {
    const Discrete& discrete = *grids_.at({group.foci, at.order});
    const DirectionModesOf<Geometry, Number> modes(slab_, discrete, at.modes, group.momentum,
                                                   group.lights, group.views);
    std::vector<C> values(group.links.size());
    int ordinates = 0;
    for (const auto& part : modes.parts()) {
      const auto layers = modes.layers(part);
      if (layers.empty()) continue;
      ordinates = std::max(ordinates, Geometry::ordinates(part.functions.size()));
      const auto collected = response_of(layers, modes.faces(part)).collected;
      for (std::size_t i = 0; i < values.size(); ++i) {
        const auto& [light, view, own] = group.links[i];
        values[i] += entry(collected, view, light);
        if constexpr (Geometry::has_double_scattering)
          if (scatters_twice_apart())
            for (const auto& [paths, in, out, factor] : twice(group, i))
              values[i] +=
                  -(factor * Geometry::double_scattering(paths, discrete.grid(0), part.functions,
                                                         layers.front(), in, out));
      }
    }
    return {flat(values), ordinates * static_cast<int>(discrete.most_ordinates())};
  }

  /// Paths with two scatterings between one wave of a pair of illuminations and one wave of a pair
  /// of views: the indices of both waves (PairWavesOf), and the factor of their contribution.
  struct Twice {
    DoubleScatteringOf<Number> paths;
    Eigen::Index light, view;
    C factor;
  };
  /// Returns the paths of a link. With faces, the two waves of the views and the two of the
  /// illuminations form four combinations. Because a layer is symmetric, the two that are mirror
  /// images of each other contribute equally.
  std::vector<Twice> twice(const Group& group, std::size_t number) const {
    const auto& link = group.links[number];
    const auto& layer = slab_.layers.front();
    const PairInLayersOf<Geometry, Number> light(
        slab_, group.lights[static_cast<std::size_t>(link.light)]),
        view(slab_, turned_round(group.views[static_cast<std::size_t>(link.view)]));
    const auto &in = light.layers().front(), &out = view.layers().front();
    std::vector<Twice> all;
    for (std::size_t wave = 0; wave < in.size(); ++wave) {
      C factor = in[wave].factor * out[0].factor;
      if (in.size() == 2) factor += in[1 - wave].factor * out[1].factor;
      all.push_back({{slab_.optical_depth(layer),
                      layer.k / layer.mu_t,
                      group.momentum,
                      {in[wave].pair, in[wave].wave},
                      {turned_round(out[0].pair), out[0].wave},
                      slab_.departure},
                     link.light + static_cast<Eigen::Index>(wave) * std::ssize(group.lights),
                     link.view,
                     factor});
    }
    return all;
  }

  /// Adds the contribution of paths with two scatterings. A first solution must exist, because the
  /// tolerance is relative to the magnitude of the entries.
  void add_double_scattering() {
    if constexpr (Geometry::has_double_scattering) {
      constexpr double part_of_tolerance = 0.01;
      const auto scale = scales_with_derivatives(request_.entries, sum(&Part::value));
      const auto& layer = slab_.layers.front();
      const auto scattered_twice = layer.albedo * layer.albedo;
      const double tolerance =
          part_of_tolerance * refinement_.tolerance / std::abs(value_of(scattered_twice));
      std::vector<std::vector<C>> found(parts_.size());
      parallel_for(parts_.size(), [&](std::size_t p) {
        stop_if_interrupted();
        const Group& group = parts_[p].group;
        for (std::size_t i = 0; i < group.links.size(); ++i) {
          C sum{};
          for (const auto& [paths, in, out, factor] : twice(group, i))
            sum += factor * paths.total(layer.law, tolerance * scale[group.links[i].entry] /
                                                       std::max(1e-12, std::abs(value_of(factor))));
          found[p].push_back(scattered_twice * sum);
        }
      });
      for (std::size_t p = 0; p < parts_.size(); ++p) add(few_, parts_[p].group, flat(found[p]));
    }
  }

  /// Records the changes of the parts that were refined last.
  void add_changes() {
    const auto of_entries = scales_with_derivatives(request_.entries, sum(&Part::value));
    for (Part& part : parts_) {
      if (part.done) continue;
      std::vector<double> scale;
      for (std::size_t i = 0; i < part.value.size(); ++i)
        scale.push_back(of_entries[entry_of(part.group, i)]);
      part.by_order.add(largest_change(part.finer.value, part.coarse.value, scale));
      part.by_modes.add(
          Geometry::refines_modes ? largest_change(part.wider.value, part.coarse.value, scale) : 0);
    }
  }

  /// Marks a part as done if its last changes are at most half the tolerance and the previous ones
  /// were small too, because one small change may be accidental; or if the next solution would be
  /// too large. Chooses the next resolution of the other parts.
  void settle() {
    const double tolerance = refinement_.tolerance / 2;
    const auto small = [&](const Changes& changes) { return changes.last <= tolerance; };
    const auto confirmed = [&](const Changes& changes) {
      return changes.before <= 100 * tolerance;
    };
    for (Part& part : parts_) {
      const bool all_small = small(part.by_order) && small(part.by_modes);
      const auto open = [&](const Changes& changes) {
        return all_small ? !confirmed(changes) : !small(changes);
      };
      const bool refine_order = open(part.by_order),
                 refine_modes = Geometry::refines_modes && open(part.by_modes);
      const int size = std::max(part.finer.ordinates, part.wider.ordinates);
      part.done = !(refine_order || refine_modes) || 4 * size > 3 * refinement_.most_ordinates;
      if (!part.done) move(part, refine_order, refine_modes);
    }
  }

  static void move(Part& part, bool refine_order, bool refine_modes) {
    if (refine_order) part.at = part.at.finer_order();
    if (refine_modes) part.at = part.at.finer_modes();
    part.moved = refine_order && refine_modes;
    if (!part.moved) part.coarse = refine_order ? part.finer : part.wider;
  }

  /// Adds the contribution of each link of a group to the entry that the link refers to.
  void add(std::vector<Complex>& entries, const Group& group,
           const std::vector<Complex>& values) const {
    for (std::size_t i = 0; i < values.size(); ++i) entries[entry_of(group, i)] += values[i];
  }

  std::size_t entry_of(const Group& group, std::size_t i) const {
    const std::size_t links = group.links.size();
    return i / links * request_.entries.size() + group.links[i % links].entry;
  }

  std::vector<Complex> sum(std::vector<Complex> Part::*values) const {
    std::vector<Complex> entries = few_;
    for (const Part& part : parts_) add(entries, part.group, part.*values);
    return entries;
  }

  const Entry& entry_at(std::size_t i) const {
    return request_.entries[i % request_.entries.size()];
  }

  /// Returns the values of the entries. Intensities at one wavelength are real; their imaginary
  /// parts, which are within the errors, are removed.
  std::vector<Complex> values() const {
    auto all = sum(&Part::value);
    for (std::size_t i = 0; i < all.size(); ++i)
      if (slab_.departure.shift == 0 && entry_at(i).a == entry_at(i).b) all[i] = all[i].real();
    return all;
  }

  /// Returns the errors of the entries: the last change and, for phase functions with a sharp peak,
  /// the effect of imbalance(). No error is smaller than half the tolerance, because a small change
  /// may be accidental.
  std::vector<Complex> errors() const {
    const auto fine = sum(&Part::value);
    auto coarse = few_;
    double lost = 0;
    for (const Part& part : parts_) {
      add(coarse, part.group, part.coarse.value);
      lost = std::max(lost, part.imbalance);
    }
    const auto scale = scales_with_derivatives(request_.entries, fine);
    std::vector<Complex> all;
    for (std::size_t i = 0; i < fine.size(); ++i) {
      const double size = std::max(std::abs(fine[i] - coarse[i]) + lost * scale[i],
                                   refinement_.tolerance / 2 * scale[i]);
      all.push_back(error_of(entry_at(i), fine[i], size));
    }
    return all;
  }

  using GridKey = std::pair<std::vector<Focus>, int>;

  const Slab& slab_;
  const Request& request_;
  Refinement refinement_;
  /// Contribution of paths with one scattering, and of those with two if these are computed
  /// separately.
  std::vector<Complex> few_;
  std::vector<Part> parts_;
  std::map<GridKey, std::unique_ptr<Discrete>> grids_;
  int ordinates_ = 0;
};

template <typename Geometry>
Refined changed_covariance(const Scene& scene, bool reversed, const Refinement& refinement,
                           const FieldChange& change) {
  const auto slab = slab_of<Geometry>(scene, change.delay);
  const auto request = directions_of<Geometry>(scene.request);
  if (change.shift == 0) return slab_covariance(slab, request, reversed, refinement);
  const SlabOf<Geometry, Complex> shifted{slab.k,           slab.mu_t,         slab.depth,
                                          slab.layers,      {1, change.shift}, slab.outside_index,
                                          slab.polarisation};
  return slab_covariance(shifted, request, reversed, refinement);
}

template <typename Geometry>
Refined changing_covariance(const Scene& scene, bool reversed, const Refinement& refinement,
                            BulkParameter parameter) {
  const auto slab = slab_of<Geometry>(scene);
  const auto& layer = slab.layers.front();
  const auto derivative = bulk_derivative<Geometry>(scene, layer.law, parameter);
  const SlabOf<Geometry, Dual<double>> changing{slab.k,
                                                slab.mu_t,
                                                slab.depth,
                                                {{layer.mu_t,
                                                  layer.depth,
                                                  {layer.albedo, derivative.albedo},
                                                  derivative.law,
                                                  layer.k,
                                                  layer.index}},
                                                {{1, -derivative.log_mu_t}},
                                                slab.outside_index,
                                                slab.polarisation};
  return by_parameter(
      slab_covariance(changing, directions_of<Geometry>(scene.request), reversed, refinement),
      derivative.unit);
}

}  // namespace

template <typename Geometry, typename Number>
Refined slab_covariance(const SlabOf<Geometry, Number>& slab,
                        const RequestOf<typename Geometry::Direction>& request, bool reversed,
                        const Refinement& refinement) {
  blas_single_thread();
  return CovarianceRefiner<Geometry, Number>(slab, request, reversed, refinement).refined();
}

Refined slab_covariance(const Scene& scene, bool reversed, const Refinement& refinement,
                        const FieldChange& change) {
  const std::size_t entries = scene.request.entries.size();
  if (scene.medium.mu_s == 0)
    return {std::vector<Complex>(entries), std::vector<Complex>(entries), 0};
  if (has_near_endpoints(scene.request))
    return near_endpoint_covariance(scene, refinement, [&](const Scene& of_plane_waves) {
      return slab_covariance(of_plane_waves, reversed, refinement, change);
    });
  const auto covariance = scene.medium.dimension == 3 ? changed_covariance<SpaceGeometry>
                                                      : changed_covariance<PlaneGeometry>;
  return covariance(scene, reversed, refinement, change);
}

Refined slab_derivatives(const Scene& scene, bool reversed, const Refinement& refinement,
                         BulkParameter parameter) {
  const auto derivatives = scene.medium.dimension == 3 ? changing_covariance<SpaceGeometry>
                                                       : changing_covariance<PlaneGeometry>;
  return derivatives(scene, reversed, refinement, parameter);
}

template Refined slab_covariance(const SlabOf<PlaneGeometry, double>&, const RequestOf<double>&,
                                 bool, const Refinement&);
template Refined slab_covariance(const SlabOf<SpaceGeometry, double>&,
                                 const RequestOf<Eigen::Vector3d>&, bool, const Refinement&);
template Refined slab_covariance(const SlabOf<SpaceGeometry, Complex>&,
                                 const RequestOf<Eigen::Vector3d>&, bool, const Refinement&);

}  // namespace flatspeckle::mc
