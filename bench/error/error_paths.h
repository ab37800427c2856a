#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/error/error_measure.h"
#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::bench {

/// A scene as error curves name it.
struct FlatScene {
  std::string name;
  std::shared_ptr<const Scene> scene;
};

/// 0 and six more, their sines equally spaced.
std::vector<double> seven_tilts(double largest_sine);

mc::Plan plan_of(const Scene& scene);
Trial trial_of(const FieldJob& job);

std::function<Trial(std::uint64_t seed)> our_paths(const std::shared_ptr<const Scene>& scene);

/// The published Monte Carlo estimator, ours, and covariances taken from drawn speckle fields.
std::vector<Method> path_methods(const FlatScene& flat);

}  // namespace flatspeckle::bench
