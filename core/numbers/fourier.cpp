#include "core/numbers/fourier.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fftw3.h>

namespace flatspeckle {

namespace {

fftw_complex* native(Complex* values) {
  return reinterpret_cast<fftw_complex*>(values);
}

}  // namespace

std::mutex& fourier_planning() {
  static std::mutex mutex;
  return mutex;
}

struct LineTransform::Plan {
  explicit Plan(fftw_plan made) : plan(made) {}
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;
  ~Plan() {
    const std::lock_guard lock(fourier_planning());
    fftw_destroy_plan(plan);
  }
  fftw_plan plan;
};

// The plan is made for this line and used for others; FFTW requires that they have the same
// alignment. All of them begin at multiples of 16 bytes.
LineTransform::LineTransform(std::size_t size, Direction direction) {
  std::vector<Complex> line(size);
  const std::lock_guard lock(fourier_planning());
  plan_ = std::make_shared<Plan>(fftw_plan_dft_1d(
      static_cast<int>(size), native(line.data()), native(line.data()),
      direction == Direction::forward ? FFTW_FORWARD : FFTW_BACKWARD, FFTW_ESTIMATE));
}

void LineTransform::operator()(Complex* line) const {
  fftw_execute_dft(plan_->plan, native(line), native(line));
}

struct PlaneTransform::Plans {
  fftw_plan forward = nullptr, backward = nullptr;

  Plans(int rows, int columns, double* picture, Complex* spectrum) {
    const std::lock_guard lock(fourier_planning());
    // Preserves the picture: forward() may not change it.
    forward = fftw_plan_dft_r2c_2d(rows, columns, picture, native(spectrum),
                                   FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
    backward = fftw_plan_dft_c2r_2d(rows, columns, native(spectrum), picture, FFTW_ESTIMATE);
  }
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;
  ~Plans() {
    const std::lock_guard lock(fourier_planning());
    fftw_destroy_plan(forward);
    fftw_destroy_plan(backward);
  }
};

PlaneTransform::PlaneTransform(std::size_t rows, std::size_t columns)
    : rows_(rows), columns_(columns) {
  std::vector<double> picture(rows * columns);
  std::vector<Complex> spectrum(spectrum_size());
  plans_ = std::make_shared<const Plans>(static_cast<int>(rows), static_cast<int>(columns),
                                         picture.data(), spectrum.data());
}

void PlaneTransform::forward(const double* picture, Complex* spectrum) const {
  fftw_execute_dft_r2c(plans_->forward, const_cast<double*>(picture), native(spectrum));
}

void PlaneTransform::backward(Complex* spectrum, double* picture) const {
  fftw_execute_dft_c2r(plans_->backward, native(spectrum), picture);
}

void transform_even(std::vector<Complex>& values, const std::vector<std::size_t>& sizes) {
  std::vector<int> halves;
  for (const std::size_t size : sizes) halves.push_back(static_cast<int>(size / 2 + 1));
  const std::vector<fftw_r2r_kind> kinds(sizes.size(), FFTW_REDFT00);
  auto* data = reinterpret_cast<double*>(values.data());
  fftw_plan plan;
  {
    const std::lock_guard lock(fourier_planning());
    plan = fftw_plan_many_r2r(static_cast<int>(sizes.size()), halves.data(), 2, data, nullptr, 2, 1,
                              data, nullptr, 2, 1, kinds.data(), FFTW_ESTIMATE);
  }
  fftw_execute(plan);
  const std::lock_guard lock(fourier_planning());
  fftw_destroy_plan(plan);
}

std::size_t transform_size(double least) {
  constexpr double most = 1e18;  // larger than any memory
  const auto needed = static_cast<std::uint64_t>(std::ceil(std::clamp(least, 2.0, most)));
  std::uint64_t best = std::bit_ceil(needed);
  for (std::uint64_t fives = 1; fives < best; fives *= 5)
    for (std::uint64_t odd = fives; odd < best; odd *= 3) {
      std::uint64_t size = 2 * odd;
      while (size < needed) size *= 2;
      best = std::min(best, size);
    }
  return best;
}

}  // namespace flatspeckle
