#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "flatland/scene/scene.h"

namespace flatspeckle {

/// Entries of which the second field may be another one: all, or of a request with a reference
/// those of reference and moved field.
std::size_t changing_entries(const CovarianceRequest& request);

/// The second view of an entry, turned so that transverse momenta match where the wavenumber of the
/// second field is larger by a share `shift` (conventions, C39); nan past the horizon.
double matched_view(const CovarianceRequest& request, const Entry& entry, double shift);
/// The same by the angles of both lights and views.
double matched_view(double light1, double view1, double light2, double view2, double shift);

/// The scene at k (1 + shift), with a channel for the second field of each changing entry, in their
/// order: its light in the matched view. The medium stays that of k.
Scene at_frequency(const Scene& scene, double shift);

/// Throws InputError for requests whose entries do not change (those of other kinds than intensity
/// and memory_effect).
void require_changing(const std::string& key, const CovarianceRequest& request);

/// Throws InputError for near lights and views, for requests whose entries do not change, for
/// shifts that are not small, and for matched views past the horizon.
void check_frequency_shifts(const CovarianceRequest& request, const std::vector<double>& shifts);

}  // namespace flatspeckle
