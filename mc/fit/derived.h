#pragma once

#include <vector>

#include "mc/fit/task/curve_values.h"

namespace flatspeckle::mc {

/// What describes a medium besides its keys.
struct DerivedRow {
  const char *name, *unit;
  double (*value)(const Medium&);
  bool of_motion = false;
};

inline const std::vector<DerivedRow> derived_rows = {
    {"reduced_scattering", "1/length",
     [](const Medium& of) { return of.scene.medium.mu_s * (1 - of.scene.medium.g); }},
    {"mu_t", "1/length", [](const Medium& of) { return of.scene.medium.mu_t; }},
    {"mu_s", "1/length", [](const Medium& of) { return of.scene.medium.mu_s; }},
    {"mu_a", "1/length",
     [](const Medium& of) { return of.scene.medium.mu_t - of.scene.medium.mu_s; }},
    {"g", "1", [](const Medium& of) { return of.scene.medium.g; }},
    {"albedo", "1", [](const Medium& of) { return of.scene.medium.albedo; }},
    {"transport_mean_free_path", "length",
     [](const Medium& of) { return of.scene.medium.transport_mean_free_path(); }},
    {"diffusion_constant", "length^2 per unit of the delays",
     [](const Medium& of) { return of.spec.diffusion / (of.scene.k * of.scene.k); }, true}};

}  // namespace flatspeckle::mc
