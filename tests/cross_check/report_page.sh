#!/usr/bin/env bash
# Opens a report in Debian's Chromium and holds it to what it must show and do: report_page.sh PAGE.html [FOLDER].
# Screenshots and the printed page go to FOLDER. Needs Node.js 20 or newer and the npm registry; Chromium is installed where it is absent.
set -euo pipefail
page="$(realpath "$1")"
folder="${2:+$(realpath -m "$2")}"
cd "$(dirname "$0")/report_page"
if [ ! -x "${CHROMIUM:-/usr/bin/chromium}" ]; then
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends chromium >/dev/null
fi
npm ci --no-audit --no-fund --silent
exec node check.mjs "$page" ${folder:+"$folder"}
