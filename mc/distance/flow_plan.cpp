#include "mc/distance/flow_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>

#include "core/result/result_group.h"
#include "mc/jobs/decay_curve.h"
#include "mc/theory/detector_noise.h"

namespace flatspeckle::mc {

namespace {

/// |g1|^2 of the light at a detector, beyond the last delay continued as an exponential.
class LightDecay {
 public:
  LightDecay(const std::vector<double>& delays, const std::vector<double>& squares)
      : curve_(delays, squares), last_(curve_.last()) {
    const double half = last_ / 2;
    rate_ = std::max(0.0, std::log(curve_(half) / curve_(last_)) / half);
    for (const double delay : delays)
      if (delay > 0) {
        shortest_ = delay;
        break;
      }
  }

  double operator()(double delay) const {
    return delay <= last_ ? curve_(delay) : curve_(last_) * std::exp(-rate_ * (delay - last_));
  }
  double shortest() const { return shortest_; }
  /// Returns the delay after which the light has lost its correlation, at most 1000 times the last.
  double longest() const {
    constexpr double least = 1e-5, most = 1000;
    double longest = last_;
    while ((*this)(longest) > least && longest < most * last_) longest *= 1.5;
    return longest;
  }

 private:
  DecayCurve curve_;
  double last_, rate_, shortest_ = 0;
};

/// Normal equations of least squares for the relative flow of the chosen layers and of all others,
/// and the covariance of their right-hand sides.
struct FlowEquations {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero(), noise = normal;

  void add(const FlowEquations& more) {
    normal += more.normal;
    noise += more.noise;
  }
  /// Returns the relative change of the estimate for a relative change of 1 of the flow of the
  /// other layers, which is known to this relative error.
  double crosstalk(double other_error) const {
    if (!(normal(0, 0) > 0)) return 0;
    if (normal(1, 1) == 0 || other_error == 0) return normal(0, 1) / normal(0, 0);
    const double known = 1 / (other_error * other_error), found = determinant(known);
    return found > 0 ? known * normal(0, 1) / found : 0;
  }
  /// Returns flow / standard error, if the flow of the other layers is known to this relative
  /// error.
  double ratio(double other_error) const {
    if (!(normal(0, 0) > 0)) return 0;
    if (normal(1, 1) == 0 || other_error == 0) return normal(0, 0) / std::sqrt(noise(0, 0));
    const double known = 1 / (other_error * other_error), found = determinant(known);
    if (!(found > 0)) return 0;
    const Eigen::RowVector2d row(normal(1, 1) + known, -normal(0, 1));
    const double variance =
        (row * noise * row.transpose()).value() + known * normal(0, 1) * normal(0, 1);
    return found / std::sqrt(variance);
  }
  /// Returns the same if it is not known at all.
  double separated() const { return ratio(std::numeric_limits<double>::infinity()); }

 private:
  /// Returns the determinant of the equations, to which the flow of the other layers adds `known`;
  /// 0 if only rounding errors are left.
  double determinant(double known) const {
    constexpr double least = 1e-13;
    const double product = normal(0, 0) * (normal(1, 1) + known),
                 difference = product - normal(0, 1) * normal(0, 1);
    return difference > least * product ? difference : 0;
  }
};

/// Light at one detector: its decay, and the relative change of |g1|^2 at each delay by a relative
/// change of the flow of the chosen layers, and of all others.
struct DetectedLight {
  std::vector<double> squares, relative[2];

  DetectedLight(const Instrument& instrument, const DistanceEstimates& found, std::size_t delays,
                std::size_t detectors, std::size_t detector) {
    constexpr double least = 1e-100;
    for (std::size_t t = 0; t < delays; ++t) {
      const double g1 = found.correlation.value[t * detectors + detector].real();
      squares.push_back(g1 * g1);
      double change[2] = {0, 0};
      for (std::size_t layer = 0; layer < instrument.flow.size(); ++layer) {
        const std::size_t part =
            layer * layer_coefficients + static_cast<std::size_t>(LayerCoefficient::diffusion);
        const double derivative =
            found.correlation_gradient.value[(part * delays + t) * detectors + detector].real();
        change[0] += derivative * instrument.flow[layer];
        change[1] += derivative * instrument.others[layer];
      }
      for (int p : {0, 1}) relative[p].push_back(squares.back() > least ? 2 * change[p] / g1 : 0);
    }
  }

  /// Returns the derivative of K^2 / beta by a relative change of flow.
  double contrast_change(int parameter, const std::vector<double>& delays, double time) const {
    constexpr double step = 1e-3;
    const auto changed = [&](double by) {
      std::vector<double> values = squares;
      for (std::size_t t = 0; t < values.size(); ++t)
        values[t] *= std::exp(by * relative[parameter][t]);
      return exposed(delays, values, time);
    };
    return (changed(step) - changed(-step)) / (2 * step);
  }
};

/// Returns the widths of bins of delays that adjoin.
std::vector<double> bins_of(const std::vector<double>& delays) {
  std::vector<double> widths;
  const std::size_t last = delays.size() - 1;
  for (std::size_t t = 0; t <= last; ++t) {
    const double above = t < last ? delays[t + 1] - delays[t] : delays[t] - delays[t - 1],
                 below = t > 0 ? delays[t] - delays[t - 1] : std::min(above, 2 * delays[t]);
    widths.push_back((below + above) / 2);
  }
  return widths;
}

/// Adds K^2 of one detector for one exposure to the plan; returns its equations.
FlowEquations add_contrast(FlowPlan& plan, const Instrument& instrument,
                           const DistanceRequest& request, const DetectedLight& light,
                           const LightDecay& decay, double time) {
  const auto& delays = request.dynamics.delays;
  const double beta = request.dynamics.exposure.beta, photons = plan.rate.back() * time,
               unit = exposed(delays, light.squares, time),
               frames = instrument.averaging_time / time,
               squares = instrument.squares * successive_exposures(decay, time, unit, frames);
  const double variance =
      contrast_variance({photons, beta * unit, instrument.read_noise, squares}) /
      (instrument.count * frames);
  FlowEquations equations;
  const Eigen::Vector2d derivative(beta * light.contrast_change(0, delays, time),
                                   beta * light.contrast_change(1, delays, time));
  equations.normal = equations.noise = derivative * derivative.transpose() / variance;
  plan.photons.push_back(photons);
  plan.bias.push_back(noise_variance({photons, instrument.read_noise}));
  plan.deviation.push_back(std::sqrt(variance));
  plan.contrast_ratio.push_back(equations.ratio(instrument.other_flow_error));
  plan.contrast_crosstalk.push_back(equations.crosstalk(instrument.other_flow_error));
  return equations;
}

/// Adds g2 of one detector to the plan; returns its equations.
FlowEquations add_correlation(FlowPlan& plan, const Instrument& instrument,
                              const DistanceRequest& request, const DetectedLight& light,
                              const LightDecay& decay) {
  const auto& delays = request.dynamics.delays;
  const auto count = static_cast<Eigen::Index>(delays.size());
  const double beta = request.dynamics.exposure.beta,
               averaged = instrument.averaging_time * instrument.count;
  const CorrelationNoise noise(
      plan.rate.back(), beta, [&](double delay) { return std::sqrt(decay(delay)); },
      decay.shortest(), decay.longest());
  const auto bins = bins_of(delays);
  Eigen::MatrixXd covariance(count, count), weighted(count, 2), derivative(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto t = static_cast<std::size_t>(i);
    for (Eigen::Index j = 0; j <= i; ++j)
      covariance(i, j) = covariance(j, i) =
          noise.covariance(delays[t], delays[static_cast<std::size_t>(j)]) / averaged;
    covariance(i, i) += noise.pair_noise(delays[t], bins[t]) / averaged;
    plan.correlation_deviation.push_back(std::sqrt(covariance(i, i)));
    for (int p : {0, 1}) derivative(i, p) = beta * light.squares[t] * light.relative[p][t];
    weighted.row(i) = derivative.row(i) / covariance(i, i);
  }
  FlowEquations equations;
  equations.normal = derivative.transpose() * weighted;
  equations.noise = weighted.transpose() * covariance * weighted;
  plan.correlation_ratio.push_back(equations.ratio(instrument.other_flow_error));
  plan.correlation_crosstalk.push_back(equations.crosstalk(instrument.other_flow_error));
  return equations;
}

/// Returns values [column][row] as [row][column].
std::vector<double> by_row(const std::vector<double>& values, std::size_t columns) {
  std::vector<double> turned(values.size());
  const std::size_t rows = values.size() / columns;
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t r = 0; r < rows; ++r) turned[r * columns + c] = values[c * rows + r];
  return turned;
}

}  // namespace

FlowPlan flow_plan(const Instrument& instrument, const DistanceRequest& request,
                   const DistanceEstimates& found) {
  const auto& delays = request.dynamics.delays;
  const auto& times = request.dynamics.exposure.times;
  const std::size_t detectors = request.detectors.size();
  FlowPlan plan;
  std::vector<FlowEquations> by_exposure(times.size());
  FlowEquations correlation;
  for (std::size_t d = 0; d < detectors; ++d) {
    const double collected = instrument.modes / (instrument.density * request.detectors[d].area());
    plan.rate.push_back(instrument.photons * collected * found.power.value[d].real());
    const DetectedLight light(instrument, found, delays.size(), detectors, d);
    const LightDecay decay(delays, light.squares);
    for (std::size_t e = 0; e < times.size(); ++e)
      by_exposure[e].add(add_contrast(plan, instrument, request, light, decay, times[e]));
    correlation.add(add_correlation(plan, instrument, request, light, decay));
  }
  for (auto* values : {&plan.photons, &plan.bias, &plan.deviation, &plan.contrast_ratio,
                       &plan.contrast_crosstalk, &plan.correlation_deviation})
    *values = by_row(*values, detectors);
  plan.contrast_separated = column(by_exposure, &FlowEquations::separated);
  plan.correlation_separated = correlation.separated();
  return plan;
}

const DatasetTable flow_table{
    "instruments at a distance",
    {{"detector_rate", Data::real, "distance", "1/s",
      "detected photons per second of a pixel or fibre"},
     {"pixel_photons", Data::real, "exposure distance", "1",
      "detected photons per pixel and exposure"},
     {"contrast_noise", Data::real, "exposure distance", "1",
      "bias of K^2 by shot noise and read noise, which is subtracted"},
     {"contrast_deviation", Data::real, "exposure distance", "1",
      "standard error of K^2 after the averaging time"},
     {"contrast_flow_ratio", Data::real, "exposure distance", "1",
      "flow divided by its standard error, from K^2 at one distance, with the flow of other layers "
      "known to other_flow_error"},
     {"contrast_flow_crosstalk", Data::real, "exposure distance", "1",
      "relative change of the flow from K^2 per relative change of the flow of other layers"},
     {"contrast_separated_ratio", Data::real, "exposure", "1",
      "flow divided by its standard error, from K^2 at all distances, with the flow of other "
      "layers unknown"},
     {"correlation_deviation", Data::real, "delay distance", "1",
      "standard error of g2 after the averaging time"},
     {"correlation_flow_ratio", Data::real, "distance", "1",
      "flow divided by its standard error, from g2 at one distance, with the flow of other layers "
      "known to other_flow_error"},
     {"correlation_flow_crosstalk", Data::real, "distance", "1",
      "relative change of the flow from g2 per relative change of the flow of other layers"},
     {"correlation_separated_ratio", Data::real, "", "1",
      "flow divided by its standard error, from g2 at all distances, with the flow of other "
      "layers unknown"}},
    {{"detector_rate", "beta", "float64", "coherence factor of a pixel or fibre"},
     {"detector_rate", "averaging_time", "float64", "averaging time in s"},
     {"detector_rate", "count", "float64", "number of pixels or fibres at each distance"}}};

void write_flow(ResultFile& file, const Instrument& instrument, const DistanceRequest& request,
                const FlowPlan& plan) {
  const ResultGroup root(file, flow_table);
  root.put("detector_rate", plan.rate);
  root.attribute("detector_rate", "beta", request.dynamics.exposure.beta);
  root.attribute("detector_rate", "averaging_time", instrument.averaging_time);
  root.attribute("detector_rate", "count", instrument.count);
  if (!plan.photons.empty()) {
    root.put("pixel_photons", plan.photons);
    root.put("contrast_noise", plan.bias);
    root.put("contrast_deviation", plan.deviation);
    root.put("contrast_flow_ratio", plan.contrast_ratio);
    root.put("contrast_flow_crosstalk", plan.contrast_crosstalk);
    root.put("contrast_separated_ratio", plan.contrast_separated);
  }
  root.put("correlation_deviation", plan.correlation_deviation);
  root.put("correlation_flow_ratio", plan.correlation_ratio);
  root.put("correlation_flow_crosstalk", plan.correlation_crosstalk);
  root.put("correlation_separated_ratio", plan.correlation_separated);
}

}  // namespace flatspeckle::mc
