#!/usr/bin/env bash
# The straight road of the paper's step test: from rest, 10 m/s from s = 0, 20 m/s from s = 100 m to s = 900 m.
# steps.net.xml is the longer variant: 300 m each at 10, 20, 15, 25, 5, 15 m/s, then 20 m/s.
# One lane, no junction interior: the position on the route is s itself.
source "$(dirname "$0")/../common.sh"
cd "$(dirname "$0")"

# road NAME LENGTH:LIMIT...
road() {
    local name=$1 s=0 i=0 part; shift
    local nodes="<nodes><node id=\"n0\" x=\"0\" y=\"0\"/>" edges="<edges>"
    for part in "$@"; do
        s=$((s + ${part%%:*}))
        nodes+="<node id=\"n$((i + 1))\" x=\"$s\" y=\"0\"/>"
        edges+="<edge id=\"s$((s - ${part%%:*}))\" from=\"n$i\" to=\"n$((i + 1))\" numLanes=\"1\" speed=\"${part##*:}\" length=\"${part%%:*}\"/>"
        i=$((i + 1))
    done
    echo "$nodes</nodes>" > "$name.nod.xml"
    echo "$edges</edges>" > "$name.edg.xml"
    "$bin/netconvert" -n "$name.nod.xml" -e "$name.edg.xml" -o "$name.net.xml" --no-internal-links --no-turnarounds --offset.disable-normalization
    rm "$name.nod.xml" "$name.edg.xml"
    clean "$name.net.xml"
}
road straight 100:10 800:20
road steps 300:10 300:20 300:15 300:25 300:5 300:15 300:20
