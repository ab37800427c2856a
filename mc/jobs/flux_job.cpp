#include "mc/jobs/flux_job.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "core/result/result_group.h"
#include "flatland/media/face_stack.h"
#include "flatland/media/layers.h"
#include "flatland/scene/scene_datasets.h"

namespace flatspeckle::mc {

FluxEstimates flux_estimates(const FluxJob& job, const GroupedSums& sums) {
  const Estimate all = jackknife(sums, sample_mean);
  const std::size_t size = flux_shares + job.angle_bins;
  const double per_radian = static_cast<double>(job.angle_bins) / job.angles;
  FluxEstimates flux;
  Estimate* const shares[flux_shares] = {&flux.reflectance, &flux.transmittance, &flux.side_loss,
                                         &flux.absorptance};
  for (std::size_t entry = 0; entry < all.value.size(); ++entry) {
    const std::size_t number = entry % size;
    Estimate& estimate = number < flux_shares ? *shares[number] : flux.exit_radiance;
    const double factor = number < flux_shares ? 1 : per_radian;
    estimate.value.push_back(factor * all.value[entry]);
    estimate.error.push_back(factor * all.error[entry]);
    estimate.rare.push_back(all.rare[entry]);
  }
  return flux;
}

std::vector<Invariant> power_balance(const FluxJob& job, const GroupedSums& sums,
                                     const std::vector<double>& direct) {
  constexpr double rounding = 1e-9;
  const std::size_t size = flux_shares + job.angle_bins;
  const Estimate found = jackknife(sums, [&](double samples, std::span<const Complex> all) {
    std::vector<Complex> off;
    for (std::size_t light = 0; light < direct.size(); ++light) {
      const auto shares = all.subspan(light * size, flux_shares);
      off.push_back(std::reduce(shares.begin(), shares.end()) / samples + direct[light] - 1.0);
    }
    return off;
  });
  const Estimate shares = jackknife(sums, sample_mean);
  std::vector<Invariant> balances;
  for (std::size_t light = 0; light < direct.size(); ++light) {
    double limit = outlier_errors(sums.groups()) * found.error[light];
    if (job.batches.one_by_one) {
      const auto first = shares.error.begin() + static_cast<std::ptrdiff_t>(light * size);
      limit = std::reduce(first, first + flux_shares);
    }
    balances.push_back({std::abs(found.value[light]), limit + rounding});
  }
  return balances;
}

namespace {

/// Returns the mean transmittance over all rays of an illumination that enter the medium, of a
/// medium that varies or of a box in space. In space the rays are a low-discrepancy sequence.
double mean_transmittance(const Scene& scene, Vec w) {
  const LightAperture aperture(scene.domain, w);
  const bool space = scene.domain.height > 0;
  const int rays = scene.domain.kind == Domain::Kind::slab ? 1 : space ? 65536 : 4096;
  constexpr double first_step = 0.7548776662466927, second_step = 0.5698402909980532;
  double sum = 0;
  for (int ray = 0; ray < rays; ++ray) {
    const auto fraction = [&](double step) { return std::fmod((ray + 0.5) * step, 1.0); };
    const Vec start = aperture.at((ray + 0.5) / rays, space ? fraction(first_step) : 0,
                                  space ? fraction(second_step) : 0);
    const double length = scene.domain.distance_to_edge(start, w);
    sum += std::exp(-(scene.profile ? scene.profile->optical_depth(start, w, length)
                                    : scene.medium.mu_t * length));
  }
  return sum / rays;
}

/// Returns the unscattered light of a slab with faces.
StackAmplitudes<double> unscattered(const Scene& slab, double light) {
  const Faces faces = *slab.faces;
  std::vector<double> indices{faces.outside}, depths;
  if (const auto* layers = dynamic_cast<const Layers*>(slab.profile.get())) {
    for (std::size_t l = 0; l < layers->materials().size(); ++l) {
      indices.push_back(layers->materials()[l].index);
      depths.push_back(layers->materials()[l].medium.mu_t * layers->thickness(l));
    }
  } else {
    indices.push_back(faces.inside);
    depths.push_back(slab.medium.mu_t * slab.domain.depth);
  }
  const auto cosine = [&](double index) {
    return Face{faces.outside, index}.refracted(std::abs(std::cos(light)));
  };
  std::vector<double> through;
  std::vector<FaceProducts> products;
  for (std::size_t l = 0; l < indices.size(); ++l) {
    const double index = indices[l], next = l + 1 < indices.size() ? indices[l + 1] : faces.outside;
    products.push_back(FaceProducts::of_power({index, next, faces.polarisation}, cosine(index)));
    if (l > 0) through.push_back(std::exp(-depths[l - 1] / cosine(index)));
  }
  return amplitudes_in_stack(through, products);
}

}  // namespace

double direct_transmittance(const Scene& scene, const Light& light) {
  const Domain& domain = scene.domain;
  const double sine = std::abs(std::sin(light.angle)), cosine = std::abs(std::cos(light.angle));
  if (scene.faces) return unscattered(scene, light.angle).transmitted;
  if (scene.profile || domain.height > 0) return mean_transmittance(scene, light.direction());
  if (domain.kind == Domain::Kind::slab)
    return std::exp(-scene.medium.mu_t * domain.depth / cosine);
  // Across the beam, the length of the chords rises linearly from 0 to its maximum, stays constant,
  // and falls to 0 again.
  const double face = domain.width * cosine, side = domain.depth * sine;
  const double longest = scene.medium.mu_t * domain.content() / std::max(face, side);
  const double rising = longest > 0 ? -std::expm1(-longest) / longest : 1;
  return (std::abs(face - side) * std::exp(-longest) + 2 * std::min(face, side) * rising) /
         (face + side);
}

double specular_reflectance(const Scene& scene, double light) {
  return scene.faces ? unscattered(scene, light).reflected : 0;
}

std::vector<double> unscattered_shares(const Scene& scene) {
  return column(scene.request.lights, [&](const Light& light) {
    return direct_transmittance(scene, light) + specular_reflectance(scene, light.angle);
  });
}

const DatasetTable flux_table{
    "flux",
    {{"reflectance", Data::estimate, "light_angle", "1",
      "share of the light scattered out through z = 0"},
     {"transmittance", Data::estimate, "light_angle", "1",
      "share of the light scattered out through z = depth"},
     {"side_loss", Data::estimate, "light_angle", "1",
      "share of the light scattered out through the sides"},
     {"absorptance", Data::estimate, "light_angle", "1", "share of the light that is absorbed"},
     {"direct_transmittance", Data::estimate, "light_angle", "1",
      "share of the light that meets no scatterer"},
     {"specular_reflectance", Data::estimate, "light_angle", "1",
      "share of the light that faces reflect without scattering, if medium_index is given"},
     {"invariants/power", Data::invariant, "light_angle", "1",
      "deviation from 1 of the sum of all shares and the unscattered light"},
     {"exit_angle", Data::scale, "", "rad",
      "centre of the bin of exit angles, measured from +z; in space a polar angle"},
     {"exit_radiance", Data::estimate, "light_angle exit_angle", "1/rad",
      "share of the light scattered out per radian of exit direction"}}};

namespace {

/// Returns the centres of equal bins of the exit angle, from -pi to pi in 2D and from 0 to pi in
/// 3D.
std::vector<double> middles(std::size_t bins, int dimension) {
  std::vector<double> angles;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double turn = static_cast<double>(2 * bin + 1) / static_cast<double>(bins);
    angles.push_back(std::numbers::pi * (dimension == 3 ? turn / 2 : turn - 1));
  }
  return angles;
}

}  // namespace

void write_flux(ResultFile& file, const Scene& scene, const FluxEstimates& flux) {
  const std::size_t lights = scene.request.lights.size(),
                    bins = flux.exit_radiance.value.size() / lights;
  write_light_axis(file, scene.request.lights);
  const ResultGroup root(file, flux_table);
  root.put("exit_angle", middles(bins, scene.medium.dimension));
  root.put("reflectance", flux.reflectance);
  root.put("transmittance", flux.transmittance);
  root.put("absorptance", flux.absorptance);
  if (scene.domain.kind == Domain::Kind::box) root.put("side_loss", flux.side_loss);
  const auto put_exact = [&](const char* name, const auto& share) {
    root.put(name, column(scene.request.lights, share), std::vector<double>(lights));
  };
  put_exact("direct_transmittance",
            [&](const Light& light) { return direct_transmittance(scene, light); });
  if (scene.faces)
    put_exact("specular_reflectance",
              [&](const Light& light) { return specular_reflectance(scene, light.angle); });
  root.put("exit_radiance", flux.exit_radiance);
}

}  // namespace flatspeckle::mc
