#pragma once

#include <algorithm>
#include <cmath>
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

/// Calls body(i, j) for i < rows, j < columns, tile by tile, so that both a matrix and its
/// transpose are accessed within the cache.
template <typename Body>
void for_each_tiled(std::size_t rows, std::size_t columns, const Body& body) {
  for (std::size_t j0 = 0; j0 < columns; j0 += tile_side)
    for (std::size_t i0 = 0; i0 < rows; i0 += tile_side)
      for (std::size_t j = j0; j < std::min(j0 + tile_side, columns); ++j)
        for (std::size_t i = i0; i < std::min(i0 + tile_side, rows); ++i) body(i, j);
}

/// Copies columns begin .. end - 1 of the lower triangle of a column-major matrix to the upper
/// triangle, tile by tile.
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

/// Returns the number of threads that solve separate systems at this moment, including this one.
int concurrent_systems();

/// Returns the bytes available to each of `together` systems that are solved at the same time.
double memory_of_system(int together = concurrent_systems());

/// Throws InputError if the dense matrix of `unknowns` unknowns needs more than memory_of_system().
void require_dense_memory(std::size_t unknowns, int together = concurrent_systems());

/// Copies of all bodies at n periods along x, with n = -count .. count. The waves of copy n are
/// those of the bodies, displaced and multiplied by e^{i n phase}.
struct Copies {
  double period = 0, phase = 0;
  int count = 0;

  /// Whether copies n and -n have the same factor, so that M is symmetric.
  bool symmetric() const { return count == 0 || std::abs(std::sin(phase)) < 1e-15; }
  Complex factor(int n) const { return std::polar(1.0, n * phase); }
};

/// The multiple-scattering equations b = T (a + S b) of bodies that scatter regular waves into
/// outgoing waves (C10). In the real standing waves of cylinder_waves.h, and with b = sigma beta
/// (sigma: diagonal scaling of the unknowns), they are
///   M beta = -sigma a,   M = -sigma T^-1 sigma + sigma S sigma.
/// The first term of M has one diagonal block per body; derived classes define the bodies. M is
/// complex symmetric. Its real part is positive semidefinite, because no body has gain (-Re T^-1 >=
/// 1) and Re S + 1 is a Gram matrix of waves. Schur complements and real congruences preserve this
/// property. With Copies, S is the sum over the copies of the senders, and M is symmetric only if
/// Copies::symmetric().
///
/// Unknowns run over bodies and, within each body, over the waves of order 0, cos(phi), sin(phi),
/// cos(2 phi), sin(2 phi), .. up to the highest order of the body.
class WaveEquations {
 public:
  /// A scatterer. The scatterer and the sources of its waves lie within the radius, which is 0 for
  /// a point.
  struct Body {
    Vec centre;
    double radius = 0;
  };

  double k() const { return k_; }
  std::size_t unknowns() const { return first_.back(); }
  std::span<const Body> bodies() const { return bodies_; }
  int order(std::size_t body) const;
  /// Index of the first unknown of a body; first(bodies().size()) is unknowns().
  std::size_t first(std::size_t body) const { return first_[body]; }
  std::size_t body_of(std::size_t unknown) const { return body_of_[unknown]; }
  const Copies& copies() const { return copies_; }
  /// Modes of the unknowns of a body; their weights contain sigma.
  ModeSet modes(std::size_t body) const;
  /// Returns sigma^2 of an unknown.
  double strength(std::size_t unknown) const;

  Complex diagonal(std::size_t unknown) const { return diagonal_[unknown]; }
  /// Writes the element of M in row rows[i] and column columns[j] to out[i + ld * j]. Unknowns of
  /// one body must be listed consecutively.
  void entries(std::span<const std::size_t> rows, std::span<const std::size_t> columns,
               Complex* out, std::size_t ld) const;
  /// Writes to out[i + ld * j] the field at points[i] if the unknown columns[j] is 1 and all others
  /// are 0, without Copies. The points must lie outside the bodies of these unknowns.
  void outgoing(std::span<const Vec> points, std::span<const std::size_t> columns, Complex* out,
                std::size_t ld) const;

  /// Returns M, column by column. Threaded unless called from a parallel region.
  Entries matrix() const;
  /// Returns M x for one or more columns x, both [column][unknown]. M is computed a block of
  /// columns at a time and is not stored.
  std::vector<Complex> apply(std::span<const Complex> x) const;

  /// Returns the right-hand sides -sigma a for unit plane waves (C6): [light][unknown].
  std::vector<Complex> right_hand_sides(std::span<const double> light_angles) const;
  /// Expands unit plane waves, with phase 0 at `origin`, in the regular modes of all bodies:
  /// [wave][unknown].
  std::vector<Complex> plane_waves(std::span<const WaveDirection> waves, Vec origin = {}) const;
  /// Expands plane waves in some of the modes: [wave][unknown]. unknowns: listed as for entries().
  std::vector<Complex> plane_waves(std::span<const WaveDirection> waves, Vec origin,
                                   std::span<const std::size_t> unknowns) const;
  /// Contribution of each unknown to the far-field amplitude at angles (C6): [view][unknown]. By
  /// reciprocity each row is a multiple of the right-hand side for light from the direction of
  /// view.
  std::vector<Complex> far_rows(std::span<const double> view_angles) const;
  /// Contribution of each unknown, with its Copies, to the scattered field at a point outside all
  /// bodies.
  std::vector<Complex> outside_row(Vec point) const;
  /// Returns far_rows() or outside_row() for each view: [view][unknown].
  std::vector<Complex> view_rows(std::span<const View> views) const;

 protected:
  using OwnBlock = std::shared_ptr<const std::vector<Complex>>;  // square, column-major

  explicit WaveEquations(double k, const Copies& copies = {}) : k_(k), copies_(copies), first_{0} {}
  ~WaveEquations() = default;
  WaveEquations(const WaveEquations&) = default;
  WaveEquations(WaveEquations&&) = default;
  WaveEquations& operator=(const WaveEquations&) = default;
  WaveEquations& operator=(WaveEquations&&) = default;

  /// Adds a body. modes: the modes of all its unknowns, with sigma in their weights. The diagonal
  /// block of M that belongs to the body is given by its diagonal elements (diagonal) or, if it is
  /// not diagonal, as a symmetric matrix (own).
  void add(const Body& body, std::span<const Mode> modes, std::span<const Complex> diagonal);
  void add(const Body& body, std::span<const Mode> modes, OwnBlock own);

 private:
  struct Listed;
  void add(const Body& body, std::span<const Mode> modes);
  // Element of M between two unknowns of the same body.
  Complex own(std::size_t row, std::size_t column) const;
  void add_own(std::size_t begin, std::size_t end, const Complex* x, Complex* y) const;
  std::vector<ModeSet> all_modes() const;
  std::vector<Complex> plane_waves(std::span<const WaveDirection> waves, Vec origin,
                                   std::span<const ModeSet> receivers, std::size_t unknowns) const;
  std::vector<std::size_t> column_blocks() const;
  // These functions fill M in groups of columns and mirror them to the rows.
  void point_columns(Complex* matrix) const;
  void multipole_columns(Complex* matrix) const;
  std::vector<Complex> plane_waves(std::span<const double> angles, double sign,
                                   Complex factor) const;

  // Calls translate() for the sender and all its copies, and adds the results. reversed: gives copy
  // n the factor of copy -n, so that the result belongs to the transpose of M.
  void translate_copies(std::span<const ModeSet> receivers, const ModeSet& sender, Target out,
                        bool reversed = false) const;

  double k_;
  Copies copies_;
  std::vector<Body> bodies_;
  std::vector<std::size_t> first_, body_of_;
  std::vector<Mode> modes_;
  std::vector<Complex> diagonal_;
  std::vector<OwnBlock> own_;  // diagonal block of each body; null if only diagonal_ is used
};

}  // namespace flatspeckle::wave
