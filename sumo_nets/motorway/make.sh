#!/usr/bin/env bash
# A motorway of three lanes (120 km/h) with an on-ramp (80 km/h) and an acceleration lane of 300 m:
#   main0 (1 200 m, 3 lanes) -> merge (300 m, 3 + 1 lanes) -> main1 (1 500 m, 3 lanes);  ramp (400 m) -> lane 0 of merge.
# The demand is written by hand in motorway.rou.xml.
source "$(dirname "$0")/../common.sh"
cd "$(dirname "$0")"
cat > motorway.nod.xml <<'XML'
<nodes>
    <node id="west" x="0" y="0"/><node id="join" x="1200" y="0"/><node id="end" x="1500" y="0"/><node id="east" x="3000" y="0"/>
    <node id="south" x="820" y="-120"/>
</nodes>
XML
cat > motorway.edg.xml <<'XML'
<edges>
    <edge id="main0" from="west" to="join" numLanes="3" speed="33.33" priority="3"/>
    <edge id="ramp" from="south" to="join" numLanes="1" speed="22.22" priority="1" shape="820,-120 1000,-30 1100,-15 1200,-13"/>
    <edge id="merge" from="join" to="end" numLanes="4" speed="33.33" priority="3"/>
    <edge id="main1" from="end" to="east" numLanes="3" speed="33.33" priority="3"/>
</edges>
XML
{
    echo '<connections>'
    echo '    <connection from="ramp" to="merge" fromLane="0" toLane="0"/>'
    for i in 0 1 2; do
        echo "    <connection from=\"main0\" to=\"merge\" fromLane=\"$i\" toLane=\"$((i + 1))\"/>"
        echo "    <connection from=\"merge\" to=\"main1\" fromLane=\"$((i + 1))\" toLane=\"$i\"/>"
    done
    echo '</connections>'
} > motorway.con.xml
"$bin/netconvert" -n motorway.nod.xml -e motorway.edg.xml -x motorway.con.xml -o motorway.net.xml --no-turnarounds --offset.disable-normalization
rm motorway.nod.xml motorway.edg.xml motorway.con.xml
clean motorway.net.xml
