#include "mc/estimators/brownian.h"

#include <cmath>

#include "core/error.h"
#include "core/result/result_group.h"
#include "mc/ends/coherent_field.h"
#include "mc/estimators/delay_scorer.h"
#include "mc/estimators/single_scattering.h"
#include "mc/estimators/tallied_walks.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

void check(const Scene& scene, const std::vector<double>& delays) {
  if (scene.request.kind != CovarianceRequest::Kind::intensity)
    throw InputError("delays: needs covariance = intensity");
  if (!scene.medium.structure.independent())
    throw InputError("delays: scatterers at correlated positions do not move independently");
  for (const double delay : delays)
    if (!(delay >= 0 && delay <= 1e100))
      throw InputError("delays", delay, "must not be negative, nor above 1e100");
}

/// B = 1 in closed form, [1 + delay][channel].
Values closed_form(const Scene& scene, const Plan& plan, const std::vector<double>& delays) {
  Values all;
  with_scattering(scene, plan.phase,
                  [&](const auto& scattering) { all = single_scattering(scene, scattering); });
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

/// [1 + delay][channel] of all paths.
Estimator with_single(const Scene& scene, const Plan& plan, const std::vector<double>& delays) {
  if (plan.sampled_single || scene.medium.mu_s == 0) return sample_mean;
  return
      [single = closed_form(scene, plan, delays)](double samples, std::span<const Complex> sums) {
        Values values = sample_mean(samples, sums);
        std::transform(values.begin(), values.end(), single.begin(), values.begin(), std::plus<>());
        return values;
      };
}

}  // namespace

DelayJob delay_job(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                   std::uint64_t seed) {
  check(scene, delays);
  const std::size_t channels = scene.request.channels.size();
  const Estimator all = with_single(scene, plan, delays);
  DelayJob job;
  job.field.covariance = [all, channels](double samples, std::span<const Complex> sums) {
    Values values = all(samples, sums);
    values.resize(channels);
    return values;
  };
  job.covariance = [all, channels](double samples, std::span<const Complex> sums) {
    const Values values = all(samples, sums);
    return Values(values.begin() + static_cast<std::ptrdiff_t>(channels), values.end());
  };
  job.correlation = [all, channels](double samples, std::span<const Complex> sums) {
    const Values values = all(samples, sums);
    Values correlation;
    for (std::size_t i = channels; i < values.size(); ++i) {
      const double intensity = values[i % channels].real();
      correlation.push_back(intensity > 0 ? values[i] / intensity : 0);
    }
    return correlation;
  };
  if (has_coherent_field(scene))
    job.field.mean = [field = coherent_field(scene)](double, std::span<const Complex>) {
      return field;
    };
  job.field.batches.size = (1 + delays.size()) * channels;
  job.field.batches.samples_per_batch = static_cast<double>(plan.paths_per_batch);
  job.field.batches.run =
      tallied_walks(scene, plan, seed, TurnTally{},
                    [delays]<typename Scattering, typename Reversed, typename Phases>(
                        const Scene& same_scene, const Scattering& scattering, Reversed, Phases,
                        std::span<Complex> sums) {
                      return DelayScorer<Scattering, Reversed::value, Phases::value>(
                          same_scene, scattering, delays, sums);
                    });
  job.field.batches.relative_error = [all](const GroupedSums& sums) {
    return relative_error(jackknife(sums, all));
  };
  return job;
}

DelayEstimates delay_estimates(const DelayJob& job, const GroupedSums& sums) {
  return {jackknife(sums, job.covariance), jackknife(sums, job.correlation)};
}

const DatasetTable delays_table{"delays",
                                {{"delay", Data::scale, "", "1", "k^2 D tau"},
                                 {"covariance", Data::estimate, "delay LIGHT VIEW", "COVARIANCE",
                                  "covariance of the field with itself after a delay"},
                                 {"field_correlation", Data::estimate, "delay LIGHT VIEW", "1",
                                  "field correlation after a delay"},
                                 {"diffusion_theory", Data::real, "delay", "1",
                                  "field correlation of transmitted light in diffusion theory"}}};

void write_delays(ResultFile& file, const Scene& scene, const std::vector<double>& delays,
                  const DelayEstimates& found) {
  const ResultGroup root(file, delays_table);
  root.put("delay", delays);
  root.put("covariance", found.covariance);
  root.put("field_correlation", found.correlation);
  if (scene.domain.kind != Domain::Kind::slab || !scene.request.transmission_only()) return;
  root.put("diffusion_theory", column(delays, [&](double delay) {
             return diffusion_delay_correlation(scene.medium, scene.domain.depth, delay);
           }));
}

double diffusion_delay_correlation(const BulkMedium& medium, double thickness, double delay) {
  // kappa^2 = 2 mu_a / l*, and what adds to it acts like the square of a tilt's wavenumber
  const double loss = 2 * delay * (1 - medium.g) * medium.mu_s;
  const double q = std::sqrt(2 * loss / medium.transport_mean_free_path());
  return diffusion_field_correlation(medium, thickness, q);
}

}  // namespace flatspeckle::mc
