#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"

namespace flatspeckle::mc {

/// The field in a box of wavenumber K, in surroundings of wavenumber k, of a unit plane wave: the
/// Lippmann-Schwinger equation on square-like cells, convolved by FFT and iterated (BiCGSTAB).
class HomogenisedBox {
 public:
  /// Throws InputError for a box of more cells than memory and time allow.
  HomogenisedBox(const Domain& box, double k, Complex inside);

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  Vec2 cell() const { return {dx_, dz_}; }
  Vec2 centre(std::size_t column, std::size_t row) const;

  /// [row][column], at the centres of the cells.
  std::vector<Complex> field(double angle) const;

 private:
  void find_spectrum();
  std::vector<Complex> applied(const std::vector<Complex>& field) const;

  Domain box_;
  double k_;
  Complex contrast_;  ///< K^2 - k^2
  std::size_t columns_, rows_, wide_, high_;
  double dx_, dz_;
  std::vector<Complex> spectrum_;  ///< of the Green function, times the cell
};

}  // namespace flatspeckle::mc
