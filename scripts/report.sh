#!/usr/bin/env bash
# report.sh [FOLDER]: installs missing packages (Debian 12), builds the program, and makes the
# report: error against time (bench error), extreme cases (bench stability), savings of plans (bench
# plan) and coverage of error bars (tests/apps/coverage.py). Result files, report.html, report.md
# with its pictures and numbers.json go to FOLDER, by default results/report in the checkout. Exit
# status 5: a row failed; the report shows which.
set -euo pipefail
report=${1:+$(realpath -m "$1")}
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
report=${report:-results/report}

install_build_packages
install_bench_packages
install_plot_packages
build_release flatspeckle -DFLATSPECKLE_TESTS=OFF -DFLATSPECKLE_BENCH=ON
mkdir -p "$report"

failed=0
for kind in stability plan error; do
  printf '\n== bench %s\n' "$kind"
  build/release/bin/flatspeckle bench "$kind" --out "$report/$kind.h5" || {
    status=$?
    [[ $status -eq 5 ]] || exit "$status"
    failed=$status
  }
done
printf '\n== coverage of error bars\n'
FLATSPECKLE=build/release/bin/flatspeckle FLATSPECKLE_DATA=data python3 -B tests/apps/coverage.py --out "$report/coverage.json" || failed=5
python3 plots/report.py "$report"/{error,stability,plan}.h5 --coverage "$report/coverage.json" --out "$report"
echo "Done in $SECONDS s."
exit "$failed"
