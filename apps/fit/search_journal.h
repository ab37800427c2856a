#pragma once

#include <string>
#include <vector>

#include "core/session/journal.h"
#include "mc/fit/task/fit_task.h"

namespace flatspeckle::apps {

/// The steps of a search in a journal beside the result (NAME.search), so that one that was ended,
/// however, can go on. It is gone once the result is there.
class SearchJournal {
 public:
  /// identity: what the search depends on. Reads the steps of the same search that are there, or
  /// begins anew where there are none. Throws InputError for those of another search.
  SearchJournal(const std::string& out, const std::string& identity, bool resume);

  const std::vector<mc::FitStep>& steps() const { return steps_; }
  void add(const mc::FitStep& step);
  void remove() const;

 private:
  std::filesystem::path path_;
  std::vector<mc::FitStep> steps_;
  Journal journal_;
};

}  // namespace flatspeckle::apps
