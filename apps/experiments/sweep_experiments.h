#pragma once

#include <memory>
#include <string>

#include "apps/sweep/sweep.h"

namespace flatspeckle::apps {

/// What the arguments, or the scene file that they name, say is to be swept; empty: memory-effect
/// curves.
std::string swept_subcommand(const Arguments& arguments);

/// A sweep of this subcommand's results, or, where it is empty, of memory-effect curves. Throws
/// InputError for the name of what cannot be swept.
std::unique_ptr<Sweep> make_sweep(const std::string& of);
/// The same, of what a resolved configuration says.
std::unique_ptr<Sweep> sweep_of_config(const std::string& config);

}  // namespace flatspeckle::apps
