#!/bin/bash
# Builds an image for containers from the Debian packages, without Docker: an OCI image layout.
#
#   scripts/oci.sh PACKAGES IMAGE     for instance scripts/oci.sh build/deb build/oci
#
# The image has Debian's smallest system and the packages ballpiston and ballpistond. Its command is
# the server, as the user ballpiston, with its data in /var/lib/ballpiston/ballpiston, where clients
# in the container find it. The user is given by number: from a name Kubernetes cannot tell whether
# it is root.
set -euo pipefail
packages=$(realpath "$1")
image=$(realpath -m "$2")

version=$(dpkg-deb --field "$packages"/ballpistond_*.deb Version)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

debs=("$packages"/ballpiston_*.deb "$packages"/ballpistond_*.deb)
mkdir "$work/debs"
cp "${debs[@]}" "$work/debs"
# The packages are copied into the system, installed with what they need, and removed again.
mmdebstrap --variant=apt --skip=cleanup/reproducible \
  --customize-hook="mkdir \"\$1/debs\" && cp $work/debs/*.deb \"\$1/debs\"" \
  --customize-hook='chroot "$1" sh -c "apt-get install --yes --no-install-recommends /debs/*.deb systemd-standalone-sysusers && systemd-sysusers"' \
  --customize-hook='rm -rf "$1/debs" "$1"/var/lib/apt/lists/* "$1"/var/cache/apt/*' \
  --customize-hook='chroot "$1" install -d -o ballpiston -g ballpiston -m 700 /var/lib/ballpiston' \
  bookworm "$work/system.tar"

if [[ -e $image && ! -e $image/oci-layout ]]; then
  echo "oci: $image exists and is not an image" >&2
  exit 1
fi
rm -rf "$image"
user=$(tar --extract --to-stdout --file "$work/system.tar" ./etc/passwd |
  awk -F: '$1 == "ballpiston" { print $3 ":" $4 }')
umoci init --layout "$image"
umoci new --image "$image:$version"
umoci raw add-layer --image "$image:$version" "$work/system.tar"
umoci config --image "$image:$version" \
  --config.user "$user" --config.env XDG_STATE_HOME=/var/lib/ballpiston \
  --config.volume /var/lib/ballpiston --config.stopsignal SIGTERM \
  --config.cmd ballpistond
echo "$image, tag $version"
