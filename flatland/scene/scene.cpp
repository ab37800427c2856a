#include "flatland/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/contract.h"
#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "flatland/media/layers.h"
#include "flatland/scene/density_maps.h"
#include "flatland/scene/scene_density.h"

namespace flatspeckle {

namespace {

/// A column of the file of layers, and the member of SceneSpec that it sets.
struct Column {
  const char* name;
  std::optional<double> SceneSpec::*member;
};
const std::vector<Column> densities = {{"optical_depth", &SceneSpec::optical_depth},
                                       {"mean_free_path", &SceneSpec::mean_free_path},
                                       {"density", &SceneSpec::density}};
const std::vector<Column> scatterer_columns = {{"g", &SceneSpec::g},
                                               {"albedo", &SceneSpec::albedo},
                                               {"radius", &SceneSpec::radius},
                                               {"phase_shift", &SceneSpec::phase_shift},
                                               {"medium_index", &SceneSpec::medium_index}};

std::vector<std::string> all_columns() {
  std::vector<std::string> names = {"thickness", "index_re", "index_im", "diffusion",
                                    "flow",      "mu_s",     "mu_a"};
  for (const auto* columns : {&densities, &scatterer_columns})
    for (const Column& column : *columns) names.emplace_back(column.name);
  return names;
}

/// File that the key `layers` names, with one line for each layer; the first layer begins at z = 0.
/// Its columns are the thickness, one of optical_depth, mean_free_path, density and mu_s (with
/// mu_a, in place of albedo), and those properties of the scatterers that differ between layers (g,
/// albedo, radius, index_re and index_im, phase_shift). The columns diffusion and flow are factors
/// on the diffusion coefficient and the flow velocity of the scene.
class LayerTable {
 public:
  /// Reads the key and the file. Throws InputError.
  LayerTable(const Keys& keys, const SceneSpec& spec)
      : path_(keys.read(spec.layers)),
        table_(read_key_table("layers", path_, all_columns(), true)) {
    constexpr std::size_t most = 1000;
    if (table_.rows() == 0 || table_.rows() > most)
      throw InputError("layers", path_, "must contain 1 to " + std::to_string(most) + " layers");
    if (!table_.has("thickness")) throw InputError(path_ + ": column thickness is missing");
    for (const double thickness : table_.column("thickness"))
      if (!(thickness > 0)) throw InputError(path_ + ", thickness", thickness, "must be positive");
    const auto given =
        std::ranges::count_if(densities,
                              [&](const Column& column) { return table_.has(column.name); }) +
        table_.has("mu_s");
    if (given != 1)
      throw InputError(path_ +
                       ": give exactly one of the columns optical_depth, mean_free_path, density, "
                       "mu_s");
    if (table_.has("mu_a") && !table_.has("mu_s"))
      throw InputError(path_ + ": the column mu_a requires a column mu_s");
    if (table_.has("mu_s") && table_.has("albedo"))
      throw InputError(path_ + ": the columns mu_s and mu_a replace albedo: leave it out");
    if (table_.has("index_im") && !table_.has("index_re"))
      throw InputError(path_ + ": the column index_im requires a column index_re");
    refuse_twice(keys, spec);
  }

  /// Returns the total thickness of all layers.
  double depth() const {
    const auto column = table_.column("thickness");
    return std::accumulate(column.begin(), column.end(), 0.0);
  }

  /// Returns the refractive index of the first layer if a column contains indices.
  std::optional<double> first_index() const {
    if (!table_.has("medium_index")) return std::nullopt;
    return table_.column("medium_index")[0];
  }

  /// Creates the layers. Throws InputError naming the line of a layer that is not valid.
  std::shared_ptr<const Layers> layers(const SceneSpec& spec) const {
    std::vector<Material> materials;
    for (std::size_t layer = 0; layer < table_.rows(); ++layer) try {
        materials.push_back(material(spec, layer));
      } catch (const InputError& error) {
        throw InputError(path_ + ", layer " + std::to_string(layer + 1) + ": " + error.what());
      }
    const auto thicknesses = table_.column("thickness");
    return std::make_shared<const Layers>(
        std::move(materials), std::vector<double>(thicknesses.begin(), thicknesses.end()));
  }

 private:
  /// Rejects values that are given twice: by a column for each layer, and by a key for all layers.
  void refuse_twice(const Keys& keys, const SceneSpec& spec) const {
    const auto refuse = [&](const std::string& column, const auto& member) {
      if (table_.has(column) && keys.given(member))
        throw InputError("layers", path_,
                         "has a column " + column + "; leave out the key " + keys.name(member));
    };
    for (const Column& column : scatterer_columns) refuse(column.name, spec.*column.member);
    refuse("mu_s", spec.albedo);
    for (const auto* coefficient : {&spec.mu_s, &spec.mu_a})
      if (*coefficient)
        throw InputError(keys.name(*coefficient), **coefficient,
                         "cannot be combined with layers, whose file has the column mu_s");
    refuse("radius", spec.diameter);
    refuse("index_re", spec.index);
    refuse("index_re", spec.particle_index);
  }

  /// Returns the optical depth or density that replaces 0 in a layer. It is so small, compared with
  /// the sum over all layers, that results change by less than rounding errors.
  double clear() const {
    constexpr double share = 1e-15;
    double all = 0;
    for (const char* name : {"optical_depth", "density", "mu_s", "mu_a"})
      if (table_.has(name))
        for (const double value : table_.column(name)) all += value;
    if (!(all > 0)) throw InputError("at least one layer must scatter or absorb");
    return share * all;
  }

  /// Returns the material of a layer, computed as for a slab that consists only of this layer.
  /// Throws InputError if a value given for the layer is not used.
  Material material(const SceneSpec& spec, std::size_t layer) const {
    SceneSpec own;
    static_cast<ScattererValues&>(own) = spec;
    own.domain = "slab";
    own.dimension = spec.dimension;
    own.depth = table_.column("thickness")[layer];
    const auto take = [&](const Column& column) {
      if (table_.has(column.name)) own.*column.member = table_.column(column.name)[layer];
    };
    for (const Column& column : densities) take(column);
    if (table_.has("mu_s")) {
      const double mu_s = coefficient("mu_s", layer), mu_t = mu_s + coefficient("mu_a", layer);
      own.optical_depth = mu_t * *own.depth;
      if (mu_t > 0) own.albedo = mu_s / mu_t;
    }
    for (auto* extinction : {&own.optical_depth, &own.density})
      if (*extinction == 0.0) *extinction = clear();
    for (const Column& column : scatterer_columns) take(column);
    if (table_.has("index_re"))
      own.index =
          number_text(Complex(table_.column("index_re")[layer],
                              table_.has("index_im") ? table_.column("index_im")[layer] : 0.0));
    const Scene scene = make_scene(own);
    const auto share = [&](const char* name) {
      return table_.has(name) ? table_.column(name)[layer] : 1.0;
    };
    if (share("diffusion") < 0)
      throw InputError("diffusion", share("diffusion"), "must not be negative");
    // If layers differ in index, k^2 D is that in vacuum.
    const double index = own.medium_index.value_or(1),
                 relative = table_.has("medium_index") ? index : 1;
    const MaterialMotion motion{share("diffusion") * relative * relative, share("flow")};
    return {scene.scatterer, scene.medium, motion, index};
  }

  /// Returns mu_s or mu_a of a layer; 0 without a column.
  double coefficient(const char* name, std::size_t layer) const {
    const double value = table_.has(name) ? table_.column(name)[layer] : 0;
    if (!(value >= 0)) throw InputError(name, value, "must not be negative");
    return value;
  }

  std::string path_;
  Table table_;
};

/// Creates the domain. If layers are given, its depth is their total thickness.
Domain make_domain(const Keys& keys, const SceneSpec& spec,
                   const std::optional<LayerTable>& layers) {
  Domain domain;
  domain.kind = keys.read(spec.domain) == "box" ? Domain::Kind::box : Domain::Kind::slab;
  domain.depth = layers ? layers->depth() : keys.required(spec.depth);
  if (domain.kind == Domain::Kind::slab) return domain;
  if (!keys.read(spec.width))
    throw InputError("width is not given: a box requires it; domain = slab is infinite in x");
  domain.width = *spec.width;
  const double most = 1e8 * spec.wavelength;  // rounding errors of phases k r grow with the extent
  if (spec.dimension == 3) {
    if (!keys.read(spec.height))
      throw InputError("height is not given: a box in space requires it");
    domain.height = *spec.height;
  }
  for (const auto& [key, extent] :
       {std::pair{"width", domain.width}, {"depth", domain.depth}, {"height", domain.height}})
    if (extent > most) throw InputError(key, extent, "must be at most 1e8 wavelengths");
  return domain;
}

BulkMedium medium_of_scatterers(const SceneSpec& spec, const Scatterer& scatterer,
                                const Domain& domain, double k) {
  BulkMedium medium = bulk_medium(scatterer, k, 1, static_cast<int>(spec.dimension));
  set_density(medium, scatterer, k,
              number_density(spec, domain, scatterer, medium.cross_sections.extinction));
  return medium;
}

/// Creates the placement rule except for its mean_count, which is set later from the density.
PlacementRule make_placement_rule(const Keys& keys, const SceneSpec& spec,
                                  const Scatterer& scatterer) {
  PlacementRule rule;
  rule.kind = placement_kind(keys.read(spec.placement), scatterer.is_disk());
  if (scatterer.is_disk())
    rule.min_gap = keys.read(spec.min_gap).value_or(default_gap * scatterer.radius);
  if (spec.count) rule.count = static_cast<std::uint64_t>(*spec.count);
  return rule;
}

void check_packing(const Scene& scene) {
  if (scene.scatterer.kind == Scatterer::Kind::mie || scene.medium.dimension == 3)
    return check_spheres(scene.medium);
  if (!scene.scatterer.is_disk()) return;
  const double reach = scene.scatterer.radius + scene.placement.min_gap / 2;
  const bool box = scene.domain.kind == Domain::Kind::box;
  const double density =
      box ? std::round(scene.placement.mean_count) / scene.domain.content() : scene.medium.density;
  check_packing(scene.domain, scene.placement.kind, density * std::numbers::pi * reach * reach,
                2 * reach);
}

void check_extinction(const BulkMedium& medium) {
  if (medium.mu_t > 0 && !std::isfinite(medium.mean_free_path()))
    throw InputError("albedo", medium.albedo,
                     "leaves an extinction of " + number_text(medium.mu_t) +
                         ", so small that its mean free path is not finite");
}

void check_structure(const Keys& keys, const SceneSpec& spec, const Scatterer& scatterer) {
  const std::string& structure = keys.read(spec.structure);
  if (structure == "none") return;
  const bool spheres = spec.dimension == 3;
  if (!scatterer.is_disk() && scatterer.kind != Scatterer::Kind::mie)
    throw InputError("structure", structure,
                     "is a key of cylinders and spheres only; otherwise it must be none");
  if (spheres != (structure == "hard_spheres"))
    throw InputError("structure", structure,
                     spheres ? "must be hard_spheres or none for spheres"
                             : "requires dimension = 3; cylinders have hard_disks, or a file "
                               "that place --structure wrote");
  for (const auto* extinction : {&spec.mean_free_path, &spec.optical_depth})
    if (*extinction)
      throw InputError(
          keys.name(*extinction), **extinction,
          "cannot be combined with structure, which changes the extinction; give another density");
}

/// Returns the medium of the scene with the correlations that `structure` names (C16). For mie,
/// whose properties are computed in space, sets only the structure factor.
BulkMedium correlated(const std::string& structure, const Scene& scene) {
  if (scene.scatterer.kind == Scatterer::Kind::mie) {
    BulkMedium medium = scene.medium;
    medium.structure = hard_sphere_structure(medium.density, 2 * scene.scatterer.radius);
    return medium;
  }
  const DiskSpacing disks{scene.medium.density,
                          2 * scene.scatterer.radius + scene.placement.min_gap};
  if (structure == "hard_spheres")
    return correlated_medium(scene.medium, scene.k,
                             hard_sphere_structure(disks.density, disks.contact));
  return correlated_medium(scene.medium, scene.k,
                           structure == "hard_disks" ? hard_disk_structure(disks, 2 * scene.k)
                                                     : read_structure(structure, disks));
}

/// Returns the largest distance of a source or sensor at which, despite rounding, points of the
/// medium remain distinct.
double furthest(const Domain& domain) {
  return 1e9 * (domain.width + domain.depth);
}

/// Rejects sources, sensors and beams that are so far away, or so wide, that points of the medium
/// are no longer distinct after rounding.
void check_reach(const Scene& scene) {
  const double most = furthest(scene.domain);
  for (const Light& light : scene.request.lights) {
    if (light.kind == Light::Kind::point) require_reach("near_sources", light.point, scene);
    if (light.kind == Light::Kind::beam && (length(light.point) > most || light.waist > most))
      throw InputError(
          "beam_waist", light.waist,
          "the beam is too wide, or its focus too far from the medium; use a plane wave instead");
  }
  for (const View& view : scene.request.views)
    if (view.near) require_reach("near_sensors", view.point, scene);
}

/// Checks that exactly one density key is given, for a scene without layers. If the scene has a
/// phase function or spheres, sets its medium; of spheres with a given density, without extinction.
void make_phase_of_bulk(const Keys& keys, const SceneSpec& spec, Scene& scene) {
  check_density_keys(keys, spec, scene.scatterer);
  if (!scene.scatterer.is_bulk()) return;
  const auto mu_t = stated_extinction(spec, scene.domain);
  const auto density = stated_density(spec, scene.domain, scene.scatterer);
  if (!mu_t && scene.scatterer.kind != Scatterer::Kind::mie)
    throw InputError("scatterer", spec.scatterer, "requires mean_free_path, optical_depth or mu_s");
  scene.medium =
      bulk_medium(scene.scatterer, make_phase(keys, spec.bulk, spec.scatterer), mu_t.value_or(0));
  if (!density) return;
  scene.medium.density = *density;
  scene.medium.packing_fraction =
      *density * scene.scatterer.content(static_cast<int>(spec.dimension));
}

/// Reads the keys of the phase function, which all layers share.
void read_layer_keys(const Keys& keys, const SceneSpec& spec, const Scatterer& scatterer) {
  if (scatterer.is_bulk()) make_phase(keys, spec.bulk, spec.scatterer);
}

/// Throws InputError for cylinders in space and for spheres in the plane.
void check_dimension(const SceneSpec& spec) {
  const auto is_one_of = [&](std::initializer_list<const char*> words) {
    return std::ranges::find(words, spec.scatterer) != words.end();
  };
  if (spec.dimension == 3 && is_one_of({"tm", "te"}))
    throw InputError("scatterer", spec.scatterer,
                     "are cylinders in the plane; dimension = 3 has point, soft, hard, penetrable, "
                     "mie and phase functions");
  if (spec.dimension != 3 && is_one_of({"penetrable", "mie"}))
    throw InputError("scatterer", spec.scatterer,
                     "spheres require dimension = 3; cylinders that light enters are tm or te");
}

/// Creates the scene without the bulk properties (BulkMedium) of its scatterers. Nearly all invalid
/// input is rejected here, before these properties are computed.
Scene without_bulk(const Keys& keys, const SceneSpec& spec,
                   const std::optional<LayerTable>& layers) {
  Scene scene;
  scene.scatterer = make_scatterer(keys, spec);
  if (scene.scatterer.is_disk() && !layers) require_radius(spec);
  check_dimension(spec);
  scene.faces = make_faces(keys, spec, layers ? layers->first_index() : std::nullopt);
  scene.wavelength = scene.faces ? spec.wavelength / scene.faces->inside : spec.wavelength;
  scene.k = 2 * std::numbers::pi / scene.wavelength;
  scene.domain = make_domain(keys, spec, layers);
  layers ? read_layer_keys(keys, spec, scene.scatterer) : make_phase_of_bulk(keys, spec, scene);
  if (spec.count && scene.domain.kind == Domain::Kind::slab)
    throw InputError("count", *spec.count, "an infinite slab has no count; give a density");
  scene.placement = make_placement_rule(keys, spec, scene.scatterer);
  check_structure(keys, spec, scene.scatterer);
  if (layers && spec.structure != "none")
    throw InputError("structure", spec.structure, "requires a medium without layers");
  scene.request = make_request(keys, spec);
  check_reach(scene);
  if (scene.domain.kind == Domain::Kind::slab)
    check_slab_request(scene.request, scene.domain.depth);
  return scene;
}

void make_layered(Scene& scene, std::shared_ptr<const Layers> layers) {
  scene.medium = layers->mean();
  for (const Material& material : layers->materials())
    scene.scatterer.radius = std::max(scene.scatterer.radius, material.scatterer.radius);
  scene.profile = std::move(layers);
}

}  // namespace

void require_phase(const std::string& key, Vec point, double k) {
  constexpr double accuracy = 1e-3;  // rad
  const double most = accuracy / (k * std::numeric_limits<double>::epsilon());
  if (!(length(point) <= most))
    throw InputError(
        key, length(point),
        "is too far away: in double precision the phase k r is accurate to 0.001 rad up to " +
            number_text(most) + "; use a direction instead");
}

void require_reach(const std::string& key, Vec point, const Scene& scene) {
  require_phase(key, point, scene.k);
  if (length(point) > furthest(scene.domain))
    throw InputError(key, length(point), "lies too far from the medium; use a direction instead");
}

Scene make_scene(const Keys& keys, const SceneSpec& spec) {
  std::optional<LayerTable> layers;
  if (!keys.read(spec.layers).empty()) layers.emplace(keys, spec);
  const MakeDensityMap map = density_map(keys, spec);
  Scene scene = without_bulk(keys, spec, layers);
  scene.index = index_field(keys, spec);
  keys.refuse_unread();
  if (layers)
    make_layered(scene, layers->layers(spec));
  else if (!scene.scatterer.is_bulk())
    scene.medium = medium_of_scatterers(spec, scene.scatterer, scene.domain, scene.k);
  if (map) {
    scene.profile = map(scene.domain, {scene.scatterer, scene.medium});
    scene.medium = scene.profile->mean();
  }
  check_index_field(scene);
  check_faces(scene);
  check_extinction(scene.medium);
  scene.placement.mean_count = scene.medium.density * scene.domain.content();
  check_packing(scene);
  if (spec.structure != "none") scene.medium = correlated(spec.structure, scene);
  FS_ENSURE(is_physical(scene.medium));
  return scene;
}

Scene make_scene(const SceneSpec& spec) {
  return made_of(spec, [](const Keys& keys, const SceneSpec& own) {
    keys.read(own.dimension);
    return make_scene(keys, own);
  });
}

CovarianceRequest make_request(const SceneSpec& spec) {
  const Keyed<SceneSpec> keyed(spec);
  return make_request(keyed.keys, keyed.values);
}

std::string inputs_text(const Scene& scene) {
  std::string text;
  const auto add = [&](Vec point) {
    text += number_text(point.x) + ',' + number_text(point.z);
    text += (point.y == 0 ? "" : ',' + number_text(point.y)) + '\n';
  };
  for (const View& view : scene.request.views)
    if (view.near) add(view.point);
  for (const Light& light : scene.request.lights) {
    if (light.kind != Light::Kind::point) continue;
    text += "source ";
    add(light.point);
  }
  return text + scene.medium.structure.text() + scene.medium.phase.text;
}

}  // namespace flatspeckle
