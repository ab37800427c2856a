#include "flatland/media/layers.h"

#include <algorithm>
#include <cmath>

#include "core/result/result_group.h"

namespace flatspeckle {

Layers::Layers(std::vector<Material> materials, const std::vector<double>& thicknesses)
    : MediumProfile(std::move(materials)), faces_{0}, depths_{0} {
  for (std::size_t layer = 0; layer < thicknesses.size(); ++layer) {
    faces_.push_back(faces_.back() + thicknesses[layer]);
    depths_.push_back(depths_.back() + mu(layer) * thicknesses[layer]);
  }
}

std::size_t Layers::material_at(Vec x) const {
  const auto inner = std::upper_bound(faces_.begin() + 1, faces_.end() - 1, x.z);
  return static_cast<std::size_t>(inner - faces_.begin()) - 1;
}

double Layers::most_density() const {
  double most = 0;
  for (const Material& material : materials()) most = std::max(most, material.medium.density);
  return most;
}

double Layers::depth_at(double z) const {
  const std::size_t layer = material_at({0, z});
  return depths_[layer] + mu(layer) * (z - faces_[layer]);
}

/// If the path stays within one layer, returns mu_t times its length, because the difference of the
/// optical depths of its ends would lose digits.
double Layers::optical_depth(Vec x, Vec w, double length) const {
  const double end = x.z + length * w.z;
  const std::size_t layer = material_at(x);
  if (layer == material_at({0, end})) return mu(layer) * length;
  return (depth_at(end) - depth_at(x.z)) / w.z;
}

double Layers::reach(Vec x, Vec w, double optical_depth, double longest) const {
  double gone = 0;
  for (auto layer = static_cast<std::ptrdiff_t>(material_at(x));; layer += w.z > 0 ? 1 : -1) {
    const auto here = static_cast<std::size_t>(layer);
    const double face = w.z > 0 ? faces_[here + 1] : faces_[here],
                 to_face = w.z == 0 ? longest : std::min(longest, (face - x.z) / w.z);
    const double across = mu(here) * std::max(0.0, to_face - gone);
    if (optical_depth <= across) return std::min(longest, gone + optical_depth / mu(here));
    optical_depth -= across;
    gone = std::max(gone, to_face);
    const bool last = w.z > 0 ? here + 2 == faces_.size() : here == 0;
    if (last || gone >= longest) return longest;
  }
}

std::shared_ptr<const MediumProfile> Layers::with(std::vector<Material> materials) const {
  std::vector<double> thicknesses;
  for (std::size_t layer = 0; layer < materials.size(); ++layer)
    thicknesses.push_back(thickness(layer));
  return std::make_shared<const Layers>(std::move(materials), thicknesses);
}

BulkMedium Layers::mean() const {
  std::vector<std::pair<const BulkMedium*, double>> shares;
  for (std::size_t layer = 0; layer < materials().size(); ++layer)
    shares.emplace_back(&materials()[layer].medium, thickness(layer) / faces_.back());
  return mean_medium(shares);
}

std::string Layers::describe() const {
  return std::to_string(materials().size()) + " layers";
}

const DatasetTable layers_table{
    "layers",
    {{"layer", Data::numbers, "", "1", "number of the layer; the first begins at z = 0"},
     {"layer_thickness", Data::real, "layer", "length", "thickness"},
     {"layer_optical_depth", Data::real, "layer", "1", "mu_t times the thickness"},
     {"layer_g", Data::real, "layer", "1", "mean cosine of scattering"},
     {"layer_albedo", Data::real, "layer", "1", "mu_s/mu_t"},
     {"layer_k_shift", Data::real, "layer", "1/length",
      "real part of the effective wavenumber, minus k"},
     {"layer_index", Data::real, "layer", "1", "refractive index around the scatterers"}}};

void Layers::write(ResultFile& file) const {
  const ResultGroup root(file, layers_table);
  root.number("layer", materials().size());
  std::vector<double> thicknesses, depths;
  for (std::size_t layer = 0; layer < materials().size(); ++layer) {
    thicknesses.push_back(thickness(layer));
    depths.push_back(mu(layer) * thickness(layer));
  }
  root.put("layer_thickness", thicknesses);
  root.put("layer_optical_depth", depths);
  const auto put = [&](const std::string& name, double BulkMedium::*member) {
    root.put(name, column(materials(), [&](const Material& each) { return each.medium.*member; }));
  };
  put("layer_g", &BulkMedium::g);
  put("layer_albedo", &BulkMedium::albedo);
  put("layer_k_shift", &BulkMedium::k_shift);
  root.put("layer_index", column(materials(), &Material::index));
}

}  // namespace flatspeckle
