#!/usr/bin/env bash
# A sweep over flow rate and mud density with curl and jq: submit, wait, table, the highest lines of a spectrum.
set -euo pipefail
server=${DRILLSWEEP_SERVER:-http://127.0.0.1:7340}

call() { # the token goes through a file, so that it is not in the list of processes
    curl --silent --show-error --fail-with-body \
        --header @<(echo "${DRILLSWEEP_TOKEN:+authorization: Bearer $DRILLSWEEP_TOKEN}") "$@"
}

sweep=$(call "$server/v1/sweeps" --header 'content-type: application/json' --data '{
    "preset": "paper-200m-damped",
    "axes": {"flow_rate": {"values": [0.01, 0.04, 0.06]}, "mud_density": {"from": 1200, "to": 2100, "count": 4}}}' | jq -r .id)

# Every answer is held back until something changes.
until call "$server/v1/sweeps/$sweep?wait=30s" | jq -er 'if .finished then true else null end' >/dev/null; do :; done

call "$server/v1/sweeps/$sweep/table" |
    jq -r '.columns | [.flow_rate, .mud_density, .friction_coefficient_max, .orbit_radius_rms_57_7m] | transpose[] | @tsv'
call "$server/v1/sweeps/$sweep/points/1/spectrum?depth=57.7&window=hann" |
    jq -c '.attributes.peaks[:3][] | {frequency, amplitude, whirl}'
