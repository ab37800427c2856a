#include "apps/sweep/sweep_ranks.h"

#include "core/run/interrupt.h"
#include "core/run/ranks.h"
#include "core/session/exit_status.h"

namespace flatspeckle::apps {

namespace {

int with_server(const std::function<int(RankServer*)>& lead) {
  RankServer server;
  try {
    const int status = lead(&server);
    server.dismiss();
    return status;
  } catch (...) {
    server.dismiss();
    leave_ranks();
    throw;
  }
}

}  // namespace

int on_all_ranks(const std::function<int(RankServer*)>& lead, const std::function<void()>& follow) {
  catch_interrupts();
  if (ranks().size == 1) return lead(nullptr);
  int status = ExitStatus::done;
  if (ranks().rank == 0)
    status = with_server(lead);
  else
    follow();
  leave_ranks();
  return status;
}

}  // namespace flatspeckle::apps
