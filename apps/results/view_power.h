#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/result/dataset_row.h"
#include "core/result/invariant.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::apps {

// The power that a medium scatters is the integral of its intensities over all directions, and also
// what neither passes unscattered nor is absorbed. Both sides are computed apart from the result:
// of the first light, as a plane wave, without reversed paths, which only redistribute power.
// Returned is their relative difference; nullopt for media to which this does not apply.

/// By light paths, in groups with far views of their own, whose spread gives the error. samples: in
/// all groups together; nullopt where they do not suffice for a batch in each.
std::optional<Invariant> paths_power(const Scene& scene, double samples, std::uint64_t seed);

/// By transport through a slab. The limit contains the errors of both solutions and of the
/// quadrature over views. In space and through layers it is the balance of the shares of light
/// instead (mc::power_balance).
std::optional<Invariant> transport_power(const Scene& slab, double tolerance);

/// How a result was made, as far as its check depends on it.
struct DoneWork {
  std::string method;    ///< mc or transport; nothing is checked by the exact solver's fields
  double samples = 0;    ///< light paths, of which the check takes some percent as many
  double tolerance = 0;  ///< of transport
  std::uint64_t seed = 0;
};
std::optional<Invariant> view_power(const Scene& scene, const DoneWork& work);
/// Returns the worst balance of what scatterers along light paths receive and what light loses
/// (mc::PathPower); nullopt for methods without paths.
std::optional<Invariant> received_power(const Scene& scene, const DoneWork& work);

extern const DatasetTable power_table;
/// Checks a result of this scene by view_power(), where it applies. group: of its method, or empty.
void check_power(ResultFile& file, const std::string& group, const Scene& scene,
                 const DoneWork& work);

}  // namespace flatspeckle::apps
