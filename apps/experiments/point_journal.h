#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/result/block_file.h"
#include "core/result/collected_result.h"
#include "core/result/scratch_numbers.h"

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

/// Finished points of a sweep in one file (BlockFile): a few hundred bytes and microseconds each,
/// and no memory. For any thread.
class PointJournal {
 public:
  /// Of a point in the file: its name, and its place, which is not 0.
  using Found = std::function<void(const std::string& name, std::uint64_t place)>;

  /// Goes on with the file there, telling what it finds, or begins one. What is torn or damaged at
  /// its end is cut off, with a warning and a copy kept where it is damaged. Throws InputError
  /// where the points there are of another sweep, IoError.
  PointJournal(const std::filesystem::path& path, const SweepHead& head, const Found& found);
  /// To read. Throws InputError where it holds no points of this sweep.
  PointJournal(const std::filesystem::path& path, const std::string& identity, const Found& found);
  /// Throws InputError where there is none.
  static SweepHead head_of(const std::filesystem::path& path);

  std::size_t size() const { return size_; }

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
    std::uint64_t count = 0;
    ScratchNumbers places;
    std::unordered_map<std::string, std::uint64_t> known;

    void add(const std::string& text, std::uint64_t place);
  };
  enum class Kind : char { head = 'h', plan = 't', layout = 'l', point = 'p' };

  BlockFile::Tail scan(const std::string& identity, const Found& found);
  void take_in(std::uint64_t place, std::span<const std::byte> block, const std::string& identity,
               const Found& found);
  void keep_damaged(const std::filesystem::path& path) const;
  std::uint64_t number_of(Kind kind, const std::string& text);
  std::string text(const Shared& shared, std::uint64_t number) const;

  std::unique_ptr<BlockFile> file_;
  std::optional<SweepHead> head_;
  std::size_t size_ = 0;
  Shared plans_, layouts_;
  mutable std::mutex mutex_;
};

}  // namespace flatspeckle::apps
