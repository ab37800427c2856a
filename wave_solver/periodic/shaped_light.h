#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// Focusing through a transmission matrix t (n x n, column-major, with a column for each light
/// channel) with light in `segments` groups of neighbouring channels. All channels carry equal
/// power, and those of a group have equal phases at r = 0. With E_bg the field of group g in
/// channel b, adds sum_b (sum_g |E_bg|)^2, the power of foci with the best phase of each group, and
/// sum_b sum_g |E_bg|^2, their mean power with random phases.
void add_focus(const std::vector<Complex>& t, std::size_t n, std::size_t segments,
               std::span<Complex, 2> sums);

/// Returns the ratio of these sums for independent Gaussian elements of t (Vellekoop and Mosk
/// [vellekoop2007]): 1 + pi/4 (N - 1) for N equal segments.
double expected_focus(const std::vector<double>& transmittance, std::size_t segments);

/// Returns the number of channels, out of n, that are closest to a fraction of them; at least 1.
std::size_t recorded_channels(double fraction, std::size_t n);

/// Phase conjugation through t. Light in channel a is recorded at the back in the middle `recorded`
/// channels, and the conjugate of this field is sent back. By reciprocity, W = t^H P t contains the
/// returned amplitudes, where P selects the recorded channels. Adds sum_a |W_aa|^2, the power that
/// returns to the original channels, and sum_ac |W_ca|^2, the power in all channels at the front.
void add_conjugation(const std::vector<Complex>& t, std::size_t n, std::size_t recorded,
                     std::span<Complex, 2> sums);

/// Returns the ratio of these sums for a lossless diffusive slab. Elements of t are Gaussian with
/// variances u_b w_a, where u and w follow from the transmittance of the channels. Their long-range
/// correlation is the one with which sum tau^2 is 2 g / 3, as by the bimodal law [dorokhov1984].
/// Without this correlation, the ratio for m of n equal channels is (m + 1) / (m + n).
double expected_conjugation(const std::vector<double>& transmittance, std::size_t recorded);

}  // namespace flatspeckle::wave
