#include "mc/paths/dynamics/brownian.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <type_traits>

#include "core/error.h"
#include "core/numbers/phasor.h"
#include "mc/jobs/delay_results.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/path_endpoints.h"
#include "mc/paths/estimators/single_scattering.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// Sum of 1 - cos(scattering angle) over the inner scatterers of a path (all but the first and
/// last).
struct TurnTally {
  using Factor = double;  ///< factor by which motion reduces a covariance
  double turn = 0;

  void flight(Vec, Vec, double) {}
  void scattering(Vec, Vec from, Vec to) { turn += one_minus_cosine(from, to); }
};

/// Two sums over the inner scatterers of a path. `turn` is the sum of (1 - cos(scattering angle))
/// times the local diffusion. `slip` is the sum of (from - to).velocity, where from and to are the
/// directions before and after scattering.
struct FlowTally {
  using Factor = Complex;
  const LocalMotion* motion = nullptr;
  double turn = 0, slip = 0;

  void flight(Vec, Vec, double) {}
  void scattering(Vec x, Vec from, Vec to) {
    turn += motion->diffusion(x) * one_minus_cosine(from, to);
    slip += dot(Vec(from) - Vec(to), motion->velocity(x));
  }
};

/// Data of a list of endpoints: for each endpoint the product A e of C14 (amplitude and endpoint
/// factor) and the tally of the scattering towards it; and the decay factors that follow from the
/// tallies, [delay][endpoint].
template <typename Tally>
struct Decaying {
  Values value;
  std::vector<Tally> tally;
  std::vector<typename Tally::Factor> decay;

  Decaying(std::size_t endpoints, std::size_t delays, const Tally& none)
      : value(endpoints), tally(endpoints, none), decay(endpoints * delays) {}
};

/// Computes the decay factors exp(-2 turn t - i k slip t) for every delay t and tally,
/// [delay][tally].
class Decay {
 public:
  Decay(std::span<const double> delays, double k, std::size_t most)
      : delays_(delays), k_(k), exponent_(delays.size() * most), phase_(exponent_.size()) {}

  void find(const std::vector<TurnTally>& tallies, std::vector<double>& decay) {
    fill(tallies, exponent_, [](const TurnTally& tally) { return -2 * tally.turn; });
    damping(std::span(exponent_).first(decay.size()), decay);
  }
  void find(const std::vector<FlowTally>& tallies, std::vector<Complex>& decay) {
    fill(tallies, exponent_, [](const FlowTally& tally) { return -2 * tally.turn; });
    fill(tallies, phase_, [this](const FlowTally& tally) { return -k_ * tally.slip; });
    damped_phasors(std::span(phase_).first(decay.size()), std::span(exponent_).first(decay.size()),
                   decay);
  }

 private:
  template <typename Tally, typename Rate>
  void fill(const std::vector<Tally>& tallies, std::vector<double>& out, const Rate& rate) const {
    for (std::size_t t = 0; t < delays_.size(); ++t)
      for (std::size_t j = 0; j < tallies.size(); ++j)
        out[t * tallies.size() + j] = delays_[t] * rate(tallies[j]);
  }

  std::span<const double> delays_;
  double k_;
  std::vector<double> exponent_, phase_;
};

/// Adds weight |f|^2 of the field f of every channel, then weight f(0) conj(f(t)) for every delay
/// t. Without flow only the real part is computed, because the imaginary part has mean 0. F and R
/// of C14 have different scattering angles at the first and last scatterer, so each has its own
/// decay.
template <typename Tally>
class DelayScorer : public TallyScorer<Tally> {
  using Factor = typename Tally::Factor;

 public:
  DelayScorer(const PathWalks& walks, std::span<const double> delays, const Tally& none,
              std::span<Complex> sums)
      : TallyScorer<Tally>(none),
        channels_(walks.scene().request.channels),
        walks_(walks),
        delays_(delays),
        sums_(sums),
        endpoints_(
            walks,
            [&](std::size_t endpoints) { return Decaying<Tally>(endpoints, delays.size(), none); }),
        inner_(1, delays.size(), none),
        decay_(delays, walks.scene().k,
               std::max(endpoints_.lights().size(), endpoints_.views().size())) {}

  /// Scores the path of one scatterer at x.
  void single(Vec x, double weight, FaceWaves waves) override {
    endpoints_.choose(waves);
    EndpointFactors &lights = endpoints_.lights(), &views = endpoints_.views();
    auto &light = endpoints_.light_last, &view = endpoints_.view_last;
    lights.attenuate(x, light.value);
    views.attenuate(x, view.value);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      const Vec from = -lights.direction(i), to = views.direction(v);
      const double square =
          std::norm(light.value[i] * view.value[v] * walks_.amplitude(x, from, to));
      sums_[c] += weight * square;
      find_inner(turned(x, from, to));
      for (std::size_t t = 0; t < delays_.size(); ++t)
        sums_[(1 + t) * channels_.size() + c] += weight * square * inner_.decay[t];
    }
  }

  void multiple(const Path& path) override {
    endpoints_.find(path,
                    [this](EndpointFactors& endpoints, Vec x, Vec arrival, Decaying<Tally>& out) {
                      endpoints.attenuate(x, out.value);
                      walks_.towards(x, arrival, endpoints.directions(), out.value);
                      for (std::size_t j = 0; j < endpoints.size(); ++j)
                        out.tally[j] = turned(x, arrival, endpoints.direction(j));
                      decay_.find(out.tally, out.decay);
                    });
    find_inner(this->tally());
    for (std::size_t c = 0; c < channels_.size(); ++c) score(c, path.weight);
  }

 private:
  /// Returns the tally of a single scattering at x.
  Tally turned(Vec x, Vec from, Vec to) const {
    Tally tally = this->none();
    tally.scattering(x, from, to);
    return tally;
  }

  void find_inner(const Tally& tally) {
    inner_.tally[0] = tally;
    decay_.find(inner_.tally, inner_.decay);
  }

  /// Returns weight field conj(term), or its real part if Factor is real (no flow).
  static Factor with_field(double weight, Complex field, Complex term) {
    const Complex both = weight * product_with_conjugate(field, term);
    if constexpr (std::is_same_v<Factor, double>)
      return both.real();
    else
      return both;
  }

  void score(std::size_t c, double weight) {
    const auto &light_first = endpoints_.light_first, &light_last = endpoints_.light_last,
               &view_first = endpoints_.view_first, &view_last = endpoints_.view_last;
    const std::size_t lights = light_first.value.size(), views = view_first.value.size();
    const auto [i, v] = channels_[c];
    const Complex forward = product(light_first.value[i], view_last.value[v]);
    Complex backward = 0;
    if (endpoints_.reversed()) backward = product(light_last.value[i], view_first.value[v]);
    const Complex field = forward + backward;
    const Factor with_forward = with_field(weight, field, forward),
                 with_backward = with_field(weight, field, backward);
    sums_[c] += std::real(with_forward + with_backward);
    for (std::size_t t = 0; t < delays_.size(); ++t) {
      const std::size_t light = t * lights + i, view = t * views + v;
      Factor sum = with_forward * light_first.decay[light] * view_last.decay[view];
      if (endpoints_.reversed())
        sum += with_backward * light_last.decay[light] * view_first.decay[view];
      sums_[(1 + t) * channels_.size() + c] += inner_.decay[t] * sum;
    }
  }

  const std::vector<Channel>& channels_;
  const PathWalks& walks_;
  std::span<const double> delays_;
  std::span<Complex> sums_;
  PathEndpoints<Decaying<Tally>> endpoints_;
  Decaying<Tally> inner_;  ///< decay by the inner scatterers of a path, or by the only one
  Decay decay_;
};

/// Returns the contribution of paths of one scatterer to the quantities of delay_job(), in closed
/// form, for a homogeneous medium. A shear flow gives the phase a gradient along z.
Values single_covariances(const PathWalks& walks, const std::vector<double>& delays,
                          const Motion& motion) {
  const Scene& scene = walks.scene();
  Values all = single_scattering(scene, walks);
  const std::size_t channels = all.size();
  for (const double delay : delays) {
    for (std::size_t c = 0; c < channels; ++c) {
      const auto [light, view] = scene.request.channels[c];
      const Vec from = scene.request.lights[light].direction(),
                to = scene.request.views[view].direction(), turn = from - to;
      const double phase_gradient = -scene.k * delay * turn.x * motion.shear;
      const Complex value =
          phase_gradient == 0
              ? all[c]
              : scene.medium.mu_s * std::norm(walks.amplitude({}, from, to)) *
                    attenuated_wave_integral(scene.domain, scene.medium.mu_t, {0, phase_gradient},
                                             {-from, to, -from, to});
      all.push_back(value *
                    std::polar(std::exp(-2 * delay * motion.diffusion * dot(turn, turn) / 2),
                               -scene.k * delay * dot(turn, motion.velocity)));
    }
  }
  return all;
}

}  // namespace

PathJob delay_job(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                  std::uint64_t seed, const Motion& motion) {
  if (scene.request.kind != CovarianceRequest::Kind::intensity)
    throw InputError("delays: requires covariance = intensity");
  check_delays(scene, delays, motion);
  std::vector<double> scaled = delays;  // k^2 D tau
  for (double& delay : scaled) delay *= motion.diffusion;
  const auto scorer = [=, local = LocalMotion(scene, motion), flows = !motion.only_diffuses(scene)](
                          const PathWalks& walks,
                          std::span<Complex> sums) -> std::unique_ptr<PathScorer> {
    if (flows)
      return std::make_unique<DelayScorer<FlowTally>>(walks, delays, FlowTally{&local}, sums);
    return std::make_unique<DelayScorer<TurnTally>>(walks, scaled, TurnTally{}, sums);
  };
  const auto single = [=](const PathWalks& walks) {
    return single_covariances(walks, delays, motion);
  };
  PathJob job = path_job({1 + delays.size(), scorer, single}, scene, plan, seed);
  job.field.batches.relative_error = relative_error_of(job.all);
  return job;
}

}  // namespace flatspeckle::mc
