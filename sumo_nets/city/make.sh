#!/usr/bin/env bash
# A signalised city grid: 8 x 8 junctions 200 m apart, every crossing with a traffic light of fixed time (cycle 50 s).
# The second and the sixth street of each direction are arterials: 2 lanes, 60 km/h; all others 1 lane, 50 km/h.
# Demand: 800 trips in 600 s from randomTrips, routed once by duarouter, so that every SUMO drives the same routes.
source "$(dirname "$0")/../common.sh"
cd "$(dirname "$0")"
tools=$SUMO_HOME/tools

"$bin/netgenerate" --grid --grid.number 8 --grid.length 200 --grid.attach-length 200 --default.lanenumber 1 --default.speed 13.89 \
    --seed 23423 --plain-output-prefix city -o city.net.xml
# Arterials: an edge whose two ends lie in the same row 1 or 5, or in the same column B or F. Ids are like B1C1, left1A1, B7top1.
awk -F'"' '
    /<edge / && ($2 ~ /^([A-H]1[A-H]1|left1A1|A1left1|right1H1|H1right1|[A-H]5[A-H]5|left5A5|A5left5|right5H5|H5right5)$/ ||
                 $2 ~ /^(B[0-7]B[0-7]|bottom1B0|B0bottom1|top1B7|B7top1|F[0-7]F[0-7]|bottom5F0|F0bottom5|top5F7|F7top5)$/) {
        sub(/numLanes="1"/, "numLanes=\"2\""); sub(/speed="[0-9.]*"/, "speed=\"16.67\""); sub(/priority="[-0-9]*"/, "priority=\"3\"")
    }
    { print }' city.edg.xml > arterials.edg.xml
"$bin/netconvert" -n city.nod.xml -e arterials.edg.xml -o city.net.xml --no-turnarounds --offset.disable-normalization \
    --tls.set "$(echo {A,B,C,D,E,F,G,H}{0,1,2,3,4,5,6,7} | tr ' ' ',')" --tls.cycle.time 50 --tls.left-green.time 5
rm -f city.nod.xml city.edg.xml city.con.xml city.tll.xml city.typ.xml arterials.edg.xml

python3 "$tools/randomTrips.py" -n city.net.xml -o trips.xml --begin 0 --end 600 --period 0.75 --fringe-factor 5 --min-distance 600 \
    --seed 23423 --trip-attributes 'type="mix" departLane="best" departPos="base" departSpeed="0"'
"$bin/duarouter" -n city.net.xml --route-files trips.xml --additional-files city.types.xml -o city.rou.xml --seed 23423 --no-warnings true --no-step-log true
rm -f trips.xml city.rou.alt.xml routes.rou.xml
clean city.net.xml city.rou.xml
# The same traffic with SUMO's default imperfection of drivers.
sed 's/ sigma="0"/ sigma="0.5"/' city.rou.xml > city_drivers.rou.xml
