#include "mc/changes/brownian.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numbers/phasor.h"
#include "core/result/result_group.h"
#include "mc/estimators/path_ends.h"
#include "mc/estimators/single_scattering.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// Sum of 1 - cos over the inner scatterers of a path.
struct TurnTally {
  double turn = 0;

  void flight(double) {}
  template <typename Direction>
  void scattering(const Direction& from, const Direction& to) {
    turn += one_minus_cosine(from, to);
  }
};

/// A e of some ends and how they decay, [delay][end].
struct Decaying {
  Values value;
  std::vector<double> turn, decay;

  Decaying(std::size_t ends, std::size_t delays) : value(ends), turn(ends), decay(ends * delays) {}
};

/// Adds weight |f|^2 of every channel, then weight Re f(0) conj(f(t)) for every delay. C14's F and
/// R turn by other angles at the path's ends, so each has its own decay.
template <typename Scattering, bool reversed, bool phases>
class DelayScorer {
  using Direction = typename Scattering::Direction;

 public:
  DelayScorer(const Scene& scene, const Scattering& scattering, std::span<const double> delays,
              std::span<Complex> sums)
      : channels_(scene.request.channels),
        scattering_(scattering),
        delays_(delays),
        sums_(sums),
        ends_(scene, [&](std::size_t ends) { return Decaying(ends, delays.size()); }),
        inner_(1, delays.size()),
        exponent_(delays.size() * std::max(ends_.lights.size(), ends_.views.size())) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) {
    auto& [lights, views, light_first, light, view_first, view] = ends_;
    lights.attenuate(x, light.value);
    views.attenuate(x, view.value);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      const Vec2 from = -lights.direction(i), to = views.direction(v);
      const double square =
          std::norm(light.value[i] * view.value[v] * local(scattering_, x).amplitude(from, to));
      sums_[c] += weight * square;
      inner_.turn[0] = one_minus_cosine(from, to);
      decay(inner_);
      for (std::size_t t = 0; t < delays_.size(); ++t)
        sums_[(1 + t) * channels_.size() + c] += weight * square * inner_.decay[t];
    }
  }

  void multiple(const TalliedPath<Direction, TurnTally>& path) {
    ends_.find(path, [this](auto& ends, Vec2 x, const Direction& arrival, Decaying& out) {
      ends.at(x, arrival, scattering_, out.value);
      for (std::size_t j = 0; j < ends.size(); ++j)
        out.turn[j] = one_minus_cosine(arrival, Direction(ends.direction(j)));
      decay(out);
    });
    inner_.turn[0] = path.tally.turn;
    decay(inner_);
    for (std::size_t c = 0; c < channels_.size(); ++c) score(c, path.weight);
  }

 private:
  void decay(Decaying& ends) {
    const std::size_t count = ends.turn.size();
    for (std::size_t t = 0; t < delays_.size(); ++t)
      for (std::size_t j = 0; j < count; ++j)
        exponent_[t * count + j] = -2 * delays_[t] * ends.turn[j];
    damping(std::span(exponent_).first(ends.decay.size()), ends.decay);
  }

  void score(std::size_t c, double weight) {
    const auto& [lights, views, light_first, light_last, view_first, view_last] = ends_;
    const auto [i, v] = channels_[c];
    const Complex forward = product(light_first.value[i], view_last.value[v]);
    Complex backward = 0;
    if constexpr (reversed) backward = product(light_last.value[i], view_first.value[v]);
    const Complex field = forward + backward;
    const double with_forward = weight * product_with_conjugate(field, forward).real(),
                 with_backward = weight * product_with_conjugate(field, backward).real();
    sums_[c] += with_forward + with_backward;
    for (std::size_t t = 0; t < delays_.size(); ++t) {
      const std::size_t light = t * lights.size() + i, view = t * views.size() + v;
      double sum = with_forward * light_first.decay[light] * view_last.decay[view];
      if constexpr (reversed)
        sum += with_backward * light_last.decay[light] * view_first.decay[view];
      sums_[(1 + t) * channels_.size() + c] += inner_.decay[t] * sum;
    }
  }

  const std::vector<Channel>& channels_;
  const Scattering& scattering_;
  std::span<const double> delays_;
  std::span<Complex> sums_;
  PathEnds<Decaying, reversed, phases> ends_;
  Decaying inner_;  ///< of the inner scatterers, or the only one
  std::vector<double> exponent_;
};

struct DelayKind {
  using Sums = std::span<Complex>;
  std::vector<double> delays;

  std::size_t quantities() const { return 1 + delays.size(); }

  TurnTally tally(const Scene&) const { return {}; }

  template <bool reversed, bool phases, typename Scattering>
  auto scorer(const Scene& scene, const Scattering& scattering, Sums sums) const {
    return DelayScorer<Scattering, reversed, phases>(scene, scattering, delays, sums);
  }

  template <typename Scattering>
  Values single(const Scene& scene, const Scattering& scattering) const {
    Values all = single_scattering(scene, scattering);
    const auto lights = light_ends(scene), views = view_ends(scene);
    const std::size_t channels = all.size();
    for (const double delay : delays) {
      for (std::size_t c = 0; c < channels; ++c) {
        const auto [i, v] = scene.request.channels[c];
        const double turn = one_minus_cosine(-lights[i].towards, views[v].towards);
        all.push_back(all[c] * std::exp(-2 * delay * turn));
      }
    }
    return all;
  }
};

}  // namespace

void check_delays(const Scene& scene, const std::vector<double>& delays) {
  if (!scene.medium.structure.independent())
    throw InputError("delays: scatterers at correlated positions do not move independently");
  for (const double delay : delays)
    if (!(delay >= 0 && delay <= 1e100))
      throw InputError("delays", delay, "must not be negative, nor above 1e100");
}

PathJob delay_job(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                  std::uint64_t seed) {
  if (scene.request.kind != CovarianceRequest::Kind::intensity)
    throw InputError("delays: needs covariance = intensity");
  check_delays(scene, delays);
  PathJob job = path_job(DelayKind{delays}, scene, plan, seed);
  job.field.batches.relative_error = relative_error_of(job.all);
  return job;
}

const DatasetTable delays_table{
    "delays",
    {{"delay", Data::scale, "", "1", "k^2 D tau"},
     {"covariance", Data::estimate, "delay LIGHT VIEW", "COVARIANCE",
      "covariance of the field with itself after a delay"},
     {"field_correlation", Data::estimate, "delay LIGHT VIEW", "1",
      "field correlation after a delay"},
     {"diffusion_theory", Data::real, "delay", "1",
      "field correlation of transmitted light in diffusion theory"},
     {"delayed_covariance", Data::complex_estimate, "delay tilt VIEW", "COVARIANCE",
      "covariance of reference and moved field after a delay"},
     {"delayed_correlation", Data::estimate, "delay tilt", "1",
      "C_E of reference and moved field after a delay"}}};

void write_delays(ResultFile& file, const Scene& scene, const std::vector<double>& delays,
                  const ChangeEstimates& found) {
  const ResultGroup root(file, delays_table);
  root.put("delay", delays);
  if (scene.request.has_reference()) {
    root.put("delayed_covariance", found.covariance);
    return root.put("delayed_correlation", found.correlation);
  }
  root.put("covariance", found.covariance);
  root.put("field_correlation", found.correlation);
  const bool uniform_slab = scene.domain.kind == Domain::Kind::slab && !scene.profile;
  if (!uniform_slab || !scene.request.transmission_only()) return;
  root.put("diffusion_theory", column(delays, [&](double delay) {
             return diffusion_delay_correlation(scene.medium, scene.domain.depth, delay);
           }));
}

double diffusion_delay_correlation(const BulkMedium& medium, double thickness, double delay) {
  // kappa^2 = mu_a dimension / l*, and what adds to it acts like the square of a tilt's wavenumber
  const double loss = 2 * delay * (1 - medium.g) * medium.mu_s;
  const double q = std::sqrt(medium.dimension * loss / medium.transport_mean_free_path());
  return diffusion_field_correlation(medium, thickness, q);
}

}  // namespace flatspeckle::mc
