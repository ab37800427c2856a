#pragma once

#include <optional>

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/goals/goal.h"
#include "grin/design/goals/picture_goal.h"

namespace flatspeckle::grin::design {

/// Parallel beams, and the pictures that they are to show on screens behind the field.
struct ScreenValues {
  static constexpr const char* word = "irradiance";
  std::vector<std::string> pictures{};
  std::vector<double> view_directions{0, 0, 1};
  std::optional<double> beam_width = {}, beam_waist = {}, screen_width = {}, screen_distance = {};
  std::int64_t rays_across = 48;
};

void add_keys(Keys& keys, ScreenValues& values);

class ScreenAim : public Aim {
 public:
  struct View {
    Vec3 direction;
    ScreenPicture picture;  ///< as given
  };
  struct Light {
    double beam_width, beam_waist;  ///< waist 0: even
    double screen_distance;         ///< from the centre of the field
    int rays_across;
  };
  ScreenAim(const Surface& hull, const Vec3& centre, const Light& light, std::vector<View> views)
      : hull_(hull), centre_(centre), light_(light), views_(std::move(views)) {}

  double rays() const override;
  DesignTask task(const RayWalk& walk, bool held_out) const override;
  const std::vector<View>& views() const { return views_; }
  /// What rays show that meet the screens there, each as shown() would be: of power 1.
  std::vector<ScreenPicture> shown_by(std::span<const double> readings, bool held_out) const;

 private:
  static constexpr int held_out_across = 192;
  int across(bool held_out) const { return held_out ? held_out_across : light_.rays_across; }
  std::vector<double> powers(int across) const;

  Surface hull_;
  Vec3 centre_;
  Light light_;
  std::vector<View> views_;
};

/// Throws InputError for pictures that are none, another number of them than directions, and beams
/// that do not fit into the field.
std::unique_ptr<Aim> make_aim(const Keys& keys, const ScreenValues& values, const FieldForm& form);

}  // namespace flatspeckle::grin::design
