#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/numbers/symmetric.h"
#include "core/run/stopwatch.h"
#include "mc/fit/medium_fit.h"
#include "mc/fit/model/path_model.h"
#include "mc/fit/task/curve_values.h"
#include "mc/fit/task/fit_data.h"
#include "mc/fit/task/fit_task.h"
#include "mc/theory/allowance.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Errors of one measured value due to wave effects that the Monte Carlo model neglects: `common`
/// is the same in all views, `own` depends on the view. angle: angle from the illumination to the
/// view.
struct NeglectedPart {
  double common = 0, own = 0;
  double angle = 0;
};

/// Neglected wave effects as fractions of an intensity: `common` is the fraction that is the same
/// in all views, `own` the fraction that depends on the view.
struct NeglectedShares {
  double common, own;

  explicit NeglectedShares(const Scene& scene) {
    const Allowance part(scene);
    common = part.crossed_paths + part.k_shift + part.correlations;
    own = part.near_zone + part.guided;
  }
};

double turned(const Scene& scene, std::size_t entry) {
  const auto& request = scene.request;
  const Channel channel = request.channels[request.entries[entry].a];
  return request.views[channel.view].angle - request.lights[channel.light].angle;
}

NeglectedPart part_of(const Curve& curve, const Medium& medium, std::size_t entry, double value) {
  if (is_flux(curve.observable) || !medium.scene.medium.has_scatterers) return {};
  const NeglectedShares shares(medium.scene);
  if (curve.observable == Observable::intensity)
    return {shares.common * value, shares.own * value, turned(medium.scene, entry)};
  const double still = curve.observable == Observable::squared_contrast ? medium.spec.beta : 1;
  return {(shares.common + shares.own) * (still - value)};
}

/// Returns the covariance of the neglected errors of all values of one measurement. width: angle
/// between two views up to which NeglectedPart::own is nearly the same in both.
MatrixXd covariance_of(const std::vector<NeglectedPart>& parts, double width) {
  const Index size = std::ssize(parts);
  MatrixXd found(size, size);
  for (Index i = 0; i < size; ++i)
    for (Index j = 0; j < size; ++j) {
      const NeglectedPart &a = parts[static_cast<std::size_t>(i)],
                          &b = parts[static_cast<std::size_t>(j)];
      const double apart = std::remainder(a.angle - b.angle, 2 * std::numbers::pi) / width;
      found(i, j) = a.common * b.common + a.own * b.own * std::exp(-apart * apart / 2);
    }
  return found;
}

/// Returns the angular width within which scattering amplitudes vary.
double width_of(const Scene& scene) {
  const double size = scene.scatterer.is_disk() ? scene.k * scene.scatterer.radius : 1;
  return 1 / std::max(1.0, size);
}

/// Returns the covariance of the errors due to neglected wave effects, for the values of all
/// curves. They are estimated from the documented bias of Monte Carlo (Allowance). The error of an
/// intensity is a fraction of the value. The fractions for crossed paths, refraction and correlated
/// positions are the same in all views. Those for near zones and for a box that guides light are
/// nearly the same only in views closer to each other than 1/(k a), with the radius a of the
/// scatterers. The error of a correlation C is the sum of all fractions times 1 - C,
/// and is fully correlated between all values. There are no such errors for power, for media given
/// only by a phase function, and for measurements simulated by Monte Carlo.
MatrixXd neglected_covariance(const FitTask& task, const Media& media, const VectorXd& values) {
  MatrixXd all = MatrixXd::Zero(values.size(), values.size());
  Index first = 0;
  auto medium = media.begin();
  for (const Measurement& one : task.measurements) {
    std::vector<NeglectedPart> parts;
    const double width = width_of(medium->scene);
    for (const Curve& curve : one.curves) {
      for (const std::size_t entry : curve.entries)
        parts.push_back(part_of(curve, *medium, entry, values[first + std::ssize(parts)]));
      ++medium;
    }
    const Index size = std::ssize(parts);
    if (!one.by_paths) all.block(first, first, size, size) = covariance_of(parts, width);
    first += size;
  }
  return all;
}

constexpr double first_paths = 10000;

/// The least-squares problem at one medium of the search. The errors of the model are added to
/// those of the measurements.
struct Round {
  SampledModel model;
  FitData data;  ///< measurements; errors of measured fields follow from this model
  MatrixXd noise, neglected;
  Eigen::LLT<MatrixXd> root;  ///< Cholesky factor of the covariance of all errors
  LeastSquaresFit at;         ///< residuals and jacobian, whitened by `root`
  /// Fisher information, without the contribution of noise in the derivatives.
  MatrixXd fisher;
  /// Largest ratio of the noise contribution to `fisher`, over all combinations of parameters.
  double excess = 0;

  Round(const VectorXd& coordinates, SampledModel sampled, MatrixXd errors, const FitData& measured)
      : model(std::move(sampled)),
        data(measured.has_fields() ? measured.about(model.values) : measured),
        noise(model.noise()),
        neglected(std::move(errors)),
        root(data.covariance() + noise + neglected) {
    at.parameters = coordinates;
    at.residuals = root.matrixL().solve(model.values - data.values());
    at.jacobian = root.matrixL().solve(model.derivatives);
    const Index size = model.values.size();
    const MatrixXd full = at.jacobian.transpose() * at.jacobian,
                   added = model.added_information(root.solve(MatrixXd::Identity(size, size)));
    const MatrixXd safe =
        full + 1e-14 * full.trace() * MatrixXd::Identity(full.rows(), full.cols());
    const Eigen::LLT<MatrixXd> rest(safe);
    const MatrixXd half = rest.matrixL().solve(added);
    excess = symmetric_eigen(rest.matrixL().solve(half.transpose())).values.maxCoeff();
    fisher = excess < 0.5 ? MatrixXd(full - added) : full;
  }

  /// Returns -2 times the log likelihood, up to a constant.
  double deviance() const {
    const MatrixXd& triangle = root.matrixLLT();
    return at.chi_squared() + 2 * triangle.diagonal().array().log().sum();
  }

  double degrees_of_freedom() const {
    const MatrixXd half = root.matrixL().solve(data.scatter() + noise + neglected);
    return expected_chi_squared(root.matrixL().solve(half.transpose()), at.jacobian);
  }

  /// Returns the contribution of errors of the model to the covariance of the estimated
  /// coordinates. errors: covariance of noise or of neglected effects.
  MatrixXd by(const MatrixXd& errors) const {
    const MatrixXd inverse = inverse_symmetric(at.jacobian.transpose() * at.jacobian);
    const MatrixXd estimator = inverse * root.solve(model.derivatives).transpose();
    return estimator * errors * estimator.transpose();
  }
};

/// Search for the medium that fits best, with the Monte Carlo model.
class PathSearch {
 public:
  explicit PathSearch(const FitTask& task)
      : task_(task), data_(task), model_(task), bounds_(bounds_of(task.free)) {}

  MediumFit fit() {
    std::optional<MediumFit> best;
    std::size_t number = 0;
    for (const VectorXd& start : starts()) {
      MediumFit one = from(start, number++);
      const bool likely = one.converged && is_likely(one.chi_squared, one.degrees_of_freedom);
      if (!best || (one.converged && !best->converged) ||
          (one.converged == best->converged && one.chi_squared < best->chi_squared))
        best = std::move(one);
      if (likely) break;
    }
    return *best;
  }

 private:
  /// Returns the most likely of the starts. The likelihood is evaluated with few paths.
  std::vector<VectorXd> starts() {
    constexpr std::size_t most = 3;
    std::multimap<double, VectorXd> ranked;
    for (const VectorXd& start : grid_of_starts(task_))
      ranked.emplace(round(start, first_paths).deviance(), start);
    std::vector<VectorXd> best;
    for (const auto& [unlikely, start] : ranked)
      if (best.size() < most) best.push_back(start);
    return best;
  }

  Round round(const VectorXd& at, double paths) {
    model_.move(at);
    return more(at, paths);
  }
  /// Continues to sample the present medium until each run has this number of paths.
  Round more(const VectorXd& at, double paths) {
    model_.sample(paths);
    SampledModel model = model_.model();
    MatrixXd neglected = MatrixXd::Zero(model.values.size(), model.values.size());
    if (!task_.paths->trusted)
      neglected = neglected_covariance(task_, media_at(task_, at), model.values);
    Round found(at, std::move(model), std::move(neglected), data_);
    task_.report(found.at.chi_squared());
    return found;
  }

  /// Returns the largest fraction that sampling noise of the model adds to the variance of a
  /// parameter.
  double share(const Round& round) const {
    const Information known = information_of(bounds_, round.fisher);
    const VectorXd sampling_variance = round.by(round.noise).diagonal(),
                   rest = (known.covariance.diagonal() - sampling_variance)
                              .cwiseMax(1e-3 * sampling_variance);
    return std::max(sampling_variance.cwiseQuotient(rest).maxCoeff(), round.excess);
  }

  bool out_of_time() const {
    return task_.paths->seconds && clock_.seconds() > *task_.paths->seconds;
  }

  /// Searches by Levenberg-Marquardt steps from a start. If a step is shorter than the errors, the
  /// model is nearly linear over the step and is not evaluated at the end of the step. The search
  /// then ends at that point or, if the noise of the model is too large, samples more paths.
  MediumFit from(const VectorXd& start, std::size_t number) {
    // far and near: squared length of a step, in standard errors
    constexpr double far = 4, near = 1, most_damping = 1e12;
    std::vector<LeastSquaresFit::Step> trace;
    const FitStep last = last_made(start, number, trace);
    double paths = last.paths, damping = last.damping;
    Round here = round(last.at, paths);
    for (int i = last.iteration;
         i < task_.most_iterations && damping < most_damping && !out_of_time(); ++i) {
      trace.push_back({here.at.parameters, here.at.chi_squared(), process_cpu_seconds()});
      if (task_.keep && i >= kept_)
        task_.keep({number, i, paths, damping, here.at.chi_squared(), trace.back().cpu_s,
                    here.at.parameters});
      const VectorXd step = damped_step(bounds_, here.at, damping);
      const double length = (here.at.jacobian * step).squaredNorm();
      if (length < near && damping <= 1) {
        const double excess = share(here) / task_.paths->share;
        if (excess <= 1) return ended(here, step, paths, true, std::move(trace));
        paths *= std::clamp(1.2 * excess, 1.3, 10.0);
        here = more(here.at.parameters, paths);
        continue;
      }
      const VectorXd next = here.at.parameters + step;
      Round there = round(next, paths);
      if (length < far || there.deviance() <= here.deviance()) {
        here = std::move(there);
        damping = std::max(damping / 10, 1e-12);
      } else {
        damping *= 10;
        model_.move(here.at.parameters);
      }
    }
    return ended(here, VectorXd::Zero(start.size()), paths, false, std::move(trace));
  }

  /// Returns the state that an earlier run had reached in the search from this start, or the
  /// initial state. Appends the earlier steps to `trace`.
  FitStep last_made(const VectorXd& start, std::size_t number,
                    std::vector<LeastSquaresFit::Step>& trace) {
    FitStep last{number, 0, first_paths, 1e-3, 0, 0, start};
    kept_ = 0;
    for (const FitStep& step : task_.made) {
      if (step.start != number) continue;
      if (kept_ > 0) trace.push_back({last.at, last.chi_squared, last.cpu_s});
      last = step;
      kept_ = step.iteration + 1;
    }
    return last;
  }

  MediumFit ended(const Round& here, const VectorXd& step, double paths, bool converged,
                  std::vector<LeastSquaresFit::Step> trace) const {
    MediumFit fit;
    const VectorXd at = here.at.parameters + step;
    put_information(task_, information_of(bounds_, here.fisher), at, fit);
    fit.by_sampling = covariance_of_values(task_, at, here.by(here.noise));
    fit.by_neglect = covariance_of_values(task_, at, here.by(here.neglected));
    fit.model = here.model.values + here.model.derivatives * step;
    fit.residuals = here.at.residuals + here.at.jacobian * step;
    fit.chi_squared = fit.residuals.squaredNorm();
    fit.degrees_of_freedom = here.degrees_of_freedom();
    const VectorXd errors =
        (here.data.errors().cwiseAbs2() + (here.noise + here.neglected).diagonal()).cwiseSqrt();
    fit.standardized_residuals = (here.data.values() - fit.model).cwiseQuotient(errors);
    fit.paths = paths;
    fit.converged = converged;
    trace.push_back({at, fit.chi_squared, process_cpu_seconds()});
    fit.trace = std::move(trace);
    for (auto& one : fit.trace) one.parameters = values_at(task_, one.parameters);
    return fit;
  }

  const FitTask& task_;
  const FitData data_;
  PathModel model_;
  BoundedLeastSquares bounds_;
  Stopwatch clock_;
  int kept_ = 0;  ///< number of iterations that an earlier run reported
};

}  // namespace

MediumFit fit_by_paths(const FitTask& task) {
  return PathSearch(task).fit();
}

void check_paths(const FitTask& task) {
  PathModel{task};
}

}  // namespace flatspeckle::mc
