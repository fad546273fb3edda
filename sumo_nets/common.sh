# Sourced by every make.sh: finds the SUMO whose tools made the committed files, and cleans what they write.
# Networks are built by SUMO 1.15.0, the oldest supported version, because newer ones read older files but not the
# other way round. `make setup-test` installs it; MAKE_SUMO_HOME names another one.
set -euo pipefail
nets=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if [ -z "${MAKE_SUMO_HOME:-}" ]; then
    MAKE_SUMO_HOME=$(echo "$nets"/../.sumo/1.15.0/lib/python3*/site-packages/sumo)
fi
[ -x "$MAKE_SUMO_HOME/bin/netconvert" ] || { echo "no SUMO 1.15.0 in .sumo: run 'make setup-test' first" >&2; exit 1; }
export SUMO_HOME=$MAKE_SUMO_HOME
export LC_ALL=C PYTHONHASHSEED=0
bin=$SUMO_HOME/bin

# clean FILE...: removes the "generated on <date> by <path>" comments, which differ from machine to machine.
clean() {
    sed -i -e '/<!-- generated on/,/-->/d' -e '/^$/d' "$@"
}
