#include "mc/imaging/retrieval/picture_retrieval.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/numbers/fourier.h"
#include "core/numbers/random.h"
#include "core/run/parallel.h"

namespace flatspeckle::mc {

namespace {

double taper(long lag, std::size_t lags) {
  const double place = static_cast<double>(std::abs(lag)) / static_cast<double>(lags);
  return place < 0.9 ? 1 : std::pow(std::cos(5 * std::numbers::pi * (place - 0.9)), 2);
}

/// Returns the moduli of the object's spectrum: the root of the spectrum of the autocorrelation,
/// which is first tapered smoothly to 0 at its last lags.
std::vector<double> moduli_of(const PlaneTransform& transform,
                              std::span<const double> autocorrelation, std::size_t lags) {
  const auto side = static_cast<long>(2 * lags - 1), size = static_cast<long>(transform.rows());
  std::vector<double> picture(transform.rows() * transform.columns());
  for (long row = 0; row < side; ++row)
    for (long column = 0; column < side; ++column) {
      const long y = row - static_cast<long>(lags - 1), x = column - static_cast<long>(lags - 1);
      picture[static_cast<std::size_t>((y + size) % size * size + (x + size) % size)] =
          taper(y, lags) * taper(x, lags) *
          autocorrelation[static_cast<std::size_t>(row * side + column)];
    }
  std::vector<Complex> spectrum(transform.spectrum_size());
  transform.forward(picture.data(), spectrum.data());
  std::vector<double> moduli;
  for (const Complex& power : spectrum) moduli.push_back(std::sqrt(std::max(power.real(), 0.0)));
  return moduli;
}

/// Iterations of phase retrieval from one random start.
class PictureSearch {
 public:
  PictureSearch(const PlaneTransform& transform, const std::vector<double>& moduli,
                std::size_t lags, const PhaseTask& task, std::uint64_t number)
      : transform_(transform),
        moduli_(moduli),
        lags_(lags),
        task_(task),
        object_(transform.rows() * transform.columns()),
        estimate_(object_.size()),
        spectrum_(transform.spectrum_size()) {
    RandomStream random(task.seed, static_cast<std::uint64_t>(Stream::camera), number);
    for (std::size_t y = 0; y < lags; ++y)
      for (std::size_t x = 0; x < lags; ++x)
        object_[y * transform.columns() + x] = random.uniform();
  }

  RetrievedPicture run() {
    RetrievedPicture found;
    const std::int64_t hybrid = 3 * task_.iterations / 4;
    for (std::int64_t i = 0; i < task_.iterations; ++i) found.residual.push_back(step(i < hybrid));
    for (std::size_t y = 0; y < lags_; ++y)
      for (std::size_t x = 0; x < lags_; ++x)
        found.picture.push_back(std::max(0.0, object_[y * transform_.columns() + x]));
    const double sum = std::reduce(found.picture.begin(), found.picture.end());
    if (sum > 0)
      for (double& value : found.picture) value /= sum;
    return found;
  }

 private:
  /// Replaces the moduli of the object's spectrum by the known ones.
  void estimate() {
    transform_.forward(object_.data(), spectrum_.data());
    const double per_value = 1 / static_cast<double>(object_.size());
    for (std::size_t m = 0; m < spectrum_.size(); ++m) {
      const double square = std::norm(spectrum_[m]), known = per_value * moduli_[m];
      spectrum_[m] = square > 0 ? known / std::sqrt(square) * spectrum_[m] : Complex(known);
    }
    transform_.backward(spectrum_.data(), estimate_.data());
  }

  double largest_inside() const {
    double largest = 0;
    for (std::size_t y = 0; y < lags_; ++y)
      for (std::size_t x = 0; x < lags_; ++x)
        largest = std::max(largest, estimate_[y * transform_.columns() + x]);
    return largest;
  }

  double step(bool hybrid) {
    estimate();
    const double least = hybrid ? 0 : task_.sparsity * largest_inside(),
                 feedback = hybrid ? task_.feedback : 0, kept = hybrid ? 1 : 0;
    double forbidden = 0, all = 0;
    const std::size_t columns = transform_.columns();
    for (std::size_t y = 0; y < transform_.rows(); ++y)
      for (std::size_t x = 0; x < columns; ++x) {
        const double value = estimate_[y * columns + x];
        double& object = object_[y * columns + x];
        const bool inside = y < lags_ && x < lags_;
        all += value * value;
        if (!(inside && value >= 0)) forbidden += value * value;
        object = inside && value >= least ? value : kept * object - feedback * value;
      }
    return all > 0 ? std::sqrt(forbidden / all) : 0;
  }

  const PlaneTransform& transform_;
  const std::vector<double>& moduli_;
  std::size_t lags_;
  PhaseTask task_;
  std::vector<double> object_, estimate_;
  std::vector<Complex> spectrum_;
};

}  // namespace

double best_correlation(std::span<const double> a, std::span<const double> b, std::size_t side) {
  const std::size_t size = transform_size(2.0 * static_cast<double>(side));
  const PlaneTransform transform(size, size);
  std::vector<double> padded(size * size);
  const auto spectrum_of = [&](std::span<const double> picture) {
    std::ranges::fill(padded, 0);
    for (std::size_t y = 0; y < side; ++y)
      std::ranges::copy(picture.subspan(y * side, side),
                        padded.begin() + static_cast<long>(y * size));
    std::vector<Complex> spectrum(transform.spectrum_size());
    transform.forward(padded.data(), spectrum.data());
    return spectrum;
  };
  const auto first = spectrum_of(a), second = spectrum_of(b);
  double most = 0;
  for (const bool rotated : {false, true}) {
    auto both = first;
    for (std::size_t m = 0; m < both.size(); ++m)
      both[m] = product(both[m], rotated ? second[m] : std::conj(second[m]));
    transform.backward(both.data(), padded.data());
    most = std::max(most, *std::ranges::max_element(padded) / static_cast<double>(padded.size()));
  }
  const auto square = [](std::span<const double> x) {
    return std::inner_product(x.begin(), x.end(), x.begin(), 0.0);
  };
  const double squares = square(a) * square(b);
  return squares > 0 ? most / std::sqrt(squares) : 0;
}

RetrievedPicture retrieved_picture(std::span<const double> autocorrelation, std::size_t lags,
                                   const PhaseTask& task) {
  const std::size_t size = transform_size(2.0 * static_cast<double>(lags));
  const PlaneTransform transform(size, size);
  const auto moduli = moduli_of(transform, autocorrelation, lags);
  std::vector<RetrievedPicture> all(static_cast<std::size_t>(task.starts));
  parallel_for(all.size(), [&](std::size_t start) {
    all[start] = PictureSearch(transform, moduli, lags, task, start).run();
  });
  std::ranges::stable_sort(all, {},
                           [](const RetrievedPicture& one) { return one.residual.back(); });
  RetrievedPicture best = all.front();
  const std::size_t better = all.size() / 2;
  if (better > 0) best.agreement = 0;
  for (std::size_t i = 1; i <= better; ++i)
    best.agreement +=
        best_correlation(best.picture, all[i].picture, lags) / static_cast<double>(better);
  return best;
}

}  // namespace flatspeckle::mc
