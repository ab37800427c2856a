#include "mc/imaging/retrieval/bispectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numbers/fourier.h"

namespace flatspeckle::mc {

namespace {

/// Frequency in cycles per window.
struct Frequency {
  long y = 0, x = 0;
  long square() const { return y * y + x * x; }
};

/// Windows of frames, and their spectra.
class Windows {
 public:
  Windows(const Frames& frames, std::size_t lags)
      : side_(std::min({transform_size(4.0 * static_cast<double>(lags)), even(frames.rows),
                        even(frames.columns)})),
        transform_(side_, side_),
        spectrum_(transform_.spectrum_size()) {
    for (std::size_t p = 0; p < side_; ++p)
      taper_.push_back(std::pow(
          std::sin(std::numbers::pi * (static_cast<double>(p) + 0.5) / static_cast<double>(side_)),
          2));
  }
  std::size_t side() const { return side_; }
  const PlaneTransform& transform() const { return transform_; }

  /// Calls f() for the spectrum of each window of a picture; windows overlap by a half.
  template <typename F>
  void each(const std::vector<double>& picture, std::size_t rows, std::size_t columns, const F& f) {
    std::vector<double> window(side_ * side_);
    for (std::size_t top = 0; top + side_ <= rows; top += side_ / 2)
      for (std::size_t left = 0; left + side_ <= columns; left += side_ / 2) {
        for (std::size_t y = 0; y < side_; ++y)
          for (std::size_t x = 0; x < side_; ++x)
            window[y * side_ + x] = taper_[y] * taper_[x] * picture[(top + y) * columns + left + x];
        transform_.forward(window.data(), spectrum_.data());
        f();
      }
  }
  Complex at(Frequency f) const { return conjugate_at(spectrum_, f); }

  /// Returns a value of the spectrum of real numbers, whose half is stored.
  Complex conjugate_at(const std::vector<Complex>& spectrum, Frequency f) const {
    const auto side = static_cast<long>(side_);
    const bool stored = f.x >= 0;
    const long y = ((stored ? f.y : -f.y) + side) % side, x = stored ? f.x : -f.x;
    const Complex value = spectrum[static_cast<std::size_t>(y) * transform_.spectrum_columns() +
                                   static_cast<std::size_t>(x)];
    return stored ? value : std::conj(value);
  }

 private:
  static std::size_t even(std::size_t n) { return n - n % 2; }

  std::size_t side_;
  PlaneTransform transform_;
  std::vector<double> taper_;
  std::vector<Complex> spectrum_;
};

/// Returns all frequencies of at most `reach`, in the order of their modulus.
std::vector<Frequency> frequencies(long reach) {
  std::vector<Frequency> list;
  for (long y = -reach; y <= reach; ++y)
    for (long x = -reach; x <= reach; ++x)
      if (y * y + x * x <= reach * reach) list.push_back({y, x});
  std::ranges::stable_sort(list, {}, &Frequency::square);
  return list;
}

/// Mean power and bispectrum of windows.
class Bispectrum {
 public:
  /// reach: largest frequency of the object, in cycles per window.
  Bispectrum(const Windows& windows, long reach)
      : windows_(windows),
        targets_(frequencies(reach)),
        bases_(frequencies(std::min(reach, largest_base))),
        values_(targets_.size() * bases_.size()),
        power_(targets_.size()) {}

  void add() {
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      const Complex whole = std::conj(windows_.at(targets_[t]));
      power_[t] += std::norm(whole);
      for (std::size_t b = 0; b < bases_.size(); ++b)
        if (const Frequency rest = difference(t, b); rest.square() < targets_[t].square())
          values_[t * bases_.size() + b] +=
              product(whole, product(windows_.at(rest), windows_.at(bases_[b])));
    }
  }

  /// Returns the spectrum of the object, at the frequencies of PlaneTransform. The power of noise
  /// is that at the highest frequencies.
  std::vector<Complex> spectrum() const {
    const PlaneTransform& transform = windows_.transform();
    std::vector<Complex> phase(transform.spectrum_size()), found(phase.size());
    double floor = power_.back();
    for (std::size_t t = power_.size() * 9 / 10; t < power_.size(); ++t)
      floor = std::min(floor, power_[t]);
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      const Frequency f = targets_[t];
      Complex sum = f.square() <= 1 ? 1 : 0;  // the choice of two phases is that of the position
      for (std::size_t b = 0; f.square() > 1 && b < bases_.size(); ++b)
        if (const Frequency rest = difference(t, b); rest.square() < f.square() &&
                                                     bases_[b].square() < f.square() &&
                                                     bases_[b].square() > 0 && rest.square() > 0)
          sum += product(
              std::conj(values_[t * bases_.size() + b]),
              product(windows_.conjugate_at(phase, rest), windows_.conjugate_at(phase, bases_[b])));
      const double modulus = std::abs(sum);
      if (modulus == 0 || f.x < 0) continue;
      const std::size_t at = index(f);
      phase[at] = sum / modulus;
      found[at] = std::sqrt(std::max(0.0, power_[t] - floor)) * phase[at];
      // In the first column both signs of y are stored
      if (f.x == 0) phase[index({-f.y, 0})] = std::conj(phase[at]);
    }
    return found;
  }

 private:
  static constexpr long largest_base = 6;

  Frequency difference(std::size_t t, std::size_t b) const {
    return {targets_[t].y - bases_[b].y, targets_[t].x - bases_[b].x};
  }
  std::size_t index(Frequency f) const {
    const auto side = static_cast<long>(windows_.side());
    return static_cast<std::size_t>((f.y + side) % side) * windows_.transform().spectrum_columns() +
           static_cast<std::size_t>(f.x);
  }

  const Windows& windows_;
  std::vector<Frequency> targets_, bases_;
  std::vector<Complex> values_;  ///< [target][base]
  std::vector<double> power_;
};

/// Returns the square of `lags` x `lags` pixels of a periodic picture with the largest sum of
/// positive values.
std::vector<double> brightest_square(const std::vector<double>& picture, std::size_t side,
                                     std::size_t lags) {
  const auto value = [&](std::size_t y, std::size_t x) {
    return std::max(0.0, picture[y % side * side + x % side]);
  };
  double most = -1;
  std::vector<double> best;
  for (std::size_t top = 0; top < side; top += 2)
    for (std::size_t left = 0; left < side; left += 2) {
      double sum = 0;
      for (std::size_t y = 0; y < lags; y += 2)
        for (std::size_t x = 0; x < lags; x += 2) sum += value(top + y, left + x);
      if (sum <= most) continue;
      most = sum;
      best.clear();
      for (std::size_t y = 0; y < lags; ++y)
        for (std::size_t x = 0; x < lags; ++x) best.push_back(value(top + y, left + x));
    }
  return best;
}

}  // namespace

std::vector<double> bispectrum_picture(const Frames& frames, std::size_t first, std::size_t count,
                                       std::size_t lags) {
  Windows windows(frames, lags);
  const double width = picture_envelope_width(std::min(frames.rows, frames.columns), lags);
  // Grains of at least two and a half pixels have no power at higher frequencies
  const auto reach = static_cast<long>(0.4 * static_cast<double>(windows.side()));
  Bispectrum bispectrum(windows, std::min(reach, static_cast<long>(lags)));
  for (std::size_t number = first; number < first + count; ++number)
    windows.each(picture_without_envelope(frames.frame(number), frames.rows, frames.columns, width),
                 frames.rows, frames.columns, [&] { bispectrum.add(); });
  auto spectrum = bispectrum.spectrum();
  std::vector<double> picture(windows.side() * windows.side());
  windows.transform().backward(spectrum.data(), picture.data());
  return brightest_square(picture, windows.side(), lags);
}

RetrievedPicture oriented_picture(const Frames& frames, std::size_t first, std::size_t count,
                                  const PictureStatistics& statistics, std::size_t lags,
                                  const PhaseTask& task) {
  return refined_picture(statistics.autocorrelation, {lags, lags}, task,
                         bispectrum_picture(frames, first, count, lags));
}

}  // namespace flatspeckle::mc
