#pragma once

#include "apps/command_line.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::apps {

/// Keys of one scatterer and of what is recorded.
void add_scatterer_options(Options& options, SceneSpec& spec);
void add_view_options(Options& options, SceneSpec& spec);
/// Keys of the medium.
void add_medium_options(Options& options, SceneSpec& spec);
/// The structure factor that Monte Carlo takes positions to have.
void add_structure_option(Options& options, SceneSpec& spec);
/// g, albedo and optical_depth, where a subcommand takes one value of each.
void add_bulk_options(Options& options, SceneSpec& spec);
/// Near sources and beams.
void add_light_options(Options& options, SceneSpec& spec);
/// Which entries of the covariance.
void add_request_options(Options& options, SceneSpec& spec);

/// Near sensors take the place of the default far view.
void settle_views(const Subcommand& subcommand, SceneSpec& spec);
/// For a covariance, whose views are all near or all far; pairs name their angles themselves.
void settle_request(const Subcommand& subcommand, SceneSpec& spec);

/// The near sensors and sources that were read, exactly.
std::string sensors_text(const CovarianceRequest& request);
/// Those and the structure factor: all that a scene takes from other files.
std::string inputs_text(const Scene& scene);

}  // namespace flatspeckle::apps
