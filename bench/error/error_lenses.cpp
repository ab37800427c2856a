#include <cmath>

#include "bench/error/error_modules.h"
#include "bench/scenes/meshes.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::bench {

namespace {

/// Returns the RMS angle between the normals of a ball of triangles, replaced by a smooth surface
/// at the default spacing, and those of the sphere.
ErrorPoint normals_of_ball(int times, double crease) {
  const double start = thread_cpu_seconds();
  const grin::TriangleMesh mesh = ball_mesh(times);
  const auto curved = grin::curved_mesh(mesh, crease, grin::first_spacing(mesh) / 3);
  const grin::LevelSurface surface = grin::mesh_surface(curved, "spacing");
  const double seconds = thread_cpu_seconds() - start;
  const auto places = ball_mesh(5).corners;
  double square = 0;
  for (const grin::Vec3& place : places) {
    const grin::Vec3 x = surface.projected(place);
    square += (surface.normal(x) - x.normalized()).squaredNorm();
  }
  return {seconds, 0, std::sqrt(square / static_cast<double>(places.size())), 0};
}

ErrorRun run_of_ball(const char* method, double crease) {
  const char* const ball = "ball of 128, 512 and 2048 triangles";
  return {ball, method,
          [=](double) {
            ErrorCurve curve{ball, method, "normals of the sphere", 0, {}};
            curve.is_monte_carlo = false;
            for (const int times : {2, 3, 4})
              curve.points.push_back(normals_of_ball(times, crease));
            return curve;
          },
          true};
}

}  // namespace

std::vector<ErrorRun> lens_error_runs() {
  return {run_of_ball("curved triangles", 0.52), run_of_ball("plane triangles", 0)};
}

}  // namespace flatspeckle::bench
