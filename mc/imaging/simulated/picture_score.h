#pragma once

#include <span>
#include <vector>

#include "mc/imaging/recovery/phase_retrieval.h"

namespace flatspeckle::mc {

/// A recovered picture at the shift and rotation at which it agrees best with the true one.
struct PictureScore {
  std::vector<double> aligned;
  double similarity = 0;  ///< structural_similarity() of the aligned picture
};
/// width: that of the windows of structural_similarity().
PictureScore picture_score(std::span<const double> truth, std::span<const double> found,
                           PictureSize size, double width);

/// Returns the mean structural similarity [wang2004] of two pictures over the smallest rectangle
/// that contains all pixels of `truth` above a hundredth of its largest value. The scale of `found`
/// is fitted. Windows are Gaussians of full width at half maximum `width` pixels. The stabilising
/// constants are (0.01 L)^2 and (0.03 L)^2 for the largest value L of `truth`.
double structural_similarity(std::span<const double> truth, std::span<const double> found,
                             PictureSize size, double width);

}  // namespace flatspeckle::mc
