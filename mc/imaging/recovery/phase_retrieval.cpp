#include "mc/imaging/recovery/phase_retrieval.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/numbers/fourier.h"
#include "core/numbers/random.h"
#include "core/run/parallel.h"

namespace flatspeckle::mc {

namespace {

/// Returns the transform in which an object of this size does not wrap around.
PlaneTransform transform_for(PictureSize size) {
  const auto padded = [](std::size_t n) {
    return n == 1 ? 1 : transform_size(2.0 * static_cast<double>(n));
  };
  return {padded(size.rows), padded(size.columns)};
}

double taper(long lag, std::size_t lags) {
  const double place = static_cast<double>(std::abs(lag)) / static_cast<double>(lags);
  return place < 0.9 ? 1 : std::pow(std::cos(5 * std::numbers::pi * (place - 0.9)), 2);
}

/// Returns the moduli of the object's spectrum: the root of the spectrum of the autocorrelation,
/// which is first tapered smoothly to 0 at its last lags.
std::vector<double> moduli_of(const PlaneTransform& transform,
                              std::span<const double> autocorrelation, PictureSize size) {
  const auto rows = static_cast<long>(size.rows), columns = static_cast<long>(size.columns),
             down = static_cast<long>(transform.rows()),
             across = static_cast<long>(transform.columns());
  std::vector<double> picture(transform.rows() * transform.columns());
  std::size_t from = 0;
  for (long y = 1 - rows; y < rows; ++y)
    for (long x = 1 - columns; x < columns; ++x)
      picture[static_cast<std::size_t>((y + down) % down * across + (x + across) % across)] =
          taper(y, size.rows) * taper(x, size.columns) * autocorrelation[from++];
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
                PictureSize size, const PhaseTask& task, std::uint64_t number)
      : transform_(transform),
        moduli_(moduli),
        size_(size),
        task_(task),
        object_(transform.rows() * transform.columns()),
        estimate_(object_.size()),
        spectrum_(transform.spectrum_size()) {
    RandomStream random(task.seed, static_cast<std::uint64_t>(Stream::camera), number);
    std::vector<double> picture(size.pixels());
    for (double& value : picture) value = random.uniform();
    begin(picture);
  }

  /// Begins with a picture.
  void begin(const std::vector<double>& picture) {
    for (std::size_t y = 0; y < size_.rows; ++y)
      for (std::size_t x = 0; x < size_.columns; ++x)
        object_[y * transform_.columns() + x] = picture[y * size_.columns + x];
  }

  /// hybrid: iterations of hybrid input-output, before those of error reduction.
  RetrievedPicture run(std::int64_t hybrid) {
    RetrievedPicture found;
    for (std::int64_t i = 0; i < task_.iterations; ++i) found.residual.push_back(step(i < hybrid));
    for (std::size_t y = 0; y < size_.rows; ++y)
      for (std::size_t x = 0; x < size_.columns; ++x)
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
    for (std::size_t y = 0; y < size_.rows; ++y)
      for (std::size_t x = 0; x < size_.columns; ++x)
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
        const bool inside = y < size_.rows && x < size_.columns;
        all += value * value;
        if (!(inside && value >= 0)) forbidden += value * value;
        object = inside && value >= least ? value : kept * object - feedback * value;
      }
    return all > 0 ? std::sqrt(forbidden / all) : 0;
  }

  const PlaneTransform& transform_;
  const std::vector<double>& moduli_;
  PictureSize size_;
  PhaseTask task_;
  std::vector<double> object_, estimate_;
  std::vector<Complex> spectrum_;
};

/// Returns the spectrum of a picture in the corner of a larger array of zeros.
std::vector<Complex> padded_spectrum(const PlaneTransform& transform,
                                     std::span<const double> picture, PictureSize size) {
  std::vector<double> padded(transform.rows() * transform.columns());
  for (std::size_t y = 0; y < size.rows; ++y)
    std::ranges::copy(picture.subspan(y * size.columns, size.columns),
                      padded.begin() + static_cast<long>(y * transform.columns()));
  std::vector<Complex> spectrum(transform.spectrum_size());
  transform.forward(padded.data(), spectrum.data());
  return spectrum;
}

double sum_of_squares(std::span<const double> x) {
  return std::inner_product(x.begin(), x.end(), x.begin(), 0.0);
}

}  // namespace

void add_keys(Keys& keys, PhaseTask& task) {
  keys.add("starts", task.starts,
           "Number of random starts of phase retrieval; the best result is used")
      .from(1, 10000)
      .only_of("phase retrieval");
  keys.add("phase_iterations", task.iterations,
           "Number of iterations of phase retrieval from each random start")
      .from(4, 100000)
      .only_of("phase retrieval");
  keys.add("sparsity", task.sparsity,
           "Error reduction sets values of the picture below this fraction of the largest value to "
           "0")
      .from(0, 1)
      .only_of("phase retrieval");
}

PhaseTask phase_task(const Keys& keys, const PhaseTask& values) {
  PhaseTask task;
  task.starts = keys.read(values.starts);
  task.iterations = keys.read(values.iterations);
  task.sparsity = keys.read(values.sparsity);
  return task;
}

RetrievedPicture retrieved_picture(std::span<const double> autocorrelation, PictureSize size,
                                   const PhaseTask& task) {
  const PlaneTransform transform = transform_for(size);
  const auto moduli = moduli_of(transform, autocorrelation, size);
  std::vector<RetrievedPicture> all(static_cast<std::size_t>(task.starts));
  parallel_for(all.size(), [&](std::size_t start) {
    all[start] = PictureSearch(transform, moduli, size, task, start).run(3 * task.iterations / 4);
  });
  std::ranges::stable_sort(all, {},
                           [](const RetrievedPicture& one) { return one.residual.back(); });
  RetrievedPicture best = all.front();
  const std::size_t better = all.size() / 2;
  if (better > 0) best.agreement = 0;
  for (std::size_t i = 1; i <= better; ++i)
    best.agreement += best_alignment(best.picture, all[i].picture, size).correlation /
                      static_cast<double>(better);
  return best;
}

RetrievedPicture refined_picture(std::span<const double> autocorrelation, PictureSize size,
                                 const PhaseTask& task, const std::vector<double>& start) {
  const PlaneTransform transform = transform_for(size);
  const auto moduli = moduli_of(transform, autocorrelation, size);
  PictureSearch search(transform, moduli, size, task, 0);
  search.begin(start);
  RetrievedPicture found = search.run(0);
  found.agreement = best_alignment(start, found.picture, size).correlation;
  return found;
}

RetrievedPicture retrieved_line(std::span<const double> autocorrelation, const PhaseTask& task) {
  std::vector<double> both(autocorrelation.rbegin(), autocorrelation.rend());
  both.insert(both.end(), autocorrelation.begin() + 1, autocorrelation.end());
  return retrieved_picture(both, {1, autocorrelation.size()}, task);
}

Alignment best_alignment(std::span<const double> a, std::span<const double> b, PictureSize size) {
  const PlaneTransform transform = transform_for(size);
  const auto first = padded_spectrum(transform, a, size),
             second = padded_spectrum(transform, b, size);
  const auto down = static_cast<long>(transform.rows()),
             across = static_cast<long>(transform.columns());
  std::vector<double> products(transform.rows() * transform.columns());
  Alignment best;
  for (const bool rotated : {false, true}) {
    auto both = first;
    for (std::size_t m = 0; m < both.size(); ++m)
      both[m] = product(both[m], rotated ? second[m] : std::conj(second[m]));
    transform.backward(both.data(), products.data());
    const auto most = std::ranges::max_element(products);
    const double value = *most / static_cast<double>(products.size());
    if (!(value > best.correlation)) continue;
    const long at = most - products.begin();
    // The rotation maps the pixel (0, 0) to the last one
    const long y = at / across - (rotated ? static_cast<long>(size.rows) - 1 : 0),
               x = at % across - (rotated ? static_cast<long>(size.columns) - 1 : 0);
    const auto wrapped = [](long offset, long pixels, std::size_t limit) {
      return offset >= static_cast<long>(limit) ? offset - pixels : offset;
    };
    best = {value, rotated, wrapped(y, down, size.rows), wrapped(x, across, size.columns)};
  }
  const double squares = sum_of_squares(a) * sum_of_squares(b);
  best.correlation = squares > 0 ? best.correlation / std::sqrt(squares) : 0;
  return best;
}

std::vector<double> Alignment::applied(std::span<const double> b, PictureSize size) const {
  const auto rows = static_cast<long>(size.rows), columns = static_cast<long>(size.columns);
  std::vector<double> picture(size.pixels());
  for (long row = 0; row < rows; ++row)
    for (long column = 0; column < columns; ++column) {
      long from_y = row - y, from_x = column - x;
      if (rotated) from_y = rows - 1 - from_y, from_x = columns - 1 - from_x;
      if (from_y >= 0 && from_y < rows && from_x >= 0 && from_x < columns)
        picture[static_cast<std::size_t>(row * columns + column)] =
            b[static_cast<std::size_t>(from_y * columns + from_x)];
    }
  return picture;
}

}  // namespace flatspeckle::mc
