#include "bench/oracles/textbook.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/numbers/random.h"
#include "grin/media/scattering/phase_function.h"

namespace flatspeckle::oracles {

namespace {

using std::numbers::pi;
constexpr std::uint64_t stream = 1001;  // not used by the estimator under test

/// Returns the angle between two unit vectors.
double angle_between(Vec a, Vec b) {
  return 2 * std::asin(std::min(1.0, length(a - b) / 2));
}

/// Returns w rotated by `angle` in the plane.
Vec turned(Vec w, double angle) {
  return direction(angle_of(w) + angle);
}
/// Returns w rotated by `angle` in space, towards a direction with this azimuth around w.
Vec turned(Vec w, double angle, double azimuth) {
  const Vec helper = std::abs(w.z) < 0.7 ? Vec{0, 1} : Vec{1, 0};
  const Vec across = cross(helper, w), first = 1 / length(across) * across;
  return std::cos(angle) * w +
         std::sin(angle) * (std::cos(azimuth) * first + std::sin(azimuth) * cross(w, first));
}

/// Scattering amplitude over sqrt(sigma_s), so that |amplitude|^2 is the phase function (C5, C22,
/// C57).
class Scattering {
 public:
  explicit Scattering(const Scene& scene)
      : in_space_(scene.medium.dimension == 3),
        plane_hg_{scene.scatterer.g},
        space_hg_{scene.scatterer.g} {
    if (scene.scatterer.kind == Scatterer::Kind::point) kind_ = Kind::isotropic;
    if (scene.scatterer.is_disk()) tabulate(scene.medium, scene.k);
  }

  Complex amplitude(Vec from, Vec to) const {
    if (kind_ == Kind::table) return interpolate(angle_between(from, to));
    return std::sqrt(density(from, to));
  }
  double density(Vec from, Vec to) const {
    if (kind_ == Kind::table) return std::norm(interpolate(angle_between(from, to)));
    if (kind_ == Kind::isotropic) return 1 / (in_space_ ? 4 * pi : 2 * pi);
    const double cosine = dot(from, to);
    return in_space_ ? space_hg_.density_at(cosine) : plane_hg_.density_at(cosine);
  }
  Vec sample(Vec from, RandomStream& random) const {
    const double u = random.uniform();
    if (!in_space_) return turned(from, plane_angle(u));
    return turned(from, space_angle(u), 2 * pi * random.uniform());
  }

 private:
  enum class Kind { isotropic, henyey_greenstein, table };

  double plane_angle(double u) const {
    if (kind_ == Kind::isotropic) return 2 * pi * u;
    if (kind_ == Kind::henyey_greenstein) return plane_hg_.sample(u);
    return std::copysign(sample_table(std::abs(2 * u - 1)), u - 0.5);
  }
  double space_angle(double u) const {
    if (kind_ == Kind::isotropic) return std::acos(2 * u - 1);
    if (kind_ == Kind::table) return sample_table(u);
    return std::acos(1 - space_hg_.sample_one_minus_cosine(u));
  }

  void tabulate(const BulkMedium& medium, double k) {
    kind_ = Kind::table;
    for (int i = 0; i <= intervals; ++i) {
      const double angle = i * step;
      const Complex value = in_space_ ? amplitude_in_space(medium.t_matrix, k, std::cos(angle))
                                      : flatspeckle::amplitude(medium.t_matrix, k, angle);
      table_.push_back(value / std::sqrt(medium.cross_sections.scattering));
    }
    cumulative_.push_back(0);
    for (int i = 0; i < intervals; ++i) {
      const double ring = in_space_ ? std::sin((i + 0.5) * step) : 1;
      cumulative_.push_back(cumulative_[i] +
                            ring * (std::norm(table_[i]) + std::norm(table_[i + 1])));
    }
    for (double& c : cumulative_) c /= cumulative_.back();
  }

  Complex interpolate(double angle) const {
    const double position = angle / step;
    const int i = std::min(static_cast<int>(position), intervals - 1);
    const double t = position - i;
    return (1 - t) * table_[i] + t * table_[i + 1];
  }

  double sample_table(double target) const {
    const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, target);
    const auto i = above - cumulative_.begin() - 1;
    const double t = (target - cumulative_[i]) / (cumulative_[i + 1] - cumulative_[i]);
    return step * (static_cast<double>(i) + t);
  }

  static constexpr int intervals = 1 << 15;
  static constexpr double step = pi / intervals;
  bool in_space_;
  Kind kind_ = Kind::henyey_greenstein;
  grin::HenyeyGreenstein<2> plane_hg_;
  grin::HenyeyGreenstein<3> space_hg_;
  std::vector<Complex> table_;  ///< at the angles i step
  /// Cumulative distribution, with |amplitude|^2 constant within each step.
  std::vector<double> cumulative_;
};

/// Samples the paths of one batch.
class Walker {
 public:
  Walker(const Scene& scene, const Scattering& scattering, bool reversed, RandomStream random,
         std::span<Complex> sums)
      : scene_(scene),
        request_(scene.request),
        scattering_(scattering),
        reversed_(reversed),
        random_(random),
        sums_(sums),
        density_(request_.lights.size()),
        light_first_(request_.lights.size()),
        light_last_(request_.lights.size()),
        view_first_(request_.views.size()),
        view_last_(request_.views.size()),
        field_(request_.channels.size()) {
    for (const Light& light : request_.lights) lights_.push_back(light.direction());
    for (const View& view : request_.views) views_.push_back(view.direction());
  }

  void walk() {
    const auto chosen = static_cast<std::size_t>(random_.uniform() * light_count());
    const Vec first = sample_first(lights_[chosen]);
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      density_[i] = first_density(first, lights_[i]) / light_count();
      light_first_[i] = light_factor(first, lights_[i]);
    }
    single_scattering(first);

    const Vec start = scattering_.sample(lights_[chosen], random_);
    double density = 0;  // probability density of x, summed over all illuminations
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      density += density_[i] * scattering_.density(lights_[i], start);
      light_first_[i] = product(light_first_[i], scattering_.amplitude(lights_[i], start));
    }
    if (reversed_) view_amplitudes(first, -start, view_first_);

    double weight = 1;
    Vec x = first;
    Vec w = start;
    while (true) {
      const double flight = -std::log(random_.uniform()) / scene_.medium.mu_t;
      if (flight >= scene_.domain.distance_to_edge(x, w)) return;
      x = x + flight * w;
      weight *= scene_.medium.albedo;
      if (weight < 0.2) {  // roulette
        if (random_.uniform() >= scene_.medium.albedo) return;
        weight /= scene_.medium.albedo;
      }
      multiple_scattering(x, w, scene_.medium.mu_s * weight / density);
      w = scattering_.sample(w, random_);
    }
  }

 private:
  double light_count() const { return static_cast<double>(lights_.size()); }

  /// Adds single scattering, B = 1 of C14.
  void single_scattering(Vec x) {
    double density = 0;
    for (double p : density_) density += p;
    for (std::size_t v = 0; v < views_.size(); ++v) view_last_[v] = view_factor(x, views_[v]);
    for (std::size_t c = 0; c < field_.size(); ++c) {
      const auto [i, v] = request_.channels[c];
      field_[c] = product(product(light_first_[i], view_last_[v]),
                          scattering_.amplitude(lights_[i], views_[v]));
    }
    add(scene_.medium.mu_s / density);
  }

  /// Adds multiple scattering, B >= 2 of C14. The last scatterer is at x and is reached in
  /// direction w.
  void multiple_scattering(Vec x, Vec w, double weight) {
    view_amplitudes(x, w, view_last_);
    if (reversed_) light_amplitudes(x, -w, light_last_);
    for (std::size_t c = 0; c < field_.size(); ++c) {
      const auto [i, v] = request_.channels[c];
      field_[c] = product(light_first_[i], view_last_[v]);
      if (reversed_) field_[c] += product(light_last_[i], view_first_[v]);
    }
    add(reversed_ ? weight / 2 : weight);
  }

  void add(double weight) {
    for (std::size_t e = 0; e < sums_.size(); ++e) {
      const auto [a, b] = request_.entries[e];
      sums_[e] += weight * product_with_conjugate(field_[a], field_[b]);
    }
  }

  /// The endpoint factors e_i(x) and e_v(x) of C13.
  Complex light_factor(Vec x, Vec light) const {
    const double inside = scene_.domain.distance_to_edge(x, -light);
    return std::polar(std::exp(-scene_.medium.mu_t * inside / 2), scene_.k * dot(light, x));
  }
  Complex view_factor(Vec x, Vec view) const {
    const double inside = scene_.domain.distance_to_edge(x, view);
    return std::polar(std::exp(-scene_.medium.mu_t * inside / 2), -scene_.k * dot(view, x));
  }

  /// Computes e_i(x) A(i -> w) for every illumination.
  void light_amplitudes(Vec x, Vec w, std::vector<Complex>& out) const {
    for (std::size_t i = 0; i < lights_.size(); ++i)
      out[i] = product(light_factor(x, lights_[i]), scattering_.amplitude(lights_[i], w));
  }
  /// Computes A(w -> v) e_v(x) for every detection direction.
  void view_amplitudes(Vec x, Vec w, std::vector<Complex>& out) const {
    for (std::size_t v = 0; v < views_.size(); ++v)
      out[v] = product(view_factor(x, views_[v]), scattering_.amplitude(w, views_[v]));
  }

  /// Returns the width (in space, the area) of the medium perpendicular to the illumination; for a
  /// slab, that of a unit of its face.
  double aperture(Vec light) const {
    if (scene_.domain.kind == Domain::Kind::slab) return std::abs(light.z);
    const auto faces = projected_faces(light);
    return faces[0] + faces[1] + faces[2];
  }

  /// Returns the sizes of the faces that the light enters, projected along it: those perpendicular
  /// to z, to x and to y.
  std::array<double, 3> projected_faces(Vec light) const {
    const Domain& box = scene_.domain;
    const double height = box.height > 0 ? box.height : 1;
    return {box.width * height * std::abs(light.z), box.depth * height * std::abs(light.x),
            box.width * box.depth * std::abs(light.y)};
  }

  /// Samples an entry point uniformly over the illuminated faces, projected along the light.
  Vec sample_entry(Vec light) {
    const Domain& domain = scene_.domain;
    const double z = light.z > 0 ? 0 : domain.depth;
    if (domain.kind == Domain::Kind::slab) return {0, z};
    const auto faces = projected_faces(light);
    const double chosen = random_.uniform() * aperture(light);
    Vec entry{domain.width * (random_.uniform() - 0.5), domain.depth * random_.uniform()};
    if (domain.height > 0) entry.y = domain.height * (random_.uniform() - 0.5);
    if (chosen < faces[0])
      entry.z = z;
    else if (chosen < faces[0] + faces[1])
      entry.x = std::copysign(domain.width / 2, -light.x);
    else
      entry.y = std::copysign(domain.height / 2, -light.y);
    return entry;
  }

  Vec sample_first(Vec light) {
    const Vec entry = sample_entry(light);
    const double mu_t = scene_.medium.mu_t;
    const double absorbed = std::expm1(-mu_t * scene_.domain.distance_to_edge(entry, light));
    return entry + -std::log1p(random_.uniform() * absorbed) / mu_t * light;
  }

  /// Returns the density with which sample_first samples x for an illumination.
  double first_density(Vec x, Vec light) const {
    const double mu_t = scene_.medium.mu_t;
    const double behind = scene_.domain.distance_to_edge(x, -light);
    const double chord = behind + scene_.domain.distance_to_edge(x, light);
    return mu_t * std::exp(-mu_t * behind) / -std::expm1(-mu_t * chord) / aperture(light);
  }

  const Scene& scene_;
  const CovarianceRequest& request_;
  const Scattering& scattering_;
  bool reversed_;
  RandomStream random_;
  std::span<Complex> sums_;
  std::vector<Vec> lights_, views_;
  std::vector<double> density_;  ///< density of the first scatterer, for each illumination
  std::vector<Complex> light_first_, light_last_, view_first_, view_last_;
  std::vector<Complex> field_;  ///< per channel
};

}  // namespace

FieldJob textbook_job(const Scene& original, bool reversed, std::uint64_t paths_per_batch,
                      std::uint64_t seed) {
  const auto scene = std::make_shared<const Scene>(original);
  assert(std::none_of(scene->request.views.begin(), scene->request.views.end(),
                      [](const View& view) { return view.near; }));
  const auto scattering = std::make_shared<const Scattering>(*scene);
  FieldJob job;
  job.covariance = sample_mean;
  job.batches.size = scene->request.entries.size();
  job.batches.samples_per_batch = static_cast<double>(paths_per_batch);
  job.batches.run = [=](std::uint64_t number, std::span<Complex> sums) {
    Walker walker(*scene, *scattering, reversed, RandomStream(seed, stream, number), sums);
    for (std::uint64_t path = 0; path < paths_per_batch; ++path) walker.walk();
  };
  job.batches.relative_error = [](const GroupedSums& sums) {
    return relative_error(jackknife(sums, sample_mean));
  };
  return job;
}

}  // namespace flatspeckle::oracles
