#include "bench/error/error_measure.h"

#include <algorithm>
#include <cmath>

#include <omp.h>

#include "bench/error/error_modules.h"
#include "bench/measure/power_fit.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::bench {

namespace {

struct Schedule {
  std::size_t runs;
  std::uint64_t first;  ///< number of batches at the first point
  std::size_t points;
};

/// Errors of one run: at each point the mean squared error, divided by the mean square of the
/// reference; and the CPU time of the run.
struct RunErrors {
  std::vector<double> square;
  double seconds = 0;
};

double mean_square(const std::vector<Complex>& values) {
  double sum = 0;
  for (const Complex& value : values) sum += std::norm(value);
  return sum / static_cast<double>(values.size());
}

double relative_square(const std::vector<Complex>& values, const ErrorReference& reference) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += std::norm(values[i] - reference.value[i]);
  return sum / static_cast<double>(values.size()) / mean_square(reference.value);
}

RunErrors run_once(const ErrorMethod& method, const ErrorReference& reference, std::uint64_t seed,
                   std::uint64_t first, std::size_t points) {
  const ErrorTrial trial = method.trial(seed);
  std::vector<Complex> sums(trial.batches.size), batch(trial.batches.size);
  RunErrors errors;
  std::uint64_t next = first;
  for (std::uint64_t number = 0; errors.square.size() < points; ++number) {
    const double start = thread_cpu_seconds();
    std::fill(batch.begin(), batch.end(), 0);
    trial.batches.run(number, batch);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += batch[i];
    errors.seconds += thread_cpu_seconds() - start;
    if (number + 1 < next) continue;
    next *= 2;
    const double samples = static_cast<double>(number + 1) * trial.batches.samples_per_batch;
    errors.square.push_back(relative_square(trial.values(samples, sums), reference));
  }
  return errors;
}

/// Chooses how many runs to make in the given time, and how often the number of batches is doubled.
/// Both are large if the time permits; otherwise there are fewer runs, so that enough points remain
/// to fit a slope. If more than `most` doublings fit, the first points are omitted.
Schedule schedule(const ErrorMethod& method, const ErrorReference& reference, double cpu_seconds) {
  constexpr double many_runs = 64, few_runs = 16, fewest_runs = 4;
  constexpr double enough = 5, few = 3, fewest = 2, most = 9;  // doublings
  const double start = thread_cpu_seconds();
  const RunErrors pilot = run_once(method, reference, 0, method.first_point, 2);
  const double setup = std::max(0.0, thread_cpu_seconds() - start - pilot.seconds);
  const double to_first = pilot.seconds / 2;
  const auto doublings = [&](double runs) {
    return std::floor(std::log2(std::max((cpu_seconds / runs - setup) / to_first, 1.0)));
  };
  double doubled = doublings(many_runs), least_runs = few_runs;
  if (doubled < enough) doubled = std::min(enough, doublings(few_runs));
  if (doubled < few) {
    doubled = fewest;
    least_runs = fewest_runs;
  }
  const double affordable = cpu_seconds / (setup + to_first * std::exp2(doubled));
  const double runs = std::clamp(std::floor(affordable), least_runs, 4 * many_runs);
  const double points = std::min(doubled, most) + 1;
  const auto left_out = static_cast<std::uint64_t>(std::exp2(doubled + 1 - points));
  return {static_cast<std::size_t>(runs), left_out * method.first_point,
          static_cast<std::size_t>(points)};
}

/// Errors summed over all runs, from which one run can be left out for the jackknife.
class SeedErrors {
 public:
  SeedErrors(std::vector<RunErrors> runs, double reference_square)
      : runs_(std::move(runs)),
        reference_square_(reference_square),
        total_(runs_.front().square.size()) {
    for (const RunErrors& run : runs_)
      for (std::size_t p = 0; p < total_.size(); ++p) total_[p] += run.square[p];
  }

  /// Returns the error over all runs, or over all but `without`.
  double error(std::size_t point, const RunErrors* without = nullptr) const {
    return std::sqrt(std::max(0.0, square(point, without) - reference_square_));
  }
  double unsubtracted(std::size_t point) const { return std::sqrt(square(point, nullptr)); }

  /// Jackknife variance of f, evaluated with each run left out.
  template <class F>
  double variance(const F& f) const {
    const auto n = static_cast<double>(runs_.size());
    double sum = 0, squares = 0;
    for (const RunErrors& run : runs_) {
      const double value = f(run);
      sum += value;
      squares += value * value;
    }
    return std::max(0.0, (squares - sum * sum / n) * (n - 1) / n);
  }

 private:
  double square(std::size_t point, const RunErrors* without) const {
    const auto n = static_cast<double>(runs_.size());
    return without ? (total_[point] - without->square[point]) / (n - 1) : total_[point] / n;
  }

  std::vector<RunErrors> runs_;
  double reference_square_;
  std::vector<double> total_;
};

/// Fits the slope, its error and the efficiency to those points whose error exceeds that of the
/// reference.
void fit(const SeedErrors& spread, ErrorCurve& curve) {
  std::vector<std::size_t> used;
  std::vector<double> time, error, whole, weight;
  for (std::size_t p = 0; p < curve.points.size(); ++p) {
    const double variance =
        spread.variance([&](const RunErrors& run) { return std::log(spread.error(p, &run)); });
    if (!(variance > 0) || !std::isfinite(variance)) continue;
    used.push_back(p);
    time.push_back(curve.points[p].cpu_s);
    error.push_back(curve.points[p].error);
    whole.push_back(spread.unsubtracted(p));
    weight.push_back(1 / variance);
  }
  if (used.size() < 2) return;
  curve.slope = fit_power(time, error, weight).exponent;
  const double variance = spread.variance([&](const RunErrors& run) {
    std::vector<double> without;
    for (const std::size_t p : used) without.push_back(spread.error(p, &run));
    return fit_power(time, without, weight).exponent;
  });
  const double of_reference = curve.slope - fit_power(time, whole, weight).exponent;
  curve.slope_error = std::hypot(std::sqrt(variance), of_reference);
  double sum = 0, weights = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    sum -= weight[i] * std::log(error[i] * error[i] * time[i]);
    weights += weight[i];
  }
  curve.efficiency = std::exp(sum / weights);
}

}  // namespace

double relative_distance(const std::vector<Complex>& values, const ErrorReference& reference) {
  return std::sqrt(relative_square(values, reference));
}

ErrorCurve measure_error(const ErrorMethod& method, const ErrorReference& reference,
                         double cpu_seconds) {
  omp_set_num_threads(1);
  const auto [runs, first, points] = schedule(method, reference, method.share * cpu_seconds);
  std::vector<RunErrors> errors;
  double seconds = 0;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    errors.push_back(run_once(method, reference, seed, first, points));
    seconds += errors.back().seconds;
  }
  const double to_last = seconds / static_cast<double>(runs);
  const double per_batch = method.trial(0).batches.samples_per_batch;
  const SeedErrors spread(std::move(errors), std::pow(reference.relative_error, 2));
  ErrorCurve curve{method.scene, method.name, reference.how, reference.relative_error, {}};
  curve.is_monte_carlo = method.is_monte_carlo;
  for (std::size_t p = 0; p < points; ++p) {
    const double batches = static_cast<double>(first) * std::exp2(p);
    const double share = std::exp2(static_cast<double>(p) - static_cast<double>(points - 1));
    const double variance =
        spread.variance([&](const RunErrors& run) { return spread.error(p, &run); });
    curve.points.push_back(
        {share * to_last, batches * per_batch, spread.error(p), std::sqrt(variance)});
  }
  fit(spread, curve);
  return curve;
}

ErrorRun run_of(const ErrorMethod& method, const std::function<ErrorReference()>& reference) {
  return {method.scene, method.name,
          [=](double cpu_seconds) { return measure_error(method, reference(), cpu_seconds); },
          method.slow};
}

void measure_points(ErrorCurve& curve, double cpu_seconds,
                    const std::function<std::optional<ErrorPoint>()>& next) {
  constexpr std::size_t fewest = 3;
  omp_set_num_threads(1);
  curve.is_monte_carlo = false;
  const double start = thread_cpu_seconds();
  while (curve.points.size() < fewest || 3 * (thread_cpu_seconds() - start) < cpu_seconds) {
    const auto point = next();
    if (!point) break;
    curve.points.push_back(*point);
    if (point->error < 2 * curve.reference_error) break;
  }
  std::vector<double> time, error;
  for (const ErrorPoint& point : curve.points) {
    time.push_back(point.cpu_s);
    error.push_back(point.error);
  }
  const PowerFit slope = fit_power(time, error);
  curve.slope = slope.exponent;
  curve.slope_error = slope.exponent_error;
  curve.efficiency = 1 / (error.back() * error.back() * time.back());
}

ErrorPoint rms_point(unsigned runs, const std::function<OneRun(unsigned seed)>& run) {
  OneRun sum{};
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const OneRun one = run(seed);
    sum.cpu_s += one.cpu_s / runs;
    sum.square += one.square / runs;
    sum.samples += one.samples / runs;
  }
  const double error = std::sqrt(sum.square);
  return {sum.cpu_s, sum.samples, error, error / std::sqrt(2.0 * runs)};
}

OneRun timed_run(double samples, const std::function<double()>& work) {
  const double start = thread_cpu_seconds();
  const double square = work();
  return {thread_cpu_seconds() - start, square, samples};
}

std::vector<ErrorRun> error_runs() {
  std::vector<ErrorRun> runs = box_error_runs();
  for (const auto& more :
       {slab_error_runs(), power_error_runs(), fit_error_runs(), search_error_runs(),
        imaging_error_runs(), render_error_runs(), design_error_runs(), lens_error_runs()})
    runs.insert(runs.end(), more.begin(), more.end());
  return runs;
}

}  // namespace flatspeckle::bench
