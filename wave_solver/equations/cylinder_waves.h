#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"
#include "flatland/media/domain.h"

namespace flatspeckle::wave {

/// A cylindrical wave about a centre. At distance r and angle phi (C2) from the centre it is
/// proportional to
///   sqrt(2) H_n(k r) cos(n phi) or sqrt(2) H_n(k r) sin(n phi),  H_0(k r) for n = 0,
/// or the corresponding regular wave with J_n. A unitary transform relates these real standing
/// waves to those with e^{i n phi}. weight: the wave is sqrt(2) weight H_n(k r) {cos, sin}(n phi),
/// so that H_0 itself has the weight sqrt(1/2).
struct Mode {
  int order = 0;
  bool odd = false;  ///< true for sin(n phi), false for cos(n phi)
  ScaledReal weight;
};

/// Modes about a common centre.
struct ModeSet {
  Vec centre;
  std::span<const Mode> modes;
  int order = 0;  ///< largest order of the modes
};

inline constexpr long double root_half = 0.70710678118654752440084436210485L;

/// Destination of a translation: element (row, column) is written to data[row + ld * column].
struct Target {
  Complex* data = nullptr;
  std::size_t ld = 0;
};

/// Computes the coefficients of the regular modes about each receiver for unit outgoing modes of
/// the sender (Graf's addition theorem, C10, in real form). Rows are the modes of all receivers,
/// one receiver after the other; columns are the modes of the sender. Let E_m = H_m(k d) cos(m
/// theta) and O_m = H_m(k d) sin(m theta), where d and theta are length and angle of the
/// displacement from sender to receiver. Then the coefficient of the mode cos(p phi) of a receiver
/// is E_{n-p} + (-1)^p E_{n+p} for the sender's mode cos(n phi), and O_{n-p} + (-1)^p O_{n+p} for
/// sin(n phi). The coefficient of sin(p phi) is -O_{n-p} + (-1)^p O_{n+p} and E_{n-p} - (-1)^p
/// E_{n+p}, respectively. A receiver at the position of the sender receives 0. Computed in double
/// precision, vectorised over receivers; in Scaled numbers for displacements whose H_m would
/// overflow. Throws InputError if the result itself is out of range.
void translate(double k, std::span<const ModeSet> receivers, const ModeSet& sender, Target out);

/// Computes the same coefficients as translate(), but for unit regular modes of the sender: J_m
/// replaces H_m. The transposed matrix converts outgoing modes of the receivers to outgoing modes
/// about the sender's centre, which are valid farther from that centre than all receivers.
void translate_regular(double k, std::span<const ModeSet> receivers, const ModeSet& sender,
                       Target out);

/// Direction of a plane wave e^{i k w.r}, with w.x^2 + w.z^2 = 1. Complex components describe
/// evanescent waves.
struct WaveDirection {
  Complex x, z;

  WaveDirection(Complex along_x, Complex along_z) : x(along_x), z(along_z) {}
  WaveDirection(Vec w) : x(w.x), z(w.z) {}
  WaveDirection operator-() const { return {-x, -z}; }
};

/// Expands `factor` times the plane wave along w in unit regular modes of the receivers (C6). `out`
/// receives sqrt(2) weight i^n {cos, sin}(n angle) e^{i k w.r} for the modes of one receiver (at r)
/// after the other. The coefficients for -w map amplitudes of outgoing modes to the far field along
/// w.
void expand_plane_wave(double k, std::span<const ModeSet> receivers, const WaveDirection& w,
                       Complex factor, std::span<Complex> out);

/// Evaluates the sender's outgoing modes at points. Rows are points, columns are modes.
void field_at(double k, std::span<const Vec> points, const ModeSet& sender, Target out);

/// Evaluates the directional derivatives of the sender's outgoing modes, divided by k: at
/// points[i], along the unit vector along[i]. Rows are points, columns are modes.
void directional_derivatives(double k, std::span<const Vec> points, std::span<const Vec> along,
                             const ModeSet& sender, Target out);

}  // namespace flatspeckle::wave
