#include "flatland/scatterers/phase_table.h"

#include <cmath>

#include "core/keys/angle_table.h"

namespace flatspeckle {

namespace {

/// Returns the integral of f(angle) times the table over [0, pi], by three Gauss-Legendre points
/// per interval.
template <typename F>
double integral(const AngleTable& table, const F& f) {
  const double root = std::sqrt(0.6), nodes[] = {-root, 0, root}, weights[] = {5, 8, 5};
  double sum = 0;
  for (std::size_t i = 0; i + 1 < table.angles().size(); ++i) {
    const double middle = (table.angles()[i] + table.angles()[i + 1]) / 2,
                 half = table.angles()[i + 1] - middle;
    for (int j = 0; j < 3; ++j) {
      const double angle = middle + nodes[j] * half;
      sum += weights[j] / 9 * half * table(angle) * f(angle);
    }
  }
  return sum;
}

}  // namespace

BulkPhase make_phase(const Keys& keys, const PhaseTable& values) {
  const AngleTable table("phase_table", keys.required(values.phase_table));
  const double half = integral(table, [](double) { return 1.0; }),
               cosine = integral(table, [](double angle) { return std::cos(angle); });
  return {[table, half](double theta) { return table(theta) / (2 * half); }, cosine / half,
          table.text()};
}

}  // namespace flatspeckle
