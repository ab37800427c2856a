#include "mc/slab/slab_flux.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "core/numbers/blas.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/adding/direction_modes.h"
#include "mc/slab/adding/plane.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// Returns 1 if a direction lies in an interval, 0 if not, and one half if it is an end of the
/// interval.
double share_between(double light, double from, double to) {
  constexpr double rounding = 1e-12;
  if (std::abs(light - from) < rounding || std::abs(light - to) < rounding) return 0.5;
  return from < light && light < to ? 1 : 0;
}

/// Light that leaves a slab in the plane through each face, at the ordinates. `right` contains the
/// directions with positive sine, `left` their mirror images about z.
class PlaneExits {
 public:
  using Discrete = DiscreteSlabOf<PlaneGeometry, double>;
  static constexpr double first_angle = -pi, angles = 2 * pi;

  PlaneExits(const Discrete& discrete, double light)
      : grid_(discrete.grid()), light_(light), reflected_(grid_.size()), transmitted_(reflected_) {}

  /// Sets the share of the power that leaves in the beam, in the direction of the illumination.
  void add_straight(double share) { straight_ = share; }
  /// Adds the leaving light that is an even (function 0) or an odd (function 1) function of the
  /// angle.
  void add(int function, const LayerResponseOf<double>& leaving) {
    reflected_.add(function, leaving.up);
    transmitted_.add(function, leaving.down);
  }
  double reflected() const { return within(-pi, -pi / 2) + within(pi / 2, pi); }
  double transmitted() const { return within(-pi / 2, pi / 2); }
  /// Returns the share of the incident power that leaves between two exit angles, -pi <= from < to
  /// <= pi. It is the sum over the four quadrants.
  double within(double from, double to) const {
    return quadrant(transmitted_.right, from, to) + quadrant(transmitted_.left, -to, -from) +
           quadrant(reflected_.right, pi - to, pi - from) +
           quadrant(reflected_.left, from + pi, to + pi) +
           straight_ * share_between(light_, from, to);
  }

 private:
  struct Face {
    Eigen::VectorXd right, left;
    explicit Face(Eigen::Index n) : right(Eigen::VectorXd::Zero(n)), left(right) {}

    void add(int function, const Rows& leaving) {
      const auto power = function == 0 ? Eigen::VectorXd(leaving.row(0).real())
                                       : Eigen::VectorXd(leaving.row(0).imag());
      right += power;
      left += function == 0 ? power : -power;
    }
  };

  double quadrant(const Eigen::VectorXd& exit, double from, double to) const {
    const Eigen::VectorXd integrals = grid_.interval_integrals(from, to);
    double sum = 0;
    for (Eigen::Index j = 0; j < exit.size(); ++j)
      sum += integrals[j] *
             (std::sqrt(grid_.cosine()[j] / (2 * grid_.weight()[j])) / std::cos(light_) * exit[j]);
    return sum;
  }

  const AngularGrid& grid_;
  double light_, straight_ = 0;
  Face reflected_, transmitted_;
};

/// Returns the scalar product. Eigen's own causes gcc 12 to print warnings about the AVX-512
/// header.
double sum_of_products(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Light that leaves a slab in space. The vectors power_ and per_radian_ convert the unknowns at
/// the ordinates to shares of the incident power, in total and per radian of the polar angle.
class SpaceExits {
 public:
  using Discrete = DiscreteSlabOf<SpaceGeometry, double>;
  static constexpr double first_angle = 0, angles = pi;

  SpaceExits(const Discrete& discrete, double light)
      : grid_(discrete.grid()),
        light_(std::abs(light)),
        power_(std::sqrt(2 * pi) * discrete.root() / std::cos(light)),
        per_radian_(power_.array() * grid_.angle().array().sin() * grid_.cosine().array() /
                    discrete.root().array().square()) {}

  /// Sets the share of the power that leaves in the beam, in the direction of the illumination.
  void add_straight(double share) { straight_ = share; }
  void add(int, const LayerResponseOf<double>& leaving) {
    up_ = leaving.up.row(0).real();
    down_ = leaving.down.row(0).real();
  }
  double reflected() const { return sum_of_products(up_, power_); }
  double transmitted() const { return sum_of_products(down_, power_) + straight_; }
  /// Returns the share of the incident power that leaves between two exit angles, 0 <= from < to <=
  /// pi.
  double within(double from, double to) const {
    const auto radiance = [this](const Eigen::VectorXd& exit) -> Eigen::VectorXd {
      return exit.cwiseProduct(per_radian_);
    };
    // Light along the z axis is counted as a whole in the interval that begins at 0, because polar
    // angles are not negative.
    const double along = light_ == 0 ? (from == 0 ? 1 : 0) : share_between(light_, from, to);
    return sum_of_products(grid_.interval_integrals(from, to), radiance(down_)) +
           sum_of_products(grid_.interval_integrals(pi - to, pi - from), radiance(up_)) +
           straight_ * along;
  }

 private:
  const AngularGrid& grid_;
  double light_, straight_ = 0;
  Eigen::VectorXd power_, per_radian_, up_, down_;
};

/// A beam that has crossed the layers. Light that is scattered into the forward peak of a phase
/// function remains in the beam.
struct UnscatteredLight {
  /// Fractions of the incident power: in the beam; not scattered at all; absorbed.
  double transmitted = 1, unscattered = 1, absorbed = 0;
  double thickness = 0;  ///< optical depth of the layers, without the scattering into forward peaks
};

template <typename Geometry>
UnscatteredLight through_layers(const SlabOf<Geometry, double>& slab, double light) {
  UnscatteredLight beam;
  for (const auto& layer : slab.layers) {
    const double path = slab.optical_depth(layer) / std::cos(light),
                 turned = 1 - layer.albedo * layer.law.peak();
    beam.absorbed -= beam.transmitted * std::expm1(-path * turned) * (1 - layer.albedo) / turned;
    beam.transmitted *= std::exp(-path * turned);
    beam.thickness += slab.optical_depth(layer) * turned;
    beam.unscattered *= std::exp(-path);
  }
  return beam;
}

/// Returns, for each layer, the radiance that the first scattering of the beam adds, and a view
/// whose signal is the absorbed power.
template <typename Geometry>
std::vector<EndpointWavesOf<double>> flux_endpoints(
    const SlabOf<Geometry, double>& slab, const DiscreteSlabOf<Geometry, double>& discrete,
    double light) {
  const Eigen::Index n = discrete.grid().size(), functions = Geometry::flux_modes + 1;
  std::vector<EndpointWavesOf<double>> endpoints;
  for (std::size_t l = 0; l < slab.layers.size(); ++l) {
    const auto& ordinates = discrete.layers()[l];
    const double extinction = 1 - ordinates.peak_scattering();
    const Eigen::VectorXd lost = (1 - ordinates.albedo()) * ordinates.all_directions();
    Rows down(1, functions * n), up = down, absorbed = Rows::Zero(1, functions * n);
    for (int m = 0; m < functions; ++m) {
      const auto [forward, backward] = ordinates.of_beam(light, m);
      down.middleCols(m * n, n) = forward.transpose();
      up.middleCols(m * n, n) = backward.transpose();
      absorbed.middleCols(m * n, n).real() = lost.transpose();
    }
    endpoints.push_back(
        {{{-extinction / std::cos(light)}, {0}, down, up}, {{0}, {0}, absorbed, absorbed}});
  }
  return endpoints;
}

/// Shares of the power of one illumination, in the same order as the sums of a FluxJob.
struct FluxSolution {
  std::vector<Complex> shares;
  int ordinates;
};

template <typename Geometry, typename Exits>
FluxSolution solved(SlabOf<Geometry, double> slab, double light, std::size_t bins, int order) {
  for (auto& layer : slab.layers) layer.law = layer.law.truncated(kept_moments(order));
  const UnscatteredLight beam = through_layers(slab, light);
  auto foci = light_foci({light, light}, slab.width());
  // In a thin slab radiance varies rapidly near the directions in which the path through the slab
  // is about one mean free path long.
  foci.push_back({pi / 2, beam.thickness});
  const typename Exits::Discrete discrete(slab, foci, order);
  const DirectionModesOf<Geometry, double> modes(slab, discrete, Geometry::flux_modes,
                                                 flux_endpoints(slab, discrete, light));
  FluxSolution found{std::vector<Complex>(flux_shares + bins),
                     static_cast<int>(2 * discrete.grid().size())};
  found.shares[absorbed] = beam.absorbed;
  Exits exits(discrete, light);
  exits.add_straight(beam.transmitted - beam.unscattered);
  for (const auto& part : modes.parts())
    if (const auto layers = modes.layers(part); !layers.empty()) {
      const auto leaving = response_of(layers);
      exits.add(part.functions.front(), leaving);
      if (part.functions.front() == 0)
        found.shares[absorbed] += leaving.collected(0, 0).real() / std::cos(light);
    }
  found.shares[reflected] = exits.reflected();
  found.shares[transmitted] = exits.transmitted();
  const double width = Exits::angles / static_cast<double>(bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double from = static_cast<double>(bin) * width + Exits::first_angle;
    found.shares[flux_shares + bin] = exits.within(from, from + width);
  }
  return found;
}

/// Returns the magnitude to which the tolerance of each share of one illumination is relative. For
/// bins of the exit angle it is a hundred times the power that leaves, because resolving the peaks
/// of large disks would take a hundred times as long. For other shares it is the share itself.
std::vector<double> scales_of_shares(std::span<const Complex> shares) {
  constexpr double least = 1e-290;  // smaller numbers lose digits
  std::vector<double> scale;
  for (const Complex share : shares.first(flux_shares))
    scale.push_back(std::max(std::abs(share), least));
  const double leaving = scale[reflected] + scale[transmitted];
  scale.resize(shares.size(), 100 * leaving);
  return scale;
}

/// Refines the shares of one illumination until they have converged, or until the number of nodes
/// per panel is at least most_order. solve: returns the solution with a given number of nodes per
/// panel.
template <typename Solve>
Refined refined_shares(const Refinement& refinement, int order, int most_order,
                       const Solve& solve) {
  FluxSolution before = solve(order);
  Refined found{before.shares, std::vector<Complex>(before.shares.size()), before.ordinates};
  std::vector<Changes> changes(before.shares.size());
  for (double worst = 1; worst > refinement.tolerance || !changes.front().are_enough();) {
    stop_if_interrupted();
    if (4 * found.ordinates > 3 * refinement.most_ordinates || order >= most_order) break;
    order = Refinement::next_order(order);
    FluxSolution finer = solve(order);
    found = {finer.shares, finer.shares, finer.ordinates};
    for (std::size_t i = 0; i < before.shares.size(); ++i) {
      changes[i].add(std::abs(finer.shares[i] - before.shares[i]));
      found.error[i] = changes[i].error();
    }
    worst = worst_error(found, scales_of_shares(found.value));
    before = std::move(finer);
  }
  return found;
}

template <typename Geometry, typename Exits>
Refined refined_flux(const Scene& scene, std::size_t bins, const Refinement& refinement) {
  blas_single_thread();
  const auto slab = slab_of<Geometry>(scene);
  const int order = std::max(refinement.first_order(), slab.least_order());
  // Beyond this order the number of kept moments of a sharp peak no longer increases.
  const bool sharp =
      std::ranges::any_of(slab.layers, [](const auto& one) { return one.law.has_sharp_peak(); });
  const int most_order = sharp ? most_order_of_moments : refinement.most_ordinates;
  const auto lights = scene.request.lights.angles();
  std::vector<Refined> each(lights.size());
  parallel_for(lights.size(), [&](std::size_t i) {
    each[i] = refined_shares(refinement, order, most_order, [&](int nodes) {
      return solved<Geometry, Exits>(slab, lights[i], bins, nodes);
    });
  });
  Refined all;
  for (const Refined& light : each) all.append(light);
  return all;
}

Refined flux_of_absorber(const Scene& scene, std::size_t angle_bins) {
  Refined all;
  for (const double light : scene.request.lights.angles()) {
    std::vector<Complex> shares(flux_shares + angle_bins);
    shares[absorbed] = 1 - direct_transmittance(scene, light);
    all.append({shares, std::vector<Complex>(shares.size()), 0});
  }
  return all;
}

}  // namespace

Refined slab_flux(const Scene& scene, std::size_t angle_bins, const Refinement& refinement) {
  if (scene.medium.mu_s == 0) return flux_of_absorber(scene, angle_bins);
  return scene.medium.dimension == 3
             ? refined_flux<SpaceGeometry, SpaceExits>(scene, angle_bins, refinement)
             : refined_flux<PlaneGeometry, PlaneExits>(scene, angle_bins, refinement);
}

FluxJob slab_flux_job(const Scene& scene, std::size_t angle_bins, const Refinement& refinement) {
  const bool in_space = scene.medium.dimension == 3;
  FluxJob job;
  job.lights = scene.request.lights.size();
  job.angle_bins = angle_bins;
  job.plan =
      std::string("intensity alone in ") + (in_space ? "space" : "the plane") + ", by doubling";
  job.angles = in_space ? SpaceExits::angles : PlaneExits::angles;
  const std::size_t shares = flux_shares + angle_bins;
  job.batches = two_batches(
      job.lights * shares, [=] { return slab_flux(scene, angle_bins, refinement); },
      [=](std::span<const Complex> all) {
        std::vector<double> scales;
        for (std::size_t first = 0; first < all.size(); first += shares) {
          const auto own = scales_of_shares(all.subspan(first, shares));
          scales.insert(scales.end(), own.begin(), own.begin() + flux_shares);
          scales.resize(scales.size() + angle_bins);  // scale 0: bins are skipped
        }
        return scales;
      });
  return job;
}

}  // namespace flatspeckle::mc
