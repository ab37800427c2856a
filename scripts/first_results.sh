#!/usr/bin/env bash
# first_results.sh PROGRAM FOLDER [STEP...]: runs the program on shipped data and scenes and writes results and plots to
# FOLDER. Steps: slab (memory-effect curves), both_methods (Monte Carlo against the exact solver), ten_disks (exact
# fields against references); all of them by default.
set -euo pipefail
flatspeckle=$(realpath "$1")
results=$(realpath -m "$2")
steps=("${@:3}")
[[ ${#steps[@]} -gt 0 ]] || steps=(slab both_methods ten_disks)
PATH=/usr/bin:$PATH  # Debian's python3, which has h5py and matplotlib
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p "$results/ten_disks"

say() { printf '\n== %s\n' "$*"; }

drawing=()
draw() {  # PLOT RESULT PREFIX: runs in the background
  python3 "plots/$1.py" "$2" --out "$3" & drawing+=($!)
}

reference=data/reference/g10

solve_and_compare() {  # KIND FLAG...: KIND is part of the names of the reference tables
  local kind=$1 result=$results/ten_disks/$1.h5 sensors=$results/ten_disks/sensors_$1.csv
  awk -F, '{ print $2 "," $3 }' "$reference/nearfield_$kind.csv" > "$sensors"
  "$flatspeckle" solve --placement "$reference/placement.csv" "${@:2}" \
    --light_angles 0 0.7 2.5 --view_angles "${views[@]}" --near_sensors "$sensors" --out "$result"
  python3 scripts/compare_reference.py "$result" "$reference"/{far,near}"field_$kind.csv"
}

ten_disks() {
  say "Ten disks of different sizes: exact fields against those of an independent program"
  mapfile -t views < <(awk -F, 'NR > 1 && $1 == 0 { print $2 }' "$reference/farfield_D.csv")
  solve_and_compare D --scatterer soft
  solve_and_compare N --scatterer hard
  solve_and_compare TM15 --scatterer tm --index 1.5
  solve_and_compare TE15abs --scatterer te --index 1.5+0.1i
}

both_methods() {
  say "Resonant points in a box: Monte Carlo against the exact solver, entry by entry"
  "$flatspeckle" validate --config data/scenes/box_points.toml --out "$results/box_points.h5"
  draw validation "$results/box_points.h5" "$results/validation"
  draw error_time "$results/box_points.h5" "$results/error_time"
}

slab() {
  say "A slab of Henyey-Greenstein scatterers: memory effect over g and albedo"
  "$flatspeckle" sweep --config data/scenes/slab_hg.toml --out "$results/slab_hg.h5"
  draw memory_effect "$results/slab_hg.h5" "$results/memory_effect"
}

for step in "${steps[@]}"; do "$step"; done
for plot in "${drawing[@]}"; do wait "$plot"; done
