#!/bin/sh
# The browser tests beside the packages of the page, which are in the build tree.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p tests
rm -f tests/*.ts
cp "$here"/*.ts tests/
export BASELINES="$here/baselines"
exec ./node_modules/.bin/playwright test -c tests "$@"
