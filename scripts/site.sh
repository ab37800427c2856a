#!/usr/bin/env bash
# Installs missing packages (Debian 12) and builds the site of the guides: scripts/site.sh [FOLDER],
# build/site by default.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_missing python3-sphinx python3-myst-parser furo doxygen
python3 scripts/site_pages.py "${1:-build/site}"
