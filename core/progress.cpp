#include "core/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <unistd.h>

namespace flatspeckle {

namespace {

void show_error(double error) {
  if (std::isfinite(error)) std::fprintf(stderr, ", error %.2g %%", 100 * error);
}

}  // namespace

Progress::Progress(std::string label, const StopRule& stop, std::string unit)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      stop_(stop),
      terminal_(isatty(STDERR_FILENO) == 1) {}

const char* Progress::line_start() const {
  return terminal_ ? "\r\033[K" : "";
}

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
  std::fprintf(stderr, "%s%s: %.0f %s, %.*f/s", line_start(), label_.c_str(), samples,
               unit_.c_str(), rate < 10 ? 2 : 0, rate);
  show_error(error);
  const double left = seconds_left(samples, rate, wall, error);
  if (std::isfinite(left)) std::fprintf(stderr, ", %.0f s left", left);
  std::fputs(terminal_ ? "" : "\n", stderr);
}

void Progress::finish(double samples, double wall, double error) {
  if (label_.empty()) return;
  std::fprintf(stderr, "%s%s: %.0f %s in %.3g s", line_start(), label_.c_str(), samples,
               unit_.c_str(), wall);
  show_error(error);
  std::fputs("\n", stderr);
}

}  // namespace flatspeckle
