#!/bin/sh
# The browser tests beside the packages of the page, which are in the build tree.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p tests
rm -rf tests/*.ts tests/support
cp "$here"/*.ts tests/
cp -r "$here/support" tests/
export BASELINES="$here/baselines" SOURCE="$here/../../.."
exec ./node_modules/.bin/playwright test -c tests "$@"
