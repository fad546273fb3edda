#!/usr/bin/env bash
# Shows whether a change keeps the bytes of the results: eight simulations (five controllers, with noise, dead time and
# lag among them, steps of 0.1 and 1 s) and the paper's tests, as SHA-256 of every table.
#
#   tests/bytes.sh BINARY DIR            runs all of it with BINARY, results below DIR, and prints the sums
#   tests/bytes.sh BINARY DIR --check    the same, compared with tests/data/bytes.sha256; exit code 1 where they differ
#   tests/bytes.sh BINARY DIR --update   the same, and makes them the sums to compare with
#
# Takes about a minute on two cores. Needs SUMO 1.28.0 and sumo-rl below .sumo/ (make setup-test).
set -euo pipefail
[ $# -ge 2 ] || { sed -n '2,/^set/{/^#/p}' "$0" >&2; exit 1; }
binary=$(realpath "$1")
mkdir -p "$2"
out=$(realpath "$2")
cd "$(dirname "$0")/.."
recorded=tests/data/bytes.sha256
foreign=$(echo .sumo/sumo-rl/lib/python3*/site-packages/sumo_rl/nets/RESCO)
SUMO_HOME=$(echo "$PWD"/.sumo/1.28.0/lib/python3*/site-packages/sumo)
export SUMO_HOME

sum() { # FILE: its sum and its name below DIR
    [ ! -e "$out/$1" ] || (cd "$out" && sha256sum "$1")
}

run() { # NAME ARGUMENTS...
    local name=$1 table
    shift
    "$binary" run "$@" --force -q -o "$out/$name" >/dev/null
    for table in vehicles edges sample trace; do sum "$name/$table.csv"; done
}

all() {
    run straight scenarios/straight.toml --controller classic --trace all
    run racing scenarios/racing.toml --controller pid --trace all
    run cologne1 "$foreign/cologne1/cologne1.sumocfg" --controller ideal --end 25800
    run motorway scenarios/motorway.toml --controller calibrating --set noise.power_db=-6 --end 200
    run city_delay scenarios/city.toml --controller adaptive --end 200 \
        --set actuator.delay_s=0.1 --set actuator.lag_s=0.1 --set noise.power_db=-20
    run city scenarios/city.toml --controller adaptive
    run ingolstadt21 "$foreign/ingolstadt21/ingolstadt21.sumocfg" --controller classic --egos share:0.5 --end 58200
    run ingolstadt21_1s "$foreign/ingolstadt21/ingolstadt21.sumocfg" --controller pid --step-length 1 \
        --set actuator.delay_s=0.25 --end 59400
    "$binary" paper all -o "$out/paper" >/dev/null 2>&1
    sum paper/results.csv
}

all > "$out/sums"
case ${3:-} in
    --check) diff "$recorded" "$out/sums" && echo "all $(wc -l < "$recorded") tables have the recorded bytes" ;;
    --update) cp "$out/sums" "$recorded" ;;
    *) cat "$out/sums" ;;
esac
