#include "apps/experiments/point_store.h"

#include <algorithm>
#include <iostream>

#include "apps/sweep/point_finder.h"
#include "core/error.h"
#include "core/result/provenance.h"
#include "core/result/run_state_file.h"

namespace flatspeckle::apps {

namespace fs = std::filesystem;

namespace {

using Part = ShardFolder::Part;

constexpr const char* ending = ".points";

constexpr int bits_of_place = 48;  // of a byte in a journal, which is below 256 TB
constexpr std::uint64_t most_place = (std::uint64_t{1} << bits_of_place) - 1;

fs::path own_journal(const std::string& folder, const SweepShare& share) {
  return fs::path(folder) /
         ("share-" + std::to_string(share.number) + "-of-" + std::to_string(share.count) + ending);
}

/// As the name of a file, which may not be too long.
std::string file_name(const std::string& name) {
  constexpr std::size_t longest = 150;
  if (name.size() <= longest) return name;
  return name.substr(0, longest) + "-" + std::to_string(std::hash<std::string>{}(name));
}

/// Of a point at work.
std::string identity_of(const std::string& identity, const std::string& name) {
  return identity + name + '\n';
}

}  // namespace

std::vector<fs::path> journals_in(const std::string& folder) {
  std::vector<fs::path> found;
  if (std::error_code none; !fs::is_directory(folder, none)) return found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ending) found.push_back(entry.path());
  std::ranges::sort(found);
  return found;
}

PointStore::PointStore(const ExperimentSweep& sweep, const std::vector<std::string>& folders)
    : sweep_(sweep), identity_(sweep.identity_of_points()), folders_(folders) {
  for (const std::string& folder : folders) open_others(folder, {});
}

PointStore::PointStore(const ExperimentSweep& sweep, const std::string& folder)
    : sweep_(sweep),
      identity_(sweep.identity_of_points()),
      folders_{folder},
      folder_(std::make_unique<ShardFolder>(folder)) {
  const fs::path own = own_journal(folder, sweep.share());
  const auto there = journals_in(folder);
  const bool has_begun = sweep.is_share() ? std::ranges::count(there, own) > 0 : !there.empty();
  if (has_begun && !sweep.settings().resume)
    throw InputError(folder +
                     " holds points of an earlier sweep: --resume goes on with them; remove the "
                     "folder to begin again");
  folder_->make();
  journals_.push_back(
      std::make_unique<PointJournal>(own, SweepHead{identity_, sweep.config()}, notes()));
  paths_.push_back(own);
  open_others(folder, own);
}

void PointStore::open_others(const std::string& folder, const fs::path& own) {
  for (const fs::path& path : journals_in(folder)) {
    if (path == own) continue;
    try {
      journals_.push_back(std::make_unique<PointJournal>(path, identity_, notes()));
      paths_.push_back(path);
    } catch (const InputError& error) {
      std::cerr << "warning: " + std::string(error.what()) + "; it is left out\n";
    }
  }
}

/// What the next journal tells.
PointJournal::Found PointStore::notes() {
  return [this, finder = std::make_shared<const PointFinder>(sweep_.points())](
             const std::string& name, std::uint64_t place) {
    if (const auto point = finder->find(name)) note(*point, journals_.size(), place);
  };
}

/// Of a point that several journals have, the first counts.
void PointStore::note(std::size_t point, std::size_t journal, std::uint64_t place) {
  const std::lock_guard lock(mutex_);
  if (places_.at(point) != 0) return;
  places_.set(point, journal << bits_of_place | place);
  ++finished_;
}

bool PointStore::has(std::size_t point) const {
  const std::lock_guard lock(mutex_);
  return places_.at(point) != 0;
}

void PointStore::for_each(
    const std::function<void(std::size_t point, const FinishedPoint&)>& use) const {
  for (std::size_t point = 0; point < sweep_.points().count(); ++point)
    if (const std::uint64_t found = places_.at(point); found != 0)
      use(point, journals_[found >> bits_of_place]->read(found & most_place));
}

void PointStore::add(std::size_t point, const FinishedPoint& finished) {
  const std::string name = name_of(point);
  note(point, 0, journals_.front()->add(name, finished));
  folder_->remove_unfinished(file_name(name));
  constexpr double seconds_between_syncs = 2;
  if (const double now = clock_.seconds(); now > synced_ + seconds_between_syncs) {
    synced_ = now;
    sync();
  }
}

RunState PointStore::unfinished(std::size_t point, std::size_t size) {
  RunState state;
  const std::string name = name_of(point), file = file_name(name);
  if (!folder_->has(file, Part::unfinished)) return state;
  const auto wrong =
      folder_->read(file, Part::unfinished, identity_of(identity_, name),
                    [&](const ResultReader& from) { state = read_state(from, "state", size); });
  if (wrong) folder_->set_aside(file, Part::unfinished, *wrong);
  return wrong ? RunState{} : std::move(state);
}

void PointStore::save_unfinished(std::size_t point, const Provenance& made, const RunState& state) {
  const std::string name = name_of(point);
  folder_->write(file_name(name), Part::unfinished, identity_of(identity_, name), Durable::yes,
                 [&](ResultFile& file) {
                   write_provenance(file, made);
                   write_state(file, "state", state);
                 });
}

void PointStore::remove() {
  journals_.clear();
  for (const fs::path& path : paths_) {
    std::error_code failed;
    if (!fs::remove(path, failed) && failed)
      throw IoError("removing " + path.string() + " failed: " + failed.message());
  }
  for (const std::string& path : folders_) {
    const ShardFolder folder(path);
    folder.remove(ours_of(folder.names()));
  }
}

/// Of names of files those that are of points.
std::set<std::string> PointStore::ours_of(const std::set<std::string>& names) const {
  std::set<std::string> ours;
  for (std::size_t point = 0; point < sweep_.points().count() && ours.size() < names.size();
       ++point)
    if (const std::string name = file_name(sweep_.points().name(point)); names.contains(name))
      ours.insert(name);
  return ours;
}

}  // namespace flatspeckle::apps
