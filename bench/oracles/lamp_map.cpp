#include "bench/oracles/lamp_map.h"

#include <cmath>

#include "bench/oracles/infinite_medium.h"
#include "bench/oracles/quadrature.h"

namespace flatspeckle::oracles {

namespace {

constexpr double nearest = 1, farthest = 5, radius = 1;
constexpr int discs = 4;

/// Mean over a disc between two distances from the lamp.
double disc_mean(double albedo, double from, double to) {
  Quadrature across, along;
  across.add(0, radius);
  along.add(from, to);
  double sum = 0;
  for (std::size_t i = 0; i < across.node.size(); ++i)
    for (std::size_t j = 0; j < along.node.size(); ++j)
      sum += across.weight[i] * across.node[i] * along.weight[j] *
             point_source_fluence(1, albedo, std::hypot(across.node[i], along.node[j]));
  return 2 * sum / (radius * radius * (to - from));
}

}  // namespace

grin::RenderScene lamp_map(double albedo) {
  using namespace grin;
  RenderScene scene{};
  scene.stage.boundary = Sphere{Vec3::Zero(), 12};
  scene.stage.medium.mu_s = albedo;
  scene.stage.medium.mu_a = 1 - albedo;
  scene.lights = {PointLight{Vec3::Zero()}};
  scene.map = RingCells(Vec3(0, 0, nearest), Vec3(0, 0, farthest), radius, {1, discs});
  return scene;
}

std::vector<double> lamp_fluence(double albedo) {
  constexpr double height = (farthest - nearest) / discs;
  std::vector<double> means;
  for (int i = 0; i < discs; ++i)
    means.push_back(disc_mean(albedo, nearest + i * height, nearest + (i + 1) * height));
  return means;
}

}  // namespace flatspeckle::oracles
