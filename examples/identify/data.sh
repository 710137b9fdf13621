#!/bin/sh
# Makes the data of the studies in this folder, in which 0.6 L/(s·bar), b = 0.32, and delays of 4 ms and 1 ms are to be found, and
# of the joint 1.3e-3 kg·m², 0.03 N·m·s/rad, and 2.8 and 3 turns, and of the arm a shoulder's inertia of 6e-3 kg·m², an elbow's
# damping of 0.05 N·m·s/rad, 2.7 turns of the biceps and a tank of 250 cm³:
#     cd examples/identify && sh data.sh
set -e
valve='--set valve.sonic_conductance="0.6L/(s*bar)" --set valve.critical_ratio=0.32 --set valve.opening_delay="4ms" --set valve.closing_delay="1ms"'

# Steady flow by ISO 6358-1, 36 L/(min·bar) ANR at 22 °C; a flow meter with steps of 0.5 L/min, sensors with steps of 10 mbar.
awk 'BEGIN {
    print "P1,P2,T1,Q"
    for (k = 0; k < 32; k++) {
        p1 = k % 2 ? 5.01 : 7.01
        p2 = int(100 * p1 * (0.22 + 0.0235 * k) + 0.5) / 100
        r = p2 / p1
        shape = r > 0.32 ? sqrt(1 - ((r - 0.32) / 0.68)^2) : 1
        q = 36 * p1 * sqrt(293.15 / 295.15) * shape
        printf "%.2f,%.2f,22.0,%.1f\n", p1, p2, int(2 * q + 0.5) / 2
    }
}' > flow.csv

# Time and pressure of run.csv, with noise of 0.3 kPa (sums of twelve numbers of the generator of Park and Miller) in steps of 0.1 kPa.
measured() {
    awk -F, -v state="$2" 'function uniform() { state = state * 16807 % 2147483647; return state / 2147483647 }
        NR == 1 { for (k = 1; k <= NF; k++) at[$k] = k; print "t,P"; next }
        { noise = -6; for (k = 0; k < 12; k++) noise += uniform()
          printf "%s,%.1f\n", $at["time_s"], $at["absolute_pressure_pa"] / 1000 + 0.3 * noise }' run.csv > "$1"
}

# A bottle of 0.5 L, of which the muscle at 90 mm has 4.5 cm³, from 7 bar.
mckibben simulate rig.toml $valve --set 'actuator.external_volume="495.474cm^3"' --set 'air.process="isothermal"' \
    --set 'command={kind="exhaust"}' --set 'valve.opening_delay="0s"' --set 'valve.closing_delay="0s"' --set 'initial.gauge_pressure="7bar"' \
    --set 'run.duration="1.5s"' --set 'run.sample_interval="10ms"' --output run.csv
measured discharge.csv 1

# Pulses into hose and fittings of 60 cm³, sampled at 2 kHz.
for frequency in 10 20 40; do
    mckibben simulate rig.toml $valve --set "command.frequency=\"${frequency}Hz\"" --output run.csv
    measured "pulses-${frequency}hz.csv" $frequency
done

# A joint every 10 ms, with noise of 0.1 deg and 0.3 kPa in steps of 0.01 deg and 0.1 kPa.
mckibben simulate ../antagonistic-joint.toml --set 'load.inertia="1.3e-3kg*m^2"' --set 'load.damping="0.03N*m*s/rad"' \
    --set 'actuator.turns=2.8' --set 'antagonist.actuator.turns=3.0' --set 'run.sample_interval="10ms"' --output run.csv
awk -F, -v state=7 'function noise() { sum = -6
            for (n = 0; n < 12; n++) { state = state * 16807 % 2147483647; sum += state / 2147483647 }
            return sum }
        NR == 1 { for (k = 1; k <= NF; k++) at[$k] = k; print "t,angle,P1,P2"; next }
        { printf "%s,%.2f,%.1f,%.1f\n", $at["time_s"], $at["angle_rad"] * 57.29577951 + 0.1 * noise(),
            $at["absolute_pressure_pa"] / 1000 + 0.3 * noise(), $at["antagonist_absolute_pressure_pa"] / 1000 + 0.3 * noise() }' run.csv > joint.csv

# An arm of six muscles, likewise: three angles, and the gauge pressures of the biceps and of the tank.
mckibben simulate ../plant/arm.toml --set 'mechanism.joints.shoulder.inertia="6e-3kg*m^2"' \
    --set 'mechanism.joints.elbow.damping="0.05N*m*s/rad"' --set 'actuators.biceps.turns=2.7' \
    --set 'supplies.tank.reservoir_volume="250cm^3"' --set 'run.sample_interval="10ms"' --output run.csv
awk -F, -v state=11 'function noise() { sum = -6
            for (n = 0; n < 12; n++) { state = state * 16807 % 2147483647; sum += state / 2147483647 }
            return sum }
        NR == 1 { for (k = 1; k <= NF; k++) at[$k] = k; print "t,shoulder,elbow,wrist,biceps,tank"; next }
        { printf "%s", $at["time_s"]
          for (k = split("shoulder elbow wrist", of, " "); k > 0; k--) angle[k] = $at[of[k] ".angle_rad"] * 57.29577951 + 0.1 * noise()
          printf ",%.2f,%.2f,%.2f", angle[1], angle[2], angle[3]
          printf ",%.1f", $at["biceps.absolute_pressure_pa"] / 1000 - 101.325 + 0.3 * noise()
          printf ",%.1f\n", $at["tank.absolute_pressure_pa"] / 1000 - 101.325 + 0.3 * noise() }' run.csv > arm.csv
rm run.csv
