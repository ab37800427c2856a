#include "mc/fit/path_model.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "mc/estimators/directional_slope.h"
#include "mc/estimators/gradient.h"
#include "mc/fit/correlated_errors.h"
#include "mc/fit/curve_values.h"
#include "mc/fit/fit_data.h"
#include "mc/fit/fit_report.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void require_slab(const Scene& scene, Observable observable) {
  if (scene.domain.kind != Domain::Kind::slab)
    throw InputError("measurement", observable_words[static_cast<std::size_t>(observable)],
                     "of a box cannot be fitted");
}

/// Entries of all curves as one request.
Scene joint_scene(const std::vector<Scene>& scenes, const std::vector<std::size_t>& curves) {
  Scene joint = scenes[curves.front()];
  joint.request = {};
  for (const std::size_t i : curves) join(joint.request, scenes[i].request);
  return joint;
}

}  // namespace

MatrixXd SampledModel::noise() const {
  const Index size = values.size();
  MatrixXd sum = MatrixXd::Zero(size, size);
  for (const MatrixXd& run : deviations) sum += run.topRows(size) * run.topRows(size).transpose();
  return sum;
}

MatrixXd SampledModel::added_information(const MatrixXd& weight) const {
  const Index size = values.size(), parameters = slopes.cols();
  MatrixXd sum = MatrixXd::Zero(parameters, parameters);
  for (const MatrixXd& run : deviations)
    for (Index i = 0; i < parameters; ++i) {
      const MatrixXd weighted = weight * run.middleRows((1 + i) * size, size);
      for (Index j = 0; j < parameters; ++j)
        sum(i, j) += weighted.cwiseProduct(run.middleRows((1 + j) * size, size)).sum();
    }
  return sum;
}

PathModel::PathModel(const FitTask& task) : task_(task), curves_(curves_of(task)) {
  if (task.free.size() > most_slopes)
    throw InputError("free", task.free.size(),
                     "parameters: paths take at most " + std::to_string(most_slopes));
  const auto scenes = scenes_at(task, middle(task));
  for (std::size_t i = 0; i < curves_.size(); ++i) {
    first_.push_back(size_);
    size_ += static_cast<Index>(curves_[i].entries.size());
    if (is_flux(curves_[i].observable)) {
      require_slab(scenes[i], curves_[i].observable);
      power_.push_back(i);
      continue;
    }
    const auto run =
        std::ranges::find_if(runs_, [&](const Run& one) { return joins(one, scenes, i); });
    if (run == runs_.end())
      runs_.push_back({needs_reversed(scenes[i]), {i}, {scenes[i].request}, {}, {}});
    else {
      run->curves.push_back(i);
      run->requests.push_back(scenes[i].request);
    }
  }
  move(middle(task));
}

bool PathModel::joins(const Run& run, const std::vector<Scene>& scenes, std::size_t curve) const {
  const Scene &first = scenes[run.curves.front()], &scene = scenes[curve];
  return first.domain.kind == scene.domain.kind && first.domain.depth == scene.domain.depth &&
         first.domain.width == scene.domain.width && first.k == scene.k &&
         run.reversed == needs_reversed(scene);
}

void PathModel::move(const VectorXd& coordinates) {
  at_ = coordinates;
  const auto scenes = scenes_at(task_, at_);
  constexpr std::uint64_t apart = 1000003;
  std::uint64_t seed = task_.paths->seed;
  for (Run& run : runs_) begin(run, seed += apart, scenes);
}

void PathModel::begin(Run& run, std::uint64_t seed, const std::vector<Scene>& scenes) const {
  const Scene scene = joint_scene(scenes, run.curves);
  const Plan plan = gradient_plan(scene, run.reversed ? ReversedPaths::yes : ReversedPaths::no);
  run.job = slope_job(scene, plan, slopes(scene, run.curves.front()), seed);
  run.state = {};
}

/// About a place so far from the bounds that all steps are within.
std::vector<MediumSlope> PathModel::slopes(const Scene& scene, std::size_t curve) const {
  constexpr double share = 1e-4;
  const VectorXd lower = lower_coordinates(task_.free), upper = upper_coordinates(task_.free);
  std::vector<MediumSlope> found;
  for (Index i = 0; i < at_.size(); ++i) {
    const double step = share * (upper[i] - lower[i]);
    VectorXd next = at_;
    const double about = std::clamp(at_[i], lower[i] + 3 * step, upper[i] - 3 * step);
    found.push_back(
        medium_slope(task_.free[static_cast<std::size_t>(i)].key, scene, step, [&](double more) {
          next[i] = about + more;
          return scene_of(with_parameters(curves_[curve].scene, task_.free, next));
        }));
  }
  return found;
}

void PathModel::sample(double paths) {
  RunOptions options;
  options.stop.samples = static_cast<std::uint64_t>(paths);
  options.threads = task_.paths->threads;
  for (Run& run : runs_)
    if (run.state.sums.batches() == 0 || run.state.sums.total_samples() < paths)
      run_batches(run.job.field.batches, options, run.state);
}

std::vector<Complex> PathModel::curve_values(const Run& run,
                                             std::span<const Complex> entries) const {
  std::vector<Complex> all;
  std::size_t first = 0;
  for (std::size_t n = 0; n < run.curves.size(); ++n) {
    const std::size_t count = run.requests[n].entries.size();
    for (const double value :
         observed(curves_[run.curves[n]], run.requests[n], entries.subspan(first, count)))
      all.emplace_back(value);
    first += count;
  }
  return all;
}

/// Of the run's curves, then their slopes by each parameter; 0 of other curves.
std::vector<Complex> PathModel::run_values(const Run& run, double samples,
                                           std::span<const Complex> sums) const {
  const auto all = run.job.all(samples, sums);
  const std::size_t entries = run.job.entries, quantities = 1 + task_.free.size();
  const auto size = static_cast<std::size_t>(size_);
  const auto covariance = std::span(all).first(entries);
  std::vector<Complex> found(quantities * size);
  for (std::size_t q = 0; q < quantities; ++q) {
    const auto values =
        q == 0 ? curve_values(run, covariance)
               : directional_slope(
                     [&](const std::vector<Complex>& moved) { return curve_values(run, moved); },
                     covariance, std::span(all).subspan(q * entries, entries));
    auto next = values.begin();
    for (const std::size_t curve : run.curves)
      for (std::size_t i = 0; i < curves_[curve].entries.size(); ++i)
        found[q * size + static_cast<std::size_t>(first_[curve]) + i] = *next++;
  }
  return found;
}

SampledModel PathModel::model() const {
  const Index parameters = std::ssize(task_.free);
  VectorXd all = VectorXd::Zero((1 + parameters) * size_);
  SampledModel model;
  for (const Run& run : runs_) {
    const Estimator values = [&](double samples, std::span<const Complex> sums) {
      return run_values(run, samples, sums);
    };
    const GroupedSums& sums = run.state.sums;
    const auto found = values(sums.total_samples(), sums.total());
    for (Index i = 0; i < all.size(); ++i) all[i] += found[static_cast<std::size_t>(i)].real();
    model.deviations.push_back(deviations(sums, values));
  }
  model.values = all.head(size_);
  model.slopes = Eigen::Map<MatrixXd>(all.data() + size_, size_, parameters);
  put_power(model);
  return model;
}

void PathModel::put_power(SampledModel& model) const {
  if (power_.empty()) return;
  std::vector<Curve> curves;
  for (const std::size_t i : power_) curves.push_back(curves_[i]);
  const auto scenes = [&](const VectorXd& at) {
    const auto all = scenes_at(task_, at);
    std::vector<Scene> some;
    for (const std::size_t i : power_) some.push_back(all[i]);
    return some;
  };
  const SlabModel transport(curves, scenes(at_));
  const LeastSquares problem{[&](const VectorXd& at) { return transport.values(scenes(at)); },
                             {},
                             lower_coordinates(task_.free),
                             upper_coordinates(task_.free)};
  const VectorXd here = problem.residuals(at_);
  const MatrixXd slopes = jacobian(problem, at_, here);
  Index next = 0;
  for (const std::size_t i : power_)
    for (std::size_t j = 0; j < curves_[i].entries.size(); ++j, ++next) {
      model.values[first_[i] + static_cast<Index>(j)] = here[next];
      model.slopes.row(first_[i] + static_cast<Index>(j)) = slopes.row(next);
    }
}

}  // namespace flatspeckle::mc
