#!/usr/bin/env bash
# Opens the report of a plan, and pages of other documents, in Debian's Chromium and holds them to what they must show and do:
# report_page.sh PLAN.html [PAGE.html…]. Screenshots and printed pages go to the folder $SHOTS, if it is set. Needs Node.js 20 or newer and the npm registry; Chromium is installed where it is absent.
set -euo pipefail
pages=()
for page in "$@"; do pages+=("$(realpath "$page")"); done
export SHOTS="${SHOTS:+$(realpath -m "$SHOTS")}"
cd "$(dirname "$0")/report_page"
if [ ! -x "${CHROMIUM:-/usr/bin/chromium}" ]; then
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends chromium >/dev/null
fi
npm ci --no-audit --no-fund --silent
node timeline.mjs
node check.mjs "${pages[0]}"
if [ ${#pages[@]} -gt 1 ]; then node document.mjs "${pages[@]:1}"; fi
