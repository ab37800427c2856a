#include "mc/paths/dynamics/moving_derivatives.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "mc/jobs/delay_results.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/derivative_endpoints.h"
#include "mc/paths/estimators/derivative_sums.h"

namespace flatspeckle::mc {

namespace {

/// Three sums over the scatterings of a path. `turn` is the sum of 1 - cos(scattering angle),
/// `slip` the sum of the vectors from - to (directions before and after scattering), `sheared` the
/// sum of the x component of from - to times the depth.
struct Turned {
  double turn = 0;
  Vec slip{};
  double sheared = 0;

  void add(Vec x, Vec from, Vec to) {
    const Vec turned = Vec(from) - Vec(to);
    turn += one_minus_cosine(from, to);
    slip = slip + turned;
    sheared += turned.x * x.z;
  }
  Turned operator+(const Turned& more) const {
    return {turn + more.turn, slip + more.slip, sheared + more.sheared};
  }
};

/// Returns the complex rate by which motion changes the second field: after a delay t the field is
/// multiplied by exp(-t rate). The rate is linear in diffusion, velocity and shear, so that
/// derivatives of these give the derivative of the rate.
Complex rate(const Turned& turned, double k, double diffusion, Vec velocity, double shear) {
  return {2 * diffusion * turned.turn, -k * (dot(velocity, turned.slip) + shear * turned.sheared)};
}

struct MovingTally : GradientTally {
  Turned turned;

  void scattering(Vec x, Vec from, Vec to) {
    GradientTally::scattering(x, from, to);
    turned.add(x, from, to);
  }
};

struct MovingEndpoints : DerivativeEndpoints {
  std::vector<Turned> turned;

  explicit MovingEndpoints(std::size_t endpoints)
      : DerivativeEndpoints(endpoints), turned(endpoints) {}
};

/// Input of a job, shared by all batches.
struct MovingDerivatives {
  std::vector<double> delays;
  Motion motion;
  std::vector<MovingDerivative> parameters;
  std::vector<MediumDerivative> media;  ///< MovingDerivative::medium of each parameter
  /// Pairs of fields, [1 + delay][channel]: the field at time 0 with itself, then with the field
  /// after each delay
  std::vector<Entry> entries;
};

/// Data of a path without its endpoints: half of its logarithmic derivatives, and the sums over its
/// inner scatterers.
struct MovingInner {
  LogDerivatives half;
  Turned turned;
};

class MovingTerms : public MediumDerivatives, public DerivativeSums {
 public:
  using Tally = MovingTally;
  using Endpoints = MovingEndpoints;

  MovingTerms(const PathWalks& walks, const MovingDerivatives& of, std::span<Complex> sums)
      : MediumDerivatives(walks, of.media),
        DerivativeSums(of.entries.size(), of.entries, of.media.size(), sums),
        of_(of),
        k_(walks.scene().k),
        channels_(walks.scene().request.channels.size()) {}

  MovingEndpoints endpoints(std::size_t count) const { return MovingEndpoints(count); }

  void attenuate(EndpointFactors& endpoints, Vec x, MovingEndpoints& out) const {
    MediumDerivatives::attenuate(endpoints, x, out);
    std::fill(out.turned.begin(), out.turned.end(), Turned{});
  }
  void turn(const EndpointFactors& endpoints, Vec x, Vec arrival, MovingEndpoints& out) const {
    MediumDerivatives::turn(endpoints, x, arrival, out);
    for (std::size_t j = 0; j < endpoints.size(); ++j)
      out.turned[j].add(x, arrival, endpoints.direction(j));
  }

  MovingInner inner(const MovingTally& tally, Vec first) const {
    return {MediumDerivatives::inner(tally, first), tally.turned};
  }
  MovingInner one(Vec x, Vec from, Vec to) const {
    MovingInner one{MediumDerivatives::one(x, from, to), {}};
    one.turned.add(x, from, to);
    return one;
  }

  /// Adds a term (F or R of C14) of the field of channel c, at time 0 and after each delay. i and
  /// v: light and view of the channel.
  void add_term(std::size_t c, Complex term, const MovingInner& inner,
                const MovingEndpoints& lights, std::size_t i, const MovingEndpoints& views,
                std::size_t v) {
    const Turned turned = inner.turned + lights.turned[i] + views.turned[v];
    const auto& [diffusion, velocity, shear] = of_.motion;
    const Complex decay = rate(turned, k_, diffusion, velocity, shear);
    LogDerivatives log{}, by_motion{};
    for (std::size_t p = 0; p < of_.parameters.size(); ++p) {
      const MovingDerivative& one = of_.parameters[p];
      log[p] = inner.half[p] + lights.log_derivatives[i][p] + views.log_derivatives[v][p];
      by_motion[p] = rate(turned, k_, one.diffusion, one.velocity, one.shear);
    }
    DerivativeSums::add_term(c, term, [&](std::size_t p) { return log[p]; });
    for (std::size_t t = 0; t < of_.delays.size(); ++t) {
      const double delay = of_.delays[t];
      const Complex later =
          product(term, std::polar(std::exp(-delay * decay.real()), -delay * decay.imag()));
      DerivativeSums::add_term((1 + t) * channels_ + c, later,
                               [&](std::size_t p) { return log[p] - delay * by_motion[p]; });
    }
  }

 private:
  const MovingDerivatives& of_;
  double k_;
  std::size_t channels_;
};

}  // namespace

PathJob moving_derivative_job(const Scene& scene, const Plan& plan,
                              const std::vector<double>& delays, const Motion& motion,
                              const std::vector<MovingDerivative>& derivatives,
                              std::uint64_t seed) {
  check_delays(scene, delays, motion);
  MovingDerivatives all{delays, motion, derivatives, {}, {}};
  for (const MovingDerivative& derivative : derivatives) all.media.push_back(derivative.medium);
  require_derivatives(scene, all.media);
  const auto channels = static_cast<std::uint32_t>(scene.request.channels.size());
  for (std::uint32_t t = 0; t <= delays.size(); ++t)
    for (std::uint32_t c = 0; c < channels; ++c) all.entries.push_back({c, t * channels + c});
  const std::size_t quantities = (1 + all.media.size()) * (1 + delays.size());
  return path_job({quantities,
                   [of = std::make_shared<const MovingDerivatives>(std::move(all))](
                       const PathWalks& walks, std::span<Complex> sums) {
                     return std::make_unique<DerivativeScorer<MovingTerms>>(
                         walks, MovingTally{{of->media}, {}}, MovingTerms(walks, *of, sums));
                   }},
                  scene, plan, seed);
}

}  // namespace flatspeckle::mc
