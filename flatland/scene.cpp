#include "flatland/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>

#include "core/error.h"

namespace flatspeckle {

namespace {

using Kind = Scatterer::Kind;

double positive(const std::string& key, double value) {
  if (!(std::isfinite(value) && value > 0)) throw InputError(key, value, "must be positive");
  return value;
}

double positive(const std::string& key, const std::optional<double>& value) {
  if (!value) throw InputError(key + " is not given: must be positive");
  return positive(key, *value);
}

void all_finite(const std::string& key, const std::vector<double>& values) {
  for (double value : values)
    if (!std::isfinite(value)) throw InputError(key, value, "must be finite");
}

/// Whoever writes 45 means degrees.
void all_radians(const std::string& key, const std::vector<double>& angles) {
  all_finite(key, angles);
  for (double angle : angles)
    if (std::abs(angle) > 2 * std::numbers::pi)
      throw InputError(key, angle, "angles are in radians, at most 2 pi");
}

void not_empty(const std::string& key, const std::vector<double>& values) {
  if (values.empty()) throw InputError(key + " = []: must hold at least one number");
}

void no_repeats(const std::string& key, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto twice = std::adjacent_find(values.begin(), values.end());
  if (twice != values.end()) throw InputError(key, *twice, "is given twice");
}

template <typename Value>
void only_for(const std::string& key, const std::optional<Value>& value, bool applies,
              const std::string& what) {
  if (value && !applies) throw InputError(key, *value, "is a key of " + what + " only");
}

template <typename Choice>
Choice choose(const std::string& key, const std::string& word,
              const std::vector<std::pair<std::string, Choice>>& choices) {
  std::string accepted = "must be one of";
  for (const auto& [name, choice] : choices) {
    if (name == word) return choice;
    accepted += ' ' + name;
  }
  throw InputError(key, word, accepted);
}

Kind scatterer_kind(const std::string& word) {
  return choose<Kind>("scatterer", word,
                      {{"point", Kind::point},
                       {"soft", Kind::soft},
                       {"hard", Kind::hard},
                       {"tm", Kind::tm},
                       {"te", Kind::te},
                       {"hg", Kind::hg}});
}

double checked_albedo(double albedo, bool is_point) {
  const bool in_range = albedo <= 1 && (is_point ? albedo > 0 : albedo >= 0);
  if (!in_range)
    throw InputError("albedo", albedo, is_point ? "must be in (0, 1]" : "must be in [0, 1]");
  return albedo;
}

Domain make_domain(const SceneSpec& spec) {
  Domain domain;
  domain.kind = choose<Domain::Kind>("domain", spec.domain,
                                     {{"box", Domain::Kind::box}, {"slab", Domain::Kind::slab}});
  domain.depth = positive("depth", spec.depth);
  const bool box = domain.kind == Domain::Kind::box;
  only_for("width", spec.width, box, "a box");
  if (box) domain.width = positive("width", spec.width);
  return domain;
}

void check_density_keys(const SceneSpec& spec) {
  std::vector<std::string> given;
  if (spec.count) given.emplace_back("count");
  if (spec.density) given.emplace_back("density");
  if (spec.mean_free_path) given.emplace_back("mean_free_path");
  if (spec.optical_depth) given.emplace_back("optical_depth");
  if (given.size() == 1) return;
  std::string all;
  for (const auto& key : given) all += (all.empty() ? "" : ", ") + key;
  throw InputError((given.empty() ? "no density is given"
                                  : "the density is given more than once (" + all + ")") +
                   ": give exactly one of count, density, mean_free_path, optical_depth");
}

/// mu_t, where the spec gives it.
std::optional<double> stated_extinction(const SceneSpec& spec, const Domain& domain) {
  if (spec.mean_free_path) return 1 / positive("mean_free_path", *spec.mean_free_path);
  if (spec.optical_depth) return positive("optical_depth", *spec.optical_depth) / domain.depth;
  return std::nullopt;
}

double number_density(const SceneSpec& spec, const Domain& domain, double sigma_e) {
  if (spec.density) return positive("density", *spec.density);
  if (spec.count) {
    if (*spec.count < 0) throw InputError("count", *spec.count, "must not be negative");
    if (domain.kind == Domain::Kind::slab)
      throw InputError("count", *spec.count, "an infinite slab has no count; give a density");
    return static_cast<double>(*spec.count) / domain.area();
  }
  if (sigma_e <= 0)
    throw InputError("scatterer", spec.scatterer,
                     "does not scatter, so no density gives this extinction");
  return *stated_extinction(spec, domain) / sigma_e;
}

BulkMedium make_medium(const SceneSpec& spec, const Scatterer& scatterer, const Domain& domain,
                       double k) {
  check_density_keys(spec);
  if (scatterer.kind == Kind::hg) {
    const auto mu_t = stated_extinction(spec, domain);
    if (!mu_t) throw InputError("scatterer = hg: give mean_free_path or optical_depth");
    return bulk_medium(scatterer, *mu_t);
  }
  const double sigma_e = bulk_medium(scatterer, k, 1).cross_sections.extinction;
  return bulk_medium(scatterer, k, number_density(spec, domain, sigma_e));
}

PlacementRule::Kind placement_kind(const SceneSpec& spec, bool disks) {
  using Rule = PlacementRule::Kind;
  if (!spec.placement) return disks ? Rule::hard_disk : Rule::poisson;
  const Rule rule = choose<Rule>("placement", *spec.placement,
                                 {{"poisson", Rule::poisson},
                                  {"hard_disk", Rule::hard_disk},
                                  {"equilibrium", Rule::equilibrium}});
  if (disks == (rule == Rule::poisson))
    throw InputError("placement", *spec.placement,
                     disks ? "disks must not overlap: hard_disk or equilibrium"
                           : "scatterers without a radius: poisson");
  return rule;
}

PlacementRule make_placement_rule(const SceneSpec& spec, const Scatterer& scatterer,
                                  const Domain& domain, double density) {
  const bool disks = scatterer.is_disk();
  PlacementRule rule;
  rule.kind = placement_kind(spec, disks);
  rule.min_gap = spec.min_gap.value_or(disks ? default_gap * scatterer.radius : 0);
  if (!(std::isfinite(rule.min_gap) && rule.min_gap >= 0))
    throw InputError("min_gap", rule.min_gap, "must not be negative");
  if (rule.min_gap > 0 && !disks)
    throw InputError("min_gap", rule.min_gap, "is a key of disks only");
  if (spec.count) rule.count = static_cast<std::uint64_t>(*spec.count);
  rule.mean_count = density * domain.area();
  return rule;
}

void check_packing(const Scene& scene) {
  if (!scene.scatterer.is_disk()) return;
  const double reach = scene.scatterer.radius + scene.placement.min_gap / 2;
  const bool box = scene.domain.kind == Domain::Kind::box;
  const double density =
      box ? std::round(scene.placement.mean_count) / scene.domain.area() : scene.medium.density;
  check_packing(scene.domain, scene.placement.kind, density * std::numbers::pi * reach * reach,
                2 * reach);
}

/// The medium with the correlations that the scene states (C16).
BulkMedium correlated(const SceneSpec& spec, const Scene& scene) {
  const std::string& structure = spec.structure;
  if (structure == "none") return scene.medium;
  if (!scene.scatterer.is_disk())
    throw InputError("structure", structure,
                     "is a key of soft, hard, tm and te; points and hg are independent (none)");
  const std::pair<const char*, const std::optional<double>*> extinctions[] = {
      {"mean_free_path", &spec.mean_free_path}, {"optical_depth", &spec.optical_depth}};
  for (const auto& [key, value] : extinctions)
    if (*value)
      throw InputError(key, **value,
                       "correlations change the extinction; with structure give count or density");
  const DiskSpacing disks{scene.medium.density,
                          2 * scene.scatterer.radius + scene.placement.min_gap};
  return correlated_medium(scene.medium, scene.k,
                           structure == "hard_disks" ? hard_disk_structure(disks, 2 * scene.k)
                                                     : read_structure(structure, disks));
}

/// The infinite slab has far fields only, lights from below the horizon, and (C18) only entries
/// whose transverse momenta match.
void check_slab_request(const CovarianceRequest& request) {
  for (double light : request.lights)
    if (std::cos(light) <= 0)
      throw InputError("light_angles", light, "light enters a slab at z = 0: |angle| < pi/2");
  for (const auto& view : request.views)
    if (view.near) throw InputError("near_sensors: a slab has far views only");
  constexpr double tolerance = 1e-9;
  const auto momentum = [&](Channel c) {
    return std::sin(request.lights[c.light]) - std::sin(request.views[c.view].angle);
  };
  for (const auto& entry : request.entries) {
    if (std::abs(momentum(request.channels[entry.a]) - momentum(request.channels[entry.b])) >
        tolerance)
      throw InputError(
          "covariance: on an infinite slab only pairs with sin(light) - sin(view) unchanged "
          "correlate (the others are exactly 0); use intensity or memory_effect, or a box");
  }
}

std::vector<View> far_views(const std::vector<double>& angles) {
  std::vector<View> views;
  for (double angle : angles) views.push_back(far_view(angle));
  return views;
}

std::vector<View> requested_views(const SceneSpec& spec) {
  auto views = far_views(spec.view_angles);
  if (!spec.near_sensors.empty())
    for (const Vec2& point : read_points(spec.near_sensors)) views.push_back(near_sensor(point));
  return views;
}

CovarianceRequest memory_effect(const SceneSpec& spec) {
  if (spec.light_angles.size() != 1)
    throw InputError("light_angles", spec.light_angles.size(),
                     "memory_effect tilts one light: give one angle");
  if (!spec.near_sensors.empty())
    throw InputError("near_sensors", spec.near_sensors, "memory_effect has far views only");
  not_empty("tilts", spec.tilts);
  no_repeats("tilts", spec.tilts);
  not_empty("view_angles", spec.view_angles);
  no_repeats("view_angles", spec.view_angles);
  return memory_effect_request(2 * std::numbers::pi / spec.wavelength, spec.light_angles[0],
                               spec.view_angles, spec.tilts);
}

CovarianceRequest angle_pairs(const SceneSpec& spec) {
  not_empty("pairs", spec.pairs);
  all_radians("pairs", spec.pairs);
  if (spec.pairs.size() % 4 != 0)
    throw InputError("pairs", spec.pairs.size(),
                     "numbers; must be light 1, view 1, light 2, view 2 of each pair in turn");
  std::vector<AnglePair> pairs;
  for (std::size_t i = 0; i < spec.pairs.size(); i += 4)
    pairs.push_back({spec.pairs[i], spec.pairs[i + 1], spec.pairs[i + 2], spec.pairs[i + 3]});
  return pairs_request(pairs);
}

}  // namespace

Complex parse_complex(const std::string& key, const std::string& text) {
  static const std::string number = R"(([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))";
  static const std::regex form(
      "\\s*" + number + R"(\s*(?:([+-])\s*((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)?\s*[ij])?\s*)");
  std::smatch match;
  if (!std::regex_match(text, match, form))
    throw InputError(key, "\"" + text + "\"", "must be a number such as 1.5 or 1.5+0.1i");
  double imaginary = 0;
  if (match[2].matched) {
    imaginary = match[3].matched ? std::strtod(match[3].str().c_str(), nullptr) : 1;
    if (match[2] == "-") imaginary = -imaginary;
  }
  const Complex value{std::strtod(match[1].str().c_str(), nullptr), imaginary};
  if (!std::isfinite(std::abs(value))) throw InputError(key, text, "must be finite");
  return value;
}

Scatterer make_scatterer(const SceneSpec& spec) {
  positive("wavelength", spec.wavelength);
  Scatterer scatterer;
  scatterer.kind = scatterer_kind(spec.scatterer);
  const bool point = scatterer.kind == Kind::point, hg = scatterer.kind == Kind::hg;
  const bool penetrable = scatterer.kind == Kind::tm || scatterer.kind == Kind::te;
  only_for("radius", spec.radius, scatterer.is_disk(), "soft, hard, tm and te");
  only_for("index", spec.index, penetrable, "tm and te");
  only_for("g", spec.g, hg, "hg");
  only_for("albedo", spec.albedo, hg || point, "hg and point");
  only_for("phase_shift", spec.phase_shift, point, "point");
  if (spec.radius) scatterer.radius = positive("radius", *spec.radius);
  if (spec.index) scatterer.index = parse_complex("index", *spec.index);
  if (scatterer.index.imag() < 0 || scatterer.index == 0.0)
    throw InputError("index", *spec.index, "must not be 0 nor amplify (Im >= 0 absorbs)");
  if (spec.g) scatterer.g = *spec.g;
  if (!(std::abs(scatterer.g) < 1)) throw InputError("g", scatterer.g, "must be in (-1, 1)");
  if (spec.albedo) scatterer.albedo = checked_albedo(*spec.albedo, point);
  if (spec.phase_shift) {
    all_finite("phase_shift", {*spec.phase_shift});
    if (scatterer.albedo != 1)
      throw InputError("phase_shift", *spec.phase_shift,
                       "an absorbing point is resonant; leave it out");
    scatterer.phase_shift = *spec.phase_shift;
  }
  return scatterer;
}

CovarianceRequest make_request(const SceneSpec& spec) {
  not_empty("light_angles", spec.light_angles);
  all_radians("light_angles", spec.light_angles);
  all_radians("view_angles", spec.view_angles);
  all_radians("tilts", spec.tilts);
  using Request = CovarianceRequest::Kind;
  const auto kind = choose<Request>("covariance", spec.covariance,
                                    {{"intensity", Request::intensity},
                                     {"pairs", Request::pairs},
                                     {"memory_effect", Request::memory_effect},
                                     {"full", Request::full}});
  if (!spec.tilts.empty() && kind != Request::memory_effect)
    throw InputError("tilts", spec.tilts.front(), "is a key of covariance = memory_effect only");
  if (!spec.pairs.empty() && kind != Request::pairs)
    throw InputError("pairs", spec.pairs.front(), "is a key of covariance = pairs only");
  if (kind == Request::memory_effect) return memory_effect(spec);
  if (kind == Request::pairs) return angle_pairs(spec);
  const auto views = requested_views(spec);
  if (views.empty()) throw InputError("view_angles = []: must hold at least one number");
  if (kind == Request::full) return full_request(spec.light_angles, views);
  return intensity_request(spec.light_angles, views);
}

Scene make_scene(const SceneSpec& spec) {
  Scene scene;
  scene.scatterer = make_scatterer(spec);
  if (scene.scatterer.is_disk() && !spec.radius)
    throw InputError("radius is not given: must be positive");
  scene.wavelength = spec.wavelength;
  scene.k = 2 * std::numbers::pi / spec.wavelength;
  scene.domain = make_domain(spec);
  scene.medium = make_medium(spec, scene.scatterer, scene.domain, scene.k);
  scene.placement = make_placement_rule(spec, scene.scatterer, scene.domain, scene.medium.density);
  check_packing(scene);
  scene.medium = correlated(spec, scene);
  scene.request = make_request(spec);
  if (scene.domain.kind == Domain::Kind::slab) check_slab_request(scene.request);
  return scene;
}

}  // namespace flatspeckle
