#!/bin/sh
# Merges what several machines built into one release: the files in their lists of checksums. Checks the lists, and that a
# file built twice has the same bytes.
#
#   sh dist/merge.sh BUILT RELEASE      each folder in BUILT is a target/dist
set -eu

built=$1 release=$2
mkdir -p "$release"
for folder in "$built"/*/; do
    (cd "$folder" && sha256sum --check --quiet SHA256SUMS)
    while read -r _ name; do
        cp "$folder$name" "$release"
    done <"${folder}SHA256SUMS"
done
cat "$built"/*/SHA256SUMS | sort -k 2 | uniq >"$release/SHA256SUMS"
twice=$(sed 's/^[^ ]* *//' "$release/SHA256SUMS" | uniq -d)
if [ -n "$twice" ]; then
    echo "merge.sh: error: these files were built twice, with different bytes: $twice" >&2
    exit 1
fi
