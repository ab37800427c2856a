#include "grin/media/scattering/case_modes.h"

#include "grin/media/scattering/diffusion_rate.h"

namespace flatspeckle::grin {

namespace {

/// Legendre series of (1 - kappa mu) psi(mu) of a growing mode.
class ModeSeries {
 public:
  ModeSeries(double albedo, double g, double kappa) {
    constexpr int most = 1000;
    constexpr double negligible = 1e-14;
    std::vector<double> ratio(most + 2);  // psi_l / psi_(l-1), by downward recurrence
    for (int l = most; l >= 1; --l)
      ratio[l] = kappa * l /
                 ((2 * l + 1) * (1 - albedo * std::pow(g, l)) - kappa * (l + 1) * ratio[l + 1]);
    double moment = 1, before = 1;
    for (int l = 0; l <= most; ++l) {
      if (l > 0) moment *= ratio[l] * g;
      terms_.push_back((2 * l + 1) * moment);
      // one term alone may vanish by chance
      if (std::abs(terms_.back()) + before < negligible) break;
      before = std::abs(terms_.back());
    }
  }

  /// Values of the even and of the odd terms, summed separately.
  struct Parts {
    double even, odd;
  };
  Parts at(double mu) const {
    Parts sum{terms_[0], 0};
    double before = 1, here = mu;
    for (std::size_t l = 1; l < terms_.size(); ++l) {
      (l % 2 == 0 ? sum.even : sum.odd) += terms_[l] * here;
      const double order = static_cast<double>(l);
      const double next = mu * here + order / (order + 1) * (mu * here - before);
      before = here;
      here = next;
    }
    return sum;
  }

 private:
  std::vector<double> terms_;
};

}  // namespace

CaseModes::CaseModes(double albedo, double g, int pairs, double highest)
    : g_(g), transport_length_(0), rates_(discrete_rates(albedo, g, 3, pairs, highest)) {
  for (std::size_t i = 0; i < rates_.size(); ++i) {
    const auto growing = static_cast<Eigen::Index>(i), decaying = growing + most_pairs;
    signed_rates_[growing] = rates_[i];
    signed_rates_[decaying] = -rates_[i];
    exists_[growing] = 1;
    exists_[decaying] = rates_[i] > 0 ? 1 : 0;
  }
  if (!(rates_[0] > 0)) transport_length_ = 1 / (1 - g);
  tabulate(albedo);
}

/// Tabulates the cubics through four values of each mode in each interval.
void CaseModes::tabulate(double albedo) {
  constexpr int intervals = 256;
  cubics_.assign(intervals, {Values::Zero(), Values::Zero(), Values::Zero(), Values::Zero()});
  for (std::size_t mode = 0; mode < rates_.size(); ++mode) {
    const ModeSeries series(albedo, g_, rates_[mode]);
    for (int i = 0; i < intervals; ++i) {
      Eigen::Array2d f[4];
      for (int k = 0; k < 4; ++k) {
        const auto [even, odd] = series.at((i + k / 3.0) / intervals);
        f[k] = {even, odd};
      }
      const Eigen::Array2d first = f[1] - f[0], second = f[2] - 2 * f[1] + f[0],
                           third = f[3] - 3 * f[2] + 3 * f[1] - f[0];
      const Eigen::Array2d cubic[] = {f[0], 3 * (first - second / 2 + third / 3),
                                      4.5 * (second - third), 4.5 * third};
      for (int power = 0; power < 4; ++power)
        for (const int part : {0, 1})
          cubics_[i][power][static_cast<Eigen::Index>(mode) + part * most_pairs] =
              cubic[power][part];
    }
  }
}

}  // namespace flatspeckle::grin
