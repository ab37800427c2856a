#include <cmath>
#include <iostream>
#include <numbers>

#include "core/result/result_file.h"
#include "wave_solver/solutions/wave_solution.h"

// Solves one sound-soft disk under a plane wave, writes its far field, and fails unless the forward
// amplitude obeys the optical theorem (conventions, C6 and C9).
int main() {
  using namespace flatspeckle;
  constexpr double k = 2 * std::numbers::pi;
  const Scatterer soft = {.kind = Scatterer::Kind::soft, .radius = 0.5};
  const Complex forward = wave::solve({{{0, 0}, soft}}, k, {0.0}).far_field(0);

  ResultFile file("one_disk.h5");
  file.dataset("forward_amplitude", std::span(&forward, 1), {std::size_t{1}}, "1", "");
  file.commit();

  const double extinction = -std::sqrt(8 * std::numbers::pi / k) *
                            (forward * std::polar(1.0, std::numbers::pi / 4)).real();
  const double expected = cross_sections(t_matrix(soft, k, 40), k).extinction;
  std::cout << "extinction " << extinction << ", expected " << expected << '\n';
  return std::abs(extinction / expected - 1) < 1e-12 ? 0 : 1;
}
