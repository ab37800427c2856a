#include "grin/design/goals/aim_values.h"

#include "core/keys/kinds.h"

namespace flatspeckle::grin::design {

void add_keys(Keys& keys, AimValues& values) {
  keys.group("Light and goal");
  keys.add("goal", values.goal,
           "Parallel light meets in points (focus); rays of a fibre go at one speed (equal_path); "
           "beams show pictures (irradiance); rays leave as was measured (deflections); light of "
           "points leaves parallel (collimation), or passes through an aperture (throughput)")
      .one_of(kind_words(values.kinds));
  each_kind(values.kinds, [&](auto& kind) {
    keys.group(std::string("Goal: ") + kind.word, kind.word);
    add_keys(keys, kind);
  });
}

std::unique_ptr<Aim> make_aim(const Keys& keys, const AimValues& values, const FieldForm& form) {
  std::unique_ptr<Aim> aim;
  with_kind(values.kinds, keys.read(values.goal),
            [&](const auto& kind) { aim = make_aim(keys, kind, form); });
  return aim;
}

}  // namespace flatspeckle::grin::design
