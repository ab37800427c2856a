#pragma once

#include <tuple>

#include "core/keys/keys.h"
#include "grin/design/descent/least_squares.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/objectives/deflection_target.h"
#include "grin/design/objectives/fibre_target.h"
#include "grin/design/objectives/focus_target.h"
#include "grin/design/objectives/screen_target.h"
#include "grin/design/objectives/source_target.h"

namespace flatspeckle::grin::design {

/// Scene keys of the designed field.
struct FormValues {
  std::string design = "ball";
  double radius = 1;
  std::vector<std::int64_t> nodes{5, 9, 17};
  std::int64_t coefficients = 8;
  double start_excess = 0, least_index = 0.5, most_index = 3;
  double index = 1.5;
  std::optional<double> delta = {};
  double index_around = 1;
  std::optional<double> smallest_feature = {}, most_gradient = {};
};

void add_keys(Keys& keys, FormValues& values);

/// The field from which a search starts, its refinement levels and the bounds of its index.
struct FormStart {
  FieldForm form;  ///< form of the field in the first refinement level
  int levels = 1;  ///< number of refinement levels, each with half the spacing of the previous one
  double finest = 1;                 ///< number of nodes along an axis in the last level
  std::vector<double> coefficients;  ///< coefficients in the first level
  /// Bounds of the index, relative to host_index.
  double least_index, most_index;
  /// Index around the field. The search works with indices relative to it, which bend rays alike.
  double host_index = 1;
  /// Largest gradient of a box's relative index; nullopt: unlimited.
  std::optional<double> most_gradient = {};
};
/// Makes the start of the search. Throws InputError.
FormStart make_form(const Keys& keys, const FormValues& values);

/// Scene keys of all design targets. To add a target, extend only this list.
using TargetKinds = std::tuple<FocusValues, FibreValues, ScreenValues, DeflectionValues,
                               CollimationValues, ThroughputValues>;

struct TargetValues {
  std::string goal = FocusValues::word;
  TargetKinds kinds{};
};

void add_keys(Keys& keys, TargetValues& values);

/// Makes the design target that the key `goal` selects. Throws InputError.
std::unique_ptr<DesignTarget> make_target(const Keys& keys, const TargetValues& values,
                                          const FieldForm& form);

/// Scene keys of the command `design`: the field, the target and the search.
struct DesignValues {
  FormValues form{};
  TargetValues design_target{};
  std::optional<double> step = {}, target = {}, noise = {};
  std::int64_t iterations = 60;
  double roughness = 0, tolerance = 0.03;
  std::string method = "gauss_newton";
};

void add_keys(Keys& keys, DesignValues& values);

struct DesignScene {
  FormStart start;
  std::shared_ptr<const DesignTarget> design_target;
  std::string goal;
  std::optional<double> focus = {};  ///< focal distance, for goal = focus
  RayWalk walk;
  double roughness;  ///< weight of the roughness (class Roughness) at the start of the search
  /// Whether the weight of the roughness is lowered until the residual equals the noise of the
  /// measurements
  bool has_noise;
  int iterations = 0;    ///< largest number of steps of the search
  double tolerance = 0;  ///< relative decrease of the residual below which a step counts as slow
  double target = 0;     ///< root mean square residual at which the search ends
};

/// Makes the scene. Throws InputError for invalid values. The overload without `keys` also throws
/// it for values that no part of the scene uses.
DesignScene make_design_scene(const Keys& keys, const DesignValues& values);
DesignScene make_design_scene(const DesignValues& values);

}  // namespace flatspeckle::grin::design
