#!/bin/sh
# Builds model.fmu in this folder from drop.c and modelDescription.xml; needs a C compiler and python3.
set -eu
cd "$(dirname "$0")"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/binaries/linux64"
${CC:-cc} -O2 -shared -fPIC -o "$work/binaries/linux64/drop.so" drop.c -lm
cp modelDescription.xml "$work"
rm -f model.fmu
here="$PWD"
(cd "$work" && python3 -m zipfile -c "$here/model.fmu" modelDescription.xml binaries)
