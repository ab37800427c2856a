#include "mc/jobs/delays.h"

#include <cmath>

#include "core/error.h"
#include "core/result/result_group.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

void check_delays(const Scene& scene, const std::vector<double>& delays) {
  if (!scene.medium.structure.independent())
    throw InputError("delays: scatterers at correlated positions do not move independently");
  for (const double delay : delays)
    if (!(delay >= 0 && delay <= 1e100))
      throw InputError("delays", delay, "must not be negative, nor above 1e100");
}

Estimate magnitude(Estimate estimate) {
  for (Complex& value : estimate.value) value = std::abs(value);
  return estimate;
}

const DatasetTable delays_table{
    "delays",
    {{"delay", Data::scale, "", "1", "k^2 D tau"},
     {"covariance", Data::estimate, "delay LIGHT VIEW", "COVARIANCE",
      "covariance of the field with itself after a delay"},
     {"field_correlation", Data::estimate, "delay LIGHT VIEW", "1",
      "field correlation after a delay, |g1|"},
     {"complex_covariance", Data::complex_estimate, "delay LIGHT VIEW", "COVARIANCE",
      "covariance of the field with itself after a delay, where scatterers flow"},
     {"complex_correlation", Data::complex_estimate, "delay LIGHT VIEW", "1",
      "field correlation after a delay, g1, where scatterers flow"},
     {"diffusion_theory", Data::real, "delay", "1",
      "field correlation of transmitted light in diffusion theory"},
     {"delayed_covariance", Data::complex_estimate, "delay tilt VIEW", "COVARIANCE",
      "covariance of reference and moved field after a delay"},
     {"delayed_correlation", Data::estimate, "delay tilt", "1",
      "C_E of reference and moved field after a delay"}}};

void write_delays(ResultFile& file, const Scene& scene, const std::vector<double>& delays,
                  const ChangeEstimates& found, const Motion& motion) {
  const ResultGroup root(file, delays_table);
  root.put("delay", delays);
  if (scene.request.has_reference()) {
    root.put("delayed_covariance", found.covariance);
    return root.put("delayed_correlation", found.correlation);
  }
  if (!motion.only_diffuses(scene)) {
    root.put("complex_covariance", found.covariance);
    root.put("complex_correlation", found.correlation);
    return root.put("field_correlation", magnitude(found.correlation));
  }
  root.put("covariance", found.covariance);
  root.put("field_correlation", found.correlation);
  if (scene.domain.kind != Domain::Kind::slab || !scene.request.transmission_only()) return;
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
