#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/result/run_state_file.h"
#include "core/session/journal.h"

namespace flatspeckle::test_journal {

namespace fs = std::filesystem;

namespace {

using Bytes = std::vector<std::byte>;
using Records = std::vector<std::pair<char, Bytes>>;

/// A temporary folder.
struct Folder {
  Folder() { fs::create_directory(path); }
  ~Folder() { fs::remove_all(path); }
  fs::path file() const { return path / "journal"; }
  fs::path path = fs::temp_directory_path() / ("test_journal-" + std::to_string(::getpid()));
};

Journal::Use collect(Records& found) {
  return [&](std::uint64_t, char kind, const ByteReader& record) {
    found.emplace_back(kind, Bytes(record.rest().begin(), record.rest().end()));
  };
}

Bytes some(std::size_t count) {
  return Bytes(count, std::byte(7));
}

void change(const fs::path& path, std::uint64_t place) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(place));
  file.put('\x55');
}

Records written(const fs::path& path) {
  Records found;
  Journal journal(path, JournalHead{"this", "first"}, "run", collect(found));
  for (std::size_t count : {3, 0, 5}) {
    const auto place = journal.append('p', some(count));
    CHECK(journal.read(place) == some(count));
  }
  return found;
}

}  // namespace

TEST_CASE("journal: reopened with its records and all configurations") {
  const Folder folder;
  CHECK(written(folder.file()).empty());
  Records found;
  { Journal(folder.file(), JournalHead{"this", "second"}, "run", collect(found)); }
  { Journal(folder.file(), JournalHead{"this", "second"}, "run", collect(found)); }
  CHECK(found.size() == 6);
  CHECK(found.at(2) == std::pair{'p', some(5)});
  CHECK(Journal::configs_in(folder.file()) == std::vector<std::string>{"first", "second"});
}

TEST_CASE("journal: that of another run is rejected, for reading and for continuing") {
  const Folder folder;
  written(folder.file());
  Records found;
  const auto size = fs::file_size(folder.file());
  CHECK_THROWS_WITH_AS(Journal(folder.file(), JournalHead{"that\n"}, "run", collect(found)),
                       doctest::Contains("another run (this)"), InputError);
  CHECK_THROWS_AS(Journal(folder.file(), std::string("that"), "run", collect(found)), InputError);
  CHECK(found.empty());
  CHECK(fs::file_size(folder.file()) == size);
}

TEST_CASE("journal: a damaged one is backed up and continued from its complete records") {
  const Folder folder;
  written(folder.file());
  change(folder.file(), fs::file_size(folder.file()) - 1);
  Records found;
  { Journal(folder.file(), JournalHead{"this", "first"}, "run", collect(found)); }
  CHECK(found.size() == 2);
  CHECK(fs::exists(folder.file().string() + ".aside-1"));
  found.clear();
  const Journal mended(folder.file(), std::string("this"), "run", collect(found));
  CHECK(found.size() == 2);
  CHECK_FALSE(mended.is_damaged());
}

TEST_CASE("kept record: replaces the previous one, and any damage is detected") {
  const Folder folder;
  CHECK_FALSE(kept_record(folder.file(), "this", "run"));
  for (std::size_t count : {9, 4}) {
    keep_record(folder.file(), "this", some(count), Durable::no);
    CHECK(kept_record(folder.file(), "this", "run") == some(count));
  }
  CHECK_THROWS_AS(kept_record(folder.file(), "that", "run"), InputError);
  const auto size = fs::file_size(folder.file());
  for (std::uint64_t place = 0; place < size; ++place) {
    change(folder.file(), place);
    CHECK_THROWS_AS(kept_record(folder.file(), "this", "run"), InputError);
    keep_record(folder.file(), "this", some(4), Durable::no);
  }
  for (auto shorter = size; shorter-- > 0;) {
    fs::resize_file(folder.file(), shorter);
    CHECK_THROWS_AS(kept_record(folder.file(), "this", "run"), InputError);
  }
  fs::remove(folder.file());
  fs::create_directory(folder.file());
  CHECK_THROWS_AS(kept_record(folder.file(), "this", "run"), InputError);
}

TEST_CASE("run state: restored from its bytes bit for bit") {
  RunState state{GroupedSums(2), {{1, 2}, {3, 4}, {80, 100}, {INFINITY, 0.4}}, 0.1, 0.2};
  for (int batch = 0; batch < 300; ++batch)
    state.sums.add(10, std::vector<Complex>{{1.0 / (1 + batch), 0.5}, {2, 0.1 * batch}});
  const Bytes bytes = bytes_of(state);
  const RunState back = state_of(bytes, 2);
  CHECK(bytes_of(back) == bytes);
  CHECK(back.sums.batches() == 300);
  CHECK(back.sums.state().sums == state.sums.state().sums);
  CHECK(back.trace.relative_error == state.trace.relative_error);
  CHECK(back.wall_s == 0.1);
  CHECK_THROWS_AS(state_of(bytes, 3), InputError);
  CHECK_THROWS_AS(state_of(std::span(bytes).first(100), 2), InputError);
}

}  // namespace flatspeckle::test_journal
