#pragma once

#include <optional>
#include <string>
#include <unordered_map>

#include "apps/experiments/point_journal.h"

namespace flatspeckle::apps {

/// Evaluations of a search in a journal, known by their names.
class EvaluationJournal {
 public:
  /// As PointJournal. Throws InputError, IoError.
  EvaluationJournal(const std::filesystem::path& path, const SweepHead& head);

  std::size_t size() const { return journal_.size(); }
  bool has(const std::string& name) const { return places_.contains(name); }
  /// Of one that is there.
  FinishedPoint read(const std::string& name) const { return journal_.read(places_.at(name)); }
  /// For any thread, while no other function is called.
  void add(const std::string& name, const FinishedPoint& evaluation);
  void sync() { journal_.sync(); }

 private:
  std::unordered_map<std::string, std::uint64_t> places_;
  std::mutex mutex_;
  PointJournal journal_;
};

}  // namespace flatspeckle::apps
