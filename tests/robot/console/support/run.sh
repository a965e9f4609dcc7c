#!/bin/bash
# The browser tests beside the packages of the page, which are in the build tree. Exit code 4 where a test asks for what
# the page cannot give at any pace, so that no stall of the host excuses it.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p tests
rm -rf tests/*.ts tests/support
cp "$here"/*.ts tests/
cp -r "$here/support" tests/
export BASELINES="$here/baselines" SOURCE="$here/../../.."
said=$(mktemp)
trap 'rm -f "$said"' EXIT
./node_modules/.bin/playwright test -c tests/support/playwright.config.ts "$@" | tee "$said" && exit 0
! grep -qE 'strict mode violation|SyntaxError|ReferenceError|TypeError' "$said" || exit 4
exit 1
