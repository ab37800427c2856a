#pragma once

#include <cstddef>
#include <string>

namespace flatspeckle {

/// Makes SIGINT, SIGTERM, SIGHUP and SIGXCPU (processor time exceeded) end the program at once with
/// exit status 130. Writing to a closed pipe or beyond a limit on file sizes fails, but does not
/// end the program. SIGUSR1, which batch systems send shortly before they end a program, is
/// ignored.
void set_signals();

/// Makes SIGINT, SIGTERM, SIGHUP, SIGXCPU and SIGUSR1 set the flag that interrupted() returns, so
/// that runs end after their current batches. A second signal, except SIGXCPU, ends the program at
/// once.
void catch_interrupts();

/// Registers a file to be removed if a signal ends the program (exit status 130) during the
/// lifetime of this object.
class RemovedIfEnded {
 public:
  explicit RemovedIfEnded(const std::string& path);
  RemovedIfEnded(const RemovedIfEnded&) = delete;
  RemovedIfEnded& operator=(const RemovedIfEnded&) = delete;
  ~RemovedIfEnded();

 private:
  std::size_t place_;
};

/// During the lifetime of this object, signals do not end the program at once but only afterwards,
/// so that a file and its registration by RemovedIfEnded can be changed together.
class DelayedTermination {
 public:
  DelayedTermination();
  DelayedTermination(const DelayedTermination&) = delete;
  DelayedTermination& operator=(const DelayedTermination&) = delete;
  ~DelayedTermination();
};

/// Makes the program ignore signals that would end it at once. To be called at the end, when the
/// result is already written.
void ignore_termination_signals();

/// Whether a signal has arrived since catch_interrupts().
bool interrupted();

/// Exception of work that stops early because of a signal, such as a long batch, whose result is
/// then lost.
struct Interrupted {};
inline void stop_if_interrupted() {
  if (interrupted()) throw Interrupted{};
}

}  // namespace flatspeckle
