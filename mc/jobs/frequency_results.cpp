#include "mc/jobs/frequency_results.h"

#include "core/result/result_group.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

const DatasetTable frequency_table{
    "frequency shifts",
    {{"frequency_shift", Data::scale, "", "1", "relative frequency shift of the second field"},
     {"frequency_shift_hz", Data::real, "frequency_shift", "Hz",
      "frequency shift, if the optical frequency is known (medium_index and length_unit)"},
     {"frequency_covariance", Data::complex_estimate, "frequency_shift LIGHT VIEW", "COVARIANCE",
      "covariance of the field with the field at the shifted frequency"},
     {"frequency_correlation", Data::complex_estimate, "frequency_shift LIGHT VIEW", "1",
      "frequency_covariance over the intensity"},
     {"frequency_diffusion_theory", Data::real, "frequency_shift", "1",
      "|frequency_correlation| of transmitted light in diffusion theory"},
     {"frequency_half_width", Data::estimate, "LIGHT VIEW", "1",
      "relative frequency shift at which C_I = |frequency_correlation|^2 falls to 1/2"},
     {"frequency_half_width_censored", Data::count, "LIGHT VIEW", "1", crossing_meaning},
     {"frequency_half_width_hz", Data::estimate, "LIGHT VIEW", "Hz",
      "the same in Hz, if the optical frequency is known"},
     {"linewidth", Data::scale, "", "1",
      "full width at half maximum of the spectrum of a source, relative to its frequency"},
     {"linewidth_hz", Data::real, "linewidth", "Hz",
      "full width at half maximum, if the optical frequency is known"},
     {"squared_source_contrast", Data::estimate, "linewidth LIGHT VIEW", "1",
      "squared contrast C^2 of the speckle of a source of this linewidth"},
     {"frequency_tilt_covariance", Data::complex_estimate, "frequency_shift tilt VIEW",
      "COVARIANCE", "covariance of the reference with the moved field at the shifted frequency"},
     {"frequency_tilt_correlation", Data::estimate, "frequency_shift tilt", "1",
      "C_E of the reference and the moved field at the shifted frequency"}},
    {{"frequency_shift", "optical_frequency", "float64",
      "optical frequency in Hz, if it is known"}}};

void write_shift_axis(ResultFile& file, const FrequencyShifts& shifts) {
  const ResultGroup root(file, frequency_table);
  root.put("frequency_shift", shifts.relative);
  if (!shifts.optical) return;
  root.attribute("frequency_shift", "optical_frequency", *shifts.optical);
  root.put("frequency_shift_hz",
           column(shifts.relative, [&](double shift) { return shifts.shown(shift); }));
}

void write_frequency_shifts(ResultFile& file, const std::string& group, const Scene& scene,
                            const std::vector<double>& shifts, const ChangeEstimates& found) {
  const CovarianceRequest& request = scene.request;
  const ResultGroup results(file, frequency_table, group);
  const std::string name = request.has_reference() ? "frequency_tilt_" : "frequency_";
  results.put(name + "covariance", found.covariance);
  results.put(name + "correlation", found.correlation);
  if (request.has_reference() || scene.domain.kind != Domain::Kind::slab || scene.profile ||
      !request.transmission_only())
    return;
  results.put("frequency_diffusion_theory", column(shifts, [&](double shift) {
                return diffusion_frequency_correlation(scene, scene.k, shift);
              }));
}

namespace {

Estimate scaled(Estimate estimate, double factor) {
  for (Complex& value : estimate.value) value *= factor;
  for (double& error : estimate.error) error *= factor;
  return estimate;
}

}  // namespace

void write_half_widths(ResultFile& file, const FrequencyShifts& shifts, const Crossings& widths) {
  const ResultGroup root(file, frequency_table);
  root.put("frequency_half_width", widths.value);
  root.put("frequency_half_width_censored", std::span(widths.censored));
  if (shifts.optical) root.put("frequency_half_width_hz", scaled(widths.value, *shifts.optical));
}

void write_source_contrast(ResultFile& file, const FrequencyShifts& shifts,
                           const std::vector<SourceLine>& lines, const Estimate& squares) {
  const ResultGroup root(file, frequency_table);
  root.put("linewidth", column(lines, &SourceLine::width));
  if (shifts.optical)
    root.put("linewidth_hz",
             column(lines, [&](const SourceLine& line) { return shifts.shown(line.width()); }));
  root.put("squared_source_contrast", squares);
}

}  // namespace flatspeckle::mc
