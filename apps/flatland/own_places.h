#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/results/estimation.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

/// Adds the key `placement`: a rule by which scatterers are placed at random, or the name of a
/// table with their positions.
void add_places_key(Keys& keys, SceneSpec& spec);
/// Whether `placement` names a table of positions.
bool has_own_places(const SceneSpec& spec);

/// Compares the exact solution of one placement given by the user with Monte Carlo. The placement
/// gives one speckle pattern, whereas Monte Carlo gives intensities averaged over placements. For a
/// circular Gaussian field, the ratios of the intensities of the pattern to these averages have
/// mean 1 and contrast 1. The errors of mean and contrast follow from the number of independent
/// speckle grains in the views.
class OwnPlaces {
 public:
  /// Reads the table of positions, and makes the scene for Monte Carlo with the same number of
  /// scatterers. Throws InputError.
  OwnPlaces(const Keys& keys, SceneSpec& spec, const MethodSettings& methods);
  /// Computes, prints and writes the comparison. Returns the exit status.
  int compare(Session& session, mc::ReversedPaths reversed, const StopRule& stop) const;

 private:
  int compare(Session& session, mc::ReversedPaths reversed, const StopRule& stop,
              const std::string& method, const std::vector<Complex>& fields,
              const std::function<void(ResultFile&)>& write_solution) const;

  Placement placement_;
  Scene scene_;
  double tolerance_;
};

}  // namespace flatspeckle::apps
