#include "grin/design/descent/least_squares.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "core/error.h"
#include "grin/design/adjoint/designed_field.h"

namespace flatspeckle::grin::design {

namespace {

using Numbers = std::vector<double>;

double dot(const Numbers& a, const Numbers& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}
void add(Numbers& a, double factor, const Numbers& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += factor * b[i];
}

}  // namespace

std::optional<std::vector<double>> Objective::residuals(
    std::span<const double> coefficients) const {
  const auto measurements = rays_.trace(form_, coefficients);
  if (!measurements) return std::nullopt;
  return design_objective_.residuals(*measurements);
}

double Objective::mean_square(std::span<const double> residuals) const {
  double sum = 0;
  for (const double r : residuals) sum += r * r;
  return sum / static_cast<double>(rays_.rays());
}

double Objective::loss(std::span<const double> coefficients) const {
  const auto found = residuals(coefficients);
  return found ? mean_square(*found) : HUGE_VAL;
}

std::vector<double> Objective::gradient(std::span<const double> residuals) const {
  std::vector<double> by_measurements = design_objective_.transposed(residuals);
  for (double& by : by_measurements) by *= 2 / static_cast<double>(rays_.rays());
  return rays_.gradient(by_measurements);
}

SearchState begin_search(const Objective& objective, const Search& search,
                         std::vector<double> coefficients) {
  const auto residuals = objective.residuals(coefficients);
  if (!residuals)
    throw InputError(
        "start", "field",
        "every ray must reach its end in the start field; change start_excess or the rays");
  SearchState state{std::move(coefficients)};
  state.damping = search.first_damping;
  state.loss = objective.mean_square(*residuals);
  state.traces = 1;
  return state;
}

/// Roughness of the coefficients c: |D c|^2, the sum of the squared third differences D c along
/// each axis. The normal matrix contains D^T D.
class Roughness {
 public:
  explicit Roughness(const CoefficientShape& shape) : shape_(shape) {}

  /// Adds weight * (D^T D values) to sums.
  void add_times(std::span<const double> values, double weight, std::span<double> sums) const;
  /// Adds weight * (diagonal of D^T D) to sums.
  void add_diagonal(double weight, std::span<double> sums) const;
  double square(std::span<const double> values) const;

 private:
  template <class Use>
  void each_difference(const Use& use) const;

  CoefficientShape shape_;
};

namespace {

/// Stencil of third differences. Third differences are small for a field that is smooth over a few
/// cells, even if the field is curved.
constexpr std::array<double, 4> stencil{-1, 3, -3, 1};
constexpr int reach = stencil.size() - 1;

double difference(std::span<const double> values, std::size_t first, std::size_t apart) {
  double sum = 0;
  for (std::size_t i = 0; i < stencil.size(); ++i) sum += stencil[i] * values[first + i * apart];
  return sum;
}

}  // namespace

/// Calls use(index of the first coefficient, stride between coefficients) for each third
/// difference.
template <class Use>
void Roughness::each_difference(const Use& use) const {
  const auto [nx, ny, nz] = shape_.extent;
  const std::size_t stride[3] = {static_cast<std::size_t>(ny) * nz, static_cast<std::size_t>(nz),
                                 1};
  for (int axis = 0; axis < 3; ++axis) {
    std::array<int, 3> end = shape_.extent;
    end[axis] -= reach;
    for (int i = 0; i < end[0]; ++i)
      for (int j = 0; j < end[1]; ++j)
        for (int k = 0; k < end[2]; ++k) use(i * stride[0] + j * stride[1] + k, stride[axis]);
  }
}

void Roughness::add_times(std::span<const double> values, double weight,
                          std::span<double> sums) const {
  each_difference([&](std::size_t first, std::size_t apart) {
    const double weighted = weight * difference(values, first, apart);
    for (std::size_t i = 0; i < stencil.size(); ++i)
      sums[first + i * apart] += stencil[i] * weighted;
  });
}

void Roughness::add_diagonal(double weight, std::span<double> sums) const {
  each_difference([&](std::size_t first, std::size_t apart) {
    for (std::size_t i = 0; i < stencil.size(); ++i)
      sums[first + i * apart] += stencil[i] * stencil[i] * weight;
  });
}

double Roughness::square(std::span<const double> values) const {
  double sum = 0;
  each_difference([&](std::size_t first, std::size_t apart) {
    const double d = difference(values, first, apart);
    sum += d * d;
  });
  return sum;
}

constexpr double least_curvature = 1e-9, least_damping = 1e-9;
constexpr int most_trials = 12;

/// Residuals linearised in the coefficients about the current point of the search.
struct LeastSquares::Model {
  RayRows rows;
  Roughness roughness;
  Numbers gradient, curvature, rough_diagonal;
  double rough_unit, mean_curvature;
  double roughness_weight;
  std::vector<char> is_held;  ///< whether a coefficient is at a bound that the step would cross

  /// Returns the weight of D^T D (class Roughness) in the normal matrix.
  double rough(double damping) const { return (damping + roughness_weight) * rough_unit; }
};

LeastSquares::Model LeastSquares::model_at(SearchState& state) const {
  const Numbers residuals = *objective_.residuals(state.coefficients);
  const std::size_t count = state.coefficients.size();
  Model model{objective_.rays().linearised(),
              Roughness(shape_of(objective_.form())),
              Numbers(count),
              Numbers(count),
              Numbers(count, 0.0),
              0,
              0,
              state.roughness,
              std::vector<char>(count, 0)};
  ++state.traces;
  model.rows.transposed(objective_.design_objective().transposed(residuals), model.gradient);
  model.rows.squares(objective_.design_objective().weights(), model.curvature);
  model.mean_curvature = mean(model.curvature);
  model.roughness.add_diagonal(1, model.rough_diagonal);
  const double rough = mean(model.rough_diagonal);
  model.rough_unit = rough > 0 ? model.mean_curvature / rough : 0;
  model.roughness.add_times(state.coefficients, state.roughness * model.rough_unit, model.gradient);
  const std::vector<double>&least = search_.bounds.least, &most = search_.bounds.most;
  for (std::size_t i = 0; i < count; ++i) {
    const bool low = state.coefficients[i] <= least[i] && model.gradient[i] >= 0;
    const bool high = state.coefficients[i] >= most[i] && model.gradient[i] <= 0;
    model.is_held[i] = low || high || least[i] == most[i];
  }
  return model;
}

/// Returns the product of the damped normal matrix of the model and a step.
Numbers LeastSquares::curved(const Model& model, double damping,
                             std::span<const double> step) const {
  const RaySystem& rays = objective_.rays();
  const DesignObjective& design_objective = objective_.design_objective();
  Numbers result(step.size());
  if (design_objective.is_plain()) {
    model.rows.normal(step, result);
  } else {
    Numbers measurements(rays.rays() * rays.measurements());
    model.rows.times(step, measurements);
    model.rows.transposed(design_objective.transposed(design_objective.times(measurements)),
                          result);
  }
  for (std::size_t i = 0; i < step.size(); ++i)
    result[i] += (damping * model.curvature[i] + least_curvature * model.mean_curvature) * step[i];
  const double rough = model.rough(search_.smooth_damping * damping);
  model.roughness.add_times(step, rough, result);
  for (std::size_t i = 0; i < step.size(); ++i)
    if (model.is_held[i]) result[i] = 0;
  return result;
}

/// Returns the step that solves the damped normal equations, by conjugate gradients with a diagonal
/// preconditioner.
Numbers LeastSquares::solve(const Model& model, double damping) const {
  const std::size_t count = model.gradient.size();
  const double rough = model.rough(search_.smooth_damping * damping);
  Numbers inverse(count), step(count, 0.0), rest(count), along(count);
  for (std::size_t i = 0; i < count; ++i) {
    inverse[i] = 1 / (model.curvature[i] * (1 + damping) + rough * model.rough_diagonal[i] +
                      least_curvature * model.mean_curvature);
    if (model.is_held[i]) inverse[i] = 0;
    rest[i] = model.is_held[i] ? 0 : -model.gradient[i];
  }
  const auto preconditioned = [&] {
    Numbers z(count);
    for (std::size_t i = 0; i < count; ++i) z[i] = inverse[i] * rest[i];
    return z;
  };
  along = preconditioned();
  double size = dot(rest, along);
  const double enough = 1e-20 * size;
  for (int i = 0; i < search_.solver_steps && size > enough; ++i) {
    const Numbers image = curved(model, damping, along);
    const double factor = size / dot(along, image);
    add(step, factor, along);
    add(rest, -factor, image);
    const Numbers z = preconditioned();
    const double before = std::exchange(size, dot(rest, z));
    for (std::size_t j = 0; j < count; ++j) along[j] = z[j] + size / before * along[j];
  }
  return step;
}

SearchStep LeastSquares::advance(SearchState& state) const {
  const Model model = model_at(state);
  const double rays = static_cast<double>(objective_.rays().rays());
  const double rough = state.roughness * model.rough_unit / rays;
  const double now = state.loss + rough * model.roughness.square(state.coefficients);
  // Decrease of the loss that the linear model predicts for the first trial step
  double expected_decrease = 0;
  for (int trial = 0; trial < most_trials; ++trial) {
    const Numbers step = solve(model, state.damping);
    Numbers next = state.coefficients;
    add(next, 1, step);
    search_.bounds.hold(next);
    if (trial == 0) expected_decrease = -dot(model.gradient, step) / rays;
    const double loss = objective_.loss(next);
    ++state.traces;
    if (loss + rough * model.roughness.square(next) < now) {
      state.coefficients = std::move(next);
      state.loss = loss;
      state.damping = std::max(0.1 * state.damping, least_damping);
      return SearchStep::better;
    }
    state.damping *= 10;
  }
  constexpr double least_gain = 1e-3;
  return expected_decrease > least_gain * now ? SearchStep::stalled : SearchStep::settled;
}

}  // namespace flatspeckle::grin::design
