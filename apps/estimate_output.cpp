#include "apps/estimate_output.h"

namespace flatspeckle::apps {

void write_estimate(ResultFile& file, const std::string& name, const Estimate& estimate,
                    const std::vector<Axis>& axes, const std::string& units,
                    const std::string& long_name) {
  std::vector<double> values;
  for (const Complex value : estimate.value) values.push_back(value.real());
  file.dataset(name, values, axes, units, long_name);
  file.dataset(name + "_error", estimate.error, axes, units, "standard error: " + long_name);
}

}  // namespace flatspeckle::apps
