#include <cmath>

#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

namespace {

void read_point(const Keys& keys, const ScattererValues& values, Scatterer& made) {
  read_albedo(keys, values, made);
  if (made.albedo == 0) throw InputError("albedo", 0, "must be in (0, 1] for points");
  const auto& phase_shift = keys.read(values.phase_shift);
  if (phase_shift && made.albedo != 1)
    throw InputError(
        "phase_shift", *phase_shift,
        "requires albedo = 1, because an absorbing point is resonant; leave out phase_shift");
  made.phase_shift = phase_shift.value_or(made.phase_shift);
}

// Returns T_0 of C8 and C57; the T_n of all other orders are 0.
std::vector<ScaledComplex> point_t_matrix(const Scatterer& point, double, int order, Radial) {
  std::vector<ScaledComplex> t(order + 1);
  const long double angle = 2 * static_cast<long double>(point.phase_shift);
  t[0] = point.albedo != 1 ? ExtendedComplex(-point.albedo)
                           : ExtendedComplex((std::cos(angle) - 1) / 2, std::sin(angle) / 2);
  return t;
}

}  // namespace

const ScattererKind point_kind{"point", Scatterer::Kind::point, read_point, point_t_matrix};

}  // namespace flatspeckle
