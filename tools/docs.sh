#!/bin/sh
# The reference of the library's modules by FORD (settings in fpm.toml), into build/docs, with the pages of docs/, the header and the
# examples. The front page is README.md.
#
# usage: tools/docs.sh

set -u
cd "$(dirname "$0")/.." || exit 1
page=README.md
rm -rf build/docs
build/tools/bin/ford $page >build/docs.log 2>&1 || { cat build/docs.log; exit 1; }
# A docstring that begins with a word and a colon is taken for a setting, and lost.
if grep -i -A 1 warning build/docs.log; then echo "docs: see build/docs.log"; exit 1; fi
# What the front page links to: pages, pictures, header, examples; each link is looked up.
for it in docs example hosts include scenes share bench CHANGELOG.md CONTRIBUTING.md CMakeLists.txt LICENSE SECURITY.md CITATION.cff; do
   [ ! -e "$it" ] || cp -R "$it" build/docs/
done
dead=$(grep -o '](\([^)#]*\)' "$page" | sed 's/^](//' | grep -v '^[a-z]*:' | sort -u | while IFS= read -r link; do
   [ -e "build/docs/$link" ] || echo "   $link"
done)
[ -z "$dead" ] || { printf 'docs: dead links of the front page:\n%s\n' "$dead"; exit 1; }
PYTHONPATH=build/tools/ford "${PYTHON:-python3}" tools/docs_pages.py build/docs build/docs/index.html || exit 1
echo "docs: build/docs/index.html"
