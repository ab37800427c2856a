#pragma once

#include <tuple>

#include "core/keys/keys.h"
#include "grin/design/descent/least_squares.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/goals/deflection_aim.h"
#include "grin/design/goals/fibre_aim.h"
#include "grin/design/goals/focus_aim.h"
#include "grin/design/goals/screen_aim.h"
#include "grin/design/goals/source_aim.h"

namespace flatspeckle::grin::design {

/// What is sought, as keys have it.
struct FormValues {
  std::string design = "ball";
  double radius = 1;
  std::vector<std::int64_t> nodes{5, 9, 17};
  std::int64_t coefficients = 8;
  double start_excess = 0, least_index = 0.5, most_index = 3;
  double index = 1.5;
  std::optional<double> delta = {};
};

void add_keys(Keys& keys, FormValues& values);

/// The field that a search starts from, and how it may change.
struct FormStart {
  FieldForm form;                    ///< of the first level
  int levels = 1;                    ///< each with half the spacing of the one before
  double finest = 1;                 ///< nodes along an axis, of the last
  std::vector<double> coefficients;  ///< of the first
  double least_index, most_index;
};
/// Throws InputError.
FormStart make_form(const Keys& keys, const FormValues& values);

/// All kinds of what light is to do; the one list of them.
using AimKinds = std::tuple<FocusValues, FibreValues, ScreenValues, DeflectionValues,
                            CollimationValues, ThroughputValues>;

struct AimValues {
  std::string goal = FocusValues::word;
  AimKinds kinds{};
};

void add_keys(Keys& keys, AimValues& values);

/// Throws InputError.
std::unique_ptr<Aim> make_aim(const Keys& keys, const AimValues& values, const FieldForm& form);

/// What is sought and what light is to do, as keys have it.
struct DesignValues {
  FormValues form{};
  AimValues aim{};
  std::optional<double> step = {}, target = {}, noise = {};
  std::int64_t iterations = 60;
  double roughness = 0;
  std::string method = "gauss_newton";
};

void add_keys(Keys& keys, DesignValues& values);

struct DesignScene {
  FormStart start;
  std::shared_ptr<const Aim> aim;
  std::string goal;
  std::optional<double> focus = {};  ///< of a ball
  RayWalk walk;
  double roughness;    ///< at the start
  bool has_noise;      ///< roughness is lowered until the target, which is the noise, is reached
  int iterations = 0;  ///< at most
  double target = 0;   ///< the loss' root that is enough
};

/// Both throw InputError; of values alone, all must be of use.
DesignScene make_design_scene(const Keys& keys, const DesignValues& values);
DesignScene make_design_scene(const DesignValues& values);

}  // namespace flatspeckle::grin::design
