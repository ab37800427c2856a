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
#include "flatland/media/face_stack.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/adding/direction_modes.h"
#include "mc/slab/adding/plane.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/scene_slab.h"

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

/// Shares of the power that leave in the beam, without being scattered except into forward peaks:
/// in the direction of the illumination, and in that of its reflection at the faces.
struct StraightShares {
  double through = 0, back = 0;
};

/// A face through which light leaves, seen from the adjacent layer. Angles from z are converted to
/// those inside by the law of refraction.
template <typename Geometry>
class ExitFace {
 public:
  ExitFace(const SlabOf<Geometry, double>& slab, const DiscreteSlabOf<Geometry, double>& discrete,
           double light, bool top)
      : ratio_(slab.outside_index / slab.index(top ? 0 : std::ssize(slab.layers) - 1)),
        ordinates_(top ? discrete.layers().front() : discrete.layers().back()),
        scale_(Geometry::power_scale(1 / ratio_) / std::cos(light)) {}

  const OrdinatesOf<Geometry, double>& ordinates() const { return ordinates_; }
  /// Factor of the share of the incident power that leaves at an ordinate, for radiance times
  /// OrdinatesOf::root() relative to a beam of unit intensity.
  double scale() const { return scale_; }
  /// Returns the integrals of the polynomials of the grid over an interval of angles outside, which
  /// is limited to [0, pi/2].
  Eigen::VectorXd integrals(double from, double to) const {
    return ordinates_.grid().interval_integrals(inside(from), inside(to));
  }

 private:
  double inside(double angle) const {
    if (ratio_ == 1) return angle;
    return std::asin(std::min(1.0, ratio_ * std::sin(std::clamp(angle, 0.0, pi / 2))));
  }

  double ratio_;
  const OrdinatesOf<Geometry, double>& ordinates_;
  double scale_;
};

/// Light that leaves a slab in the plane through each face, at the ordinates. `right` contains the
/// directions with positive sine, `left` their mirror images about z.
class PlaneExits {
 public:
  using Discrete = DiscreteSlabOf<PlaneGeometry, double>;
  static constexpr double first_angle = -pi, angles = 2 * pi;

  PlaneExits(const SlabOf<PlaneGeometry, double>& slab, const Discrete& discrete, double light,
             StraightShares straight)
      : light_(light),
        straight_(straight),
        reflected_({slab, discrete, light, true}),
        transmitted_({slab, discrete, light, false}) {}

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
    return transmitted_.share(transmitted_.right, from, to) +
           transmitted_.share(transmitted_.left, -to, -from) +
           reflected_.share(reflected_.right, pi - to, pi - from) +
           reflected_.share(reflected_.left, from + pi, to + pi) +
           straight_.through * share_between(light_, from, to) +
           straight_.back * share_between(std::remainder(pi - light_, 2 * pi), from, to);
  }

 private:
  struct Leaving {
    ExitFace<PlaneGeometry> face;
    Eigen::VectorXd right, left;

    explicit Leaving(const ExitFace<PlaneGeometry>& exit)
        : face(exit), right(Eigen::VectorXd::Zero(exit.ordinates().grid().size())), left(right) {}

    void add(int function, const Rows& leaving) {
      const auto power = function == 0 ? Eigen::VectorXd(leaving.row(0).real())
                                       : Eigen::VectorXd(leaving.row(0).imag());
      right += power;
      left += function == 0 ? power : -power;
    }
    double share(const Eigen::VectorXd& exit, double from, double to) const {
      const AngularGrid& grid = face.ordinates().grid();
      const Eigen::VectorXd integrals = face.integrals(from, to);
      double sum = 0;
      for (Eigen::Index j = 0; j < exit.size(); ++j)
        sum += integrals[j] *
               (std::sqrt(grid.cosine()[j] / (2 * grid.weight()[j])) * face.scale() * exit[j]);
      return sum;
    }
  };

  double light_;
  StraightShares straight_;
  Leaving reflected_, transmitted_;
};

/// Returns the scalar product. Eigen's own causes gcc 12 to print warnings about the AVX-512
/// header.
double sum_of_products(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Light that leaves a slab in space.
class SpaceExits {
 public:
  using Discrete = DiscreteSlabOf<SpaceGeometry, double>;
  static constexpr double first_angle = 0, angles = pi;

  SpaceExits(const SlabOf<SpaceGeometry, double>& slab, const Discrete& discrete, double light,
             StraightShares straight)
      : light_(std::abs(light)),
        straight_(straight),
        reflected_({slab, discrete, light, true}),
        transmitted_({slab, discrete, light, false}) {}

  void add(int, const LayerResponseOf<double>& leaving) {
    reflected_.exit = leaving.up.row(0).real();
    transmitted_.exit = leaving.down.row(0).real();
  }
  double reflected() const { return reflected_.all() + straight_.back; }
  double transmitted() const { return transmitted_.all() + straight_.through; }
  /// Returns the share of the incident power that leaves between two exit angles, 0 <= from < to <=
  /// pi.
  double within(double from, double to) const {
    // Light along the z axis is counted as a whole in the first or the last interval, because polar
    // angles lie between 0 and pi.
    const double along = light_ == 0 ? (from == 0 ? 1 : 0) : share_between(light_, from, to),
                 opposite = light_ == 0 ? (to == pi ? 1 : 0) : share_between(pi - light_, from, to);
    return transmitted_.share(from, to) + reflected_.share(pi - to, pi - from) +
           straight_.through * along + straight_.back * opposite;
  }

 private:
  /// The vectors power and per_radian convert the unknowns at the ordinates to shares of the
  /// incident power, in total and per radian of the polar angle inside.
  struct Leaving {
    ExitFace<SpaceGeometry> face;
    Eigen::VectorXd power, per_radian, exit;

    explicit Leaving(const ExitFace<SpaceGeometry>& leaves)
        : face(leaves),
          power(std::sqrt(2 * pi) * leaves.scale() * leaves.ordinates().root()),
          per_radian(power.array() * leaves.ordinates().grid().angle().array().sin() *
                     leaves.ordinates().grid().cosine().array() /
                     leaves.ordinates().root().array().square()) {}

    double all() const { return sum_of_products(exit, power); }
    double share(double from, double to) const {
      return sum_of_products(face.integrals(from, to), exit.cwiseProduct(per_radian));
    }
  };

  double light_;
  StraightShares straight_;
  Leaving reflected_, transmitted_;
};

/// A beam in a stack of layers, with all its reflections at faces. Light that is scattered into the
/// forward peak of a phase function remains in the beam.
struct BeamLayer {
  double cosine;  ///< of its direction in the layer
  /// Power that enters the layer from above, and from below after reflections, as fractions of the
  /// incident power
  double down, up;
};
struct LayeredBeam {
  std::vector<BeamLayer> layers;
  double transmitted, reflected;
  double absorbed = 0;   ///< fraction of the incident power
  double thickness = 0;  ///< optical depth of the layers, without the scattering into forward peaks
};

/// Follows a beam that meets the face z = 0. with_peaks: whether light that is scattered into
/// forward peaks leaves the beam.
template <typename Geometry>
LayeredBeam beam_in_layers(const SlabOf<Geometry, double>& slab, double light, bool with_peaks) {
  const auto layers = std::ssize(slab.layers);
  std::vector<double> cosines{std::cos(light)}, through, kept;
  std::vector<FaceProducts> faces;
  LayeredBeam beam;
  for (std::ptrdiff_t l = 0; l < layers; ++l) {
    const auto& layer = slab.layers[static_cast<std::size_t>(l)];
    const Face refraction{slab.outside_index, layer.index, slab.polarisation};
    cosines.push_back(refraction.refracted(cosines.front()));
    kept.push_back(with_peaks ? 1 : 1 - layer.albedo * layer.law.peak());
    through.push_back(std::exp(-slab.optical_depth(layer) * kept.back() / cosines.back()));
    beam.thickness += slab.optical_depth(layer) * kept.back();
  }
  for (std::ptrdiff_t l = 0; l <= layers; ++l)
    faces.push_back(FaceProducts::of_power(slab.face(l), cosines[static_cast<std::size_t>(l)]));
  const auto powers = amplitudes_in_stack(through, faces);
  beam.transmitted = powers.transmitted;
  beam.reflected = powers.reflected;
  for (std::size_t l = 0; l < slab.layers.size(); ++l) {
    beam.layers.push_back({cosines[l + 1], powers.forward[l], powers.backward[l]});
    beam.absorbed += (powers.forward[l] + powers.backward[l]) * (1 - through[l]) *
                     (1 - slab.layers[l].albedo) / kept[l];
  }
  return beam;
}

/// Returns, for each layer, the radiance that the first scattering of the beam adds, and a view
/// whose signal is the absorbed power. The intensity of the incident beam is 1.
template <typename Geometry>
std::vector<EndpointWavesOf<double>> flux_endpoints(
    const SlabOf<Geometry, double>& slab, const DiscreteSlabOf<Geometry, double>& discrete,
    const LayeredBeam& beam, double light) {
  std::vector<EndpointWavesOf<double>> endpoints;
  for (std::size_t l = 0; l < slab.layers.size(); ++l) {
    const auto& ordinates = discrete.layers()[l];
    const Eigen::Index n = ordinates.grid().size(), functions = Geometry::flux_modes + 1;
    const auto& [cosine, down_power, up_power] = beam.layers[l];
    const double rate = (1 - ordinates.peak_scattering()) / cosine,
                 scale = Geometry::power_scale(slab.layers[l].index / slab.outside_index);
    const Eigen::VectorXd lost = (1 - ordinates.albedo()) * ordinates.all_directions();
    const double angle = refracted(light, slab.outside_index / slab.layers[l].index);
    Rows down(2, functions * n), up = down, absorbed = Rows::Zero(1, functions * n);
    for (int m = 0; m < functions; ++m) {
      const auto [forward, backward] = ordinates.of_beam(angle, m);
      down.middleCols(m * n, n) << forward.transpose(), backward.transpose();
      up.middleCols(m * n, n) << backward.transpose(), forward.transpose();
      absorbed.middleCols(m * n, n).real() = lost.transpose();
    }
    const double intensity = std::cos(light) / cosine / scale;
    endpoints.push_back(
        {{{-rate, 0}, {0, -rate}, down, up, {down_power * intensity, up_power * intensity}, 1},
         {{0}, {0}, absorbed, absorbed, {scale}, 1}});
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
  const LayeredBeam beam = beam_in_layers(slab, light, false);
  const double refraction = slab.outside_index / slab.largest_index();
  auto foci = light_foci(refracted(Pair{light, light}, refraction), slab.width());
  // In a thin slab radiance varies rapidly near the directions in which the path through the slab
  // is about one mean free path long.
  foci.push_back({pi / 2, beam.thickness});
  const typename Exits::Discrete discrete(slab, foci, order);
  const DirectionModesOf<Geometry, double> modes(slab, discrete, Geometry::flux_modes,
                                                 flux_endpoints(slab, discrete, beam, light));
  FluxSolution found{std::vector<Complex>(flux_shares + bins),
                     static_cast<int>(2 * discrete.most_ordinates())};
  found.shares[absorbed] = beam.absorbed;
  const LayeredBeam unscattered = beam_in_layers(slab, light, true);
  Exits exits(slab, discrete, light,
              {beam.transmitted - unscattered.transmitted, beam.reflected - unscattered.reflected});
  for (const auto& part : modes.parts())
    if (const auto layers = modes.layers(part); !layers.empty()) {
      const auto leaving = response_of(layers, modes.faces(part));
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
    order = Resolution::next(order);
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
  const int order = std::max(refinement.first_order(slab.has_faces()), slab.least_order());
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
    shares[absorbed] = 1 - direct_transmittance(scene, light) - specular_reflectance(scene, light);
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
