#pragma once

#include <limits>
#include <string>

namespace flatspeckle {

/// Prints progress on standard error. On a terminal, a single line is updated; otherwise a new line
/// is printed, at first every ten seconds and later at longer intervals. If the label is empty,
/// nothing is printed.
class Progress {
 public:
  /// unit: name of what is counted, such as "samples"; empty if nothing is counted.
  explicit Progress(std::string label, std::string unit = "samples");

  struct Figures {
    /// Text about the finished parts of the work, such as "3 of 40 points"; empty if the work has
    /// one part.
    std::string done;
    double samples = 0, rate = 0;
    double cpu_s = 0;  ///< processor time of all threads, in seconds; 0 if unknown
    /// Relative error of the result so far; infinite if unknown.
    double error = std::numeric_limits<double>::infinity();
    double seconds_left = std::numeric_limits<double>::infinity();
  };
  /// Whether a progress line should be printed now, `wall_s` seconds after the start of the work.
  bool due(double wall_s) const;
  void update(double wall_s, const Figures& figures);
  /// Prints the final figures on a new line that stays.
  void finish(double wall_s, const Figures& figures);

 private:
  void begin_line() const;
  void show(const Figures& figures) const;

  std::string label_, unit_;
  bool terminal_;
  double next_ = 0;
};

}  // namespace flatspeckle
