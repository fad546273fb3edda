#!/usr/bin/env bash
# A straight road of 14 km at 30 m/s for a leader and ten followers: long enough for ten minutes at 20 m/s. One lane, no junction interior.
source "$(dirname "$0")/../common.sh"
cd "$(dirname "$0")"

echo '<nodes><node id="a" x="0" y="0"/><node id="b" x="14000" y="0"/></nodes>' > platoon.nod.xml
echo '<edges><edge id="ab" from="a" to="b" numLanes="1" speed="30" length="14000"/></edges>' > platoon.edg.xml
"$bin/netconvert" -n platoon.nod.xml -e platoon.edg.xml -o platoon.net.xml --no-internal-links --no-turnarounds --offset.disable-normalization
rm platoon.nod.xml platoon.edg.xml
clean platoon.net.xml
