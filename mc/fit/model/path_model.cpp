#include "mc/fit/model/path_model.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.h"
#include "core/search/levenberg_marquardt.h"
#include "mc/fit/task/curve_values.h"
#include "mc/fit/task/fit_data.h"
#include "mc/fit/task/measurement.h"
#include "mc/jobs/gradient_job.h"
#include "mc/paths/estimators/gradient.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Function that returns the derivative of a member of MovingSpec by a coordinate.
using Difference = std::function<double(double MovingSpec::*)>;

MovingDerivative moving_derivative(MediumDerivative medium, const Difference& by) {
  return {std::move(medium),
          by(&MovingSpec::diffusion),
          {by(&MovingSpec::velocity_x), by(&MovingSpec::velocity_z)},
          by(&MovingSpec::shear)};
}

}  // namespace

MatrixXd SampledModel::noise() const {
  const Index size = values.size();
  MatrixXd sum = MatrixXd::Zero(size, size);
  for (const MatrixXd& run : deviations) sum += run.topRows(size) * run.topRows(size).transpose();
  return sum;
}

MatrixXd SampledModel::added_information(const MatrixXd& weight) const {
  const Index size = values.size(), parameters = derivatives.cols();
  MatrixXd sum = MatrixXd::Zero(parameters, parameters);
  for (const MatrixXd& run : deviations)
    for (Index i = 0; i < parameters; ++i) {
      const MatrixXd weighted = weight * run.middleRows((1 + i) * size, size);
      for (Index j = 0; j < parameters; ++j)
        sum(i, j) += weighted.cwiseProduct(run.middleRows((1 + j) * size, size)).sum();
    }
  return sum;
}

std::vector<Complex> PathModel::FixedCount::correction(double samples,
                                                       std::span<const Complex> sums) const {
  auto all = job.all(samples, sums);
  all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(job.entries));
  for (Complex& value : all) value /= -2 * count;
  return all;
}

PathModel::PathModel(const FitTask& task) : task_(task), curves_(curves_of(task)) {
  if (task.free.size() > most_derivatives)
    throw InputError("free", task.free.size(),
                     "with method = mc, the number of free keys must be at most " +
                         std::to_string(most_derivatives));
  const Media media = media_at(task, middle(task));
  for (std::size_t i = 0; i < curves_.size(); ++i) {
    first_.push_back(size_);
    size_ += static_cast<Index>(curves_[i].entries.size());
    const bool power = is_flux(curves_[i].observable);
    if (power && media[i].scene.domain.kind == Domain::Kind::slab) {
      power_.push_back(i);
      continue;
    }
    const auto run =
        std::ranges::find_if(runs_, [&](const Run& one) { return can_share(one, media, i); });
    if (run == runs_.end())
      runs_.push_back({.power = power,
                       .reversed = !power && needs_reversed(media[i].scene),
                       .delays = curves_[i].delays,
                       .curves = {i},
                       .requests = {media[i].scene.request}});
    else {
      run->curves.push_back(i);
      run->requests.push_back(media[i].scene.request);
    }
  }
  move(middle(task));
}

bool PathModel::can_share(const Run& run, const Media& media, std::size_t curve) const {
  const Scene &first = media[run.curves.front()].scene, &scene = media[curve].scene;
  return first.domain.kind == scene.domain.kind && first.domain.depth == scene.domain.depth &&
         first.domain.width == scene.domain.width && first.k == scene.k &&
         first.faces == scene.faces && run.power == is_flux(curves_[curve].observable) &&
         (run.power || run.reversed == needs_reversed(scene)) &&
         run.delays == curves_[curve].delays &&
         curves_[run.curves.front()].fixed_count == curves_[curve].fixed_count;
}

void PathModel::move(const VectorXd& coordinates) {
  at_ = coordinates;
  const Media media = media_at(task_, at_);
  constexpr std::uint64_t apart = 1000003;
  std::uint64_t seed = task_.paths->seed;
  for (Run& run : runs_) begin(run, seed += apart, media);
}

void PathModel::begin(Run& run, std::uint64_t seed, const Media& media) const {
  const MovingSpec& spec = media[run.curves.front()].spec;
  const bool moving = !run.delays.empty();
  Scene scene = joint_scene(media, run.curves);
  if (moving) scene.request.kind = CovarianceRequest::Kind::intensity;
  const auto all = derivatives(run, scene);
  run.state = {};
  run.beta = spec.beta;
  std::vector<MediumDerivative> media_alone;
  for (const MovingDerivative& derivative : all) media_alone.push_back(derivative.medium);
  if (run.power) {
    run.lights = scene.request.lights;
    run.job = flux_derivative_job(scene, media_alone, seed);
    return;
  }
  Plan plan = gradient_plan(scene, run.reversed ? ReversedPaths::yes : ReversedPaths::no);
  if (moving) {
    plan.sampled_single = true;
    run.job = moving_derivative_job(scene, plan, run.delays, spec.motion(), all, seed);
    return;
  }
  run.job = derivative_job(scene, plan, media_alone, seed);
  if (!curves_[run.curves.front()].fixed_count) return;
  plan.sampled_single = true;
  run.fixed_count = {fixed_count_job(scene, plan, ~seed),
                     {},
                     scene.medium.density * scene.domain.width * scene.domain.depth};
}

/// Returns the derivatives of the medium by each coordinate. If a coordinate is close to a bound,
/// the finite differences are taken about a point so far from the bound that all steps stay within
/// the bounds.
std::vector<MovingDerivative> PathModel::derivatives(Run& run, const Scene& scene) const {
  constexpr double share = 1e-4;
  const VectorXd lower = lower_coordinates(task_.free), upper = upper_coordinates(task_.free);
  const MovingSpec& spec = curves_[run.curves.front()].scene;
  std::vector<MovingDerivative> found;
  run.beta_derivatives.clear();
  for (Index i = 0; i < at_.size(); ++i) {
    const double step = share * (upper[i] - lower[i]);
    const double about = std::clamp(at_[i], lower[i] + 3 * step, upper[i] - 3 * step);
    const auto moved = [&](double more) {
      VectorXd next = at_;
      next[i] = about + more;
      return with_parameters(spec, task_.free, next);
    };
    const MovingSpec above = moved(step), below = moved(-step);
    const Difference by = [&](double MovingSpec::*value) {
      return (above.*value - below.*value) / (2 * step);
    };
    found.push_back(moving_derivative(
        medium_derivative(task_.free[static_cast<std::size_t>(i)].key, scene, step,
                          [&](double more) { return scene_of(moved(more)); }),
        by));
    run.beta_derivatives.push_back(by(&MovingSpec::beta));
  }
  return found;
}

void PathModel::sample(double paths) {
  constexpr double of_correction = 0.5;  // fraction of the paths; the correction is small
  RunOptions options;
  options.threads = task_.paths->threads;
  const auto sample_to = [&](const PathJob& job, RunState& state, double most) {
    options.stop.samples = static_cast<std::uint64_t>(most);
    if (state.sums.batches() == 0 || state.sums.total_samples() < most)
      run_to_end(job.field.batches, options, state);
  };
  for (Run& run : runs_) {
    sample_to(run.job, run.state, paths);
    if (run.fixed_count)
      sample_to(run.fixed_count->job, run.fixed_count->state, of_correction * paths);
  }
}

/// Returns the values of those curves of a run that measure power. shares: [light][reflected,
/// transmitted].
std::vector<Complex> PathModel::power_values(const Run& run,
                                             std::span<const Complex> shares) const {
  std::vector<Complex> all;
  for (std::size_t n = 0; n < run.curves.size(); ++n) {
    const Curve& curve = curves_[run.curves[n]];
    for (const std::size_t entry : curve.entries) {
      const auto light = std::ranges::find(run.lights, run.requests[n].lights[entry]);
      all.push_back(shares[2 * static_cast<std::size_t>(light - run.lights.begin()) +
                           (curve.observable == Observable::reflectance ? 0 : 1)]);
    }
  }
  return all;
}

std::vector<Complex> PathModel::curve_values(const Run& run, double beta,
                                             std::span<const Complex> covariances) const {
  if (run.power) return power_values(run, covariances);
  std::vector<Complex> all;
  std::size_t first = 0;
  for (std::size_t n = 0; n < run.curves.size(); ++n) {
    const std::size_t count = run.requests[n].entries.size();
    std::vector<Complex> own;
    for (std::size_t t = 0; t <= run.delays.size(); ++t) {
      const auto then = covariances.subspan(t * run.job.entries + first, count);
      own.insert(own.end(), then.begin(), then.end());
    }
    for (const double value : observed(curves_[run.curves[n]], beta, run.requests[n], own))
      all.emplace_back(value);
    first += count;
  }
  return all;
}

/// Returns the values of all curves, then their derivatives by each parameter. Both are 0 for
/// curves that belong to other runs. all: estimates by the job of this run. correction: result of
/// FixedCount::correction(), which is added to the covariances.
std::vector<Complex> PathModel::run_values(const Run& run, std::vector<Complex> all,
                                           std::span<const Complex> correction) const {
  for (std::size_t e = 0; e < correction.size(); ++e) all[e] += correction[e];
  const std::size_t count = run.covariances(), quantities = 1 + task_.free.size();
  const auto size = static_cast<std::size_t>(size_);
  const auto covariances = std::span(all).first(count);
  std::vector<Complex> found(quantities * size);
  for (std::size_t q = 0; q < quantities; ++q) {
    auto values = q == 0 ? curve_values(run, run.beta, covariances)
                         : directional_derivative(
                               [&](const std::vector<Complex>& moved) {
                                 return curve_values(run, run.beta, moved);
                               },
                               covariances, std::span(all).subspan(q * count, count));
    auto next = values.begin();
    for (const std::size_t curve : run.curves)
      for (std::size_t i = 0; i < curves_[curve].entries.size(); ++i) {
        Complex& value = found[q * size + static_cast<std::size_t>(first_[curve]) + i];
        value = *next++;
        if (q > 0 && curves_[curve].observable == Observable::squared_contrast)
          value += run.beta_derivatives[q - 1] / run.beta *
                   found[static_cast<std::size_t>(first_[curve]) + i];
      }
  }
  return found;
}

SampledModel PathModel::model() const {
  const Index parameters = std::ssize(task_.free);
  VectorXd all = VectorXd::Zero((1 + parameters) * size_);
  SampledModel model;
  for (const Run& run : runs_) add(run, model, all);
  model.values = all.head(size_);
  model.derivatives = Eigen::Map<MatrixXd>(all.data() + size_, size_, parameters);
  put_power(model);
  return model;
}

void PathModel::add(const Run& run, SampledModel& model, VectorXd& all) const {
  const auto mean = [](const PathJob& job, const GroupedSums& sums) {
    return job.all(sums.total_samples(), sums.total());
  };
  const GroupedSums& sums = run.state.sums;
  std::vector<Complex> correction;
  if (const auto& fixed = run.fixed_count) {
    const GroupedSums& others = fixed->state.sums;
    correction = fixed->correction(others.total_samples(), others.total());
    model.deviations.push_back(
        deviations(others, [&](double samples, std::span<const Complex> total) {
          return run_values(run, mean(run.job, sums), fixed->correction(samples, total));
        }));
  }
  const auto found = run_values(run, mean(run.job, sums), correction);
  for (Index i = 0; i < all.size(); ++i) all[i] += found[static_cast<std::size_t>(i)].real();
  model.deviations.push_back(deviations(sums, [&](double samples, std::span<const Complex> total) {
    return run_values(run, run.job.all(samples, total), correction);
  }));
}

void PathModel::put_power(SampledModel& model) const {
  if (power_.empty()) return;
  std::vector<Curve> curves;
  for (const std::size_t i : power_) curves.push_back(curves_[i]);
  const auto media = [&](const VectorXd& at) {
    const Media all = media_at(task_, at);
    Media some;
    for (const std::size_t i : power_) some.push_back(all[i]);
    return some;
  };
  const SlabModel transport(curves, media(at_));
  BoundedLeastSquares problem = bounds_of(task_.free);
  problem.residuals = [&](const VectorXd& at) { return transport.values(media(at)); };
  const VectorXd here = problem.residuals(at_);
  const MatrixXd derivatives = jacobian(problem, at_, here);
  Index next = 0;
  for (const std::size_t i : power_)
    for (std::size_t j = 0; j < curves_[i].entries.size(); ++j, ++next) {
      model.values[first_[i] + static_cast<Index>(j)] = here[next];
      model.derivatives.row(first_[i] + static_cast<Index>(j)) = derivatives.row(next);
    }
}

}  // namespace flatspeckle::mc
