#!/bin/bash
# Formats the C++ and proto files of the project. With --check it only prints the lines that are not
# formatted. The third-party files under proto/google/ are not formatted.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh clang-format

arguments=(-i)
[[ ${1:-} != --check ]] || arguments=(--dry-run -Werror)
git ls-files -z --cached --others --exclude-standard -- '*.cc' '*.h' '*.proto' ':!proto/google' |
  while IFS= read -r -d '' file; do [[ ! -e $file ]] || printf '%s\0' "$file"; done |
  xargs -0 --no-run-if-empty clang-format "${arguments[@]}"
