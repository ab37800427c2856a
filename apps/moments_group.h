#pragma once

#include <string>
#include <vector>

#include "apps/moments_output.h"
#include "core/numbers/statistics.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::apps {

inline std::vector<double> real_parts(const std::vector<Complex>& values) {
  std::vector<double> real;
  for (Complex value : values) real.push_back(value.real());
  return real;
}

using Axes = std::vector<Axis>;

/// Writes datasets of one group; each estimate with its `_error`.
class MomentsGroup {
 public:
  MomentsGroup(ResultFile& file, const std::string& name, const Scene& scene)
      : file_(file),
        prefix_(name.empty() ? "" : name + "/"),
        covariance_units_(covariance_units(scene)) {
    if (covariance_units_ == "length") field_units_ = "length^(1/2)";
  }

  template <typename Number>
  void write(const std::string& name, const std::vector<Number>& values,
             const std::vector<double>& errors, const Axes& axes, const std::string& units,
             const std::string& long_name) {
    file_.dataset(prefix_ + name, values, axes, units, long_name);
    file_.dataset(prefix_ + name + "_error", errors, axes, units, "standard error: " + long_name);
  }
  /// What has no error: theory.
  void write(const std::string& name, const std::vector<double>& values, const Axes& axes,
             const std::string& units, const std::string& long_name) {
    file_.dataset(prefix_ + name, values, axes, units, long_name);
  }
  void covariance(const std::string& name, const Estimate& estimate, const Axes& axes,
                  const std::string& long_name) {
    write(name, estimate.value, estimate.error, axes, covariance_units_, long_name);
  }
  void intensity(const std::string& name, const Estimate& estimate, const Axes& axes,
                 const std::string& long_name) {
    write(name, real_parts(estimate.value), estimate.error, axes, covariance_units_, long_name);
  }
  void mean_field(const Estimate& estimate, const Axes& axes, const std::string& long_name) {
    write("mean_field", estimate.value, estimate.error, axes, field_units_, long_name);
  }
  /// "" or the group's name and a slash.
  const std::string& prefix() const { return prefix_; }
  void attribute(const std::string& name, const std::string& key, const Attribute& value) {
    file_.attribute(prefix_ + name, key, value);
  }

 private:
  ResultFile& file_;
  std::string prefix_, covariance_units_, field_units_ = "1";
};

}  // namespace flatspeckle::apps
