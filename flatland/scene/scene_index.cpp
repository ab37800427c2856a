#include <string>
#include <vector>

#include "core/error.h"
#include "core/keys/chosen.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

namespace {

std::vector<IndexBlob> read_index_blobs(const std::string& path) {
  const Table table = read_key_table("index_blobs", path, {"x", "z", "height", "width"});
  std::vector<IndexBlob> blobs;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto of = [&](const char* name) { return table.column(name)[row]; };
    blobs.push_back({{of("x"), of("z")}, of("height"), of("width")});
    if (!(blobs.back().width > 0))
      throw InputError(path + ", width", blobs.back().width, "must be positive");
  }
  return blobs;
}

std::string shown_place(Vec x) {
  return '(' + number_text(x.x) + ", " + number_text(x.z) + ')';
}

/// Returns points that the light of the scene must reach: the corners of the domain, near sources
/// and near sensors.
std::vector<Vec> lit_places(const Scene& scene) {
  const double half = scene.domain.width / 2, depth = scene.domain.depth;
  std::vector<Vec> places = {{-half, 0}, {half, 0}, {-half, depth}, {half, depth}};
  for (const Light& light : scene.request.lights)
    if (light.kind == Light::Kind::point) places.push_back(light.point);
  for (const View& view : scene.request.views)
    if (view.near) places.push_back(view.point);
  return places;
}

void check_mean_field(const Scene& scene) {
  if (!scene.medium.has_scatterers)
    throw InputError("index_field", "mean_field", "requires scatterers, not a phase function");
  if (has_near_endpoints(scene.request))
    throw InputError("index_field", "mean_field", "requires plane waves and far views");
}

}  // namespace

std::optional<IndexField> index_field(const Keys& keys, const SceneSpec& spec) {
  using Kind = IndexField::Kind;
  IndexField field;
  field.kind = chosen<Kind>(index_field_words, keys.read(spec.index_field));
  if (field.kind == Kind::homogeneous) return std::nullopt;
  if (field.kind != Kind::grid && field.is_around()) field.origin = keys.read(spec.axis_index);
  switch (field.kind) {
    case Kind::linear:
      field.gradient = {keys.required(spec.index_gradient)[0], spec.index_gradient[1]};
      break;
    case Kind::parabolic:
      field.alpha = keys.required(spec.index_alpha);
      break;
    case Kind::blobs:
      field.blobs = read_index_blobs(keys.required(spec.index_blobs));
      break;
    case Kind::ultrasound:
      field.sound_amplitude = keys.required(spec.sound_amplitude);
      field.sound_wavenumber = keys.required(spec.sound_wavenumber);
      break;
    case Kind::grid:
      field.grid = keys.required(spec.index_grid);
      break;
    case Kind::homogeneous:
    case Kind::mean_field:
      break;
  }
  return field;
}

void check_index_field(const Scene& scene) {
  if (!scene.index) return;
  const auto refuse = [](const std::string& why) { throw InputError("index_field: " + why); };
  if (scene.scatterer.is_disk() && scene.index->is_around())
    refuse("requires points or phase functions of the bulk as scatterers");
  if (scene.profile) refuse("requires a medium without layers or density maps");
  if (scene.medium.dimension == 3) refuse("requires dimension = 2");
  if (!scene.request.lights.all(Light::Kind::plane) &&
      !scene.request.lights.all(Light::Kind::point))
    refuse("requires plane waves or near sources, not beams");
  if (!scene.index->is_around()) return check_mean_field(scene);
  const bool stratified =
      scene.index->kind == IndexField::Kind::linear && scene.index->gradient.x == 0;
  if (scene.domain.kind == Domain::Kind::slab && !stratified)
    refuse("an infinite slab requires a linear field with its gradient along z");
  if (!scene.index->is_quadratic()) return;
  for (const Vec place : lit_places(scene))
    if (!(scene.index->square(place) > 0))
      throw InputError("index_field",
                       index_field_words[static_cast<std::size_t>(scene.index->kind)],
                       "has n^2 = " + number_text(scene.index->square(place)) + " at " +
                           shown_place(place) + "; it must be positive");
}

void refuse_graded(const Scene& scene, const std::string& what) {
  if (scene.index)
    throw InputError("index_field", index_field_words[static_cast<std::size_t>(scene.index->kind)],
                     "is not supported by " + what);
}

}  // namespace flatspeckle
