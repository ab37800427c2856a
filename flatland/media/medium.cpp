#include "flatland/media/medium.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

#include "core/contract.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/gauss.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "flatland/media/hard_sphere_fluid.h"
#include "flatland/media/structure_factor.h"

namespace flatspeckle {

namespace {

/// Throws InputError if a value stored in a structure-factor file differs from the value of the
/// scene by more than 2 %. This also detects files in another unit of length.
void check_same(const std::string& path, const std::string& what, double measured, double scene) {
  constexpr double rounding = 0.02;
  if (std::abs(measured - scene) <= rounding * scene) return;
  std::ostringstream accepted;
  accepted << "was measured at " << what << ' ' << measured << ", but the scene has " << scene
           << "; measure it with the scene's own disks";
  throw InputError("structure", path, accepted.str());
}

/// Returns sqrt(S) at the momentum transfer of a scattering angle.
double structure_amplitude(const StructureFactor& structure, double k, double theta) {
  return std::sqrt(structure(2 * k * std::abs(std::sin(theta / 2))));
}

}  // namespace

StructureFactor::StructureFactor(std::string origin, std::vector<double> q,
                                 std::vector<double> values)
    : origin_(std::move(origin)), q_(std::move(q)), values_(std::move(values)) {
  FS_EXPECT(q_.size() == values_.size() && std::is_sorted(q_.begin(), q_.end()));
}

StructureFactor::StructureFactor(std::string origin, std::function<double(double)> formula)
    : origin_(std::move(origin)), formula_(std::move(formula)) {}

double StructureFactor::operator()(double q) const {
  if (formula_) return formula_(q);
  if (independent() || q > q_.back()) return 1;
  const auto above = std::upper_bound(q_.begin(), q_.end(), q);
  if (above == q_.begin()) return values_.front();
  const auto i = static_cast<std::size_t>(above - q_.begin());
  if (i == q_.size()) return values_.back();
  const double t = (q - q_[i - 1]) / (q_[i] - q_[i - 1]);
  return (1 - t) * values_[i - 1] + t * values_[i];
}

std::string StructureFactor::text() const {
  if (formula_) return origin_;
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  for (std::size_t i = 0; i < q_.size(); ++i) text << q_[i] << ',' << values_[i] << '\n';
  return text.str();
}

double DiskSpacing::packing() const {
  return density * std::numbers::pi * contact * contact / 4;
}

StructureFactor hard_disk_structure(const DiskSpacing& disks, double q_max) {
  const double packing = disks.packing();
  if (packing > 0.7)
    throw InputError("structure", "hard_disks",
                     "the fluid of hard disks freezes near packing fraction 0.7");
  // Step and last node of the table, in q times the contact distance. At packing 0.3, linear
  // interpolation with this step is accurate to 1e-4. Beyond the last node |S - 1| is below 6e-3
  // eta g(contact), with eta the packing fraction: 0.2 % at packing 0.2.
  constexpr double step = 0.05, last = 100;
  q_max = std::min(q_max, last / disks.contact);
  const HardDiskFluid fluid(packing, disks.contact);
  const auto steps = static_cast<std::size_t>(std::ceil(q_max * disks.contact / step));
  std::vector<double> q, values;
  for (std::size_t i = 0; i <= steps; ++i) {
    q.push_back(q_max * static_cast<double>(i) / static_cast<double>(steps));
    values.push_back(fluid.structure_factor(q.back()));
  }
  std::ostringstream origin;
  origin << "of hard disks, packing fraction " << packing;
  return {origin.str(), std::move(q), std::move(values)};
}

StructureFactor hard_sphere_structure(double density, double diameter) {
  constexpr double most = HardSphereFluid::most_packing, rounding = 1e-12;
  double packing = density * std::numbers::pi * std::pow(diameter, 3) / 6;
  if (packing > (1 + rounding) * most)
    throw InputError(
        "structure", "hard_spheres",
        "requires a volume fraction of at most 0.49, because the fluid of hard spheres "
        "freezes at 0.494; the spheres fill " +
            number_text(packing));
  packing = std::min(packing, most);
  return {
      "of hard spheres of diameter " + number_text(diameter) + ", packing fraction " +
          number_text(packing),
      [fluid = HardSphereFluid(packing, diameter)](double q) { return fluid.structure_factor(q); }};
}

namespace {

StructureFactor read_table(const std::string& path, const DiskSpacing& disks) {
  const ResultReader file(path);
  for (const char* name : {"q", "structure_factor"})
    if (!file.has(name))
      throw InputError("structure", path,
                       std::string("has no dataset ") + name +
                           "; must be none, hard_disks or a file that place --structure wrote");
  const auto measured = [&](const char* name) { return file.attribute<double>("/", name); };
  const double area = measured("width") * measured("depth");
  const auto count = static_cast<double>(file.attribute<std::uint64_t>("/", "count"));
  const double density = count / area;
  // The attribute packing_fraction does not include the gap.
  const double diameter =
      std::sqrt(4 * measured("packing_fraction") / (std::numbers::pi * density));
  check_same(path, "density", density, disks.density);
  check_same(path, "contact distance", diameter + measured("min_gap"), disks.contact);
  auto q = file.dataset<double>("q"), values = file.dataset<double>("structure_factor");
  const bool rising = std::adjacent_find(q.begin(), q.end(), std::not_fn(std::less<>{})) == q.end();
  const bool possible =
      std::all_of(values.begin(), values.end(), [&](double s) { return s > 0 && s <= count; });
  if (q.size() != values.size() || q.empty() || !rising || !(q.front() >= 0) ||
      !std::isfinite(q.back()) || !possible)
    throw InputError(
        "structure", path,
        "must contain increasing q, and values of S above 0 and at most the number of disks");
  return {"measured, " + path, std::move(q), std::move(values)};
}

}  // namespace

StructureFactor read_structure(const std::string& path, const DiskSpacing& disks) {
  if (std::error_code none; !std::filesystem::exists(path, none))
    throw InputError("structure", path,
                     "must be none, hard_disks or a file that place --structure wrote");
  return guarded_read(path, [&] { return read_table(path, disks); });
}

bool is_physical(const BulkMedium& medium) {
  constexpr double rounding = 1e-9;
  return std::isfinite(medium.mu_t) && medium.mu_s >= 0 &&
         medium.mu_s <= (1 + rounding) * medium.mu_t && std::abs(medium.g) <= 1 + rounding;
}

BulkMedium bulk_medium(const Scatterer& scatterer, double k, double density, int dimension) {
  constexpr double tolerance = 1e-13;
  const Radial kind = dimension == 3 ? Radial::spherical : Radial::cylindrical;
  BulkMedium medium;
  medium.dimension = dimension;
  medium.has_scatterers = true;
  medium.t_matrix = t_matrix(scatterer, k, isolated_order(scatterer, k, tolerance, kind), kind);
  medium.cross_sections = dimension == 3 ? cross_sections_in_space(medium.t_matrix, k)
                                         : cross_sections(medium.t_matrix, k);
  medium.g = medium.cross_sections.g;
  medium.albedo = medium.cross_sections.extinction == 0
                      ? 0
                      : medium.cross_sections.scattering / medium.cross_sections.extinction;
  set_density(medium, scatterer, k, density);
  return medium;
}

void set_density(BulkMedium& medium, const Scatterer& scatterer, double k, double density) {
  medium.density = density;
  medium.mu_s = density * medium.cross_sections.scattering;
  medium.mu_t = density * medium.cross_sections.extinction;
  if (scatterer.is_disk()) medium.packing_fraction = density * scatterer.content(medium.dimension);
  if (medium.dimension == 3) {  // k_eff - k = (2 pi rho / k) f(0) (C58)
    medium.k_shift =
        2 * std::numbers::pi * density / k * amplitude_in_space(medium.t_matrix, k, 1).real();
    return;
  }
  // k_eff - k = (2 rho / (i k)) sum_n T_n (C15)
  long double sum_imag = medium.t_matrix[0].imag();
  for (std::size_t n = 1; n < medium.t_matrix.size(); ++n)
    sum_imag += 2 * medium.t_matrix[n].imag();
  medium.k_shift = 2 * density / k * static_cast<double>(sum_imag);
}

BulkMedium bulk_medium(const Scatterer& bulk, const BulkPhase& phase, double mu_t) {
  BulkMedium medium;
  medium.mu_t = mu_t;
  medium.albedo = bulk.albedo;
  medium.mu_s = medium.albedo * mu_t;
  medium.g = phase.density ? phase.g : bulk.g;
  medium.phase = phase;
  return medium;
}

std::vector<Complex> correlated_amplitudes_in_space(const BulkMedium& medium, double k) {
  auto values = amplitudes_in_space(medium.t_matrix, k);
  const double step = std::numbers::pi / static_cast<double>(values.size() - 1);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] *= structure_amplitude(medium.structure, k, static_cast<double>(i) * step);
  return values;
}

namespace {

/// Integrals of |A|^2 S, and of |A|^2 S times the cosine of the scattering angle, over all angles.
struct Scattered {
  double sum = 0, cosine = 0;

  void add(double weight, double square, double cosine_of_angle) {
    sum += weight * square;
    cosine += weight * square * cosine_of_angle;
  }
};

/// S is an analytic function of q^2 and thus of the cosine, so that Gauss's rule converges
/// spectrally.
Scattered scattered_in_space(const BulkMedium& medium, double k) {
  const auto rule = gauss_legendre(static_cast<int>(64 * (medium.t_matrix.size() + 1)));
  Scattered scattered;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double cosine = 2 * rule.node[i] - 1;
    const double structure = medium.structure(k * std::sqrt(2 * (1 - cosine)));
    scattered.add(4 * std::numbers::pi * rule.weight[i],
                  structure * std::norm(amplitude_in_space(medium.t_matrix, k, cosine)), cosine);
  }
  return scattered;
}

Scattered scattered_in_plane(const BulkMedium& medium, double k) {
  // If S is smooth, the trapezoidal rule converges spectrally. If S is tabulated, this number of
  // intervals is fine enough.
  const std::size_t intervals = 256 * (medium.t_matrix.size() + 1);
  const auto alone = amplitudes(medium.t_matrix, k, intervals);
  const double step = std::numbers::pi / static_cast<double>(intervals);
  Scattered scattered;
  for (std::size_t i = 0; i <= intervals; ++i) {
    const double theta = static_cast<double>(i) * step;
    const double weight = i == 0 || i == intervals ? step : 2 * step;
    const double root = structure_amplitude(medium.structure, k, theta);
    scattered.add(weight, std::norm(root * alone[i]), std::cos(theta));
  }
  return scattered;
}

}  // namespace

BulkMedium correlated_medium(BulkMedium medium, double k, StructureFactor structure) {
  medium.structure = std::move(structure);
  const auto [sum, cosine] =
      medium.dimension == 3 ? scattered_in_space(medium, k) : scattered_in_plane(medium, k);
  const double absorption = medium.mu_t - medium.mu_s;
  medium.mu_s = medium.density * sum;
  medium.mu_t = medium.mu_s + absorption;
  medium.g = sum > 0 ? cosine / sum : 0;
  medium.albedo = medium.mu_t == 0 ? 0 : medium.mu_s / medium.mu_t;
  return medium;
}

std::vector<Complex> normalised_amplitudes(const BulkMedium& medium, double k,
                                           std::size_t intervals) {
  const double step = std::numbers::pi / static_cast<double>(intervals);
  if (medium.phase.density) {
    std::vector<Complex> roots;
    for (std::size_t i = 0; i <= intervals; ++i)
      roots.emplace_back(std::sqrt(medium.phase.density(static_cast<double>(i) * step)));
    return roots;
  }
  auto values = amplitudes(medium.t_matrix, k, intervals);
  const double scale = std::sqrt(medium.density / medium.mu_s);
  for (std::size_t i = 0; i <= intervals; ++i)
    values[i] *= scale * structure_amplitude(medium.structure, k, static_cast<double>(i) * step);
  return values;
}

BulkMedium mean_medium(const std::vector<std::pair<const BulkMedium*, double>>& shares) {
  BulkMedium mean;
  double cosine = 0;
  for (const auto& [medium, share] : shares) {
    mean.has_scatterers = medium->has_scatterers;
    mean.mu_t += share * medium->mu_t;
    mean.mu_s += share * medium->mu_s;
    mean.density += share * medium->density;
    mean.packing_fraction += share * medium->packing_fraction;
    mean.k_shift += share * medium->k_shift;
    cosine += share * medium->mu_s * medium->g;
  }
  mean.albedo = mean.mu_t > 0 ? mean.mu_s / mean.mu_t : 0;
  mean.g = mean.mu_s > 0 ? cosine / mean.mu_s : 0;
  return mean;
}

}  // namespace flatspeckle
