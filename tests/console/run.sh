#!/bin/sh
# The browser tests beside the packages of the page, which are in the build tree.
set -eu
here=$(dirname "$0")
mkdir -p tests
cp "$here"/*.ts tests/
exec ./node_modules/.bin/playwright test -c tests "$@"
