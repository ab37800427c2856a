#pragma once

#include <cstdint>
#include <vector>

#include "core/result/dataset_row.h"
#include "flatland/request/request.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

/// Fields of one placement at several wavelengths, one after the other, and how far each solution
/// can be trusted: [wavelength][light][view].
class Spectrum {
 public:
  Spectrum(const std::vector<double>& view_angles, const std::vector<Vec2>& sensors);

  void add(double wavelength, const WaveSolution& solution);

  /// With axes and placement.
  void write(ResultFile& file) const;

  /// The worst residual so far.
  double residual() const;
  /// Of the largest system so far.
  std::size_t unknowns() const;

 private:
  std::vector<View> far_views_, near_sensors_;
  std::vector<double> wavelengths_, light_angles_;
  std::vector<Complex> far_, near_;
  std::vector<std::uint64_t> unknowns_, orders_;
  std::vector<double> residual_, boundary_residual_;
  Placement placement_;
};

extern const DatasetTable spectrum_table;

}  // namespace flatspeckle::wave
