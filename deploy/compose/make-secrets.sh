#!/bin/sh
# Makes the secrets of docker-compose.yml in a directory (secrets beside that file unless given); those that are there stay.
#
# Compose mounts a secret's file as it is, and the users of the containers are not its owner: so the directory is closed to all
# but its owner, and the files in it are readable.
set -eu

directory=${1:-$(dirname "$0")/../../secrets}
umask 077
mkdir -p "$directory"
chmod 0700 "$directory"
cd "$directory"

# 256 random bits, as hexadecimal digits: they need no quoting in any of the files.
random() {
    od -An -v -tx1 -N32 /dev/urandom | tr -d ' \n'
}

# Writes its input to a file that appears whole.
keep() {
    cat >"$1.partial"
    chmod 0444 "$1.partial"
    mv "$1.partial" "$1"
}

[ -e admin-token ] || random | keep admin-token
[ -e database-password ] || random | keep database-password
if ! [ -e objects-credentials ] || ! [ -e objects-identities ]; then
    key=$(random)
    secret=$(random)
    keep objects-credentials <<EOF
[default]
aws_access_key_id = $key
aws_secret_access_key = $secret
EOF
    keep objects-identities <<EOF
{"identities": [{"name": "drillsweep", "credentials": [{"accessKey": "$key", "secretKey": "$secret"}], "actions": ["Read", "Write", "List", "Tagging"]}]}
EOF
fi
