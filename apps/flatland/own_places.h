#pragma once

#include "apps/results/estimation.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

/// `placement` where it may also be a table of the user's places.
void add_places_key(Keys& keys, SceneSpec& spec);
/// Whether it is.
bool has_own_places(const SceneSpec& spec);

/// One placement of the user's, solved exactly, against Monte Carlo. It makes one speckle pattern:
/// its intensities are not those of Monte Carlo, which are means over placements; but over these
/// they have the mean 1 and the contrast 1 of a circular Gaussian field. What is known of both is
/// told by the number of independent grains among the views.
class OwnPlaces {
 public:
  /// Reads the table and makes the scene of as many scatterers. Throws InputError.
  OwnPlaces(const Keys& keys, SceneSpec& spec, const MethodSettings& methods);
  /// Returns the exit status.
  int compare(Session& session, mc::ReversedPaths reversed, const StopRule& stop) const;

 private:
  Placement placement_;
  Scene scene_;
  double tolerance_;
};

}  // namespace flatspeckle::apps
