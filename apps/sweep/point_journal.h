#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <unordered_map>

#include "core/result/collected_result.h"
#include "core/session/journal.h"

namespace flatspeckle::apps {

/// A finished point of a sweep: its cost and its result.
struct FinishedPoint {
  std::string plan, started;
  double samples = 0, cpu_s = 0, wall_s = 0, relative_error = 0;
  /// True if the target error, if any, is reached and all invariants are within their limits.
  bool reached = true;
  CollectedResult result;
};

/// Journal of the finished points of a sweep, or of the evaluations of a search. A point needs a
/// few hundred bytes and a few microseconds. Thread-safe.
class PointJournal {
 public:
  /// Function that is called for each point in the journal, with the name of the point and its
  /// position in the file, which is never 0.
  using Found = std::function<void(const std::string& name, std::uint64_t place)>;

  /// Open a journal for writing (with `head`) or for reading (with `identity`), as described at
  /// Journal.
  PointJournal(const std::filesystem::path& path, const JournalHead& head, const std::string& whose,
               const Found& found);
  PointJournal(const std::filesystem::path& path, const std::string& identity, const Found& found);

  std::size_t size() const { return size_; }
  bool is_damaged() const { return journal_.is_damaged(); }

  /// Appends a point and returns its position in the file. Throws IoError.
  std::uint64_t add(const std::string& name, const FinishedPoint& point);
  /// Reads the point at this position in the file.
  FinishedPoint read(std::uint64_t place) const;
  /// Waits until all points are on the disk.
  void sync();

 private:
  /// Numbered texts that many points share and that are stored once. A text that was dropped from
  /// the cache gets a new number when it is used again.
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
