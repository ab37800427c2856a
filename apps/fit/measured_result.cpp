#include <algorithm>
#include <functional>
#include <optional>
#include <set>
#include <sstream>

#include "apps/command/command_line.h"
#include "apps/fit/measurement_file.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "core/result/run_state_file.h"
#include "mc/fit/task/curve_values.h"
#include "mc/fit/task/measurement.h"
#include "mc/jobs/flux_job.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::apps {

namespace {

using Eigen::Index;
using mc::Curve;
using mc::Observable;

/// Keys that describe the arrangement of a measurement (domain, lights, views ...), not the medium.
const std::set<std::string> arrangement = {
    "wavelength",   "domain",       "width",         "depth",          "dimension",
    "light_angles", "near_sources", "beam_waist",    "beam_depth",     "view_angles",
    "covariance",   "tilts",        "shifts",        "beam_positions", "pairs",
    "near_sensors", "medium_index", "outside_index", "polarisation",
};

/// Values of an observable in a result file, with their errors and the variable (tilt, delay ...)
/// over which they are given.
struct Observed {
  Observable observable;
  std::vector<double> values, errors, abscissa;
  bool of_times = false;  ///< true if `abscissa` contains delays or exposures

  /// Returns the tilt, delay or exposure of the value with this index. If `abscissa` contains
  /// times, the values are ordered [time][light][view].
  double place(std::size_t entry) const {
    return of_times ? abscissa[entry / (values.size() / abscissa.size())]
                    : abscissa[entry % abscissa.size()];
  }
};

struct Contents {
  std::string config;
  bool numerical = false, of_placements = false, fixed_count = false, flows = false;
  double beta = 1;
  std::vector<Observed> observed;
  std::vector<double> delays;  ///< delays of the covariances in `entries`
  /// Covariance entries of the request. If there are delays: first the intensities, then the
  /// covariances after each delay.
  std::vector<Complex> entries;
  std::optional<GroupedSums> sums;
};

Observed observed(const ResultReader& file, Observable observable, const std::string& axis) {
  const std::string& name = mc::observable_words[static_cast<std::size_t>(observable)];
  Observed found{observable, file.dataset<double>(name), {}, file.dataset<double>(axis)};
  if (!file.has(name + "_error"))
    throw InputError("measurement", file.path().string(), "has no " + name + "_error");
  found.errors = file.dataset<double>(name + "_error");
  const std::size_t size = found.values.size();
  found.of_times = axis == "delay" || axis == "exposure";
  const bool of_views = found.of_times || observable == Observable::intensity;
  const bool fits = of_views ? size % found.abscissa.size() == 0 : size == found.abscissa.size();
  if (!fits || found.errors.size() != size)
    throw InputError("measurement", file.path().string(),
                     name + " has " + std::to_string(size) + " values for " +
                         std::to_string(found.abscissa.size()) + " values of " + axis +
                         ": must be the result for one medium, not for a sweep");
  return found;
}

/// Returns the sums over samples that a run has stored in its result; nullopt if the file does not
/// contain them.
std::optional<GroupedSums> sums_of(const ResultReader& file) {
  const std::string group = "state/run";
  if (!file.has(group)) return std::nullopt;
  const auto shape = file.shape(group + "/group_sums");
  if (shape.size() != 2) return std::nullopt;
  return read_state(file, group, shape[1]).sums;
}

/// Returns the covariance entries of a result file, in the order of its CovarianceRequest.
std::vector<Complex> entries_of(const ResultReader& file, Observable observable) {
  if (observable == Observable::intensity) {
    const auto values = file.dataset<double>("intensity");
    return {values.begin(), values.end()};
  }
  std::vector<Complex> entries;
  if (!file.has("reference_intensity")) return entries;
  entries = file.dataset<Complex>("covariance");
  for (const char* name : {"reference_intensity", "tilted_intensity"})
    for (const double value : file.dataset<double>(name)) entries.emplace_back(value);
  return entries;
}

/// Reads the covariances over delays of a result file, from which speckle contrasts can also be
/// computed.
void read_delays(const ResultReader& file, Contents& contents) {
  contents.delays = file.dataset<double>("delay");
  contents.flows = file.has("complex_covariance");
  if (file.has("squared_contrast"))
    contents.beta = file.attribute<double>("squared_contrast", "beta");
  for (const double value : file.dataset<double>("intensity")) contents.entries.emplace_back(value);
  if (contents.flows)
    for (const Complex value : file.dataset<Complex>("complex_covariance"))
      contents.entries.push_back(value);
  else
    for (const double value : file.dataset<double>("covariance"))
      contents.entries.emplace_back(value);
}

Contents contents_of(const ResultReader& file) {
  Contents found;
  found.config = file.attribute<std::string>("/", "config");
  found.of_placements = found.config.find("method = \"wave\"") != std::string::npos;
  const bool points = found.config.find("scatterer = \"point\"") != std::string::npos;
  found.fixed_count =
      found.of_placements && (!points || found.config.find("\ncount = ") != std::string::npos);
  found.numerical = file.has_attribute("/", "errors");
  if (file.has("exposure"))
    found.observed.push_back(observed(file, Observable::squared_contrast, "exposure"));
  else if (file.has("field_correlation"))
    found.observed.push_back(
        observed(file, Observable::field_correlation, file.has("delay") ? "delay" : "tilt"));
  if (!file.has("delay") && file.has("intensity") && file.has("view_angle") &&
      file.has("light_angle"))
    found.observed.push_back(observed(file, Observable::intensity, "view_angle"));
  if (file.has("reflectance")) {
    found.observed.push_back(observed(file, Observable::reflectance, "light_angle"));
    found.observed.push_back(observed(file, Observable::transmittance, "light_angle"));
  }
  if (file.has("distance_reflectance"))
    throw InputError("measurement", file.path().string(),
                     "has numerical errors instead of measurement errors: give a table with the "
                     "columns distance, reflectance and error");
  if (found.observed.empty())
    throw InputError("measurement", file.path().string(),
                     "must contain field_correlation over tilts or delays, squared_contrast, "
                     "intensity of far views, or reflectance and transmittance");
  const Observed& first = found.observed.front();
  if (first.of_times)
    read_delays(file, found);
  else if (first.observable <= Observable::intensity)
    found.entries = entries_of(file, first.observable);
  found.sums = sums_of(file);
  return found;
}

/// Returns the lines of a scene file whose keys describe the arrangement of the measurement, not
/// the medium.
std::string arrangement_of(const std::string& config) {
  std::istringstream lines(config);
  std::string kept, line;
  while (std::getline(lines, line))
    if (arrangement.contains(line.substr(0, line.find(" = ")))) kept += line + '\n';
  return kept;
}

/// Throws InputError if the user has given the fit a key of the arrangement with another value than
/// in the measurement.
void check_same(const std::string& path, const Keys& fit_keys, const Keys& there) {
  for (const Key& row : there.rows()) {
    if (!arrangement.contains(row.name())) continue;
    const Key* const here = fit_keys.find(row.name());
    if (here != nullptr && here->given() && here->value() != row.value())
      throw InputError(row.name(), here->shown(),
                       path + " has " + row.shown() + ": leave the key out");
  }
}

/// Returns the scene that the fit models: its medium, with domain, lights, views ... of the
/// measurement.
mc::MovingSpec arranged(const std::string& path, const std::string& config, const Keys& fit_keys,
                        const mc::MovingSpec& medium) {
  Subcommand there("measurement", "");
  SceneSpec measured;
  add_keys(there.keys(), measured);
  there.parse_config(arrangement_of(config));
  check_same(path, fit_keys, there.keys());
  Keyed<mc::MovingSpec> keyed(medium);
  for (const Key& row : there.keys().rows())
    if (arrangement.contains(row.name()) && row.given()) keyed.keys.set(row.name(), row.value());
  keyed.values.domain = measured.domain;
  keyed.values.dimension = measured.dimension;
  return keyed.values;
}

/// Sets beta, the squared speckle contrast of static scatterers, to its value in the measurement.
/// Throws InputError if the user has given the fit another value.
void take_beta(const std::string& path, const Contents& there, const Keys& fit_keys,
               mc::MovingSpec& scene) {
  if (there.delays.empty()) return;
  const Key* const here = fit_keys.find("beta");
  if (here != nullptr && here->given() && scene.beta != there.beta)
    throw InputError("beta", here->shown(), path + " has " + number_text(there.beta));
  scene.beta = there.beta;
}

/// Whether the value with this index contains information; a correlation at tilt or delay 0 does
/// not, because it is always 1.
bool is_informative(const Observed& of, std::size_t entry) {
  return of.observable != Observable::field_correlation || of.place(entry) != 0;
}

/// Returns the estimator of the covariance entries from the sums over paths. The entries also have
/// a part that the run has computed in closed form; it is the difference between the stored entries
/// and the mean of the sums, and is added as a constant.
Estimator path_covariance(const Contents& there) {
  auto closed = sample_mean(there.sums->total_samples(), there.sums->total());
  closed.resize(there.entries.size());
  for (std::size_t e = 0; e < closed.size(); ++e) closed[e] = there.entries[e] - closed[e];
  return [closed](double samples, std::span<const Complex> sums) {
    auto entries = sample_mean(samples, sums.first(closed.size()));
    for (std::size_t e = 0; e < closed.size(); ++e) entries[e] += closed[e];
    return entries;
  };
}

/// Returns the estimator of one flux fraction for each light. share: index of the fraction among
/// the sums of a light, such as mc::reflected.
Estimator power(std::size_t lights, std::size_t per_light, std::size_t share) {
  return [=](double samples, std::span<const Complex> sums) {
    std::vector<Complex> shares;
    for (std::size_t light = 0; light < lights; ++light)
      shares.push_back(sums[light * per_light + share] / samples);
    return shares;
  };
}

/// Returns the estimator that computes the values of a curve from the stored sums.
Estimator estimator_of(const Contents& there, const Curve& curve) {
  if (mc::is_flux(curve.observable)) {
    const std::size_t lights = curve.scene.light_angles.size();
    const Estimator shares =
        power(lights, there.sums->size() / lights,
              curve.observable == Observable::reflectance ? mc::reflected : mc::transmitted);
    return shares;
  }
  const CovarianceRequest request = make_request(curve.scene);
  const Estimator covariance = there.of_placements
                                   ? std::bind_front(wave::placement_covariance, request)
                                   : path_covariance(there);
  return [=](double samples, std::span<const Complex> sums) {
    std::vector<Complex> values;
    for (const double value : mc::observed(curve, there.beta, request, covariance(samples, sums)))
      values.emplace_back(value);
    return values;
  };
}

/// Returns the covariance matrix of the errors of all measured values, by the jackknife over the
/// stored sums; empty if the file does not contain the sums needed.
Eigen::MatrixXd errors_of(const Contents& there, const std::vector<Curve>& curves) {
  const bool of_paths = !mc::is_flux(curves.front().observable);
  if (!there.sums ||
      (of_paths && (there.entries.empty() || there.sums->size() < there.entries.size())))
    return {};
  std::vector<Estimator> each;
  for (const Curve& curve : curves) each.push_back(estimator_of(there, curve));
  return mc::correlated_errors(*there.sums, [&](double samples, std::span<const Complex> sums) {
    std::vector<Complex> values;
    for (const Estimator& curve : each) {
      const auto own = curve(samples, sums);
      values.insert(values.end(), own.begin(), own.end());
    }
    return values;
  });
}

/// Throws InputError if values or errors are so large or small that their squares or ratios would
/// overflow.
void check_sizes(const mc::Measurement& measurement) {
  constexpr double most = 1e50;
  const auto is_fit = [](double variance) {
    return !(variance > 0) || (variance >= 1 / (most * most) && variance <= most * most);
  };
  const Eigen::VectorXd variances = measurement.covariance.diagonal();
  if (!(measurement.values.array().abs() <= most).all() || !std::ranges::all_of(variances, is_fit))
    throw InputError("measurement", measurement.name,
                     "must have values of at most 1e50 and errors from 1e-50 to 1e50");
}

}  // namespace

Eigen::MatrixXd independent_errors(const std::string& path, const std::vector<double>& errors) {
  Eigen::VectorXd variances(static_cast<Index>(errors.size()));
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!(errors[i] > 0))
      throw InputError("measurement", path,
                       "the error of value " + std::to_string(i + 1) + " must be positive");
    variances[static_cast<Index>(i)] = errors[i] * errors[i];
  }
  return variances.asDiagonal();
}

/// Reads a result of the subcommand `field`, in which each tilt is a light angle of its own.
/// Returns nullopt for results of other subcommands.
std::optional<mc::Measurement> drawn_fields(const std::string& path, const Keys& fit_keys,
                                            const mc::MovingSpec& medium) {
  const ResultReader file(path);
  if (!file.has("realization") || !file.has("field")) return std::nullopt;
  mc::MovingSpec scene =
      arranged(path, file.attribute<std::string>("/", "config"), fit_keys, medium);
  scene.tilts.clear();
  scene.light_angles = file.dataset<double>("light_angle");
  if (!file.has("view_angle"))
    throw InputError("measurement", path,
                     "must have fields in far-field views (view_angle), not at near sensors");
  return measurement_of_drawn_fields(path, scene, file.dataset<Complex>("field"));
}

mc::Measurement measurement_of_result(const std::string& path, const Keys& fit_keys,
                                      const mc::MovingSpec& medium) {
  if (auto fields = guarded_read(path, [&] { return drawn_fields(path, fit_keys, medium); }))
    return *fields;
  const Contents there = guarded_read(path, [&] { return contents_of(ResultReader(path)); });
  if (there.numerical)
    throw InputError("measurement", path,
                     "has numerical errors instead of measurement errors: compute it with --method "
                     "mc, or give a table with errors");
  mc::MovingSpec scene = arranged(path, there.config, fit_keys, medium);
  take_beta(path, there, fit_keys, scene);
  mc::Measurement found;
  found.name = path;
  found.by_paths = !there.of_placements;
  std::vector<double> values, errors;
  for (const Observed& of : there.observed) {
    Curve curve{scene, of.observable, {}, {}};
    if (of.of_times) {
      curve.times = of.abscissa;
      curve.delays = there.delays;
    } else if (of.observable == Observable::field_correlation) {
      curve.scene.covariance = "memory_effect";
    }
    curve.flows = there.flows;
    curve.fixed_count = there.fixed_count;
    for (std::size_t entry = 0; entry < of.values.size(); ++entry) {
      if (!is_informative(of, entry)) continue;
      curve.entries.push_back(entry);
      curve.abscissa.push_back(of.place(entry));
      values.push_back(of.values[entry]);
      errors.push_back(of.errors[entry]);
    }
    found.curves.push_back(std::move(curve));
  }
  found.values = Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Index>(values.size()));
  found.covariance = independent_errors(path, errors);
  if (const Eigen::MatrixXd known = errors_of(there, found.curves); known.size() > 0)
    found.covariance = known, found.shrinkage = mc::shrinkage_of(*there.sums);
  else
    found.guessed_independent = true;
  return found;
}

mc::Measurement read_measurement(const std::string& path, const Keys& fit_keys,
                                 const mc::MovingSpec& medium,
                                 const mc::DetectorValues& detectors) {
  mc::Measurement found = path.ends_with(".h5")
                              ? measurement_of_result(path, fit_keys, medium)
                              : measurement_of_table(path, fit_keys, medium, detectors);
  check_sizes(found);
  return found;
}

}  // namespace flatspeckle::apps
