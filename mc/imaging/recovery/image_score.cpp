#include "mc/imaging/recovery/image_score.h"

#include <cmath>

namespace flatspeckle::mc {

namespace {

LineObject mirrored(LineObject object) {
  for (double& x : object.x) x = -x;
  return object;
}

/// Returns the score if the found object is shifted by `shift`. Each found point is matched at most
/// once.
ImageScore score_at(const LineObject& truth, const LineObject& found, double shift,
                    double resolution) {
  std::vector<bool> used(found.x.size());
  double count = 0, product = 0, of_truth = 0, of_found = 0;
  for (std::size_t i = 0; i < truth.x.size(); ++i) {
    of_truth += truth.brightness[i] * truth.brightness[i];
    std::size_t nearest = found.x.size();
    double least = resolution;
    for (std::size_t j = 0; j < found.x.size(); ++j)
      if (const double off = std::abs(found.x[j] + shift - truth.x[i]); !used[j] && off <= least) {
        least = off;
        nearest = j;
      }
    if (nearest == found.x.size()) continue;
    used[nearest] = true;
    ++count;
    product += truth.brightness[i] * found.brightness[nearest];
  }
  for (const double b : found.brightness) of_found += b * b;
  const double squares = of_truth * of_found;
  return {count / static_cast<double>(truth.x.size()),
          squares > 0 ? product / std::sqrt(squares) : 0};
}

}  // namespace

ImageScore score(const LineObject& truth, const LineObject& found, double resolution,
                 MirrorImage mirror) {
  ImageScore best;
  std::vector<LineObject> either{found};
  if (mirror == MirrorImage::perhaps) either.push_back(mirrored(found));
  for (const LineObject& each : either)
    for (const double to : truth.x)
      for (const double from : each.x) {
        const ImageScore at = score_at(truth, each, to - from, resolution);
        if (at.found > best.found || (at.found == best.found && at.correlation > best.correlation))
          best = at;
      }
  return best;
}

}  // namespace flatspeckle::mc
