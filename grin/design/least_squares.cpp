#include "grin/design/least_squares.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "grin/design/roughness.h"

namespace flatspeckle::grin::design {

namespace {

using Numbers = std::vector<double>;

double dot(const Numbers& a, const Numbers& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}
/// a += factor b
void add(Numbers& a, double factor, const Numbers& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += factor * b[i];
}
double mean(const Numbers& a) {
  return std::accumulate(a.begin(), a.end(), 0.0) / static_cast<double>(a.size());
}

constexpr double least_curvature = 1e-9, least_damping = 1e-9;
constexpr int most_trials = 12;

}  // namespace

/// Residuals as linear functions of the coefficients, about where the search is.
struct LeastSquares::Model {
  RayRows rows;
  Roughness roughness;
  Numbers gradient, curvature, rough_diagonal;
  double rough_unit, mean_curvature;
  std::vector<char> is_held;  ///< at a bound that it would cross
};

LeastSquares::LeastSquares(RaySystem& rays, Goal& goal, const FieldForm& form, const Search& search)
    : rays_(rays), goal_(goal), form_(form), search_(search) {}

double LeastSquares::loss_of(std::span<const double> residuals) const {
  double sum = 0;
  for (const double r : residuals) sum += r * r;
  return sum / static_cast<double>(rays_.rays());
}

SearchState LeastSquares::begin(std::vector<double> coefficients) {
  const auto readings = rays_.trace(form_, coefficients);
  if (!readings) throw InputError("start", "field", "a ray does not come to its end in it");
  const double loss = loss_of(goal_.residuals(*readings));
  return {std::move(coefficients), search_.first_damping, loss, 1};
}

LeastSquares::Model LeastSquares::model_at(SearchState& state) {
  const auto readings = rays_.trace(form_, state.coefficients);
  const Numbers residuals = goal_.residuals(*readings);
  const std::size_t count = state.coefficients.size();
  Model model{rays_.linearised(),
              Roughness(shape_of(form_)),
              Numbers(count),
              Numbers(count),
              Numbers(count, 0.0),
              0,
              0,
              std::vector<char>(count, 0)};
  ++state.traces;
  model.rows.transposed(goal_.transposed(residuals), model.gradient);
  model.rows.squares(goal_.weights(), model.curvature);
  model.mean_curvature = mean(model.curvature);
  model.roughness.add_diagonal(1, model.rough_diagonal);
  model.rough_unit = model.mean_curvature / mean(model.rough_diagonal);
  model.roughness.add_times(state.coefficients, search_.roughness * model.rough_unit,
                            model.gradient);
  for (std::size_t i = 0; i < count; ++i) {
    const bool low = state.coefficients[i] <= search_.least && model.gradient[i] > 0;
    const bool high = state.coefficients[i] >= search_.most && model.gradient[i] < 0;
    model.is_held[i] = low || high;
  }
  return model;
}

/// The normal matrix and its damping times a step.
Numbers LeastSquares::curved(const Model& model, double damping,
                             std::span<const double> step) const {
  Numbers readings(rays_.rays() * rays_.readings()), result(step.size());
  model.rows.times(step, readings);
  model.rows.transposed(goal_.transposed(goal_.times(readings)), result);
  for (std::size_t i = 0; i < step.size(); ++i)
    result[i] += (damping * model.curvature[i] + least_curvature * model.mean_curvature) * step[i];
  const double rough = (search_.smooth_damping * damping + search_.roughness) * model.rough_unit;
  model.roughness.add_times(step, rough, result);
  for (std::size_t i = 0; i < step.size(); ++i)
    if (model.is_held[i]) result[i] = 0;
  return result;
}

/// Conjugate gradients, preconditioned by the diagonal.
Numbers LeastSquares::solve(const Model& model, double damping) const {
  const std::size_t count = model.gradient.size();
  const double rough = (search_.smooth_damping * damping + search_.roughness) * model.rough_unit;
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

SearchStep LeastSquares::advance(SearchState& state) {
  const Model model = model_at(state);
  const double rays = static_cast<double>(rays_.rays());
  const double rough = search_.roughness * model.rough_unit / rays;
  const double now = state.loss + rough * model.roughness.square(state.coefficients);
  double promised = 0;  // by the first trial
  for (int trial = 0; trial < most_trials; ++trial) {
    const Numbers step = solve(model, state.damping);
    Numbers next = state.coefficients;
    add(next, 1, step);
    for (double& c : next) c = std::clamp(c, search_.least, search_.most);
    if (trial == 0) promised = -dot(model.gradient, step) / rays;
    const auto readings = rays_.trace(form_, next);
    ++state.traces;
    const double loss = readings ? loss_of(goal_.residuals(*readings)) : HUGE_VAL;
    if (loss + rough * model.roughness.square(next) < now) {
      state.coefficients = std::move(next);
      state.loss = loss;
      state.damping = std::max(0.1 * state.damping, least_damping);
      return SearchStep::better;
    }
    state.damping *= 10;
  }
  constexpr double worth = 1e-3;
  return promised > worth * now ? SearchStep::stalled : SearchStep::settled;
}

}  // namespace flatspeckle::grin::design
