#!/bin/bash
# Checks the alert rules for Prometheus and runs their tests, with promtool. If PATH has no
# promtool, it unpacks promtool from Debian's package prometheus into build/promtool and keeps it
# there. It does not install the package, because that would start a Prometheus on this machine.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly FOLDER=build/promtool

unpack_promtool() (
  mkdir -p "$FOLDER"
  cd "$FOLDER"
  apt-get -qq -o APT::Sandbox::User="$(id -un)" download prometheus || {
    echo "test-alerts: cannot download the package prometheus; if apt does not know it, run apt-get update" >&2
    exit 1
  }
  dpkg-deb --fsys-tarfile prometheus_*.deb | tar -x --strip-components=3 ./usr/bin/promtool
  rm prometheus_*.deb
)

promtool=$(command -v promtool) || promtool=$FOLDER/promtool
[[ -x $promtool ]] || unpack_promtool
"$promtool" check rules server/prometheus/alerts.yml
"$promtool" test rules tests/server/prometheus/alerts_test.yml
