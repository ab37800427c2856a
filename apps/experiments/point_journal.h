#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/result/block_file.h"
#include "core/result/collected_result.h"

namespace flatspeckle::apps {

/// A finished point of a sweep: what it cost, and what was found.
struct FinishedPoint {
  std::string plan, started;
  double samples = 0, cpu_s = 0, wall_s = 0, relative_error = 0;
  bool reached = true;  ///< the target error, if there was one
  CollectedResult result;
};

/// What all points of a sweep have in common.
struct SweepHead {
  std::string identity;     ///< equal texts, equal numbers of points of the same name
  std::string config = {};  ///< of the sweep that wrote here first
};

/// Finished points of a sweep in one file (BlockFile), known by their names: a few hundred bytes
/// and microseconds each. For any thread.
class PointJournal {
 public:
  /// Goes on with the file there, or begins one. What is torn or damaged at its end is cut off,
  /// with a warning and a copy kept where it is damaged. Throws InputError where the points there
  /// are of another sweep, IoError.
  PointJournal(const std::filesystem::path& path, const SweepHead& head);
  /// To read. Throws InputError where it holds no points.
  explicit PointJournal(const std::filesystem::path& path);

  const SweepHead& head() const { return head_; }
  std::size_t size() const { return places_.size(); }
  bool has(const std::string& name) const;

  /// Throws IoError.
  void add(const std::string& name, const FinishedPoint& point);
  /// Of a point that is there.
  FinishedPoint read(const std::string& name) const;
  /// Waits until the disk has it all.
  void sync();

 private:
  /// Texts that many points share, by number and back.
  struct Shared {
    std::vector<std::string> texts;
    std::unordered_map<std::string, std::uint64_t> numbers;

    void add(const std::string& text);
    const std::string& at(std::uint64_t number) const;
  };
  enum class Kind : char { head = 'h', plan = 't', layout = 'l', point = 'p' };

  BlockFile::Tail scan();
  void take_in(std::uint64_t place, std::span<const std::byte> block);
  void keep_damaged(const std::filesystem::path& path) const;
  std::uint64_t number_of(Kind kind, const std::string& text);
  std::optional<std::uint64_t> place_of(const std::string& name) const;

  std::unique_ptr<BlockFile> file_;
  SweepHead head_;
  bool has_head_ = false;
  Shared plans_, layouts_;
  std::unordered_multimap<std::size_t, std::uint64_t> places_;  ///< by the hash of the name
  mutable std::mutex mutex_;
};

}  // namespace flatspeckle::apps
