#pragma once

#include <optional>

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/objectives/design_objective.h"

namespace flatspeckle::grin::design {

/// A picture: a square of pixels centred on a screen. Pixels are stored row by row, from the top.
struct ScreenPicture {
  double width = 0;  ///< length of a side
  int pixels = 0;    ///< number of pixels along a side
  std::vector<double> values;
};

/// Returns the light on each pixel. The power of each ray is distributed over 4 x 4 pixels by cubic
/// splines. hits: for each ray, two coordinates on the screen, relative to the centre of the
/// screen.
std::vector<double> irradiance_of(const ScreenPicture& screen, std::span<const double> hits,
                                  std::span<const double> power);

/// Returns the best approximation of the picture that rays can form: normalised to a total power of
/// 1 and blurred along both axes with the weights 1/8, 6/8, 1/8.
ScreenPicture shown(const ScreenPicture& picture);

/// Light beam of power 1 and the picture that it should form. The loss of several beams is the mean
/// over all pixels of the squared irradiance error relative to the picture's largest value.
struct Beam {
  ScreenPicture picture;      ///< picture that rays can form: result of shown()
  std::vector<double> power;  ///< power of each ray
};
std::unique_ptr<DesignObjective> make_picture_objective(std::vector<Beam> beams);

/// Scene keys of the goal `irradiance`: parallel beams and the pictures that they should form on
/// screens behind the field.
struct ScreenValues {
  static constexpr const char* word = "irradiance";
  std::vector<std::string> pictures{};
  std::vector<double> view_directions{0, 0, 1};
  std::optional<double> beam_width = {}, beam_waist = {}, screen_width = {}, screen_distance = {};
  std::int64_t rays_across = 48;
};

void add_keys(Keys& keys, ScreenValues& values);

class ScreenTarget : public DesignTarget {
 public:
  struct View {
    Vec3 direction;
    ScreenPicture picture;  ///< picture as given by the user, not blurred
  };
  struct Light {
    double beam_width, beam_waist;  ///< beam_waist = 0 means a uniform beam
    double screen_distance;         ///< distance of the screen from the centre of the field
    int rays_across;
  };
  ScreenTarget(const Surface& hull, const Vec3& centre, const Light& light, std::vector<View> views)
      : hull_(hull), centre_(centre), light_(light), views_(std::move(views)) {}

  double rays() const override;
  DesignTask task(const RayWalk& walk, bool held_out) const override;
  const std::vector<View>& views() const { return views_; }
  /// Returns the pictures formed by rays that hit the screens at these coordinates. The rays of
  /// each picture have a total power of 1.
  std::vector<ScreenPicture> shown_by(std::span<const double> measurements, bool held_out) const;

 private:
  static constexpr int held_out_across = 192;
  int across(bool held_out) const { return held_out ? held_out_across : light_.rays_across; }
  std::vector<double> powers(int across) const;

  Surface hull_;
  Vec3 centre_;
  Light light_;
  std::vector<View> views_;
};

/// Makes the design target: each beam should form its picture. Throws InputError if a picture
/// cannot be read, if the numbers of pictures and directions differ, or if the beams do not fit
/// into the field.
std::unique_ptr<DesignTarget> make_target(const Keys& keys, const ScreenValues& values,
                                          const FieldForm& form);

}  // namespace flatspeckle::grin::design
