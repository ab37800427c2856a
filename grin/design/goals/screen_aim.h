#pragma once

#include <optional>

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/goals/goal.h"

namespace flatspeckle::grin::design {

/// A square of pixels on a screen, about its middle; row after row, from the top.
struct ScreenPicture {
  double width = 0;  ///< of its side
  int pixels = 0;    ///< along a side
  std::vector<double> values;
};

/// Light that falls on the pixels: each ray's share is spread over 4 x 4 of them by cubic splines.
/// hits: two numbers of each ray, where it meets the screen from the middle.
std::vector<double> irradiance_of(const ScreenPicture& screen, std::span<const double> hits,
                                  std::span<const double> power);

/// The light of a picture as rays show it at their best: of the same power, 1, and blurred by
/// 1/8, 6/8, 1/8 along both sides.
ScreenPicture shown(const ScreenPicture& picture);

/// Rays of several beams, each of power 1, one after another, are to show a picture each. The loss
/// is the mean over all pixels of the square of what irradiance is off, over the largest of the
/// picture.
struct Beam {
  ScreenPicture picture;      ///< shown()
  std::vector<double> power;  ///< of each ray
};
std::unique_ptr<Goal> make_picture_goal(std::vector<Beam> beams);

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
