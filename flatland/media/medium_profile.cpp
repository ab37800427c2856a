#include "flatland/media/medium_profile.h"

namespace flatspeckle {

BulkMedium mean_medium(const std::vector<std::pair<const BulkMedium*, double>>& shares) {
  BulkMedium mean;
  double cosine = 0;
  for (const auto& [medium, share] : shares) {
    mean.has_scatterers = medium->has_scatterers;
    mean.mu_t += share * medium->mu_t;
    mean.mu_s += share * medium->mu_s;
    mean.density += share * medium->density;
    mean.packing_fraction += share * medium->packing_fraction;
    mean.k_shift += share * medium->k_shift;
    cosine += share * medium->mu_s * medium->g;
  }
  mean.albedo = mean.mu_t > 0 ? mean.mu_s / mean.mu_t : 0;
  mean.g = mean.mu_s > 0 ? cosine / mean.mu_s : 0;
  return mean;
}

}  // namespace flatspeckle
