#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "flatland/scene/scene.h"

namespace flatspeckle {

/// Returns the number of entries whose second field can be replaced by the field at another
/// frequency or time. These entries come first in the request. They are all entries or, if the
/// request has a reference field, those that combine the reference with a moved field.
std::size_t changing_entries(const CovarianceRequest& request);

/// Returns the angle to which the second view of an entry must turn so that the transverse momenta
/// of both fields match although the second field has the wavenumber (1 + shift) k (conventions,
/// C39). Returns nan if that direction is past the horizon.
double matched_view(const CovarianceRequest& request, const Entry& entry, double shift);
/// Computes the same angle from the angles of both lights and both views.
double matched_view(double light1, double view1, double light2, double view2, double shift);

/// Returns the scene at the wavenumber k (1 + shift). Its channel e, for e below
/// changing_entries(), is the second field of entry e: the second light of that entry in its
/// matched view. The medium keeps the properties that it has at k.
Scene at_frequency(const Scene& scene, double shift);

/// Throws InputError unless the kind of the request is intensity or memory_effect. Only for these
/// kinds can the second field of an entry be taken at another frequency or time.
void require_changing(const std::string& key, const CovarianceRequest& request);

/// Throws InputError for near sources, beams and near sensors, for requests that require_changing()
/// rejects, if |shift| exceeds 0.1, and if a matched view is past the horizon.
void check_frequency_shifts(const CovarianceRequest& request, const std::vector<double>& shifts);

}  // namespace flatspeckle
