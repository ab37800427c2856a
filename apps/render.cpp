#include "apps/render_output.h"
#include "apps/subcommands.h"
#include "core/session/identity.h"
#include "core/session/session.h"
#include "grin/scene/render_values.h"

namespace flatspeckle::apps {

int render(const Arguments& arguments) {
  grin::RenderValues values;
  grin::RenderRequestValues request_values;
  RunSettings run;
  Subcommand command("render",
                     "Pictures of scattering media with a gradient index, in space: radiance that "
                     "curves and scatters");
  Keys& keys = command.keys();
  add_keys(keys, values);
  add_keys(keys, request_values);
  add_run_keys(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;

  Session session(command.text(), keys, run, command.only_prints());
  const StopRule stop = stop_rule(keys, run);
  const grin::RenderRequest request = make_render_request(keys, request_values);
  const grin::RenderScene scene = make_render_scene(keys, values);
  check(scene, request);
  if (!command.settle()) return ExitStatus::done;
  const grin::RenderJob job = render_job(scene, request, session.seed());
  return session.run("render: " + request_values.method + ": " + job.plan,
                     {{"", "render", job.batches, stop}}, inputs_text(keys), [&](ResultFile& file) {
                       const RenderResult result = render_result(scene, job, session.sums(""));
                       print_render(scene, job, result);
                       write_render(file, scene, job, result, scene.length_unit);
                     });
}

}  // namespace flatspeckle::apps
