#pragma once

#include <tuple>

#include "core/keys/keys.h"
#include "grin/design/descent/objective.h"
#include "grin/design/forms/form_values.h"
#include "grin/design/goals/deflection_aim.h"
#include "grin/design/goals/fibre_aim.h"
#include "grin/design/goals/focus_aim.h"
#include "grin/design/goals/screen_aim.h"
#include "grin/design/goals/source_aim.h"

namespace flatspeckle::grin::design {

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
