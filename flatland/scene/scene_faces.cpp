#include "core/error.h"
#include "core/keys/chosen.h"
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

void check_faces(const Scene& scene) {
  if (!scene.faces) return;
  const auto refuse = [&](const std::string& why) {
    throw InputError("medium_index", scene.faces->inside, why);
  };
  if (scene.index) refuse("cannot be combined with index_field");
  if (has_near_endpoints(scene.request)) refuse("requires plane waves and far views");
  if (scene.profile && dynamic_cast<const Layers*>(scene.profile.get()) == nullptr)
    refuse("requires a homogeneous medium or layers");
}

void refuse_unpolarised(const Scene& scene) {
  if (scene.faces && scene.faces->polarisation == Polarisation::unpolarised)
    throw InputError("polarisation", "unpolarised", "is possible in flux only; use tm or te");
}

}  // namespace flatspeckle
