#pragma once

#include <string>

#include "apps/command_line.h"
#include "grin/media/scattering_medium.h"

namespace flatspeckle::apps {

/// A medium in space as the user writes it.
struct MediumSpec {
  double mu_s = 0, mu_a = 0, g = 0;
  std::string phase = "isotropic", density;
};

/// prefix: of the keys, "" or "body_"; of: what the medium fills, in words.
void add_space_medium_options(Options& options, MediumSpec& spec, const std::string& prefix,
                              const std::string& of);

/// Throws InputError, also for keys that the medium has no use for.
grin::ScatteringMedium make_space_medium(const Subcommand& command, const MediumSpec& spec,
                                         const std::string& prefix);

/// Whether any of its keys was given.
std::string first_medium_key(const Subcommand& command, const std::string& prefix);

}  // namespace flatspeckle::apps
