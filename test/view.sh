#!/usr/bin/env bash
# The page of a motion in a headless Chromium: it reports itself ready, its own checks hold, nothing is said on the console,
# nothing leaves it, and no name can break it. Ends with "N passed, M failed"; exit code 77 without Chromium.
#
# usage: test/view.sh [APP]        the app, build/stage/bin/poinsot if not named
cd "$(dirname "$0")/.." || exit 1
app=${1:-$PWD/build/stage/bin/poinsot}
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || { echo "skipped: no Chromium"; exit 77; }
out=$PWD/build/view-test
rm -rf "$out"; mkdir -p "$out"
passed=0 failed=0

result() { # name, state, what
   if [ "$2" = 0 ]; then passed=$((passed + 1)); word=PASSED; else failed=$((failed + 1)); word=FAILED; fi
   echo "       ... $1 [$word]${3:+  $3}"
}

# The page after three seconds of its time, on standard output; the browser's own words in $out/log.
open_page() { # file, query, more options
   profile=$(mktemp -d)
   timeout 60 "$browser" --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking \
      --disable-component-update --disable-sync --user-data-dir="$profile" --window-size=1240,1100 --virtual-time-budget=3000 \
      --enable-logging=stderr --v=0 --log-net-log="$out/net.json" $3 --dump-dom "file://$1$2" 2>"$out/log"
   rm -rf "$profile"
}

quiet_page() { # name, file, query: ready, no console, no request
   open_page "$2" "$3" >"$out/dom.html"
   grep -q 'data-ready="yes"' "$out/dom.html"; result "$1-ready" $?
   ! grep -E 'CONSOLE' "$out/log"; result "$1-console" $?
   ! requests | grep -F -f "$out/kinds" >"$out/requests"; result "$1-no-request" $? "$(head -c 200 "$out/requests")"
}

# What kind of request and where to, of a page and of the browser itself, whose own come and go.
requests() { grep -oE '"traffic_annotation":[0-9]+,"url":"(https?|wss?|ftp)://[^/"]*' "$out/net.json" | sort -u; }

at_most() { awk -v value="$1" -v bound="$2" 'BEGIN { exit !(value != "" && value + 0 <= bound) }'; }

# The kinds that a page makes, from one that does make them.
cat >"$out/asking.html" <<'END'
<!doctype html><link rel="icon" href="data:,"><script src="http://page.invalid/a"></script><img src="http://page.invalid/b">
<script>fetch("http://page.invalid/").catch(() => 0); new WebSocket("ws://page.invalid/")</script>
END
open_page "$out/asking.html" "" >/dev/null
requests | grep 'page\.invalid' | grep -oE '"traffic_annotation":[0-9]+,' | sort -u >"$out/kinds"
[ -s "$out/kinds" ]; result requests-are-seen $?

for scene in free-body tennis-racket heavy-top satellite gyrostat rotating-field dipole-chain thermostat sleeping-top large-ensemble; do
   "$app" run $scene --out "$out/$scene" --no-pictures --quiet
   page=$out/$scene/view.html
   quiet_page $scene "$page" "?t=3"
   size=$(wc -c <"$page"); at_most "$size" 310000; result $scene-size $? "$size bytes"
   case $scene in free-body | tennis-racket)
      height=$(sed -n 's/.*data-height="\([^"]*\)".*/\1/p' "$out/dom.html"); at_most "$height" 1e-5; result $scene-height $? "$height"
      slide=$(sed -n 's/.*data-slide="\([^"]*\)".*/\1/p' "$out/dom.html"); at_most "$slide" 1e-2; result $scene-contact-at-rest $? "$slide" ;;
   esac
done

# A name that would end a text, an element, or run something.
evil='q"</script><b>`touch OWNED`$(touch OWNED)'"'"
mkdir -p "$out/evil"
sed 's/free body/free/' scenes/free-body.nml >"$out/evil/$(echo "$evil" | tr '/' '_').nml"
(cd "$out/evil" && "$app" run ./*.nml --out "$out/evil/run" --quiet)
quiet_page names "$out/evil/run/view.html" ""
[ -z "$(find "$out" -name OWNED)" ]; result names-run-nothing $?
grep -q '<h1 id="title">q"&lt;_script&gt;' "$out/dom.html"; result names-shown $?

# Made anew: the same bytes. A phone's width.
cp "$out/free-body/view.html" "$out/before.html"
"$app" view "$out/free-body" >"$out/said"
cmp -s "$out/before.html" "$out/free-body/view.html" && grep -qx "$out/free-body/view.html" "$out/said"; result made-anew $?
open_page "$out/free-body/view.html" "?t=3" --window-size=390,1400 >"$out/dom.html"
grep -q 'data-ready="yes"' "$out/dom.html"; result phone-ready $?

printf '\n%d passed, %d failed\n' $passed $failed
[ $failed -eq 0 ]
