#pragma once

#include <tuple>

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

}  // namespace flatspeckle::grin::design
