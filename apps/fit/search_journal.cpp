#include "apps/fit/search_journal.h"

namespace flatspeckle::apps {

namespace {

constexpr char step_kind = 's';

std::vector<std::byte> record_of(const mc::FitStep& step) {
  ByteWriter record;
  record.put(step.start);
  record.put(step.iteration);
  for (const double value : {step.paths, step.damping, step.chi_squared, step.cpu_s})
    record.put(value);
  record.put(std::vector<double>(step.at.begin(), step.at.end()));
  return record.take();
}

mc::FitStep step_of(ByteReader& record) {
  mc::FitStep step;
  record.get(step.start);
  record.get(step.iteration);
  for (double* value : {&step.paths, &step.damping, &step.chi_squared, &step.cpu_s})
    record.get(*value);
  const auto at = record.get<std::vector<double>>();
  step.at = Eigen::Map<const Eigen::VectorXd>(at.data(), std::ssize(at));
  return step;
}

std::filesystem::path beside(const std::string& out, bool resume) {
  std::filesystem::path path = out + ".search";
  std::error_code none;
  if (!resume) std::filesystem::remove(path, none);
  return path;
}

}  // namespace

SearchJournal::SearchJournal(const std::string& out, const std::string& identity, bool resume)
    : path_(beside(out, resume)),
      journal_(
          path_, JournalHead{identity}, "search",
          [this](std::uint64_t, char, ByteReader& record) { steps_.push_back(step_of(record)); }) {}

void SearchJournal::add(const mc::FitStep& step) {
  journal_.append(step_kind, record_of(step));
}

void SearchJournal::remove() const {
  std::error_code none;
  std::filesystem::remove(path_, none);
}

}  // namespace flatspeckle::apps
