#include "core/run/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unistd.h>
#include <utility>

namespace flatspeckle {

namespace {

/// Returns a duration, given in seconds, as text such as "34 s", "12 min", "5.2 h" or "3.1 d".
std::string duration(double seconds) {
  struct Unit {
    double length, most;
    const char* name;
    int digits;
  };
  constexpr Unit units[] = {
      {1, 300, "s", 0}, {60, 7200, "min", 0}, {3600, 48 * 3600, "h", 1}, {86400, 0, "d", 1}};
  const Unit* unit = units;
  while (unit->most > 0 && seconds >= unit->most) ++unit;
  char text[64];
  std::snprintf(text, sizeof text, "%.*f %s", unit->digits, seconds / unit->length, unit->name);
  return text;
}

}  // namespace

Progress::Progress(std::string label, std::string unit)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      terminal_(isatty(STDERR_FILENO) == 1),
      next_(terminal_ ? 0.2 : 10) {}

bool Progress::due(double wall_s) const {
  return !label_.empty() && wall_s >= next_;
}

void Progress::begin_line() const {
  std::fprintf(stderr, "%s%s: ", terminal_ ? "\r\033[K" : "", label_.c_str());
}

void Progress::show(const Figures& figures) const {
  begin_line();
  if (!figures.done.empty()) std::fprintf(stderr, "%s, ", figures.done.c_str());
  if (unit_.empty())
    std::fputs("solved", stderr);
  else
    std::fprintf(stderr, "%.0f %s", figures.samples, unit_.c_str());
}

void Progress::update(double wall_s, const Figures& figures) {
  if (!due(wall_s)) return;
  next_ = wall_s + (terminal_ ? 0.2 : std::clamp(0.02 * wall_s, 10.0, 600.0));
  if (unit_.empty()) {
    begin_line();
    std::fprintf(stderr, "solving, %s so far%s", duration(wall_s).c_str(), terminal_ ? "" : "\n");
    return;
  }
  show(figures);
  if (figures.samples > 0)
    std::fprintf(stderr, ", %.*f/s", figures.rate < 10 ? 2 : 0, figures.rate);
  else
    std::fprintf(stderr, " in %s", duration(wall_s).c_str());
  if (std::isfinite(figures.error)) std::fprintf(stderr, ", error %.2g %%", 100 * figures.error);
  if (std::isfinite(figures.seconds_left))
    std::fprintf(stderr, ", %s left", duration(figures.seconds_left).c_str());
  std::fputs(terminal_ ? "" : "\n", stderr);
}

void Progress::finish(double wall_s, const Figures& figures) {
  if (label_.empty()) return;
  show(figures);
  std::fprintf(stderr, " in %.3g s", wall_s);
  if (figures.cpu_s > 0) std::fprintf(stderr, " (%.3g s of processor time)", figures.cpu_s);
  if (std::isfinite(figures.error)) std::fprintf(stderr, ", error %.3g %%", 100 * figures.error);
  std::fputs("\n", stderr);
}

}  // namespace flatspeckle
