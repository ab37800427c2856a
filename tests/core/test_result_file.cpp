#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <sys/resource.h>
#include <thread>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/result/atomic_file.h"
#include "core/result/collected_result.h"
#include "core/result/guarded_read.h"
#include "core/result/provenance.h"
#include "core/result/result_file.h"
#include "core/result/result_reader.h"
#include "core/result/run_state_file.h"

namespace flatspeckle::test_result_file {

namespace fs = std::filesystem;

namespace {

/// A temporary empty folder.
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "flatspeckle-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    path_ = pattern;
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  fs::path operator/(const std::string& name) const { return path_ / name; }
  std::ptrdiff_t entries() const {
    return std::distance(fs::directory_iterator(path_), fs::directory_iterator());
  }

 private:
  fs::path path_;
};

/// Limits the size of files to `bytes` during its lifetime, like a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*signal_)(int);
  rlimit before_{};
};

std::vector<double> noise(std::size_t count) {
  std::mt19937_64 random(7);
  std::vector<double> values(count);
  for (double& value : values) value = std::ldexp(static_cast<double>(random()), -60);
  return values;
}

void write_number(const fs::path& path, double number) {
  ResultFile file(path);
  file.attribute("/", "number", number);
  file.commit();
}

double read_number(const fs::path& path) {
  return ResultReader(path).attribute<double>("/", "number");
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("result file: attributes of all types are read back") {
  const Folder folder;
  const std::vector<double> doubles{1.5, -0.1};
  const std::vector<std::string> names{"one", "", "three \u00b5m"};
  ResultFile file(folder / "a.h5");
  file.attribute("/", "text", "line\nline");
  file.attribute("/", "empty", std::string());
  file.attribute("/", "double", 0.1);
  file.attribute("/", "int", -3);
  file.attribute("/", "count", std::numeric_limits<std::uint64_t>::max());
  file.attribute("/", "yes", true);
  file.attribute("mc/solve", "doubles", doubles);
  file.attribute("mc/solve", "names", names);
  file.attribute("mc/solve", "none", std::vector<double>());
  file.attribute("mc/solve", "no names", std::vector<std::string>());
  file.commit();

  const ResultReader reader(folder / "a.h5");
  CHECK(reader.attribute<std::string>("/", "text") == "line\nline");
  CHECK(reader.attribute<std::string>("/", "empty").empty());
  CHECK(reader.attribute<double>("/", "double") == 0.1);
  CHECK(reader.attribute<double>("/", "int") == -3);
  CHECK(reader.attribute<std::uint64_t>("/", "count") == std::numeric_limits<std::uint64_t>::max());
  CHECK(reader.attribute<bool>("/", "yes"));
  CHECK(reader.attribute<std::vector<double>>("mc/solve", "doubles") == doubles);
  CHECK(reader.attribute<std::vector<double>>("mc/solve", "none").empty());
  CHECK(reader.has_attribute("mc/solve", "no names"));
  CHECK(reader.has("mc/solve"));
  CHECK_FALSE(reader.has("mc/other/solve"));
  CHECK(reader.has_attribute("mc/solve", "names"));
  CHECK_FALSE(reader.has_attribute("mc/solve", "text"));
}

TEST_CASE("result file: datasets of all types are read back with shape, axes and units") {
  const Folder folder;
  const std::vector<double> angles{0, 0.1, -0.3}, tilts{0, 0.01};
  const std::vector<Complex> field{{1, 2}, {3, -4}, {5, 0}, {0, 6}, {-7, 8}, {9, 1e-300}};
  const std::vector<std::uint64_t> orders{3, std::numeric_limits<std::uint64_t>::max()};
  const std::vector<double> large = noise(300'000);  // three chunks
  const double residual = 1e-14;
  ResultFile file(folder / "a.h5");
  file.scale("mc/view_angle", angles, "rad", "angle of the view");
  file.scale("tilt", tilts, "rad", "");
  file.dataset("mc/covariance", field, {"tilt", "mc/view_angle"}, "1", "covariance");
  file.dataset("solve/basis_order", orders, {orders.size()}, "1", "");
  file.dataset("solve/residual", std::span(&residual, 1), {}, "", "relative residual");
  file.dataset("large", large, {std::size_t{3}, std::size_t{100'000}}, "", "");
  file.dataset("mixed", field, {"mc/view_angle", std::size_t{2}}, "", "");
  file.dataset("nothing", std::vector<Complex>(), {std::size_t{0}, "tilt"}, "", "");
  file.commit();

  const ResultReader reader(folder / "a.h5");
  CHECK(reader.dataset<double>("mc/view_angle") == angles);
  CHECK(reader.dataset<Complex>("mc/covariance") == field);
  CHECK(reader.shape("mc/covariance") == std::vector<std::size_t>{2, 3});
  CHECK(reader.attribute<std::string>("mc/view_angle", "units") == "rad");
  CHECK(reader.attribute<std::string>("mc/view_angle", "long_name") == "angle of the view");
  CHECK_FALSE(reader.has_attribute("tilt", "long_name"));
  CHECK(reader.dataset<double>("solve/basis_order") == std::vector{3, 0x1p64});
  CHECK(reader.dataset<double>("solve/residual") == std::vector{residual});
  CHECK(reader.shape("solve/residual").empty());
  CHECK(reader.dataset<double>("large") == large);
  CHECK(reader.shape("nothing") == std::vector<std::size_t>{0, 2});
  CHECK(reader.dataset<Complex>("nothing").empty());
}

TEST_CASE("result file: equal results produce equal bytes") {
  const Folder folder;
  const auto bytes = [&](const std::string& name) {
    ResultFile file(folder / name);
    file.scale("tilt", noise(1000), "rad", "tilt");
    file.dataset("value", noise(1000), {"tilt"}, "1", "value");
    file.commit();
    std::ifstream stream(folder / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string first = bytes("first");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // a time stamp would differ
  CHECK(first.size() > 1000);
  CHECK(first == bytes("second"));
}

TEST_CASE("result file: values that are not finite are rejected") {
  const Folder folder;
  ResultFile file(folder / "a.h5");
  for (double bad : {not_a_number, infinity, -infinity}) {
    CHECK_THROWS_WITH_AS(file.scale("tilt", std::vector{0, bad}, "rad", ""),
                         "tilt: a value is not finite", std::logic_error);
    CHECK_THROWS_AS(file.dataset("x", std::vector{bad}, {std::size_t{1}}, "", ""),
                    std::logic_error);
    CHECK_THROWS_AS(file.dataset("z", std::vector{Complex(bad, 0)}, {std::size_t{1}}, "", ""),
                    std::logic_error);
    CHECK_THROWS_AS(file.dataset("z", std::vector{Complex(0, bad)}, {std::size_t{1}}, "", ""),
                    std::logic_error);
    CHECK_THROWS_AS(file.attribute("/", "x", bad), std::logic_error);
    CHECK_THROWS_AS(file.attribute("/", "x", std::vector{1, bad}), std::logic_error);
  }
  file.commit();
  const ResultReader reader(folder / "a.h5");
  CHECK_FALSE(reader.has("tilt"));
  CHECK_FALSE(reader.has("x"));
  CHECK_FALSE(reader.has_attribute("/", "x"));
}

TEST_CASE("result file: incorrect calls are a logic_error") {
  const Folder folder;
  ResultFile file(folder / "a.h5");
  const std::vector<double> two{1, 2};
  file.scale("tilt", two, "rad", "");
  CHECK_THROWS_AS(file.scale("tilt", two, "rad", ""), std::logic_error);
  CHECK_THROWS_AS(file.attribute("tilt", "units", "m"), std::logic_error);
  CHECK_THROWS_AS(file.dataset("x", two, {std::size_t{3}}, "", ""), std::logic_error);
  CHECK_THROWS_AS(file.dataset("x", two, {}, "", ""), std::logic_error);
  CHECK_THROWS_AS(file.dataset("x", two, {"view"}, "", ""), std::logic_error);
  CHECK_THROWS_AS(file.dataset("x", std::vector<std::string>(3), {"tilt"}, "", ""),
                  std::logic_error);
  file.commit();
  CHECK_THROWS_AS(file.attribute("/", "late", 1), std::logic_error);
  CHECK_THROWS_AS(file.commit(), std::logic_error);
}

TEST_CASE("result file: appears only with commit() and replaces the old one as a whole") {
  const Folder folder;
  { const ResultFile unfinished(folder / "a.h5"); }
  CHECK(folder.entries() == 0);

  write_number(folder / "a.h5", 1);
  {
    ResultFile unfinished(folder / "a.h5");
    unfinished.attribute("/", "number", 2);
    CHECK(read_number(folder / "a.h5") == 1);
  }
  CHECK(read_number(folder / "a.h5") == 1);
  write_number(folder / "a.h5", 3);
  CHECK(read_number(folder / "a.h5") == 3);
  CHECK(folder.entries() == 1);
}

TEST_CASE("result file: two files with the same path may be open") {
  const Folder folder;
  ResultFile first(folder / "a.h5"), second(folder / "a.h5");
  first.attribute("/", "number", 1.0);
  second.attribute("/", "number", 2.0);
  second.commit();
  first.commit();
  CHECK(read_number(folder / "a.h5") == 1);
}

TEST_CASE("result file: a full disk is an IoError and keeps the old file") {
  const Folder folder;
  write_number(folder / "a.h5", 1);
  ResultFile file(folder / "a.h5");
  file.dataset("noise", noise(10'000), {std::size_t{10'000}}, "", "");
  {
    const FullDisk disk(20'000);
    CHECK_THROWS_AS(file.commit(), IoError);
  }
  CHECK(read_number(folder / "a.h5") == 1);
  CHECK(folder.entries() == 1);
}

TEST_CASE("result file: a dataset written in blocks is read back, in memory and on disk") {
  const Folder folder;
  std::vector<Complex> values(2 * 5 * 7);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = {static_cast<double>(i), -1};
  const std::span<const Complex> none;
  for (const auto storage : {ResultFile::Storage::memory, ResultFile::Storage::disk}) {
    ResultFile file(folder / "blocks.h5", storage);
    file.scale("a", std::vector<double>{0, 1}, "1", "");
    file.scale("b", std::vector<double>(5, 1.0), "1", "");
    file.scale("c", std::vector<double>(7, 1.0), "1", "");
    file.begin_dataset("u", none, {"a", "b", "c"}, {1, 4, 64}, "1", "blocks");
    for (const std::size_t first : {3, 0})  // rows 3 and 4, then 0 to 2 of b
      for (const std::size_t a : {0, 1}) {
        const std::size_t count = first == 0 ? 3 : 2;
        file.write_block("u",
                         std::span<const Complex>(values).subspan(7 * (5 * a + first), 7 * count),
                         {a, first}, {1, count});
      }
    CHECK_THROWS_AS(file.write_block("u", values, {0, 0, 0}, {1, 1, 1}), std::logic_error);
    CHECK_THROWS_AS(file.begin_dataset("u", none, {"a"}, {1}, "1", ""), std::logic_error);
    file.commit();
    const ResultReader reader(folder / "blocks.h5");
    CHECK(reader.dataset<Complex>("u") == values);
    CHECK(folder.entries() == 1);
  }
}

TEST_CASE("result file: blocks of all types and a generated scale are read back") {
  const Folder folder;
  constexpr std::size_t count = 20'000;  // more than are written at once
  CollectedResult collected;
  const auto write = [&](ResultFile& file) {
    file.scale(
        "x", count, [](std::size_t i) { return 0.5 * static_cast<double>(i); }, "1", "");
    file.begin_dataset("n", std::span<const std::uint64_t>(), {"x"}, {7000}, "1", "");
    file.begin_dataset("word", std::span<const std::string>(), {"x", std::size_t{2}}, {7000}, "",
                       "");
    for (std::size_t first = 0; first < count; first += 7000) {
      const std::size_t points = std::min<std::size_t>(7000, count - first);
      const std::vector<std::uint64_t> numbers(points, first);
      const std::vector<std::string> words(2 * points, std::to_string(first));
      file.write_block("n", std::span(numbers), {first}, {points});
      file.write_block("word", std::span(words), {first}, {points});
    }
  };
  ResultFile in_memory(collected), file(folder / "blocks.h5", ResultFile::Storage::disk);
  write(in_memory);
  write(file);
  file.commit();
  const ResultReader reader(folder / "blocks.h5");
  const auto x = reader.dataset<double>("x"), n = reader.dataset<double>("n");
  CHECK(x[19'999] == 0.5 * 19'999);
  CHECK(x == std::get<0>(collected.find("x")->values));
  const auto& numbers = std::get<2>(collected.find("n")->values);
  CHECK(numbers[13'999] == 7000);
  CHECK(std::ranges::equal(n, numbers));
  CHECK(std::get<3>(collected.find("word")->values)[2 * 14'000 - 1] == "7000");
}

TEST_CASE("result file: without commit or disk space the old file remains alone") {
  const Folder folder;
  write_number(folder / "a.h5", 1);
  const std::vector<Complex> row(100'000, Complex(0.1, 0.2));
  {
    ResultFile file(folder / "a.h5", ResultFile::Storage::disk);
    file.dataset("u", row, {row.size()}, "1", "");
    CHECK(folder.entries() == 2);
  }
  CHECK(folder.entries() == 1);
  {
    const FullDisk full(1'500'000);
    ResultFile file(folder / "a.h5", ResultFile::Storage::disk);
    CHECK_THROWS_AS(file.dataset("u", row, {row.size()}, "1", ""), IoError);
  }
  CHECK(read_number(folder / "a.h5") == 1);
  CHECK(folder.entries() == 1);
}

TEST_CASE("result file: an unwritable path is an InputError at once") {
  const Folder folder;
  std::ofstream(folder / "file") << "text";
  CHECK_THROWS_AS(check_writable(folder / "missing" / "a.h5"), InputError);
  CHECK_THROWS_AS(check_writable(folder / "file" / "a.h5"), InputError);
  CHECK_THROWS_AS(check_writable(folder / ""), InputError);
  CHECK_THROWS_AS(check_writable(fs::temp_directory_path()), InputError);
  CHECK_THROWS_AS(check_writable("/dev/null"), InputError);
  CHECK_THROWS_AS(ResultFile(folder / "missing" / "a.h5").commit(), IoError);
  check_writable(folder / "a.h5");
  check_writable(folder / "file");
  CHECK(folder.entries() == 1);
}

TEST_CASE("result file: temporary files of killed processes are removed") {
  const Folder folder;
  const char* const others[] = {".a.h5.tmp-x", ".b.h5.tmp-1", ".a.h5.tmp", "a.h5.tmp-1"};
  for (const char* name : {".a.h5.tmp-1", ".a.h5.tmp-4194304"}) std::ofstream(folder / name) << "1";
  for (const char* name : others) std::ofstream(folder / name) << "1";
  remove_temporary_files(folder / "a.h5");
  CHECK(folder.entries() == std::size(others));
  for (const char* name : others) CHECK(fs::exists(folder / name));
}

TEST_CASE("result file: a file on disk is checksummed like one in memory") {
  const Folder folder;
  ResultFile file(folder / "a.h5", ResultFile::Storage::disk);
  file.dataset("noise", noise(200'000), {std::size_t{200'000}}, "", "");
  file.commit_checksummed(Durable::no);
  CHECK(is_checksummed(folder / "a.h5"));
  CHECK(ResultReader(folder / "a.h5").dataset<double>("noise") == noise(200'000));
}

TEST_CASE("result file: a folder removed before commit() is an IoError") {
  const Folder folder;
  fs::create_directory(folder / "sub");
  ResultFile file(folder / "sub" / "a.h5");
  fs::remove(folder / "sub");
  CHECK_THROWS_AS(file.commit(), IoError);
}

TEST_CASE("result reader: missing, foreign, truncated and damaged files are rejected") {
  const Folder folder;
  CHECK_THROWS_AS(ResultReader(folder / "missing.h5"), InputError);
  std::ofstream(folder / "foreign.h5") << "x,z\n1,2\n";
  CHECK_THROWS_AS(ResultReader(folder / "foreign.h5"), InputError);

  ResultFile file(folder / "a.h5");
  file.dataset("noise", noise(10'000), {std::size_t{10'000}}, "", "");
  file.commit();
  const auto size = fs::file_size(folder / "a.h5");
  fs::copy_file(folder / "a.h5", folder / "truncated.h5");
  fs::resize_file(folder / "truncated.h5", size - 100);
  CHECK_THROWS_AS(ResultReader(folder / "truncated.h5"), InputError);

  std::fstream damaged(folder / "a.h5", std::ios::in | std::ios::out | std::ios::binary);
  damaged.seekp(static_cast<std::streamoff>(size / 2));
  damaged << "damaged";
  damaged.close();
  CHECK_THROWS_AS(ResultReader(folder / "a.h5").dataset<double>("noise"), InputError);
}

TEST_CASE("result reader: missing datasets and wrong types are an InputError") {
  const Folder folder;
  const std::vector<double> x{1.5, 2};
  ResultFile file(folder / "a.h5");
  file.dataset("x", x, {x.size()}, "m", "");
  file.attribute("/", "x", 1.5);
  file.attribute("/", "list", x);
  file.commit();
  const ResultReader reader(folder / "a.h5");
  CHECK_THROWS_AS(reader.dataset<double>("y"), InputError);
  CHECK_THROWS_AS(reader.shape("group/y"), InputError);
  CHECK_THROWS_AS(reader.dataset<double>("/"), InputError);
  CHECK_THROWS_AS(reader.dataset<Complex>("x"), InputError);
  CHECK_THROWS_AS(reader.attribute<double>("/", "y"), InputError);
  CHECK_THROWS_AS(reader.attribute<double>("y", "x"), InputError);
  CHECK_THROWS_AS(reader.attribute<std::uint64_t>("/", "x"), InputError);
  CHECK_THROWS_AS(reader.attribute<std::string>("/", "x"), InputError);
  CHECK_THROWS_AS(reader.attribute<double>("/", "list"), InputError);
}

TEST_CASE("run state: read back bit for bit, and continued like one never written") {
  const Folder folder;
  const std::size_t size = 37;
  const std::vector<double> values = noise(2 * size * 300);
  const auto add = [&](GroupedSums& sums, std::size_t first, std::size_t last) {
    for (std::size_t batch = first; batch < last; ++batch) {
      std::vector<Complex> batch_sums(size);
      for (std::size_t i = 0; i < size; ++i)
        batch_sums[i] = {values[2 * (batch * size + i)], -values[2 * (batch * size + i) + 1]};
      sums.add(values[batch], batch_sums);
    }
  };
  RunState state{
      GroupedSums(size), {{1, 2, 3}, {4, 8, 12}, {10, 20, 30}, {infinity, 0.5, 0.25}}, 3.5, 13.25};
  add(state.sums, 0, 290);
  ResultFile file(folder / "state.h5");
  write_state(file, "state", state);
  file.commit();

  const ResultReader reader(folder / "state.h5");
  RunState restored = read_state(reader, "state", size);
  CHECK(restored.sums.state().samples == state.sums.state().samples);
  CHECK(restored.sums.state().sums == state.sums.state().sums);
  CHECK(restored.wall_s == 3.5);
  CHECK(restored.cpu_s == 13.25);
  CHECK(restored.trace.wall_s == std::vector<double>{2, 3});
  CHECK(restored.trace.cpu_s == std::vector<double>{8, 12});
  CHECK(restored.trace.samples == std::vector<double>{20, 30});
  CHECK(restored.trace.relative_error == std::vector<double>{0.5, 0.25});

  add(state.sums, 290, 300);
  add(restored.sums, 290, 300);
  CHECK(restored.sums.batches() == 300);
  CHECK(restored.sums.state().sums == state.sums.state().sums);
  CHECK_THROWS_AS(read_state(reader, "state", size + 1), InputError);
  CHECK_THROWS_AS(read_state(reader, "other", size), InputError);
}

TEST_CASE("provenance: is read back from the result") {
  const Folder folder;
  const Provenance provenance{"flatspeckle solve --seed 18446744073709551615",
                              "seed = 1\n",
                              std::numeric_limits<std::uint64_t>::max(),
                              "far field",
                              3,
                              utc_now(),
                              1.5,
                              4.5,
                              1e6,
                              true};
  ResultFile file(folder / "a.h5");
  write_provenance(file, provenance);
  file.commit();
  const ResultReader reader(folder / "a.h5");
  const auto text = [&](const char* name) { return reader.attribute<std::string>("/", name); };
  CHECK(text("program") == "flatspeckle");
  CHECK(text("version").find('.') != std::string::npos);
  CHECK_FALSE(text("git_commit").empty());
  CHECK(text("command_line") == provenance.command_line);
  CHECK(text("config") == provenance.config);
  CHECK(text("plan") == "far field");
  CHECK(text("machine").find(" cores") != std::string::npos);
  CHECK(text("started").size() == 20);
  CHECK(text("started").back() == 'Z');
  CHECK(reader.attribute<std::uint64_t>("/", "seed") == provenance.seed);
  CHECK(reader.attribute<double>("/", "threads") == 3);
  CHECK(reader.attribute<double>("/", "wall_s") == 1.5);
  CHECK(reader.attribute<double>("/", "cpu_s") == 4.5);
  CHECK(reader.attribute<double>("/", "samples") == 1e6);
  CHECK(reader.attribute<bool>("/", "converged"));
}

}  // namespace flatspeckle::test_result_file
