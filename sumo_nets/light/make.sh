#!/usr/bin/env bash
# A straight road of 1 000 m at 20 m/s with a traffic light at s = 500 m: red for the first 120 s, then green.
source "$(dirname "$0")/../common.sh"
cd "$(dirname "$0")"
cat > light.nod.xml <<'XML'
<nodes><node id="a" x="0" y="0"/><node id="tl" x="500" y="0" type="traffic_light"/><node id="b" x="1000" y="0"/></nodes>
XML
cat > light.edg.xml <<'XML'
<edges><edge id="before" from="a" to="tl" numLanes="1" speed="20"/><edge id="after" from="tl" to="b" numLanes="1" speed="20"/></edges>
XML
cat > light.con.xml <<'XML'
<connections><connection from="before" to="after" fromLane="0" toLane="0"/></connections>
XML
cat > light.tll.xml <<'XML'
<tlLogics>
    <tlLogic id="tl" type="static" programID="0" offset="0"><phase duration="120" state="r"/><phase duration="600" state="G"/><phase duration="3" state="y"/></tlLogic>
    <connection from="before" to="after" fromLane="0" toLane="0" tl="tl" linkIndex="0"/>
</tlLogics>
XML
"$bin/netconvert" -n light.nod.xml -e light.edg.xml -x light.con.xml -i light.tll.xml -o light.net.xml --no-turnarounds --offset.disable-normalization
rm light.nod.xml light.edg.xml light.con.xml light.tll.xml
clean light.net.xml
