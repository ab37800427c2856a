#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <unordered_map>

#include "core/result/collected_result.h"
#include "core/session/journal.h"

namespace flatspeckle::apps {

/// A finished point of a sweep: what it cost, and what was found.
struct FinishedPoint {
  std::string plan, started;
  double samples = 0, cpu_s = 0, wall_s = 0, relative_error = 0;
  bool reached = true;  ///< the target error, if there was one, and keeps its invariants
  CollectedResult result;
};

/// Finished points of a sweep in a journal: a few hundred bytes and microseconds each. For any
/// thread.
class PointJournal {
 public:
  /// Called with each point in the file: its name, and its place, which is not 0.
  using Found = std::function<void(const std::string& name, std::uint64_t place)>;

  /// Both as Journal.
  PointJournal(const std::filesystem::path& path, const JournalHead& head, const std::string& whose,
               const Found& found);
  PointJournal(const std::filesystem::path& path, const std::string& identity, const Found& found);

  std::size_t size() const { return size_; }
  bool is_damaged() const { return journal_.is_damaged(); }

  /// Its place. Throws IoError.
  std::uint64_t add(const std::string& name, const FinishedPoint& point);
  /// Of the point at this place.
  FinishedPoint read(std::uint64_t place) const;
  /// Waits until the disk has it all.
  void sync();

 private:
  /// Texts that many points share, by number and back. A text that is forgotten gets another number
  /// when it comes again.
  struct Shared {
    std::vector<std::uint64_t> places;
    std::unordered_map<std::string, std::uint64_t> known;

    void add(const std::string& text, std::uint64_t place);
  };
  static constexpr char plan_kind = 't', layout_kind = 'l', point_kind = 'p';

  Journal::Use taking(const Found& found);
  std::uint64_t number_of(char kind, const std::string& text);
  std::string text(const Shared& shared, std::uint64_t number) const;

  std::size_t size_ = 0;
  Shared plans_, layouts_;
  Journal journal_;
  mutable std::mutex mutex_;
};

}  // namespace flatspeckle::apps
