#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <malloc.h>
#include <new>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/resource.h>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "apps/command/subcommands.h"
#include "core/error.h"
#include "core/numbers/blas.h"
#include "core/result/version.h"
#include "core/run/interrupt.h"
#include "core/run/ranks.h"

namespace {

using namespace flatspeckle;
using namespace flatspeckle::apps;

/// Lets the process keep the memory that it frees. By default, temporaries of some megabytes are
/// returned to the system and fetched again, which takes a third of the time of `reflectance` and
/// a quarter of that of `matrix`.
void keep_freed_memory() {
#ifdef M_TRIM_THRESHOLD
  constexpr int largest_kept = 1 << 29, largest_on_heap = 1 << 25;
  mallopt(M_TRIM_THRESHOLD, largest_kept);
  mallopt(M_MMAP_THRESHOLD, largest_on_heap);
#endif
}

/// Returns the name of the OpenBLAS kernel that suits this processor if OpenBLAS has chosen its
/// oldest kernel instead; otherwise nullptr.
const char* better_kernel() {
  constexpr std::string_view oldest = "Prescott";
  if (openblas_get_corename() != oldest) return nullptr;
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    return "SkylakeX";
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
#endif
  return nullptr;
}

/// Sets an environment variable, unless it is already set or `value` is nullptr. Returns whether
/// this call has set it.
bool set(const char* variable, const char* value) {
  return value != nullptr && std::getenv(variable) == nullptr && ::setenv(variable, value, 0) == 0;
}

/// If OpenBLAS has chosen its oldest kernel, restarts the program with the environment variable
/// OPENBLAS_CORETYPE set to the right kernel. OpenBLAS selects its kernel when it is loaded and
/// does not recognise processors newer than itself; for them it uses the oldest kernel, which takes
/// two to three times as long. If the variable is already set, the program is not restarted.
void prepare_blas(char** argv) {
  // execv() returns only if it fails; the program then continues with the old kernel.
  if (set("OPENBLAS_CORETYPE", better_kernel())) ::execv("/proc/self/exe", argv);
}

/// If the address space is limited (ulimit -v), restarts the program with the environment variable
/// OPENBLAS_NUM_THREADS = 1, unless it is already set. Otherwise the threads that OpenBLAS starts
/// when it is loaded may wait forever for memory, or OpenBLAS may end the program for lack of
/// memory. This function runs before libraries, including sanitizers, are initialised.
__attribute__((no_sanitize("address"), no_sanitize("thread"), no_sanitize("undefined"))) void
limit_blas_threads(int, char** argv, char** environment) {
  static char one_thread[] = "OPENBLAS_NUM_THREADS=1";
  constexpr std::size_t name_size = sizeof one_thread - 2;
  rlimit limit;
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  std::size_t size = 0;
  for (; environment[size] != nullptr; ++size)
    if (std::strncmp(environment[size], one_thread, name_size) == 0) return;
  const std::size_t bytes = (size + 2) * sizeof(char*);
  auto** const more = static_cast<char**>(__builtin_alloca(bytes));
  for (std::size_t i = 0; i < size; ++i) more[i] = environment[i];
  more[size] = one_thread;
  more[size + 1] = nullptr;
  ::execve("/proc/self/exe", argv, more);
}

[[gnu::section(".preinit_array"),
  gnu::used]] void (*const before_libraries)(int, char**, char**) = limit_blas_threads;

void print_usage() {
  std::puts(
      "flatspeckle - speckle statistics: path-space Monte Carlo checked by an exact wave solver\n\n"
      "  flatspeckle SUBCOMMAND [--config SCENE.toml] [--key value ...] --out FILE.h5\n");
  for (const SubcommandEntry& entry : subcommands())
    std::printf("  %-12s %s\n", entry.name, entry.purpose);
  std::puts(
      "\n  flatspeckle SUBCOMMAND --help lists the keys; flatspeckle --version prints the "
      "version.\n"
      "  Exit status: 0 done, 2 bad input, 3 stopped before the target error was reached,\n"
      "  4 input or output failed, 5 a row of a benchmark failed, 75 interrupted and resumable,\n"
      "  130 interrupted, nothing to resume.");
}

const SubcommandEntry& subcommand_named(const std::string& word) {
  std::string words;
  for (const SubcommandEntry& entry : subcommands()) {
    if (word == entry.name) return entry;
    words += std::string(" ") + entry.name;
  }
  throw InputError("subcommand", word, "must be one of" + words);
}

CallEnd run(const Arguments& arguments) {
  const std::string word = arguments.size() > 1 ? arguments[1] : "--help";
  if (word == "help" && arguments.size() > 2)
    return run_subcommand(subcommand_named(arguments[2]), {arguments[0], arguments[2], "--help"});
  if (word == "--help" || word == "-h" || word == "help") {
    print_usage();
    return {};
  }
  if (word == "--version") {
    std::cout << "flatspeckle " << version() << " (" << git_commit() << ")\n";
    return {};
  }
  const SubcommandEntry& subcommand = subcommand_named(word);
  if (word != "sweep" && launched_ranks().size > 1)
    throw InputError("subcommand", word, "must run as one process; only sweep uses several (MPI)");
  return run_subcommand(subcommand, arguments);
}

/// Returns the text, in which the middle (usually a long value) is replaced by " ... " if the text
/// is long.
std::string shortened(const std::string& what) {
  constexpr std::size_t most = 400, end = 150;
  if (what.size() <= most) return what;
  return what.substr(0, most - end) + " ... " + what.substr(what.size() - end);
}

/// Prints an error as one line and returns the exit status. Control characters, which may come from
/// files or flags, are replaced by '?'. If all MPI processes fail with the same input error, only
/// the first prints it.
int fail(std::string what, int status) {
  if (status == ExitStatus::bad_input && launched_ranks().rank > 0) {
    // gives rank 0 time to print the error and end all processes
    std::this_thread::sleep_for(std::chrono::seconds(1));
    return status;
  }
  what = shortened(what);
  std::replace_if(
      what.begin(), what.end(), [](unsigned char c) { return std::iscntrl(c); }, '?');
  std::cerr << "flatspeckle: " << what << '\n';
  return status;
}

/// Returns the exit status of the call. If writing to the standard output has failed, prints an
/// error, and returns 1 unless the call has also written a result file. It is no error if the
/// output is closed or a pipe without reader.
int with_written_output(const CallEnd& end) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return end.status;
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  ::poll(&output, 1, 0);
  if ((output.revents & (POLLERR | POLLNVAL)) != 0) return end.status;
  return fail("the standard output cannot be written: is its device full?",
              end.has_result ? end.status : 1);
}

/// Prints the error and exits at once, without destructors. Used if memory or disk space has run
/// out, because the cleanup of libraries may then crash.
[[noreturn]] void fail_at_once(const std::string& what, int status) {
  fail(what, status);
  std::_Exit(status);
}

}  // namespace

int main(int argc, char** argv) {
  prepare_blas(argv);
  keep_freed_memory();
  set_signals();
  try {
    return with_written_output(run({argv, argv + argc}));
  } catch (const InputError& error) {
    return fail(error.what(), ExitStatus::bad_input);
  } catch (const IoError& error) {
    fail_at_once(error.what(), ExitStatus::io_failed);
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(error.what(), ExitStatus::io_failed);
  } catch (const std::bad_alloc&) {
    fail_at_once("this scene needs more memory than is available: reduce its size",
                 ExitStatus::bad_input);
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::resource_unavailable_try_again) return fail(error.what(), 1);
    return fail("no thread can be started, probably for lack of memory: reduce threads",
                ExitStatus::bad_input);
  } catch (const Interrupted&) {
    return ExitStatus::interrupted_for_good;
  } catch (const std::exception& error) {
    return fail(error.what(), 1);
  }
}
