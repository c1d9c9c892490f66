#!/bin/sh
# The reference of the library's modules by FORD (settings in fpm.toml), into build/docs. The front page is README.md.
#
# usage: tools/docs.sh

set -u
cd "$(dirname "$0")/.." || exit 1
page=README.md
[ -f $page ] || page=CONTRIBUTING.md
rm -rf build/docs
build/tools/bin/ford $page >build/docs.log 2>&1 || { cat build/docs.log; exit 1; }
grep -i warning build/docs.log
echo "docs: build/docs/index.html"
