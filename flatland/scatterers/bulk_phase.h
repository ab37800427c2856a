#pragma once

#include <functional>
#include <string>

namespace flatspeckle {

/// A phase function of the bulk, even in the scattering angle (conventions, C5).
struct BulkPhase {
  /// Per radian, of theta in [0, pi]. Empty: the scatterer says what it is.
  std::function<double(double theta)> density;
  double g = 0;      ///< mean cosine
  std::string text;  ///< of a table: every number, which tells one from another
};

}  // namespace flatspeckle
