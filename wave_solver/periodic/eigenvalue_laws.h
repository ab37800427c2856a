#pragma once

#include <cstddef>
#include <vector>

namespace flatspeckle::wave {

/// Returns the mean number of transmission eigenvalues in each of `bins` equal bins of (0, 1) by
/// Dorokhov's bimodal law for a conductance g and n channels, whose smallest eigenvalue is 1 /
/// cosh^2(n / g).
std::vector<double> bimodal_counts(double g, std::size_t n, std::size_t bins);

/// Returns the same for the part of t between `kept` of the n light channels and as many outgoing
/// ones, by the law of filtered random matrices [goetschy2013]. The law assumes that all channels
/// transmit equally.
std::vector<double> filtered_counts(double g, std::size_t n, std::size_t kept, std::size_t bins);

}  // namespace flatspeckle::wave
