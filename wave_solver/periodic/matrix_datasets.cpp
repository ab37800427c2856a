#include <span>
#include <vector>

#include "core/result/result_group.h"
#include "wave_solver/periodic/eigenvalue_laws.h"
#include "wave_solver/periodic/matrix_job.h"

namespace flatspeckle::wave {

const DatasetTable matrix_table{
    "matrix",
    {{"light_sine", Data::scale, "", "1", "k_x / k of a light channel at the front"},
     {"transmittance", Data::estimate, "light_sine", "1",
      "transmitted power of each light channel"},
     {"reflectance", Data::estimate, "light_sine", "1", "reflected power of each light channel"},
     {"conductance", Data::estimate, "", "1", "g: transmittance summed over light channels"},
     {"conductance_variance", Data::estimate, "", "1", "variance of g over placements"},
     {"c2", Data::estimate, "", "1",
      "relative variance of the transmittance of a channel, averaged over channels"},
     {"c3", Data::estimate, "", "1", "relative variance of the conductance"},
     {"largest_eigenvalue", Data::estimate, "", "1", "transmittance of the most open eigenchannel"},
     {"eigenvalue", Data::scale, "", "1", "transmission eigenvalue, centre of a bin"},
     {"eigenvalue_count", Data::estimate, "eigenvalue", "1",
      "mean number of transmission eigenvalues in each bin"},
     {"bimodal_count", Data::real, "eigenvalue", "1",
      "eigenvalue_count by Dorokhov's law for the measured conductance"},
     {"filtered_eigenvalue_count", Data::estimate, "eigenvalue", "1",
      "eigenvalue_count of the part of t within the numerical aperture"},
     {"filtered_law_count", Data::real, "eigenvalue", "1",
      "filtered_eigenvalue_count by the law of filtered random matrices"},
     {"channel_shift", Data::numbers, "", "1", "shift of light and view, in channels"},
     {"tilt", Data::real, "channel_shift", "1", "shift of sin(angle)"},
     {"tilt_correlation", Data::estimate, "channel_shift", "1",
      "field correlation C_E of tilted light, over all light channels"},
     {"normal_tilt_correlation", Data::estimate, "channel_shift", "1",
      "field correlation C_E for light tilted from normal incidence"},
     {"open_tilt_correlation", Data::estimate, "channel_shift", "1",
      "field correlation C_E of the most open eigenchannel, tilted"},
     {"focus_enhancement", Data::estimate, "", "1",
      "enhancement of the intensity in a channel by phases of all light channels"},
     {"focus_theory", Data::real, "", "1", "focus_enhancement for independent Gaussian amplitudes"},
     {"segments", Data::scale, "", "1",
      "number of segments, groups of neighbouring light channels"},
     {"segment_enhancement", Data::estimate, "segments", "1",
      "focus_enhancement by one phase for each segment"},
     {"segment_theory", Data::real, "segments", "1",
      "segment_enhancement for independent Gaussian amplitudes"},
     {"conjugated_fraction", Data::scale, "", "1",
      "part of the channels at the back that is recorded and phase-conjugated"},
     {"conjugation_peak", Data::estimate, "conjugated_fraction", "1",
      "part of the transmitted conjugated light that returns to the original channel"},
     {"conjugation_theory", Data::real, "conjugated_fraction", "1",
      "conjugation_peak of a lossless diffusive slab, by the bimodal law"},
     {"invariants/power", Data::invariant, "", "1",
      "mean over placements of the largest deviation from conservation of power"},
     {"invariants/reciprocity", Data::invariant, "", "1",
      "mean over placements of the largest deviation from reciprocity"},
     {"invariants/unit_cell", Data::invariant, "", "1",
      "largest change of the first scattering matrix if the unit cell begins at another x"}}};

void write_statistics(ResultFile& file, const MatrixJob& job, const MatrixStatistics& found) {
  const ResultGroup root(file, matrix_table);
  const std::size_t bins = job.settings.eigenvalue_bins, n = job.channels.size();
  std::vector<double> centres, tilts;
  for (std::size_t i = 0; i < bins; ++i)
    centres.push_back((static_cast<double>(i) + 0.5) / static_cast<double>(bins));
  for (std::size_t d = 0; d <= job.settings.shifts; ++d)
    tilts.push_back(job.channels[n / 2 + d].sine - job.channels[n / 2].sine);
  root.put("light_sine", column(job.channels, &CellChannel::sine));
  root.put("transmittance", found.transmittance);
  root.put("reflectance", found.reflectance);
  root.put("conductance", found.conductance);
  root.put("conductance_variance", found.conductance_variance);
  root.put("c2", found.channel_variance);
  root.put("c3", found.relative_variance);
  root.put("largest_eigenvalue", found.largest);
  root.put("eigenvalue", centres);
  root.put("eigenvalue_count", found.eigenvalues);
  root.put("bimodal_count", bimodal_counts(found.conductance.value[0].real(), n, bins));
  if (found.kept < n) {
    root.put("filtered_eigenvalue_count", found.filtered);
    root.put("filtered_law_count",
             filtered_counts(found.conductance.value[0].real(), n, found.kept, bins));
  }
  root.number("channel_shift", job.settings.shifts + 1);
  root.put("tilt", tilts);
  root.put("tilt_correlation", found.tilt_correlation);
  root.put("normal_tilt_correlation", found.normal_correlation);
  root.put("open_tilt_correlation", found.open_correlation);
  root.put("focus_enhancement", found.focus);
  root.put("focus_theory", found.focus_theory.front());
  if (!job.settings.segments.empty()) {
    root.put("segments", column(job.settings.segments,
                                [](std::int64_t number) { return static_cast<double>(number); }));
    root.put("segment_enhancement", found.segment_focus);
    root.put("segment_theory", std::span(found.focus_theory).subspan(1));
  }
  if (!found.recorded.empty()) {
    root.put("conjugated_fraction", found.recorded);
    root.put("conjugation_peak", found.conjugation);
    root.put("conjugation_theory", found.conjugation_theory);
  }
  root.check("invariants/power", found.power);
  if (found.reciprocity.limit > 0) root.check("invariants/reciprocity", found.reciprocity);
  if (found.unit_cell.limit > 0) root.check("invariants/unit_cell", found.unit_cell);
}

const DatasetTable scattering_matrix_table{
    "solve in a periodic cell",
    {{"light_side", Data::numbers, "", "1", "side of the light: 0 front (z < 0), 1 back"},
     {"light_sine", Data::scale, "", "1", "k_x / k of a light channel"},
     {"side", Data::numbers, "", "1", "side of the outgoing wave: 0 front, 1 back"},
     {"sine", Data::scale, "", "1", "k_x / k of an outgoing channel"},
     {"scattering_matrix", Data::complex, "light_side light_sine side sine", "1",
      "amplitudes of outgoing channels with unit flux, phase origin at r = 0"},
     {"absorptance", Data::real, "light_side light_sine", "1", "absorbed power"},
     {"eigenchannel", Data::numbers, "", "1", "number of a transmission eigenchannel"},
     {"transmission_eigenvalue", Data::real, "eigenchannel", "1",
      "eigenvalue of t^H t for light from the front"},
     {"map_wave", Data::numbers, "", "1",
      "mapped light: 0 the channel closest to normal incidence, then map_eigenchannels, then those "
      "of map_lights"},
     {"map_light", Data::complex, "map_wave light_sine", "1",
      "amplitudes with unit flux of the mapped light in the channels at the front, phase origin at "
      "r = 0"},
     {"map_transmittance", Data::real, "map_wave", "1", "transmittance of the mapped light"},
     {"solve/residual", Data::real, "", "1", "relative residual of the unscaled equations"},
     {"invariants/power", Data::invariant, "", "1",
      "largest deviation from conservation of power and, without absorption, from unitarity"},
     {"invariants/reciprocity", Data::invariant, "", "1",
      "largest deviation from reciprocity, for phases 0 and pi"},
     {"invariants/unit_cell", Data::invariant, "", "1",
      "largest change of scattering_matrix if the unit cell begins at another x"}},
    {{"map_wave", "eigenchannels", "int64", "number of mapped eigenchannels"}}};

void write_scattering_matrix(ResultFile& file, const ScatteringMatrix& found) {
  const ResultGroup root(file, scattering_matrix_table);
  const auto sines = column(found.channels, &CellChannel::sine);
  root.number("light_side", 2);
  root.put("light_sine", sines);
  root.number("side", 2);
  root.put("sine", sines);
  root.put("scattering_matrix", found.s);
  root.put("absorptance", found.absorbed);
  root.number("eigenchannel", found.channels.size());
  root.put("transmission_eigenvalue",
           eigenchannels(found.quarter(false, true), found.channels.size()).eigenvalues);
  if (found.residual >= 0) root.put("solve/residual", found.residual);
  root.check("invariants/power", found.power);
  if (found.reciprocity.limit > 0) root.check("invariants/reciprocity", found.reciprocity);
  if (found.unit_cell.limit > 0) root.check("invariants/unit_cell", found.unit_cell);
}

}  // namespace flatspeckle::wave
