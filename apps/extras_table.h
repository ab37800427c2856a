#pragma once

#include <vector>

#include "flatland/scene/scene.h"
#include "mc/estimators/brownian.h"
#include "mc/estimators/gradient.h"

namespace flatspeckle::apps {

/// Derivatives of the entries, and of the range where it is not censored.
void print_gradient(const CovarianceRequest& request, const mc::GradientJob& job,
                    const mc::GradientEstimates& gradient);

/// The correlation after each delay.
void print_delays(const CovarianceRequest& request, const std::vector<double>& delays,
                  const Estimate& correlation);

}  // namespace flatspeckle::apps
