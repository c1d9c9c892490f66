#!/bin/sh
# The reference of the library's modules by FORD (settings in fpm.toml), into build/docs. The front page is README.md.
#
# usage: tools/docs.sh

set -u
cd "$(dirname "$0")/.." || exit 1
page=README.md
rm -rf build/docs
build/tools/bin/ford $page >build/docs.log 2>&1 || { cat build/docs.log; exit 1; }
grep -i warning build/docs.log
# What the front page links to: pages, pictures, header, examples; each link is looked up.
for it in docs example hosts include scenes share bench CHANGELOG.md CONTRIBUTING.md CMakeLists.txt LICENSE SECURITY.md; do
   [ ! -e "$it" ] || cp -R "$it" build/docs/
done
dead=$(grep -o '](\([^)#]*\)' "$page" | sed 's/^](//' | grep -v '^[a-z]*:' | sort -u | while IFS= read -r link; do
   [ -e "build/docs/$link" ] || echo "   $link"
done)
[ -z "$dead" ] || { printf 'docs: dead links of the front page:\n%s\n' "$dead"; exit 1; }
echo "docs: build/docs/index.html"
