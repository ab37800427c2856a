#include "grin/render/values/tagging.h"

#include <cmath>
#include <numbers>

#include "core/error.h"

namespace flatspeckle::grin {

void add_keys(Keys& keys, TaggingValues& values) {
  keys.group("Light that the sound of the field shifts in frequency");
  keys.add("tag_wavelength", values.tag_wavelength,
           "Vacuum wavelength of light: also computes the light that the sound shifts in frequency "
           "(method = forward; field = focused_sound or transducers). The sound then bends no rays")
      .positive()
      .unit("length");
  keys.add("strain_optic", values.strain_optic,
           "Change of the index per compression of the medium; the default is that of water")
      .positive()
      .only_of("tag_wavelength");
}

std::shared_ptr<const TaggingSound> make_tagging(const Keys& keys, const TaggingValues& values,
                                                 Part part, SceneField& field) {
  const auto& wavelength = keys.read(values.tag_wavelength);
  if (!wavelength) return nullptr;
  const SoundWaves* const sound = std::visit(
      [](const auto& of) -> const SoundWaves* {
        if constexpr (std::is_base_of_v<SoundWaves, std::remove_cvref_t<decltype(of)>>)
          return &of;
        else
          return nullptr;
      },
      field.field);
  if (!sound)
    throw InputError("tag_wavelength", *wavelength,
                     "requires sound: field = focused_sound or transducers alone");
  constexpr double same = 1e-9;
  const double first = sound->waves().front().k.norm();
  auto tagging = std::make_shared<TaggingSound>();
  tagging->part = part;
  for (const SoundWaves::Wave& wave : sound->waves()) {
    if (std::abs(wave.k.norm() - first) > same * first)
      throw InputError("tag_wavelength", *wavelength, "requires sound of one frequency");
    const double index = 1 + sound->background();
    tagging->waves.push_back(
        {wave.k, std::polar(2 * std::numbers::pi / *wavelength * wave.amplitude, -wave.phase),
         index / (keys.read(values.strain_optic) * wave.k.squaredNorm())});
  }
  const Homogeneous still{sound->background()};
  field = SceneField{};
  field.field = still;
  return tagging;
}

}  // namespace flatspeckle::grin
