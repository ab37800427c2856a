#include "grin/media/scattering/table_phase.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace flatspeckle::grin {

namespace {

/// Returns the exact integral of the table times sin(k angle) over interval i of the table. Uses
/// d^2 j_1(d), with the spherical Bessel function j_1, for sin d - d cos d, which cancels for small
/// d.
double moment(const AngleTable& table, std::size_t i, int k) {
  const double middle = k * (table.angles()[i] + table.angles()[i + 1]) / 2,
               half = k * (table.angles()[i + 1] - table.angles()[i]) / 2,
               mean = (table.values()[i] + table.values()[i + 1]) / 2,
               derivative = (table.values()[i + 1] - table.values()[i]) / (2 * half);
  return 2 / static_cast<double>(k) *
         (mean * std::sin(middle) * std::sin(half) +
          derivative * std::cos(middle) * half * half * std::sph_bessel(1, half));
}

double one_minus_cosine_of(double angle) {
  return 2 * std::sin(angle / 2) * std::sin(angle / 2);
}
double angle_of(double one_minus_cosine) {
  return 2 * std::asin(std::sqrt(std::clamp(one_minus_cosine / 2, 0.0, 1.0)));
}

}  // namespace

TablePhase::TablePhase(AngleTable table) {
  Shape shape{std::move(table)};
  double cosine = 0;
  for (std::size_t i = 0; i + 1 < shape.table.angles().size(); ++i) {
    shape.so_far.push_back(shape.so_far.back() + 2 * std::numbers::pi * moment(shape.table, i, 1));
    cosine += std::numbers::pi * moment(shape.table, i, 2);  // cos sin = sin(2 angle) / 2
  }
  shape.mean_cosine = cosine / shape.so_far.back();
  shape_ = std::make_shared<const Shape>(std::move(shape));
}

double TablePhase::density(double cosine) const {
  return shape_->table(angle_of(1 - cosine)) / shape_->so_far.back();
}

/// Samples an interval of the table, then an angle in this interval by rejection from a uniform
/// distribution over the sphere. In an interval where the table falls to 0, one of three trials is
/// accepted.
double TablePhase::one_minus_cosine(RandomStream& random) const {
  const AngleTable& table = shape_->table;
  const auto& so_far = shape_->so_far;
  const double target = random.uniform() * so_far.back();
  const auto above = std::upper_bound(so_far.begin() + 1, so_far.end() - 1, target);
  const auto i = static_cast<std::size_t>(above - so_far.begin()) - 1;
  const double low = one_minus_cosine_of(table.angles()[i]),
               high = one_minus_cosine_of(table.angles()[i + 1]),
               most = std::max(table.values()[i], table.values()[i + 1]);
  double turn;
  do {
    turn = low + (high - low) * random.uniform();
  } while (random.uniform() * most > table(angle_of(turn)));
  return turn;
}

TablePhase phase_of_amplitudes(const std::vector<Complex>& amplitudes) {
  const auto last = static_cast<double>(amplitudes.size() - 1);
  std::vector<double> angles, values;
  for (const Complex& amplitude : amplitudes) {
    angles.push_back(std::numbers::pi * static_cast<double>(angles.size()) / last);
    values.push_back(std::norm(amplitude));
  }
  return TablePhase(AngleTable(std::move(angles), std::move(values)));
}

TablePhase make_phase(const Keys& keys, const TablePhaseValues& values) {
  const std::string& path = keys.required(values.phase_table);
  return TablePhase(AngleTable(keys.name(values.phase_table), path));
}

}  // namespace flatspeckle::grin
