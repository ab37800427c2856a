#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/keys/chosen.h"
#include "core/keys/number_text.h"
#include "flatland/media/layers.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

std::optional<Faces> make_faces(const Keys& keys, const SceneSpec& spec,
                                const std::optional<double>& first_layer) {
  const auto inside = first_layer ? first_layer : keys.read(spec.medium_index);
  if (!inside) return std::nullopt;
  Faces faces{*inside, keys.read(spec.outside_index).value_or(1)};
  const bool cylinders = spec.scatterer == "te" || spec.scatterer == "tm";
  const std::string own = cylinders ? spec.scatterer : "tm",
                    given = keys.read(spec.polarisation).value_or(own);
  if (cylinders && given != own)
    throw InputError("polarisation", given, "must be that of the cylinders, scatterer = " + own);
  faces.polarisation = chosen<Polarisation>(polarisation_words, given);
  if (spec.dimension == 3 && faces.polarisation == Polarisation::te)
    throw InputError("polarisation", given,
                     "requires dimension = 2; scalar waves in space have tm");
  return faces;
}

namespace {

/// Throws InputError for a light or view that is totally reflected at the faces, because the medium
/// outside has a larger index than a layer inside.
void check_total_reflection(const Scene& scene) {
  double least = scene.faces->inside;
  if (const auto* layers = dynamic_cast<const Layers*>(scene.profile.get()))
    for (const Material& material : layers->materials()) least = std::min(least, material.index);
  const double most_sine = least / scene.faces->outside;
  if (most_sine > 1) return;
  const auto check = [&](const char* key, double angle) {
    if (std::abs(std::sin(angle)) < most_sine) return;
    throw InputError(key, angle,
                     "is totally reflected at a face between the indices " +
                         number_text(scene.faces->outside) + " outside and " + number_text(least) +
                         ": must be less than " + number_text(std::asin(most_sine)) +
                         " from the normal, also after each tilt");
  };
  for (const Light& light : scene.request.lights) check("light_angles", light.angle);
  for (const View& view : scene.request.views) check("view_angles", view.angle);
}

}  // namespace

void check_faces(const Scene& scene) {
  if (!scene.faces) return;
  const auto refuse = [&](const std::string& why) {
    throw InputError("medium_index", scene.faces->inside, why);
  };
  if (scene.index) refuse("cannot be combined with index_field");
  if (has_near_endpoints(scene.request)) refuse("requires plane waves and far views");
  if (scene.profile && dynamic_cast<const Layers*>(scene.profile.get()) == nullptr)
    refuse("requires a homogeneous medium or layers");
  check_total_reflection(scene);
}

void refuse_unpolarised(const Scene& scene) {
  if (scene.faces && scene.faces->polarisation == Polarisation::unpolarised)
    throw InputError("polarisation", "unpolarised", "is possible in flux only; use tm or te");
}

}  // namespace flatspeckle
