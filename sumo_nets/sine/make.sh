#!/usr/bin/env bash
# A straight road whose limit follows the sine of position  v(s) = 15 m/s + 5 m/s * sin(2 pi s / 200 m), 0 <= s <= 1200 m:
# edges of 10 m, each with the sine's value at its middle, so 20 values per wavelength. Following it takes at most
# 2.5 m/s^2. One lane, no junction interior: the position on the route is s itself.
source "$(dirname "$0")/../common.sh"
cd "$(dirname "$0")"
awk 'BEGIN {
    pi = atan2(0, -1)
    print "<nodes>" > "sine.nod.xml"; print "<edges>" > "sine.edg.xml"
    for (i = 0; i <= 120; i++) printf "<node id=\"n%d\" x=\"%d\" y=\"0\"/>\n", i, 10 * i > "sine.nod.xml"
    for (i = 0; i < 120; i++)
        printf "<edge id=\"s%d\" from=\"n%d\" to=\"n%d\" numLanes=\"1\" speed=\"%.2f\" length=\"10\"/>\n", \
            10 * i, i, i + 1, 15 + 5 * sin(2 * pi * (10 * i + 5) / 200) > "sine.edg.xml"
    print "</nodes>" > "sine.nod.xml"; print "</edges>" > "sine.edg.xml"
    print "<?xml version=\"1.0\" encoding=\"UTF-8\"?>"
    print "<!-- One car from rest at s = 0; speedFactor 1 without spread: its limit is the lane'"'"'s. Written by make.sh. -->"
    print "<routes>"
    print "    <vType id=\"ego\" vClass=\"passenger\" length=\"5\" accel=\"2.6\" decel=\"4.5\" emergencyDecel=\"9\" sigma=\"0\" tau=\"1\" minGap=\"2.5\" maxSpeed=\"60\" speedFactor=\"1\" speedDev=\"0\"/>"
    print "    <vehicle id=\"ego\" type=\"ego\" depart=\"0\" departPos=\"0\" departSpeed=\"0\" departLane=\"0\">"
    printf "        <route edges=\""
    for (i = 0; i < 120; i++) printf "%ss%d", (i ? " " : ""), 10 * i
    print "\"/>\n    </vehicle>\n</routes>"
}' > sine.rou.xml
"$bin/netconvert" -n sine.nod.xml -e sine.edg.xml -o sine.net.xml --no-internal-links --no-turnarounds --offset.disable-normalization
rm sine.nod.xml sine.edg.xml
clean sine.net.xml
