#include "mc/slab/slab_flux.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
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

/// Of a slab in the plane: power that leaves through a face per ordinate, over its weight and the
/// power that enters, of directions with sin > 0, and of their mirror images.
class PlaneExits {
 public:
  using Discrete = DiscreteSlabOf<PlaneGeometry, double>;
  static constexpr double first_angle = -pi, angles = 2 * pi;

  PlaneExits(const Discrete& discrete, double light)
      : grid_(discrete.grid()), light_(light), reflected_(grid_.size()), transmitted_(reflected_) {}

  /// What leaves in a function of direction: 0 even, 1 odd.
  void add(int function, const LayerResponseOf<double>& leaving) {
    reflected_.add(function, leaving.up);
    transmitted_.add(function, leaving.down);
  }
  double reflected() const { return within(-pi, -pi / 2) + within(pi / 2, pi); }
  double transmitted() const { return within(-pi / 2, pi / 2); }
  /// Exit angles, -pi <= from < to <= pi, quadrant by quadrant.
  double within(double from, double to) const {
    return quadrant(transmitted_.right, from, to) + quadrant(transmitted_.left, -to, -from) +
           quadrant(reflected_.right, pi - to, pi - from) +
           quadrant(reflected_.left, from + pi, to + pi);
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
  double light_;
  Face reflected_, transmitted_;
};

/// Eigen's own makes gcc 12 warn of AVX-512's header.
double sum_of_products(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Of a slab in space: power that leaves through a face over what enters, all, and per radian of
/// the polar angle at the ordinates.
class SpaceExits {
 public:
  using Discrete = DiscreteSlabOf<SpaceGeometry, double>;
  static constexpr double first_angle = 0, angles = pi;

  SpaceExits(const Discrete& discrete, double light)
      : grid_(discrete.grid()),
        power_(std::sqrt(2 * pi) * discrete.root() / std::cos(light)),
        per_radian_(power_.array() * grid_.angle().array().sin() * grid_.cosine().array() /
                    discrete.root().array().square()) {}

  void add(int, const LayerResponseOf<double>& leaving) {
    up_ = leaving.up.row(0).real();
    down_ = leaving.down.row(0).real();
  }
  double reflected() const { return sum_of_products(up_, power_); }
  double transmitted() const { return sum_of_products(down_, power_); }
  /// Exit angles, 0 <= from < to <= pi.
  double within(double from, double to) const {
    const auto radiance = [this](const Eigen::VectorXd& exit) -> Eigen::VectorXd {
      return exit.cwiseProduct(per_radian_);
    };
    return sum_of_products(grid_.interval_integrals(from, to), radiance(down_)) +
           sum_of_products(grid_.interval_integrals(pi - to, pi - from), radiance(up_));
  }

 private:
  const AngularGrid& grid_;
  Eigen::VectorXd power_, per_radian_, up_, down_;
};

/// Shares of one light as the sums of a FluxJob, what is absorbed left out.
struct FluxSolution {
  std::vector<Complex> shares;
  int ordinates;
};

template <typename Geometry, typename Exits>
FluxSolution solved(const SlabOf<Geometry, double>& slab, double light, std::size_t bins,
                    int order) {
  const typename Exits::Discrete discrete(slab, light_foci({light, light}, slab.width()), order);
  const auto direction = Geometry::direction(light);
  const DirectionModesOf<Geometry, double> modes(slab, discrete, Geometry::flux_modes, {},
                                                 {{direction, direction}}, {});
  Exits exits(discrete, light);
  for (const auto& part : modes.parts())
    if (const auto layers = modes.layers(part); !layers.empty())
      exits.add(part.functions.front(), response_of(layers));
  FluxSolution found{std::vector<Complex>(flux_shares + bins),
                     static_cast<int>(2 * discrete.grid().size())};
  found.shares[reflected] = exits.reflected();
  found.shares[transmitted] = exits.transmitted();
  const double width = Exits::angles / static_cast<double>(bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double from = static_cast<double>(bin) * width + Exits::first_angle;
    found.shares[flux_shares + bin] = exits.within(from, from + width);
  }
  return found;
}

/// Of what leaves through a face relative to itself; of bins relative to all that leaves, and a
/// hundredth of it, for peaks of large disks would take a hundred times as long.
double worst_difference(const Refined& shares) {
  double worst = 0, leaving = 0;
  for (const FluxShare share : {reflected, transmitted}) {
    worst = std::max(worst, std::abs(shares.difference[share] / shares.value[share]));
    leaving += shares.value[share].real();
  }
  for (std::size_t i = flux_shares; i < shares.value.size(); ++i)
    worst = std::max(worst, std::abs(shares.difference[i]) / leaving / 100);
  return worst;
}

/// Of one light. solve: of panels with so many nodes.
template <typename Solve>
Refined refined_shares(const Scene& scene, double light, const Refinement& refinement, int order,
                       const Solve& solve) {
  const auto solved_with_absorbed = [&] {
    FluxSolution found = solve(order);
    auto& shares = found.shares;
    if (scene.medium.albedo < 1)
      shares[absorbed] =
          1 - direct_transmittance(scene, light) - shares[reflected] - shares[transmitted];
    return found;
  };
  FluxSolution before = solved_with_absorbed();
  Refined found{before.shares, std::vector<Complex>(before.shares.size()), before.ordinates};
  for (double last = 1, worst = 1;
       worst > refinement.tolerance || last > 100 * refinement.tolerance;) {
    stop_if_interrupted();
    if (4 * found.ordinates > 3 * refinement.most_ordinates) break;
    order = Refinement::next_order(order);
    FluxSolution finer = solved_with_absorbed();
    found = {finer.shares, finer.shares, finer.ordinates};
    for (std::size_t i = 0; i < before.shares.size(); ++i) found.difference[i] -= before.shares[i];
    last = std::exchange(worst, worst_difference(found));
    before = std::move(finer);
  }
  return found;
}

template <typename Geometry, typename Exits>
Refined refined_flux(const Scene& scene, std::size_t bins, const Refinement& refinement) {
  blas_single_thread();
  const auto slab = slab_of<Geometry>(scene);
  const int order = std::max(refinement.first_order(), slab.least_order());
  const auto lights = scene.request.lights.angles();
  std::vector<Refined> each(lights.size());
  parallel_for(lights.size(), [&](std::size_t i) {
    each[i] = refined_shares(scene, lights[i], refinement, order, [&](int nodes) {
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
  job.batches = two_batches(job.lights * (flux_shares + angle_bins),
                            [=] { return slab_flux(scene, angle_bins, refinement); });
  return job;
}

}  // namespace flatspeckle::mc
