#!/usr/bin/env bash
# Describes, checks and runs robots as vendors publish them, and prints a table:
#     tools/vendor_robots.sh FOLDER [NAME...]
# FOLDER/robots has the unpacked package example-robot-data 6.0.0 (see docs/robot.md); `benchdog` is on the path. A robot must
# hold a board under a drill of 10 N if its line ends with `holds`.
set -euo pipefail
folder=$1
shift
robots="$folder/robots/cmeel.prefix/share/example-robot-data/robots"
wanted=("$@")

is_wanted() {
    [ "${#wanted[@]}" -eq 0 ] && return 0
    local name
    for name in "${wanted[@]}"; do [ "$name" = "$1" ] && return 0; done
    return 1
}

failed=0
printf '%-12s %-5s %-6s %-7s %s\n' robot arms pairs doctor verdict
while read -r name urdf expected; do
    is_wanted "$name" || continue
    toml="$folder/$name.toml" scenario="$folder/$name-drill.toml"
    benchdog robot new "$robots/$urdf" -o "$toml" --scenario "$scenario" --force > "$folder/$name-new.txt"
    doctor=ok
    benchdog doctor "$toml" > "$folder/$name-doctor.txt" 2>&1 || doctor=faults
    benchdog run "$scenario" --out "$folder/out-$name" --record never > "$folder/$name-run.txt" 2>&1 || true
    verdict=$(grep -oE '"verdict": "[a-z_]+"' "$folder/out-$name/$name-drill/verdict.json" | head -1 | cut -d'"' -f4)
    printf '%-12s %-5s %-6s %-7s %s\n' "$name" "$(grep -c '^  arm ' "$folder/$name-new.txt")" \
        "$(grep -oE '[0-9]+ pairs' "$folder/$name-new.txt" | cut -d' ' -f1)" "$doctor" "$verdict"
    if [ -n "$expected" ] && [ "$verdict" != "$expected" ]; then
        echo "$name: found $verdict, expected $expected" >&2
        failed=1
    fi
done <<'LIST'
baxter baxter_description/urdf/baxter.urdf holds
panda panda_description/urdf/panda.urdf holds
ur5 ur_description/urdf/ur5_robot.urdf holds
ur10 ur_description/urdf/ur10_robot.urdf holds
pr2 pr2_description/urdf/pr2.urdf holds
tiago-dual tiago_description/robots/tiago_dual.urdf holds
tiago-pro tiago_pro_description/robots/tiago_pro.urdf holds
icub icub_description/robots/icub.urdf
talos talos_data/robots/talos_full_v2.urdf holds
alex-nub alex_description/urdf/alex_nub_hands.urdf holds
alex-sake alex_description/urdf/alex_sake_hands.urdf holds
alex-psyonic alex_description/urdf/alex_psyonic_hands.urdf holds
centauro centauro_description/urdf/centauro.urdf holds
g1 g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf holds
romeo romeo_description/urdf/romeo.urdf holds
anymal-kinova anymal_b_simple_description/robots/anymal-kinova.urdf holds
b1-z1 b1_description/urdf/b1-z1.urdf holds
z1 z1_description/urdf/z1.urdf holds
so100 so_arm_description/urdf/so100.urdf holds
so101 so_arm_description/urdf/so101.urdf holds
ur3 ur_description/urdf/ur3_robot.urdf holds
xarm7 xarm_description/urdf/xarm7.urdf holds
kinova kinova_description/robots/kinova.urdf holds
LIST
exit "$failed"
