#!/usr/bin/env bash
# quickstart.sh [FOLDER]: installs what is missing (Debian 12), builds the program, and runs it on
# shipped data and scenes: exact fields against references, Monte Carlo against the exact solver, and
# memory-effect curves. Results and plots go to FOLDER, by default results/ in the checkout.
set -euo pipefail
results=${1:+$(realpath -m "$1")}
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
results=${results:-results}

install_build_packages
install_plot_packages
build_release flatspeckle -DFLATSPECKLE_TESTS=OFF -DFLATSPECKLE_BENCH=OFF
flatspeckle=build/release/bin/flatspeckle
mkdir -p "$results/ten_disks"

say() { printf '\n== %s\n' "$*"; }

say "Ten disks of different sizes, solved exactly, against an independent program's fields"
reference=data/reference/g10
mapfile -t views < <(awk -F, 'NR > 1 && $1 == 0 { print $2 }' "$reference/farfield_D.csv")
solve_and_compare() {  # KIND FLAG...: KIND as in the names of the reference's tables
  local kind=$1 result=$results/ten_disks/$1.h5
  cut -d, -f2,3 "$reference/nearfield_$kind.csv" > "$results/ten_disks/$kind.csv"  # x, z of its rows
  "$flatspeckle" solve --placement "$reference/placement.csv" "${@:2}" \
    --light_angles 0 0.7 2.5 --view_angles "${views[@]}" \
    --near_sensors "$results/ten_disks/$kind.csv" --out "$result"
  python3 scripts/compare_reference.py "$result" "$reference"/{far,near}"field_$kind.csv"
}
solve_and_compare D --scatterer soft
solve_and_compare N --scatterer hard
solve_and_compare TM15 --scatterer tm --index 1.5
solve_and_compare TE15abs --scatterer te --index 1.5+0.1i

say "Resonant points in a box: both methods, entry by entry"
"$flatspeckle" validate --config data/scenes/box_points.toml --out "$results/box_points.h5"

say "A slab of Henyey-Greenstein scatterers: memory effect over g and albedo"
"$flatspeckle" sweep --config data/scenes/slab_hg.toml --out "$results/slab_hg.h5"

say "Plots"
python3 plots/validation.py "$results/box_points.h5" --out "$results/validation"
python3 plots/error_time.py "$results/box_points.h5" --out "$results/error_time"
python3 plots/memory_effect.py "$results/slab_hg.h5" --out "$results/memory_effect"

say "Done in $SECONDS s; in $results:"
ls "$results" "$results/ten_disks"
