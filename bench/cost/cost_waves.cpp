#include <cmath>
#include <memory>

#include "bench/cost/cost_measure.h"
#include "bench/scenes/standard_scenes.h"
#include "core/numbers/random.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::bench {

namespace {

/// Resonant points, ten per square wavelength.
Placement points(std::size_t count) {
  RandomStream random(1, static_cast<std::uint64_t>(Stream::placement), count);
  const double side = std::sqrt(static_cast<double>(count) / 10);
  Placement placement(count);
  for (auto& placed : placement)
    placed.position = {side * random.uniform(), side * random.uniform()};
  return placement;
}

CostRun solver(const std::string& what, wave::Method method, double smallest, double largest,
               double expected) {
  return cost_run({what, "scatterers", smallest, largest, expected, [method](double size) {
                     const auto placement =
                         std::make_shared<const Placement>(points(static_cast<std::size_t>(size)));
                     return [placement, method] {
                       const wave::SolveOptions options{
                           .tolerance = 1e-6, .sensors = {}, .diagnose = false, .method = method};
                       wave::solve(*placement, k, {0}, options);
                     };
                   }});
}

}  // namespace

std::vector<CostRun> wave_cost_runs() {
  return {solver("exact, dense", wave::Method::dense, 250, 8000, 3),
          // the last factorisation has as many unknowns as scatterers along the perimeter, ~
          // N^(1/2), and costs their cube
          solver("exact, fast", wave::Method::fast, 1024, 131072, 1.5)};
}

}  // namespace flatspeckle::bench
