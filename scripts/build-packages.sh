#!/usr/bin/env bash
# Builds the packages for Debian (debian/) from the files that git knows, as they are in this folder, into
# build/package/packages. Arguments go to dpkg-buildpackage: -d builds without asking for all of Build-Depends.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install-deps.sh packages
folder=build/package
rm -rf "$folder/vdwmesh/debian" "$folder/packages"
mkdir -p "$folder/vdwmesh" "$folder/packages"
# Times are kept, so a second call compiles what has changed.
git ls-files -z --cached --others --exclude-standard | xargs -0 cp --parents --preserve=all -t "$folder/vdwmesh"
export DEB_BUILD_OPTIONS=${DEB_BUILD_OPTIONS:-parallel=$(nproc)}
(cd "$folder/vdwmesh" && dpkg-buildpackage -b -us -uc -nc "$@")
mv "$folder"/*.deb "$folder"/*.changes "$folder"/*.buildinfo "$folder/packages"
ls -l "$folder/packages"
