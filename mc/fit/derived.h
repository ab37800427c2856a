#pragma once

#include <vector>

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// What describes a medium besides its keys.
struct DerivedRow {
  const char *name, *unit;
  double (*value)(const Scene&);
};

inline const std::vector<DerivedRow> derived_rows = {
    {"reduced_scattering", "1/length",
     [](const Scene& scene) { return scene.medium.mu_s * (1 - scene.medium.g); }},
    {"mu_t", "1/length", [](const Scene& scene) { return scene.medium.mu_t; }},
    {"mu_s", "1/length", [](const Scene& scene) { return scene.medium.mu_s; }},
    {"mu_a", "1/length", [](const Scene& scene) { return scene.medium.mu_t - scene.medium.mu_s; }},
    {"g", "1", [](const Scene& scene) { return scene.medium.g; }},
    {"albedo", "1", [](const Scene& scene) { return scene.medium.albedo; }},
    {"transport_mean_free_path", "length",
     [](const Scene& scene) { return scene.medium.transport_mean_free_path(); }}};

}  // namespace flatspeckle::mc
