#include "apps/fit/search_journal.h"

#include <functional>
#include <optional>
#include <sstream>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

std::string head_of(const std::string& identity) {
  return "search " + std::to_string(std::hash<std::string>{}(identity));
}

std::string line_of(const mc::FitStep& step) {
  std::string line = std::to_string(step.start) + ' ' + std::to_string(step.iteration);
  for (const double value : {step.paths, step.damping, step.chi_squared, step.cpu_s})
    line += ' ' + number_text(value);
  for (const double value : step.at) line += ' ' + number_text(value);
  return line;
}

std::optional<mc::FitStep> step_of(const std::string& line) {
  std::istringstream words(line);
  mc::FitStep step;
  std::vector<double> at;
  words >> step.start >> step.iteration >> step.paths >> step.damping >> step.chi_squared >>
      step.cpu_s;
  if (!words) return std::nullopt;
  for (double value = 0; words >> value;) at.push_back(value);
  step.at = Eigen::Map<const Eigen::VectorXd>(at.data(), std::ssize(at));
  return step;
}

/// Whole lines alone: the last may have been cut off.
std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line) && !file.eof();) lines.push_back(line);
  return lines;
}

}  // namespace

SearchJournal::SearchJournal(const std::string& out, const std::string& identity, bool resume)
    : path_(out + ".search") {
  const auto lines = resume ? lines_of(path_) : std::vector<std::string>();
  if (!lines.empty() && lines.front() != head_of(identity))
    throw InputError("resume", path_.string(),
                     "is of another search: keys, measurements and version must be the same");
  for (std::size_t i = 1; i < lines.size(); ++i)
    if (auto step = step_of(lines[i])) steps_.push_back(std::move(*step));
  file_.open(path_);
  file_ << head_of(identity) << '\n';
  for (const mc::FitStep& step : steps_) file_ << line_of(step) << '\n';
  file_.flush();
}

void SearchJournal::add(const mc::FitStep& step) {
  file_ << line_of(step) << '\n' << std::flush;
}

void SearchJournal::remove() {
  file_.close();
  std::error_code none;
  std::filesystem::remove(path_, none);
}

}  // namespace flatspeckle::apps
