#include "flatland/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>

#include "core/error.h"
#include "flatland/scene/scene_checks.h"

namespace flatspeckle {

namespace {

using Kind = Scatterer::Kind;

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
  const double most = 1e8 * spec.wavelength;  // along which phases are integrated
  for (const auto& [key, extent] : {std::pair{"width", domain.width}, {"depth", domain.depth}})
    if (box && extent > most) throw InputError(key, extent, "must be at most 1e8 wavelengths");
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

/// Sources and beams so far away, or so wide, that the medium is lost in their rounding.
void check_reach(const Scene& scene) {
  const double most = 1e9 * (scene.domain.width + scene.domain.depth);
  for (const Light& light : scene.request.lights) {
    if (light.kind == Light::Kind::point && length(light.point) > most)
      throw InputError("near_sources", length(light.point),
                       "lies too far from the medium; a light angle does as well");
    if (light.kind == Light::Kind::beam && (length(light.point) > most || light.waist > most))
      throw InputError(
          "beam_waist", light.waist,
          "is too wide, or its focus too far from the medium; a plane wave does as well");
  }
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
  if (spec.index) {
    scatterer.index = parse_complex("index", *spec.index);
    if (const auto fault = index_fault(scatterer.index); !fault.empty())
      throw InputError("index", *spec.index, fault);
  }
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
  check_reach(scene);
  if (scene.domain.kind == Domain::Kind::slab) check_slab_request(scene.request);
  return scene;
}

}  // namespace flatspeckle
