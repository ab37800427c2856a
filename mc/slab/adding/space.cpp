#include "mc/slab/adding/space.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/numbers/gauss.h"
#include "flatland/media/layers.h"
#include "flatland/scene/scene_density.h"
#include "grin/media/scattering/hg_phase.h"
#include "grin/media/scattering/mie_phase.h"
#include "grin/media/scattering/rayleigh_phase.h"
#include "grin/media/scattering/table_phase.h"
#include "grin/media/scattering/two_term_phase.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/slab/adding/correlated_phase.h"
#include "mc/slab/adding/ordinates.h"

namespace flatspeckle::mc {

namespace {

/// Sets the phase function of a medium, the function that samples it, and the mean cosine g.
template <typename Phase>
void set_phase(BulkMedium& medium, const Phase& phase) {
  medium.space_phase = {[phase](double cosine) { return phase.density(cosine); },
                        [phase](RandomStream& random) { return phase.one_minus_cosine(random); }};
  medium.g = phase.mean_cosine();
}

/// Sets extinction and scattering of independent spheres from their density or, if that is not
/// given, their density from the extinction.
void set_sphere_density(BulkMedium& medium, const Scatterer& spheres) {
  const double sigma_e = medium.cross_sections.extinction;
  if (medium.density > 0)
    medium.mu_t = medium.density * sigma_e;
  else
    medium.density = medium.mu_t / sigma_e;
  if (!(medium.mu_t > 0 && std::isfinite(1 / medium.mu_t) && std::isfinite(medium.density)))
    throw InputError("radius", spheres.radius,
                     "with this density or extinction, the mean free path or the number density is "
                     "not finite");
  medium.packing_fraction = medium.density * spheres.content(3);
  medium.albedo = medium.cross_sections.scattering / sigma_e;
  medium.mu_s = medium.albedo * medium.mu_t;
}

/// Includes the structure factor of a medium of spheres in its phase function and scattering (C16);
/// absorption is unchanged.
void correlate(BulkMedium& medium, const grin::MiePhase& alone, double k) {
  const CorrelatedPhase phase(alone, medium.structure, k);
  const double absorption = medium.mu_t - medium.mu_s;
  medium.mu_s *= phase.mean_structure();
  medium.mu_t = medium.mu_s + absorption;
  medium.albedo = medium.mu_s / medium.mu_t;
  set_phase(medium, phase);
}

/// Sets the properties of a medium of spheres, except for its structure factor.
void set_spheres(BulkMedium& medium, const Scatterer& scatterer, double k) {
  const double size = k * scatterer.radius;
  // Up to this size parameter SpaceLaw keeps all moments of the phase function.
  constexpr double largest = 500;
  if (!(size >= grin::MieSphere::smallest && size <= largest))
    throw InputError("radius", scatterer.radius,
                     "2 pi radius / wavelength of spheres must be from 1e-6 to 500");
  const grin::MieSphere sphere(size, scatterer.index);
  if (!(sphere.scattering() > 0))
    throw InputError("index", scatterer.index.real(), "spheres of this index do not scatter");
  const double area = scatterer.content(2), sigma_s = area * sphere.scattering();
  const bool lossless = scatterer.index.imag() == 0;
  medium.cross_sections = {sigma_s, lossless ? sigma_s : area * sphere.extinction(),
                           sphere.mean_cosine()};
  set_sphere_density(medium, scatterer);
  const grin::MiePhase phase(sphere);
  set_phase(medium, phase);
  if (!medium.structure.independent()) correlate(medium, phase, k);
}

void set_phase(BulkMedium& medium, const Scatterer& scatterer, const ScattererValues& values) {
  if (scatterer.kind == Scatterer::Kind::hg) return set_phase(medium, grin::HgPhase{scatterer.g});
  if (values.scatterer == PhaseTable::word) {
    const auto& path = std::get<PhaseTable>(values.bulk).phase_table;
    return set_phase(medium, grin::TablePhase(AngleTable(PhaseTable::word, path)));
  }
  if (values.scatterer == Rayleigh::word) return set_phase(medium, grin::RayleighPhase());
  if (values.scatterer != TwoTermHg::word)
    throw InputError("scatterer", values.scatterer,
                     "dimension = 3 requires hg (g = 0 is isotropic), two_term_hg, phase_table, "
                     "rayleigh or mie");
  const auto& terms = std::get<TwoTermHg>(values.bulk);
  set_phase(medium, grin::TwoTermPhase{{*terms.g}, {*terms.g_back}, *terms.forward_share});
}

/// Sets the phase function of points, or of spheres with a T-matrix (C56, C57), with the structure
/// factor of their positions (C16).
void set_wave_phase(BulkMedium& medium, double k) {
  const auto sampled = grin::phase_of_amplitudes(correlated_amplitudes_in_space(medium, k));
  const auto sample = [sampled](RandomStream& random) { return sampled.one_minus_cosine(random); };
  const auto alone = [t = medium.t_matrix, k](double cosine) {
    return std::norm(amplitude_in_space(t, k, cosine));
  };
  if (medium.structure.independent())
    medium.space_phase = {[alone, per = 1 / medium.cross_sections.scattering](double cosine) {
                            return per * alone(cosine);
                          },
                          sample};
  else
    medium.space_phase = {[alone, k, structure = medium.structure,
                           per = medium.density / medium.mu_s](double cosine) {
                            return per * alone(cosine) *
                                   structure(k * std::sqrt(2 * std::max(0.0, 1 - cosine)));
                          },
                          sample};
}

using std::numbers::pi;

constexpr int most_legendre_moments = 2048;

Complex power_of_i(int m) {
  constexpr Complex powers[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  return powers[m % 4];
}

/// Returns the normalised functions 1, cos(m phi) and sin(m phi) at equal steps of the azimuth phi,
/// times the step, [azimuth][function].
Matrix azimuthal_functions(int steps, int highest) {
  const double step = 2 * pi / steps;
  Matrix values(steps, 2 * highest + 1);
  for (int i = 0; i < steps; ++i) {
    values(i, 0) = step / std::sqrt(2 * pi);
    for (int m = 1; m <= highest; ++m) {
      values(i, m) = step / std::sqrt(pi) * std::cos(m * i * step);
      values(i, highest + m) = step / std::sqrt(pi) * std::sin(m * i * step);
    }
  }
  return values;
}

/// Returns unit vectors parallel to the faces at equal steps of the azimuth, which is measured from
/// the direction of the transverse momentum, [azimuth][x, y].
Matrix azimuths(int steps, const SpaceGeometry::Momentum& momentum) {
  const Eigen::Vector2d along(momentum[0], momentum[1]),
      x = along.norm() == 0 ? Eigen::Vector2d(1, 0) : Eigen::Vector2d(along.normalized());
  Matrix directions(steps, 2);
  for (int i = 0; i < steps; ++i) {
    const double phi = 2 * pi * i / steps, c = std::cos(phi), s = std::sin(phi);
    directions.row(i) << c * x.x() - s * x.y(), c * x.y() + s * x.x();
  }
  return directions;
}

Matrix associated_legendre(const Eigen::VectorXd& angle, int m, int last) {
  if (last < m) return Matrix(angle.size(), 0);
  const Eigen::ArrayXd cosine = angle.array().cos(), sine = angle.array().sin();
  const double order = m;
  Matrix values(angle.size(), last - m + 1);
  values.col(0).setConstant(std::sqrt(0.5));
  for (int i = 1; i <= m; ++i) values.col(0).array() *= std::sqrt(1 + 0.5 / i) * sine;
  for (int l = m + 1; l <= last; ++l) {
    const double a = std::sqrt((4.0 * l * l - 1) / ((l - order) * (l + order))),
                 b = std::sqrt((l - 1 - order) * (l - 1 + order) / (4.0 * (l - 1) * (l - 1) - 1));
    const Eigen::Index i = l - m;
    values.col(i) = a * cosine * values.col(i - 1).array();
    if (i > 1) values.col(i) -= a * b * values.col(i - 2);
  }
  return values;
}

}  // namespace

Scene in_space(Scene scene, const ScattererValues& values) {
  const auto convert = [&](BulkMedium& medium, const Scatterer& scatterer, double k) {
    medium.dimension = 3;
    if (scatterer.kind == Scatterer::Kind::mie)
      set_spheres(medium, scatterer, k);
    else if (medium.has_scatterers)
      set_wave_phase(medium, k);
    else
      set_phase(medium, scatterer, values);
  };
  if (!scene.profile) {
    convert(scene.medium, scene.scatterer, scene.k);
    return scene;
  }
  auto materials = scene.profile->materials();
  for (auto& [scatterer, medium, motion, index] : materials)
    convert(medium, scatterer, scene.faces ? scene.k * (index / scene.faces->inside) : scene.k);
  scene.profile = scene.profile->with(std::move(materials));
  scene.medium = scene.profile->mean();
  scene.medium.dimension = 3;
  return scene;
}

SpaceLaw SpaceGeometry::law(const Scene& scene, double delay) {
  const auto& density = scene.medium.space_phase.density;
  if (scene.scatterer.kind != Scatterer::Kind::hg) return SpaceLaw(density, delay);
  return SpaceLaw(density, delay, [g = scene.scatterer.g](int count) {
    return henyey_greenstein_moments(g, count);
  });
}

Scene SpaceGeometry::with_scatterer(Scene scene, const Scatterer& scatterer) {
  set_spheres(scene.medium, scatterer, scene.k);
  return scene;
}

SpaceLaw::SpaceLaw(std::function<double(double)> density, double delay, FirstMoments moments)
    : density_(std::move(density)), delay_(delay) {
  const auto p = [density = density_](double angle) { return density(std::cos(angle)); };
  if (!moments) total_ = sphere_integral(p);
  if (!moments || delay > 0)
    moments = [p, delay](int count) {
      const auto decay = [=](double angle) { return std::exp(-2 * delay * (1 - std::cos(angle))); };
      return first_moments(3, p, decay, count);
    };
  moments_ = {std::move(moments), most_legendre_moments};
  width_ = moments_.kept().width;
  if (has_sharp_peak()) width_ = std::min(width_, peak_width(p));
}

SpaceLaw SpaceLaw::truncated(int count) const {
  SpaceLaw law = *this;
  law.moments_ = moments_.truncated(count);
  law.width_ = law.moments_.kept().width;
  return law;
}

double SpaceLaw::pair_derivative(double g, double first, double second) const {
  const auto by_g = [g](double cosine) { return henyey_greenstein_derivative(g, 1 - cosine, 3); };
  return (by_g(first) + by_g(second)) / 2;
}

double SpaceLaw::decay(double cosine) const {
  return std::exp(-2 * delay_ * (1 - cosine));
}

double SpaceLaw::amplitude(double cosine) const {
  return std::sqrt(density_(std::clamp(cosine, -1.0, 1.0)) / total_);
}

Eigen::Vector3d SpaceGeometry::matched(const SpacePair& lights, const SpacePair& views,
                                       double shift) {
  const Eigen::Vector2d along =
      (lights.second - (lights.first - views.first) / (1 + shift)).head<2>();
  return {along.x(), along.y(),
          std::copysign(std::sqrt(1 - along.squaredNorm()), views.second.z())};
}

SpaceGeometry::Momentum SpaceGeometry::momentum(const SpacePair& lights, double, double,
                                                double shift) {
  constexpr double same_momentum = 1e-12;
  const Eigen::Vector3d difference = lights.first - (1 + shift) * lights.second;
  const auto rounded = [](double q) { return std::round(q / same_momentum) * same_momentum; };
  return {rounded(difference.x()), rounded(difference.y())};
}

std::vector<Focus> SpaceGeometry::Foci::of(const SpacePair& lights, const Momentum&) const {
  constexpr double too_wide = 0.4;  // foci wider than this require no shorter panels
  std::vector<Focus> found;
  if (width_ >= too_wide) return found;
  for (const auto& light : {lights.first, lights.second}) {
    const double angle = std::atan2(light.head<2>().norm(), std::abs(light.z()));
    found.push_back({width_ / 2 * std::round(angle / (width_ / 2)), width_});
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

double SpaceGeometry::coupling(int m) {
  return m == 0 ? std::numbers::sqrt2 / 2 : 0.5;
}

Matrix SpaceGeometry::functions(const Eigen::VectorXd& angle, int m, int last) {
  const Eigen::VectorXd sine = angle.array().sin();
  return sine.asDiagonal() * associated_legendre(angle, m, last);
}

std::vector<Complex> SpaceGeometry::beam(double light, int m, int last) {
  const Matrix values = associated_legendre(Eigen::VectorXd::Constant(1, light), m, last);
  std::vector<Complex> shares;
  for (Eigen::Index i = 0; i < values.cols(); ++i)
    shares.push_back(values(0, i) / std::sqrt(2 * pi));
  return shares;
}

Eigen::VectorXd SpaceGeometry::weights(const AngularGrid& grid) {
  return grid.integrals_of(
      1, [](const Eigen::VectorXd& angle) -> Matrix { return angle.array().sin(); });
}

template <typename Number>
PairWavesOf<Number> SpaceGeometry::fed(const OrdinatesOf<SpaceGeometry, RealOf<Number>>& ordinates,
                                       const Momentum& momentum, int highest,
                                       const std::vector<SpacePair>& pairs) {
  double most_sine = 0;
  for (const SpacePair& pair : pairs)
    for (const Eigen::Vector3d& direction : {pair.first, pair.second})
      most_sine = std::max(most_sine, direction.head<2>().norm());
  // If a light has the polar angle theta, moment l of p hardly contributes to azimuthal modes above
  // l sin(theta).
  constexpr double nodes_per_width = 25;
  const double most_modes = 1.2 * (1 + degree(ordinates.law().moments())),
               of_peak = ordinates.law().has_sharp_peak() ? nodes_per_width / ordinates.fine() : 0;
  const int steps = 2 * highest + 32 + static_cast<int>(most_sine * std::max(most_modes, of_peak));
  const Matrix azimuthal = azimuthal_functions(steps, highest),
               directions = azimuths(steps, momentum);
  const auto projected = [&](const Eigen::VectorXd& angles, const SpacePair& pair, double side,
                             const auto& part) -> Matrix {
    Matrix values(angles.size(), steps);
    for (Eigen::Index j = 0; j < angles.size(); ++j) {
      const double sine = std::sin(angles[j]), cosine = side * std::cos(angles[j]);
      for (Eigen::Index i = 0; i < steps; ++i) {
        const Eigen::Vector3d to(sine * directions(i, 0), sine * directions(i, 1), cosine);
        values(j, i) = sine * part(ordinates.law().pair(pair.first.dot(to), pair.second.dot(to)));
      }
    }
    return product(values, azimuthal);
  };
  const Eigen::Index n = ordinates.grid().size(), functions = azimuthal.cols();
  const auto into = [&](double side) {
    return each_part<Number>([&](const auto& part) {
      Rows rows(std::ssize(pairs), functions * n);
      for (Eigen::Index i = 0; i < rows.rows(); ++i) {
        const Matrix integrals =
            ordinates.root().cwiseInverse().asDiagonal() *
            ordinates.grid().integrals_of(functions, [&](const Eigen::VectorXd& angles) {
              return projected(angles, pairs[static_cast<std::size_t>(i)], side, part);
            });
        for (Eigen::Index f = 0; f < functions; ++f)
          rows.block(i, f * n, 1, n) = power_of_i(static_cast<int>(f > highest ? f - highest : f)) *
                                       integrals.col(f).transpose();
      }
      return rows;
    });
  };
  return {{}, {}, ordinates.albedo() * into(1), ordinates.albedo() * into(-1), {}};
}

template PairWavesOf<double> SpaceGeometry::fed<double>(const OrdinatesOf<SpaceGeometry, double>&,
                                                        const Momentum&, int,
                                                        const std::vector<SpacePair>&);
template PairWavesOf<Complex> SpaceGeometry::fed<Complex>(const OrdinatesOf<SpaceGeometry, double>&,
                                                          const Momentum&, int,
                                                          const std::vector<SpacePair>&);
template PairWavesOf<Dual<double>> SpaceGeometry::fed<Dual<double>>(
    const OrdinatesOf<SpaceGeometry, Dual<double>>&, const Momentum&, int,
    const std::vector<SpacePair>&);

}  // namespace flatspeckle::mc
