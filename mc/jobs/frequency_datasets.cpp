#include "mc/jobs/frequency_datasets.h"

#include <cmath>

#include "core/result/result_group.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

const DatasetTable frequency_table{
    "frequency shifts",
    {{"frequency_shift", Data::scale, "", "1", "of the second field, relative"},
     {"frequency_covariance", Data::complex_estimate, "frequency_shift LIGHT VIEW", "COVARIANCE",
      "covariance of the field with that at the shifted frequency"},
     {"frequency_correlation", Data::complex_estimate, "frequency_shift LIGHT VIEW", "1",
      "the same over the intensity"},
     {"frequency_diffusion_theory", Data::real, "frequency_shift", "1",
      "|frequency_correlation| of transmitted light in diffusion theory"},
     {"frequency_tilt_covariance", Data::complex_estimate, "frequency_shift tilt VIEW",
      "COVARIANCE", "covariance of the reference with the moved field at the shifted frequency"},
     {"frequency_tilt_correlation", Data::estimate, "frequency_shift tilt", "1",
      "C_E of the reference and the moved field at the shifted frequency"}}};

void write_shift_axis(ResultFile& file, const std::vector<double>& shifts) {
  ResultGroup(file, frequency_table).put("frequency_shift", shifts);
}

void write_frequency_shifts(ResultFile& file, const std::string& group, const Scene& scene,
                            const std::vector<double>& shifts, const ChangeEstimates& found) {
  const CovarianceRequest& request = scene.request;
  const ResultGroup results(file, frequency_table, group);
  const std::string name = request.has_reference() ? "frequency_tilt_" : "frequency_";
  results.put(name + "covariance", found.covariance);
  results.put(name + "correlation", found.correlation);
  if (request.has_reference() || scene.domain.kind != Domain::Kind::slab || scene.profile ||
      !request.transmission_only())
    return;
  results.put("frequency_diffusion_theory", column(shifts, [&](double shift) {
                return diffusion_frequency_correlation(scene, shift);
              }));
}

double diffusion_frequency_correlation(const Scene& slab, double shift) {
  const Complex absorption(0, slab.k * shift);
  const double per_loss = slab.medium.dimension / slab.medium.transport_mean_free_path();
  return std::abs(
      diffusion_loss_correlation(slab.medium, slab.domain.depth, per_loss * absorption));
}

}  // namespace flatspeckle::mc
