#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/request/request.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/cylinder_waves.h"

namespace flatspeckle::wave {

inline constexpr std::size_t tile_side = 32;

/// body(i, j) for i < rows, j < columns, tile by tile: both [i][j] and [j][i] stay in cache.
template <typename Body>
void for_each_tiled(std::size_t rows, std::size_t columns, const Body& body) {
  for (std::size_t j0 = 0; j0 < columns; j0 += tile_side)
    for (std::size_t i0 = 0; i0 < rows; i0 += tile_side)
      for (std::size_t j = j0; j < std::min(j0 + tile_side, columns); ++j)
        for (std::size_t i = i0; i < std::min(i0 + tile_side, rows); ++i) body(i, j);
}

/// Copies columns begin .. end - 1 of the lower triangle of a column-major matrix onto the upper
/// one, tile by tile.
inline void mirror_columns(Complex* matrix, std::size_t size, std::size_t begin, std::size_t end) {
  for (std::size_t row0 = begin; row0 < size; row0 += tile_side)
    for (std::size_t row = row0; row < std::min(row0 + tile_side, size); ++row)
      for (std::size_t column = begin; column < std::min(end, row); ++column)
        matrix[row * size + column] = matrix[column * size + row];
}

inline void mirror_lower(std::vector<Complex>& matrix, std::size_t size) {
  for (std::size_t column = 0; column < size; column += tile_side)
    mirror_columns(matrix.data(), size, column, std::min(column + tile_side, size));
}

/// Threads that solve systems of their own at this moment, this one included.
int systems_at_work();

/// Bytes that each of some systems, solved together, may take.
double memory_of_system(int together = systems_at_work());

/// Throws InputError where the dense matrix of so many unknowns needs more.
void require_dense_memory(std::size_t unknowns, int together = systems_at_work());

/// The multiple-scattering equations of bodies that answer regular waves with outgoing ones,
/// b = T (a + S b) (C10), in the real standing waves of cylinder_waves.h and with b = sigma beta:
///   M beta = -sigma a,   M = -sigma T^-1 sigma + sigma S sigma,
/// the first part block by block, one for each body. What the bodies are is said by those who
/// derive from this. M is complex symmetric. No body amplifies, -Re T^-1 >= 1, and Re S + 1 is a
/// Gram matrix of waves, so the real part of M is positive semidefinite; Schur complements and real
/// congruences keep that.
///
/// Unknowns run over bodies and, within each, over 0, cos 1, sin 1, cos 2, sin 2, .. order.
class WaveEquations {
 public:
  /// All of it is within the radius, 0 for a point, and so are its waves' sources.
  struct Body {
    Vec2 centre;
    double radius = 0;
  };

  double k() const { return k_; }
  std::size_t unknowns() const { return first_.back(); }
  std::span<const Body> bodies() const { return bodies_; }
  int order(std::size_t body) const;
  /// First unknown of a body; first(bodies().size()) is unknowns().
  std::size_t first(std::size_t body) const { return first_[body]; }
  std::size_t body_of(std::size_t unknown) const { return body_of_[unknown]; }
  /// sigma psi of each unknown of a body.
  ModeSet modes(std::size_t body) const;
  /// sigma^2
  double strength(std::size_t unknown) const;

  Complex diagonal(std::size_t unknown) const { return diagonal_[unknown]; }
  /// M(rows, columns) into out[i + ld * j], for unknowns listed so that those of one body stand
  /// side by side.
  void entries(std::span<const std::size_t> rows, std::span<const std::size_t> columns,
               Complex* out, std::size_t ld) const;
  /// Field at points of sigma psi of each column's unknown, into out[i + ld * j]. The points must
  /// lie off the bodies concerned.
  void outgoing(std::span<const Vec2> points, std::span<const std::size_t> columns, Complex* out,
                std::size_t ld) const;

  /// M, column by column. Threaded unless called from a parallel region.
  Entries matrix() const;
  /// M x formed a block of columns at a time: [column][unknown].
  std::vector<Complex> apply(std::span<const Complex> x) const;

  /// -sigma a of unit plane waves (C6): [light][unknown].
  std::vector<Complex> right_sides(std::span<const double> light_angles) const;
  /// What each unknown adds to the far-field amplitude at angles (C6): [view][unknown]. By
  /// reciprocity a multiple of the right side of the light that comes from there.
  std::vector<Complex> far_rows(std::span<const double> view_angles) const;
  /// What each unknown adds to the scattered field at a point off all bodies.
  std::vector<Complex> outside_row(Vec2 point) const;
  /// Either, of far and near views: [view][unknown].
  std::vector<Complex> view_rows(std::span<const View> views) const;

 protected:
  using OwnBlock = std::shared_ptr<const std::vector<Complex>>;  // column-major

  explicit WaveEquations(double k) : k_(k), first_{0} {}
  ~WaveEquations() = default;
  WaveEquations(const WaveEquations&) = default;
  WaveEquations(WaveEquations&&) = default;
  WaveEquations& operator=(const WaveEquations&) = default;
  WaveEquations& operator=(WaveEquations&&) = default;

  /// modes: of all unknowns of one more body, with sigma. The body's part of M is diagonal, or any
  /// symmetric block.
  void add(const Body& body, std::span<const Mode> modes, std::span<const Complex> diagonal);
  void add(const Body& body, std::span<const Mode> modes, OwnBlock own);

 private:
  struct Listed;
  void add(const Body& body, std::span<const Mode> modes);
  Complex own(std::size_t row, std::size_t column) const;  // of one body
  void add_own(std::size_t begin, std::size_t end, const Complex* x, Complex* y) const;
  std::vector<ModeSet> all_modes() const;
  std::vector<std::size_t> column_blocks() const;
  // M, in parts of columns with what is symmetric to them.
  void point_columns(Complex* matrix) const;
  void multipole_columns(Complex* matrix) const;
  std::vector<Complex> plane_waves(std::span<const double> angles, double sign,
                                   Complex factor) const;

  double k_;
  std::vector<Body> bodies_;
  std::vector<std::size_t> first_, body_of_;
  std::vector<Mode> modes_;
  std::vector<Complex> diagonal_;
  std::vector<OwnBlock> own_;  // of each body; none where it is diagonal
};

}  // namespace flatspeckle::wave
