#include "wave_solver/points/foldy_lax.h"

#include <algorithm>
#include <utility>

#include "wave_solver/dense/dense_factor.h"

namespace flatspeckle::wave {

std::vector<Complex> foldy_lax(const Placement& placement, double k, const EmittedWave& wave,
                               const std::vector<Complex>& lights,
                               const std::vector<Complex>& views) {
  const std::size_t n = placement.size();
  Entries matrix(n * n);
  for (std::size_t j = 0; j < n; ++j) {
    const auto& [place, scatterer] = placement[j];
    const auto t = static_cast<Complex>(t_matrix(scatterer, k, 0).front());
    matrix[j * (n + 1)] = wave(place, place) - 1.0 / t;
    for (std::size_t l = 0; l < j; ++l)
      matrix[j * n + l] = matrix[l * n + j] = wave(place, placement[l].position);
  }
  DenseFactor factor(std::move(matrix), n);
  auto fields = views.size() < lights.size()
                    ? transposed_product(factor.solve(views), lights.data(), lights.size() / n, n)
                    : transposed_product(views, factor.solve(lights).data(), lights.size() / n, n);
  for (Complex& field : fields) field = -field;
  require_finite(fields);
  return fields;
}

}  // namespace flatspeckle::wave
