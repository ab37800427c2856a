#pragma once

#include "core/keys/keys.h"
#include "grin/design/design_light.h"
#include "grin/design/least_squares.h"

namespace flatspeckle::grin::design {

/// What is sought and what light is to do, as keys have it.
struct DesignValues {
  std::string design = "ball";
  double radius = 1;
  std::vector<std::int64_t> nodes{5, 9, 17};
  std::int64_t coefficients = 8;
  double start_excess = 0, least_index = 0.5, most_index = 3;
  std::optional<double> focus = {};
  double aperture = 1;
  std::int64_t directions = 50, rays_per_direction = 100;
  std::optional<double> step = {}, target = {};
  std::int64_t iterations = 60;
  double roughness = 0;
};

void add_keys(Keys& keys, DesignValues& values);

struct DesignScene {
  FieldForm form;  ///< of the first level
  int levels = 1;  ///< each with half the spacing of the one before
  double start_excess = 0;
  FocusLight light;
  RayWalk walk;
  Search search;
  int iterations = 0;  ///< at most
  double target = 0;   ///< the loss' root that is enough
};

/// Both throw InputError; of values alone, all must be of use.
DesignScene make_design_scene(const Keys& keys, const DesignValues& values);
DesignScene make_design_scene(const DesignValues& values);

}  // namespace flatspeckle::grin::design
