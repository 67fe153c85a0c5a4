#!/bin/bash
set -euo pipefail
curl --fail-with-body --silent --show-error --json @"$(dirname "$0")/tetrahedron.json" \
  "http://$1/latvox.v1.Voxelizer/VoxelizeSmall" |
  sed -E 's/.*"summary":\{"voxels":"([0-9]+)".*"digest":"([0-9a-f]+)".*/\1 voxels, digest \2\n/'
