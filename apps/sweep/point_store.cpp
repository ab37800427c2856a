#include "apps/sweep/point_store.h"

#include <algorithm>
#include <iostream>
#include <map>

#include "core/error.h"
#include "core/result/run_state_file.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

namespace fs = std::filesystem;

namespace {

constexpr const char* ending = ".points";
constexpr const char* unfinished_ending = ".part";

// bits for a position in a journal, whose size is therefore limited to 256 TB
constexpr int bits_of_place = 48;
constexpr std::uint64_t most_place = (std::uint64_t{1} << bits_of_place) - 1;

fs::path own_journal(const std::string& folder, const SweepShare& share) {
  return fs::path(folder) /
         ("share-" + std::to_string(share.number) + "-of-" + std::to_string(share.count) + ending);
}

/// Returns the name of a run, shortened if it is too long for a file name.
std::string file_name(const std::string& name) {
  constexpr std::size_t longest = 150;
  if (name.size() <= longest) return name;
  return name.substr(0, longest) + "-" + std::to_string(std::hash<std::string>{}(name));
}

/// Returns the name of the unfinished run whose state a file contains; empty for other files.
/// Temporary files of such states (core/result/atomic_file.h) and files of earlier versions
/// (.part.h5) are recognised too.
std::string unfinished_name(const fs::path& path) {
  std::string text = path.filename().string();
  if (const auto making = text.rfind(".tmp-"); text.starts_with('.') && making != text.npos)
    text = text.substr(1, making - 1);
  for (const std::string part : {unfinished_ending, ".part.h5"})
    if (text.ends_with(part)) return text.substr(0, text.size() - part.size());
  return "";
}

void make_folder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directory(folder, failed);
  if (failed || !fs::is_directory(folder))
    throw IoError("cannot make the folder " + folder.string() + ": " +
                  (failed ? failed.message() : "a file with this name exists"));
}

void remove_file(const fs::path& path) {
  std::error_code failed;
  if (!fs::remove(path, failed) && failed)
    throw IoError("removing " + path.string() + " failed: " + failed.message());
}

}  // namespace

std::vector<fs::path> journals_in(const std::string& folder) {
  std::vector<fs::path> found;
  if (std::error_code none; !fs::is_directory(folder, none)) return found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (path.extension() == ending) found.push_back(path);
    if (path.extension() == ".h5" && unfinished_name(path).empty())
      throw InputError(
          folder + " contains one file per point, the format of earlier versions" +
          ": finish or merge that sweep with the version that wrote it, or remove the folder");
  }
  std::ranges::sort(found);
  return found;
}

PointStore::PointStore(const Sweep& sweep, const std::vector<std::string>& folders)
    : sweep_(sweep),
      finder_(sweep.points()),
      identity_(sweep.identity_of_points()),
      folders_(folders),
      places_(sweep.runs()) {
  for (const std::string& folder : folders) {
    const std::size_t before = foreign_files_;
    open_others(folder, {});
    if (foreign_files_ > before)
      warnings_ += "warning: " + folder + ": " + std::to_string(foreign_files_ - before) +
                   " points of another sweep are ignored\n";
  }
}

PointStore::PointStore(const Sweep& sweep, const std::string& folder)
    : sweep_(sweep),
      finder_(sweep.points()),
      identity_(sweep.identity_of_points()),
      folders_{folder},
      places_(sweep.runs()) {
  const fs::path own = own_journal(folder, sweep.share().value_or(SweepShare{}));
  const auto there = journals_in(folder);
  const bool has_begun = sweep.share() ? std::ranges::count(there, own) > 0 : !there.empty();
  if (has_begun && !sweep.settings().resume)
    throw InputError(folder +
                     " contains points of an earlier sweep: continue with --resume, or remove the "
                     "folder to start again");
  make_folder(folder);
  journals_.push_back(std::make_unique<PointJournal>(own, JournalHead{identity_, sweep.config()},
                                                     "sweep", notes()));
  paths_.push_back(own);
  open_others(folder, own);
  std::cerr << warnings_;
}

void PointStore::open_others(const std::string& folder, const fs::path& own) {
  for (const fs::path& path : journals_in(folder)) {
    if (path == own) continue;
    try {
      journals_.push_back(std::make_unique<PointJournal>(path, identity_, notes()));
      paths_.push_back(path);
      if (journals_.back()->is_damaged())
        warnings_ += "warning: " + path.string() + " is damaged; " +
                     std::to_string(journals_.back()->size()) + " of its points are used\n";
    } catch (const InputError& error) {
      warnings_ += std::string("warning: ") + error.what() + "; the file is ignored\n";
    }
  }
}

/// Returns the function that the next journal to be opened calls for each of its points, to record
/// the point.
PointJournal::Found PointStore::notes() {
  return [this](const std::string& name, std::uint64_t place) {
    if (const auto run = sweep_.find(name, finder_))
      note(*run, journals_.size(), place);
    else
      ++foreign_files_;
  };
}

/// Records in which journal and at which position a finished run is stored. If several journals
/// contain the run, the first one is used.
void PointStore::note(std::size_t run, std::size_t journal, std::uint64_t place) {
  const std::lock_guard lock(mutex_);
  if (places_[run] != 0) return;
  places_[run] = journal << bits_of_place | place;
  ++finished_;
}

bool PointStore::has(std::size_t run) const {
  const std::lock_guard lock(mutex_);
  return places_[run] != 0;
}

void PointStore::for_each(
    const std::function<void(std::size_t run, const FinishedPoint&)>& use) const {
  for (std::size_t run = 0; run < sweep_.runs(); ++run)
    if (const std::uint64_t found = places_[run]; found != 0)
      use(run, journals_[found >> bits_of_place]->read(found & most_place));
}

void PointStore::add(std::size_t run, const FinishedPoint& finished) {
  const std::string name = sweep_.name(run);
  note(run, 0, journals_.front()->add(name, finished));
  std::error_code none;
  fs::remove(unfinished_file(name), none);
  constexpr double seconds_between_syncs = 2;
  if (const double now = clock_.seconds(); now > synced_ + seconds_between_syncs) {
    synced_ = now;
    sync();
  }
}

fs::path PointStore::unfinished_file(const std::string& name) const {
  return fs::path(folders_.front()) / (file_name(name) + unfinished_ending);
}

/// If the file with the state of the run is damaged, renames it and returns an empty state, so that
/// the run starts again from the beginning.
RunState PointStore::unfinished(std::size_t run, std::size_t size) const {
  const std::string name = sweep_.name(run);
  const fs::path path = unfinished_file(name);
  try {
    const auto kept = kept_record(path, identity_of(name), "sweep");
    return kept ? state_of(*kept, size) : RunState{};
  } catch (const InputError& error) {
    const fs::path place = free_backup(path);
    std::error_code failed;
    fs::rename(path, place, failed);
    if (failed) throw IoError("renaming " + path.string() + " failed: " + failed.message());
    // Prints the line in one piece, because other threads may print at the same time.
    std::cerr << std::string("warning: ") + error.what() + "; renamed to " +
                     place.filename().string() + '\n';
    return {};
  }
}

void PointStore::save_unfinished(std::size_t run, const RunState& state) const {
  const std::string name = sweep_.name(run);
  keep_record(unfinished_file(name), identity_of(name), bytes_of(state), Durable::yes);
}

void PointStore::require_in_place() const {
  for (const fs::path& path : paths_) BlockFile(path, BlockFile::Access::read);
}

void PointStore::remove() {
  journals_.clear();
  for (const fs::path& path : paths_) remove_file(path);
  for (const std::string& folder : folders_) {
    if (!fs::is_directory(folder)) continue;
    remove_unfinished(folder);
    std::error_code not_empty;
    fs::remove(folder, not_empty);
  }
}

/// Removes the files with states of unfinished runs of this sweep that a killed process has left in
/// the folder.
void PointStore::remove_unfinished(const fs::path& folder) const {
  std::multimap<std::string, fs::path> there;
  for (const auto& entry : fs::directory_iterator(folder))
    if (const std::string name = unfinished_name(entry.path()); !name.empty())
      there.emplace(name, entry.path());
  for (std::size_t run = 0; run < sweep_.runs() && !there.empty(); ++run) {
    const std::string name = file_name(sweep_.name(run));
    const auto [first, last] = there.equal_range(name);
    for (auto found = first; found != last; ++found) remove_file(found->second);
    there.erase(name);
  }
}

}  // namespace flatspeckle::apps
