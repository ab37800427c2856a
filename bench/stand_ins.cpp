#include <cmath>

#include "bench/error_curve.h"
#include "core/random.h"

namespace flatspeckle::bench {

std::vector<ErrorRun> error_runs() {
  std::vector<ErrorRun> runs;
  int n = 0;
  for (const char* scene : {"box_points", "box_cylinders", "slab_hg"})
    for (const char* method : {"exact dense", "exact fast", "textbook Monte Carlo", "ours", "fields"})
      runs.push_back({scene, method, [=, start = 0.3 / (1 + n++ % 5)](double cpu) {
                        ErrorCurve curve{scene, method, "exact solver", 1e-3, {}};
                        RandomStream random(1, 1, static_cast<std::uint64_t>(n));
                        for (double t = cpu / 128; t <= cpu; t *= 2)
                          curve.points.push_back(
                              {t, 1000 * t, start / std::sqrt(t) * (0.95 + 0.1 * random.uniform())});
                        curve.slope = -0.5;
                        curve.slope_error = 0.01;
                        curve.efficiency = 1 / (start * start);
                        return curve;
                      }});
  for (const char* scene : {"luneburg", "waveguide", "luneburg_wide_beam", "luneburg_from_outside"})
    for (const char* method : {"path tracing", "light tracing", "bidirectional", "photon map, biased by its radius"})
      runs.push_back({scene, method, [=, start = 0.3 / (1 + n++ % 4)](double cpu) {
                        ErrorCurve curve{scene, method, "long run", 1e-3, {}};
                        for (double t = cpu / 128; t <= cpu; t *= 2)
                          curve.points.push_back({t, 1000 * t, start / std::sqrt(t)});
                        curve.slope = -0.5;
                        curve.slope_error = 0.01;
                        curve.efficiency = 1 / (start * start);
                        curve.is_monte_carlo = std::string(method).find("photon") == std::string::npos;
                        return curve;
                      }});
  return runs;
}

std::vector<CostRun> cost_runs() {
  std::vector<CostRun> runs;
  for (const char* what : {"dense factorization", "fast direct solver", "paths", "rays"})
    runs.push_back({what, [=](double) {
                      CostCurve curve{what, "scatterers", {100, 200, 400, 800}, {}, 3, 0.02, 3, "CPU seconds"};
                      for (double n : curve.size) curve.cpu_s.push_back(1e-9 * n * n * n);
                      return curve;
                    }});
  return runs;
}

}  // namespace flatspeckle::bench
