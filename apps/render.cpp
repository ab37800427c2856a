#include "apps/render_output.h"
#include "apps/render_scene.h"
#include "apps/session.h"
#include "apps/subcommands.h"

namespace flatspeckle::apps {

int render(const Arguments& arguments) {
  RenderSpec spec;
  RunSettings settings;
  Subcommand command("render",
                     "Pictures of scattering media with a gradient index, in space: radiance that "
                     "curves and scatters");
  add_render_options(command.options(), spec);
  add_run_options(command.options(), settings);
  if (!command.parse(arguments)) return ExitStatus::done;

  const grin::RenderScene scene = make_render_scene(command, spec);
  const auto length_unit = length_unit_of(spec);
  const grin::RenderJob job = render_job(scene, make_render_request(spec), seed_of(settings));
  Session session(command.command_line(), settings, "render: " + spec.method + ": " + job.plan,
                  {{"", "render", job.batches, stop_rule(settings)}}, inputs_text(spec));
  return session.run([&](ResultFile& file) {
    const grin::RenderResult result = grin::render_result(scene, job, session.state("").sums);
    print_render(scene, job, result);
    grin::write_render(file, scene, job, result, length_unit);
  });
}

}  // namespace flatspeckle::apps
