#pragma once

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

}  // namespace flatspeckle::grin::design
