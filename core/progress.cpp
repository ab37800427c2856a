#include "core/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace flatspeckle {

Progress::Progress(std::string label, const StopRule& stop)
    : label_(std::move(label)), stop_(stop), terminal_(isatty(STDERR_FILENO) == 1) {}

double Progress::seconds_left(double samples, double rate, double wall, double error) const {
  double left = std::numeric_limits<double>::infinity();
  if (stop_.samples) left = std::min(left, (static_cast<double>(*stop_.samples) - samples) / rate);
  if (stop_.seconds) left = std::min(left, *stop_.seconds - wall);
  if (stop_.target_error && std::isfinite(error))
    left = std::min(left, samples * (std::pow(error / *stop_.target_error, 2) - 1) / rate);
  return std::max(0.0, left);
}

void Progress::update(double samples, double new_samples, double wall, double new_wall,
                      double error) {
  const double interval = terminal_ ? 0.2 : 10;
  if (label_.empty() || new_wall - last_shown_ < interval) return;
  last_shown_ = new_wall;
  const double rate = new_samples / new_wall;
  std::fprintf(stderr, "%s%s: %.3g samples, %.3g/s", terminal_ ? "\r\033[K" : "", label_.c_str(),
               samples, rate);
  if (std::isfinite(error)) std::fprintf(stderr, ", error %.2g %%", 100 * error);
  const double left = seconds_left(samples, rate, wall, error);
  if (std::isfinite(left)) std::fprintf(stderr, ", %.0f s left", left);
  std::fputs(terminal_ ? "" : "\n", stderr);
  line_open_ = terminal_;
}

void Progress::finish() {
  if (line_open_) std::fputs("\n", stderr);
  line_open_ = false;
}

}  // namespace flatspeckle
