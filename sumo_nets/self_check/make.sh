#!/usr/bin/env bash
# Three roads of 600 m at 20 m/s side by side, each with a traffic light in its middle: red for the first 30 s, then green.
# `sumo-mfc doctor` carries this network in its binary and drives it to check the coupling.
source "$(dirname "$0")/../common.sh"
cd "$(dirname "$0")"
y=0 nodes= edges= connections= lights=
for road in classic adaptive plain; do
    y=$((y + 20))
    nodes+="<node id=\"$road.a\" x=\"0\" y=\"$y\"/><node id=\"$road.light\" x=\"300\" y=\"$y\" type=\"traffic_light\"/><node id=\"$road.b\" x=\"600\" y=\"$y\"/>"
    edges+="<edge id=\"$road.before\" from=\"$road.a\" to=\"$road.light\" numLanes=\"1\" speed=\"20\"/>"
    edges+="<edge id=\"$road.after\" from=\"$road.light\" to=\"$road.b\" numLanes=\"1\" speed=\"20\"/>"
    connections+="<connection from=\"$road.before\" to=\"$road.after\" fromLane=\"0\" toLane=\"0\"/>"
    lights+="<tlLogic id=\"$road.light\" type=\"static\" programID=\"0\" offset=\"0\"><phase duration=\"30\" state=\"r\"/><phase duration=\"600\" state=\"G\"/><phase duration=\"3\" state=\"y\"/></tlLogic>"
    lights+="<connection from=\"$road.before\" to=\"$road.after\" fromLane=\"0\" toLane=\"0\" tl=\"$road.light\" linkIndex=\"0\"/>"
done
echo "<nodes>$nodes</nodes>" > self_check.nod.xml
echo "<edges>$edges</edges>" > self_check.edg.xml
echo "<connections>$connections</connections>" > self_check.con.xml
echo "<tlLogics>$lights</tlLogics>" > self_check.tll.xml
"$bin/netconvert" -n self_check.nod.xml -e self_check.edg.xml -x self_check.con.xml -i self_check.tll.xml -o self_check.net.xml --no-turnarounds --offset.disable-normalization
rm self_check.nod.xml self_check.edg.xml self_check.con.xml self_check.tll.xml
clean self_check.net.xml
