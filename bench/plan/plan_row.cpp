#include "bench/plan/plan_row.h"

#include <utility>

#include "bench/plan/plan_rooms.h"

namespace flatspeckle::bench {

std::vector<PlanCase> plan_cases() {
  std::vector<PlanCase> cases;
  for (const auto& room :
       {mc_plan_cases, transport_plan_cases, field_plan_cases, fit_plan_cases, imaging_plan_cases,
        wave_plan_cases, ray_plan_cases, render_plan_cases, design_plan_cases})
    for (PlanCase& plan_case : room()) cases.push_back(std::move(plan_case));
  return cases;
}

PlanCase named(const std::string& room, const std::string& left_out, const std::string& scene,
               const std::function<PlanRow(double)>& run) {
  return {room, left_out, scene, [=](double cpu_seconds) {
            PlanRow row = run(cpu_seconds);
            row.room = room;
            row.left_out = left_out;
            row.scene = scene;
            return row;
          }};
}

bool passes(const PlanRow& row) {
  return row.difference <= row.limit;
}

}  // namespace flatspeckle::bench
