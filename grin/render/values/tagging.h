#pragma once

#include <memory>
#include <optional>

#include "core/keys/keys.h"
#include "grin/media/fields/scene_field.h"
#include "grin/render/transport/tagging_sound.h"

namespace flatspeckle::grin {

/// Values of the keys of tagged light.
struct TaggingValues {
  std::optional<double> tag_wavelength = {};
  double strain_optic = 0.32;
};

void add_keys(Keys& keys, TaggingValues& values);

/// Returns the sound that shifts the frequency of light, taken from the index field; null unless
/// tagged light is requested. The field then has its background alone, so that the sound bends no
/// rays. Throws InputError for a field other than plane waves of one frequency.
std::shared_ptr<const TaggingSound> make_tagging(const Keys& keys, const TaggingValues& values,
                                                 Part part, SceneField& field);

}  // namespace flatspeckle::grin
