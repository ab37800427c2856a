#include "mc/imaging/recovery/phase_retrieval.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/numbers/random.h"
#include "mc/imaging/recovery/line_spectrum.h"

namespace flatspeckle::mc {

namespace {

/// Returns the amplitudes of the object's spectrum: the square root of the spectrum of the
/// autocorrelation, which is first tapered smoothly to 0 at its last lags.
std::vector<double> amplitudes_of(const LineSpectrum& spectra,
                                  std::span<const double> autocorrelation) {
  const std::size_t lags = autocorrelation.size(), size = spectra.size();
  std::vector<double> line(size);
  for (std::size_t lag = 0; lag < lags; ++lag) {
    const double place = static_cast<double>(lag) / static_cast<double>(lags),
                 taper =
                     place < 0.9 ? 1 : std::pow(std::cos(5 * std::numbers::pi * (place - 0.9)), 2);
    line[lag] = line[(size - lag) % size] = taper * autocorrelation[lag];
  }
  std::vector<double> amplitudes;
  for (const Complex& power : spectra.of(line))
    amplitudes.push_back(std::sqrt(std::max(power.real(), 0.0)));
  return amplitudes;
}

/// Iterations of phase retrieval from one random start.
class Phases {
 public:
  Phases(const LineSpectrum& spectra, const std::vector<double>& amplitudes, std::size_t lags,
         const PhaseTask& task, std::uint64_t number)
      : spectra_(spectra), amplitudes_(amplitudes), lags_(lags), task_(task) {
    RandomStream random(task.seed, static_cast<std::uint64_t>(Stream::camera), number);
    object_.assign(spectra.size(), 0);
    for (std::size_t p = 0; p < lags; ++p) object_[p] = random.uniform();
    const double square =
        std::inner_product(amplitudes.begin(), amplitudes.end(), amplitudes.begin(), 0.0);
    all_ = square / static_cast<double>(spectra.size());
  }

  void run() {
    const std::int64_t hybrid = 3 * task_.iterations / 4;
    for (std::int64_t i = 0; i < task_.iterations; ++i) step(i < hybrid);
  }
  const std::vector<double>& residual() const { return residual_; }
  std::vector<double> picture() const {
    std::vector<double> picture(object_.begin(), object_.begin() + static_cast<long>(lags_));
    for (double& value : picture) value = std::max(value, 0.0);
    const double sum = std::reduce(picture.begin(), picture.end());
    if (sum > 0)
      for (double& value : picture) value /= sum;
    return picture;
  }

 private:
  /// Returns the object after the amplitudes of its spectrum have been replaced by the known ones.
  std::vector<double> with_amplitudes() const {
    auto spectrum = spectra_.of(object_);
    for (std::size_t m = 0; m < spectrum.size(); ++m) {
      const double own = std::abs(spectrum[m]);
      spectrum[m] = own > 0 ? spectrum[m] * (amplitudes_[m] / own) : amplitudes_[m];
    }
    return spectra_.line(std::move(spectrum));
  }
  void step(bool hybrid) {
    const auto estimate = with_amplitudes();
    const double largest = *std::max_element(estimate.begin(),
                                             estimate.begin() + static_cast<long>(lags_)),
                 least = hybrid ? 0 : task_.sparsity * largest;
    double squares = 0;
    for (std::size_t p = 0; p < estimate.size(); ++p) {
      const bool allowed = p < lags_ && estimate[p] >= least;
      if (!(p < lags_ && estimate[p] >= 0)) squares += estimate[p] * estimate[p];
      if (allowed)
        object_[p] = estimate[p];
      else
        object_[p] = hybrid ? object_[p] - task_.feedback * estimate[p] : 0;
    }
    residual_.push_back(all_ > 0 ? std::sqrt(squares / all_) : 0);
  }

  const LineSpectrum& spectra_;
  const std::vector<double>& amplitudes_;
  std::size_t lags_;
  PhaseTask task_;
  double all_ = 0;
  std::vector<double> object_, residual_;
};

}  // namespace

PhasedPicture retrieved_phases(std::span<const double> autocorrelation, const PhaseTask& task) {
  const std::size_t lags = autocorrelation.size();
  const LineSpectrum spectra(transform_size(2.0 * static_cast<double>(lags)));
  const auto amplitudes = amplitudes_of(spectra, autocorrelation);
  PhasedPicture best;
  for (std::int64_t start = 0; start < task.starts; ++start) {
    Phases phases(spectra, amplitudes, lags, task, static_cast<std::uint64_t>(start));
    phases.run();
    if (best.residual.empty() || phases.residual().back() < best.residual.back())
      best = {phases.picture(), phases.residual()};
  }
  return best;
}

double best_correlation(std::span<const double> truth, std::span<const double> picture) {
  const LineSpectrum spectra(transform_size(static_cast<double>(truth.size() + picture.size())));
  const auto a = spectra.of(truth), b = spectra.of(picture);
  double most = 0;
  for (const bool mirrored : {false, true}) {
    auto both = a;
    for (std::size_t m = 0; m < both.size(); ++m)
      both[m] = product(both[m], mirrored ? b[m] : std::conj(b[m]));
    const auto line = spectra.line(std::move(both));
    most = std::max(most, *std::max_element(line.begin(), line.end()));
  }
  const auto square = [](std::span<const double> x) {
    return std::inner_product(x.begin(), x.end(), x.begin(), 0.0);
  };
  const double squares = square(truth) * square(picture);
  return squares > 0 ? most / std::sqrt(squares) : 0;
}

}  // namespace flatspeckle::mc
