#pragma once

#include <cstdint>
#include <vector>

#include "core/numbers/statistics.h"
#include "core/result/dataset_row.h"
#include "core/run/runner.h"
#include "flatland/scene/scene.h"
#include "wave_solver/periodic/scattering_matrix.h"

namespace flatspeckle::wave {

/// Transmission eigenchannels of a matrix t, the most open first.
struct Eigenchannels {
  std::vector<double> eigenvalues;
  std::vector<std::vector<Complex>> waves;  ///< amplitudes of the light channels, with the norm 1
};
/// t: n x n, column-major, with a column for each light channel.
Eigenchannels eigenchannels(std::vector<Complex> t, std::size_t n);

/// Settings of an ensemble of scattering matrices.
struct MatrixSettings {
  double phase = 0;  ///< Bloch phase of a period, the width of the box
  std::size_t eigenvalue_bins = 20;
  std::size_t shifts = 10;  ///< largest shift of channels for correlations
  /// Largest |sin| of the channels, on both sides, of the filtered part of t.
  double numerical_aperture = 1;
  std::vector<std::int64_t> segments;       ///< numbers of segments for focusing
  std::vector<double> conjugated_fraction;  ///< parts of the back channels, for phase conjugation
  SolveOptions options;
};

/// Statistics of the transmission matrices t of many placements. In a batch, one placement is drawn
/// with draw_periodic_placement() and solved for all channels. With N channels on each side and
/// t_ba the amplitude from light channel a to channel b at the back:
/// - transmittance T_a = sum_b |t_ba|^2, conductance g = sum_a T_a;
/// - eigenvalues tau of t^H t, and the largest of them;
/// - tilt correlations |<sum t_ba conj(t_b'a')>| / sqrt(<sum |t_ba|^2> <sum |t_b'a'|^2>), where
///   primes are channels shifted by d and the phase origin of outgoing waves is the back of the
///   slab: over all a and b != a, for the light closest to normal incidence (a fixed, b != a), and
///   for the most open eigenchannel, with its incident wave shifted;
/// - focusing on a channel b by light of equal power in all channels with the best phases, compared
///   with random phases: sum_b (sum_a |t_ba|)^2 / sum_b sum_a |t_ba|^2;
/// - the same for segments of the light channels (add_focus), and the part of the light that
/// returns
///   to its channel by phase conjugation (add_conjugation).
struct MatrixJob {
  BatchJob batches;
  std::vector<CellChannel> channels;
  MatrixSettings settings;
};
MatrixJob matrix_job(const Scene& scene, const MatrixSettings& settings, std::uint64_t seed);

/// Results of a MatrixJob.
struct MatrixStatistics {
  Estimate transmittance, reflectance;  ///< of each light channel
  /// Mean conductance; variance of g; <T_a^2> / <T_a>^2 - 1 averaged over the channels (C2);
  /// variance of g / <g>^2 (C3); mean of the largest eigenvalue; enhancement of focusing.
  Estimate conductance, conductance_variance, channel_variance, relative_variance, largest, focus;
  Estimate eigenvalues;  ///< mean number of eigenvalues in each bin
  Estimate filtered;     ///< the same for the filtered part of t, if it is smaller than t
  std::size_t kept = 0;  ///< number of channels of the filtered part
  /// [shift = 0 .. shifts]
  Estimate tilt_correlation, normal_correlation, open_correlation;
  Estimate segment_focus;            ///< enhancement of focusing for each number of segments
  std::vector<double> focus_theory;  ///< expected_focus() of all channels, and of each segmentation
  std::vector<double> recorded;      ///< part of the channels that is recorded and conjugated
  Estimate conjugation;              ///< for each of them, part of the light that returns
  std::vector<double> conjugation_theory;
  Invariant power, reciprocity;
  Invariant unit_cell;  ///< of the first placement; its limit is 0 if unit cells are not compared
};
MatrixStatistics matrix_statistics(const MatrixJob& job, const GroupedSums& sums);

extern const DatasetTable matrix_table, scattering_matrix_table;
void write_statistics(ResultFile& file, const MatrixJob& job, const MatrixStatistics& found);
/// Writes the scattering matrix of one placement and its transmission eigenvalues.
void write_scattering_matrix(ResultFile& file, const ScatteringMatrix& found);

}  // namespace flatspeckle::wave
