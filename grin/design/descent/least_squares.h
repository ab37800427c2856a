#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "grin/design/forms/field_form.h"
#include "grin/design/objectives/design_objective.h"
#include "grin/design/system/ray_system.h"

namespace flatspeckle::grin::design {

/// Bounds of the coefficients, and settings of the search for the best coefficients.
struct Search {
  Bounds bounds;
  double first_damping = 1e-2;
  /// Weight of the roughness of a step (class Roughness) in the damping term.
  double smooth_damping = 0.1;
  int solver_steps = 30;  ///< largest number of conjugate-gradient iterations per search step
};

/// Current point of a search. The loss is the mean over the rays of the sum of squared residuals.
struct SearchState {
  std::vector<double> coefficients;
  double damping = 0;
  /// Weight of the roughness, the sum of squared third differences of the coefficients, in the
  /// loss. It is relative to the mean curvature of the loss due to the rays.
  double roughness = 0;
  double loss = 0;
  long traces = 0;  ///< number of times that each ray was traced, forward or backward
};

enum class SearchStep {
  better,
  settled,  ///< no further decrease of the loss is expected
  stalled   ///< the linear model predicts a decrease, but no trial step achieves it
};

/// The loss of all rays (see SearchState) as a function of the coefficients of the field.
class Objective {
 public:
  Objective(RaySystem& rays, DesignObjective& design_objective, const FieldForm& form)
      : rays_(rays), design_objective_(design_objective), form_(form) {}

  RaySystem& rays() const { return rays_; }
  DesignObjective& design_objective() const { return design_objective_; }
  const FieldForm& form() const { return form_; }

  /// Returns the residuals of all rays; nullopt if a ray is lost.
  std::optional<std::vector<double>> residuals(std::span<const double> coefficients) const;
  double mean_square(std::span<const double> residuals) const;
  /// Returns the loss; infinite if a ray is lost.
  double loss(std::span<const double> coefficients) const;
  /// Returns the gradient of the loss at the coefficients with which the rays were traced last.
  std::vector<double> gradient(std::span<const double> residuals) const;

 private:
  RaySystem& rays_;
  DesignObjective& design_objective_;
  FieldForm form_;
};

/// Starts a search at these coefficients. Throws InputError if a ray is lost in the field with
/// these coefficients.
SearchState begin_search(const Objective& objective, const Search& search,
                         std::vector<double> coefficients);

/// Gauss-Newton search with bounds. Steps are damped (Levenberg, Marquardt) by the curvature of the
/// loss along each coefficient and by the roughness of the step, which keeps regions without rays
/// smooth. The normal equations are solved by conjugate gradients, from the stored derivatives of
/// the measurements.
class LeastSquares {
 public:
  LeastSquares(const Objective& objective, Search search)
      : objective_(objective), search_(std::move(search)) {}

  /// Makes one step; the result depends on the state alone.
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
