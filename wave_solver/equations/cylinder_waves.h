#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"
#include "flatland/media/domain.h"

namespace flatspeckle::wave {

/// One wave about a centre: with angles phi measured as in C2,
///   sqrt(2) H_n(k r) cos(n phi) or sqrt(2) H_n(k r) sin(n phi),  H_0(k r) for n = 0,
/// or the same with J_n. These real standing waves and e^{i n phi} are related by a unitary
/// transform. weight: what multiplies the wave, over sqrt(2); sqrt(1/2) for a bare H_0.
struct Mode {
  int order = 0;
  bool odd = false;  ///< sin
  ScaledReal weight;
};

/// A centre and some of its modes.
struct ModeSet {
  Vec2 centre;
  std::span<const Mode> modes;
  int order = 0;  ///< the largest one
};

inline constexpr long double root_half = 0.70710678118654752440084436210485L;

/// Where a translation is written: element (row, column) at data[row + ld * column].
struct Target {
  Complex* data = nullptr;
  std::size_t ld = 0;
};

/// Coefficients of the regular modes about each of the receivers for unit outgoing modes of the
/// sender (Graf's addition theorem, C10, in real form). Rows run over the modes of all receivers,
/// one after the other. With E_m = H_m cos(m theta), O_m = H_m sin(m theta) of the displacement
/// from sender to receiver, cos p receives E_{n-p} + (-1)^p E_{n+p} from cos n and
/// O_{n-p} + (-1)^p O_{n+p} from sin n; sin p receives -O_{n-p} + (-1)^p O_{n+p} and
/// E_{n-p} - (-1)^p E_{n+p}. A receiver at the very place of the sender gets 0. Vectorised over
/// receivers in double precision; pairs whose H_m would leave its range are done in Scaled numbers.
/// Throws InputError where the result itself is out of range.
void translate(double k, std::span<const ModeSet> receivers, const ModeSet& sender, Target out);

/// The same for unit regular modes of the sender: J_m in place of H_m. Its transpose takes outgoing
/// modes of the receivers to outgoing modes about the sender's centre, beyond the receivers.
void translate_regular(double k, std::span<const ModeSet> receivers, const ModeSet& sender,
                       Target out);

/// The coefficients of `factor` times the plane wave along the unit vector w in unit regular modes
/// of the receivers (C6): sqrt(2) weight i^n {cos, sin}(n angle) e^{i k w.r}, one after the other.
/// With -w they take outgoing modes to the far field along w.
void expand_plane_wave(double k, std::span<const ModeSet> receivers, Vec2 w, Complex factor,
                       std::span<Complex> out);

/// The sender's outgoing modes at points: rows are points.
void field_at(double k, std::span<const Vec2> points, const ModeSet& sender, Target out);

/// Derivatives of the sender's outgoing modes along unit vectors at points, over k.
void slopes(double k, std::span<const Vec2> points, std::span<const Vec2> along,
            const ModeSet& sender, Target out);

}  // namespace flatspeckle::wave
