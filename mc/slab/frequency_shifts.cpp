#include "mc/slab/frequency_shifts.h"

#include <cmath>

#include "core/error.h"
#include "core/result/result_group.h"
#include "mc/transport/chains.h"

namespace flatspeckle::mc {

void check_frequency_shifts(const Scene& slab, const std::vector<double>& shifts) {
  const CovarianceRequest& request = slab.request;
  if (has_near_ends(request)) throw InputError("frequency_shifts: needs plane waves and far views");
  for (const double shift : shifts) {
    if (!(std::abs(shift) <= 0.1))
      throw InputError("frequency_shifts", shift, "must be from -0.1 to 0.1");
    for (const Entry& entry : request.entries)
      if (!std::isfinite(matched_view(request, entry, shift)))
        throw InputError("frequency_shifts", shift, "takes the matched view past the horizon");
  }
}

const DatasetTable frequency_table{
    "frequency shifts",
    {{"frequency_shift", Data::scale, "", "1", "of the second field, relative"},
     {"frequency_covariance", Data::complex_estimate, "frequency_shift LIGHT VIEW", "COVARIANCE",
      "covariance of the field with that at the shifted frequency"},
     {"frequency_correlation", Data::complex_estimate, "frequency_shift LIGHT VIEW", "1",
      "the same over the intensity"},
     {"frequency_tilt_covariance", Data::complex_estimate, "frequency_shift tilt VIEW",
      "COVARIANCE", "covariance of the reference with the moved field at the shifted frequency"},
     {"frequency_tilt_correlation", Data::estimate, "frequency_shift tilt", "1",
      "C_E of the reference and the moved field at the shifted frequency"}}};

void write_frequency_shifts(ResultFile& file, const CovarianceRequest& request,
                            const std::vector<double>& shifts, const ChangeEstimates& found) {
  const ResultGroup root(file, frequency_table);
  const std::string name = request.has_reference() ? "frequency_tilt_" : "frequency_";
  root.put("frequency_shift", shifts);
  root.put(name + "covariance", found.covariance);
  root.put(name + "correlation", found.correlation);
}

}  // namespace flatspeckle::mc
