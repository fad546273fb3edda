#!/usr/bin/env bash
# A large grid for benchmarks, made when needed and not kept in the repository:  make.sh OUT_DIR [CARS] [SEED]
# Junctions 200 m apart, 2 lanes, lights at every crossing; 8 cars for each of them, that is 50 x 50 junctions for the
# default of 20 000 CARS. All depart within the first 60 s, from random places on random lanes.
source "$(dirname "$0")/../common.sh"
out=${1:?usage: make.sh OUT_DIR [CARS] [SEED]}
cars=${2:-20000}
seed=${3:-23423}
mkdir -p "$out"
cd "$out"

side=$(awk -v n="$cars" 'BEGIN { side = int(sqrt(n / 8) + 0.5); print side < 6 ? 6 : side }')
"$bin/netgenerate" --grid --grid.number "$side" --grid.length 200 --default.lanenumber 2 --default.speed 13.89 \
    --default-junction-type traffic_light --no-turnarounds -o large.net.xml
period=$(awk -v n="$cars" 'BEGIN { printf "%.9f", 60 / n }')
python3 "$SUMO_HOME/tools/randomTrips.py" -n large.net.xml -o trips.xml --begin 0 --end 60 --period "$period" --min-distance $((80 * side)) \
    --seed "$seed" --vehicle-class passenger --trip-attributes 'departLane="random" departPos="random" departSpeed="0"'
"$bin/duarouter" -n large.net.xml --route-files trips.xml -o large.rou.xml --seed "$seed" --no-warnings true --no-step-log true
rm -f trips.xml large.rou.alt.xml
sed -i 's|<vType [^>]*/>|<vType id="passenger" vClass="passenger" accel="2.6" decel="4.5" emergencyDecel="9" sigma="0" speedFactor="normc(1,0.1,0.8,1.2)"/>|' large.rou.xml
clean large.net.xml large.rou.xml
cat > large.sumocfg <<'XML'
<configuration>
    <input>
        <net-file value="large.net.xml"/>
        <route-files value="large.rou.xml"/>
    </input>
    <time>
        <step-length value="0.1"/>
    </time>
    <processing>
        <step-method.ballistic value="true"/>
        <time-to-teleport value="-1"/>
        <collision.action value="warn"/>
    </processing>
    <report>
        <no-step-log value="true"/>
    </report>
</configuration>
XML
