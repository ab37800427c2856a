#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/command_line.h"

namespace flatspeckle::apps {

/// The index field as the user writes it.
struct IndexFieldSpec {
  std::vector<std::string> kinds = {"homogeneous"};
  std::optional<double> index;
  double radius = 1, alpha = 1;
  std::vector<double> centre = {0, 0, 0}, slope = {0, 0, 0}, ramp_axis = {0, 0, 1};
  double index_low = 1, index_high = 1, ramp_width = 1;
  std::string blobs, grid;
  double amplitude = 0, sound_wavenumber = 0, sound_phase = 0, aperture = 0.5;
  std::int64_t sound_order = 0, emitters = 16;
  std::string focusing = "cone";
};

void add_index_field_options(Options& options, IndexFieldSpec& spec);

/// The kind that is a medium, not something added to one; "" if there is none. Throws InputError
/// for kinds that are unknown, there twice, or do not go together, and for keys that they have no
/// use for.
std::string medium_of(const Subcommand& command, const IndexFieldSpec& spec);

}  // namespace flatspeckle::apps
