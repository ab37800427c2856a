#include "apps/optimise/evaluation_journal.h"

namespace flatspeckle::apps {

EvaluationJournal::EvaluationJournal(const std::filesystem::path& path, const SweepHead& head)
    : journal_(path, head, [this](const std::string& name, std::uint64_t place) {
        places_.emplace(name, place);
      }) {}

void EvaluationJournal::add(const std::string& name, const FinishedPoint& evaluation) {
  const std::uint64_t place = journal_.add(name, evaluation);
  const std::lock_guard lock(mutex_);
  places_.emplace(name, place);
}

}  // namespace flatspeckle::apps
