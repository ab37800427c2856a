#pragma once

#include <limits>
#include <string>

namespace flatspeckle {

/// Says on standard error how long work gets on: a line that renews itself on a terminal; elsewhere
/// a line every ten seconds at first, then ever more rarely. Silent without a label.
class Progress {
 public:
  /// unit: what the samples are called; empty where there is nothing to count.
  explicit Progress(std::string label, std::string unit = "samples");

  struct Figures {
    std::string done;  ///< of the parts, as "3 of 40 points"; empty where there is one
    double samples = 0, rate = 0;
    double error = std::numeric_limits<double>::infinity();  ///< relative; infinite: not known
    double seconds_left = std::numeric_limits<double>::infinity();
  };
  /// Whether it is time for another line, `wall_s` seconds after the start.
  bool due(double wall_s) const;
  void update(double wall_s, const Figures& figures);
  /// Leaves the end standing on its own line.
  void finish(double wall_s, const Figures& figures);

 private:
  void begin_line() const;
  void show(const Figures& figures) const;

  std::string label_, unit_;
  bool terminal_;
  double next_ = 0;
};

}  // namespace flatspeckle
