#include "wave_solver/solutions/spectrum.h"

#include <algorithm>
#include <functional>

#include "core/result/result_group.h"
#include "flatland/scene/scene_datasets.h"

namespace flatspeckle::wave {

const DatasetTable spectrum_table{
    "solve at several wavelengths",
    {{"wavelength", Data::scale, "", "length", "around the scatterers"},
     {"far_field", Data::complex, "wavelength light_angle view_angle", "length^(1/2)",
      "far-field amplitude A, phase origin at r = 0"},
     {"near_field", Data::complex, "wavelength light_angle sensor", "1",
      "scattered field, without the incident wave"},
     {"solve/unknowns", Data::count, "wavelength", "1", "of the equations"},
     {"solve/highest_order", Data::count, "wavelength", "1", "highest angular order of all"},
     {"solve/residual", Data::real, "wavelength", "1",
      "relative residual of the unscaled equations"},
     {"solve/boundary_residual", Data::real, "wavelength", "1",
      "largest mismatch of the boundary conditions, unit incident waves"}}};

Spectrum::Spectrum(const std::vector<double>& view_angles, const std::vector<Vec2>& sensors)
    : far_views_(column(view_angles, far_view)), near_sensors_(column(sensors, near_sensor)) {}

void Spectrum::add(double wavelength, const WaveSolution& solution) {
  const auto append = [&](std::vector<Complex>& fields, const std::vector<View>& views) {
    const auto more = solution.fields(views);
    fields.insert(fields.end(), more.begin(), more.end());
  };
  append(far_, far_views_);
  append(near_, near_sensors_);
  wavelengths_.push_back(wavelength);
  light_angles_ = solution.light_angles();
  placement_ = solution.system().placement();
  unknowns_.push_back(solution.system().unknowns());
  const auto orders = solution.basis_order();
  orders_.push_back(orders.empty() ? 0
                                   : static_cast<std::uint64_t>(*std::ranges::max_element(orders)));
  residual_.push_back(solution.diagnosis().residual);
  boundary_residual_.push_back(solution.diagnosis().boundary_residual);
}

double Spectrum::residual() const {
  return *std::ranges::max_element(residual_);
}

std::size_t Spectrum::unknowns() const {
  return *std::ranges::max_element(unknowns_);
}

void Spectrum::write(ResultFile& file) const {
  const ResultGroup root(file, spectrum_table);
  root.put("wavelength", wavelengths_);
  write_light_axis(file, light_angles_);
  const auto put = [&](const std::string& name, const std::vector<Complex>& fields,
                       const std::vector<View>& views) {
    if (views.empty()) return;
    write_view_axis(file, views);
    root.put(name, fields);
  };
  put("far_field", far_, far_views_);
  put("near_field", near_, near_sensors_);
  root.put("solve/unknowns", unknowns_);
  root.put("solve/highest_order", orders_);
  root.put("solve/residual", residual_);
  root.put("solve/boundary_residual", boundary_residual_);
  write_placement(file, placement_);
}

}  // namespace flatspeckle::wave
