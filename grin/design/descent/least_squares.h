#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "grin/design/forms/field_form.h"
#include "grin/design/goals/goal.h"
#include "grin/design/system/ray_system.h"

namespace flatspeckle::grin::design {

/// How coefficients are sought.
struct Search {
  Bounds bounds;
  double first_damping = 1e-2;
  double smooth_damping = 0.1;  ///< weight of a step's roughness in its damping
  int solver_steps = 30;        ///< of conjugate gradients, for each step of the search
};

/// Where a search is. The loss is the mean over the rays of the sum of squares of the residuals.
struct SearchState {
  std::vector<double> coefficients;
  double damping = 0;
  double roughness = 0;  ///< weight of it in the loss, relative to what rays tell on average
  double loss = 0;
  long traces = 0;  ///< of each ray, forward or backward
};

enum class SearchStep {
  better,
  settled,  ///< no more to be gained
  stalled   ///< what the linear model promises is not there
};

/// The loss of all rays as a function of the coefficients of a field.
class Objective {
 public:
  Objective(RaySystem& rays, Goal& goal, const FieldForm& form)
      : rays_(rays), goal_(goal), form_(form) {}

  RaySystem& rays() const { return rays_; }
  Goal& goal() const { return goal_; }
  const FieldForm& form() const { return form_; }

  /// Nothing where a ray is lost.
  std::optional<std::vector<double>> residuals(std::span<const double> coefficients) const;
  double mean_square(std::span<const double> residuals) const;
  /// The loss; infinite where a ray is lost.
  double loss(std::span<const double> coefficients) const;
  /// Its derivative by the coefficients, where the rays were traced last.
  std::vector<double> gradient(std::span<const double> residuals) const;

 private:
  RaySystem& rays_;
  Goal& goal_;
  FieldForm form_;
};

/// Throws InputError where a ray is lost in the field of these coefficients.
SearchState begin_search(const Objective& objective, const Search& search,
                         std::vector<double> coefficients);

/// Gauss-Newton steps with bounds, damped (Levenberg, Marquardt) by the curvature of each
/// coefficient and by the roughness of the step, so that what no ray sees stays smooth; normal
/// equations by conjugate gradients on the stored derivatives of rays.
class LeastSquares {
 public:
  LeastSquares(const Objective& objective, Search search)
      : objective_(objective), search_(std::move(search)) {}

  /// A step; a function of the state alone.
  SearchStep advance(SearchState& state) const;

 private:
  struct Model;
  Model model_at(SearchState& state) const;
  std::vector<double> solve(const Model& model, double damping) const;
  std::vector<double> curved(const Model& model, double damping,
                             std::span<const double> step) const;

  Objective objective_;
  Search search_;
};

}  // namespace flatspeckle::grin::design
