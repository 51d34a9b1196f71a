#!/bin/bash
# Counts the C++ of each folder: lines, files, functions, and the median and the 90th percentile of
# the functions' lengths.
#
#   scripts/count-lines.sh [FOLDER...]     by default all top folders
#
# A function begins with the line that ends its signature with an opening brace, outside of functions,
# and ends with the brace below it at the same indentation, as the formatter lays them out.
set -euo pipefail
cd "$(dirname "$0")/.."
folders=("$@")
((${#folders[@]} > 0)) || folders=(core tools server client tests)

# The lengths of the functions of these files.
function_lengths() {
  awk '
    FNR == 1 { inside = 0 }
    inside && $0 == indent "}" { print FNR - first + 1; inside = 0; next }
    inside { next }
    /\) (const )?(noexcept )?(override )?\{$/ || /\) const .*\{$/ || /\).* : .*\{$/ {
      if ($0 ~ /^ *(if|for|while|switch|else|do|return)\>/) next
      match($0, /^ */)
      if (RLENGTH > 4) next
      # The signature of several lines ends with a line that is indented further.
      indent = RLENGTH == 4 ? start_indent : substr($0, 1, RLENGTH)
      inside = 1
      first = RLENGTH == 4 ? start : FNR
    }
    /^(  )?[A-Za-z~:_<>].*\(/ { match($0, /^ */); start_indent = substr($0, 1, RLENGTH); start = FNR }
  ' "$@"
}

percentile() { sort -n | awk -v share="$1" '{ a[NR] = $1 } END { print NR ? a[int((NR - 1) * share) + 1] : 0 }'; }

printf '%-24s %8s %6s %10s %7s %5s\n' folder lines files functions median '90 %'
for folder in "${folders[@]}"; do
  mapfile -t files < <(git ls-files "$folder" | grep -E '\.(cc|h)$')
  lengths=$(function_lengths "${files[@]}")
  printf '%-24s %8d %6d %10d %7d %5d\n' "$folder" "$(cat "${files[@]}" | wc -l)" "${#files[@]}" \
    "$(wc -l <<<"$lengths")" "$(percentile 0.5 <<<"$lengths")" "$(percentile 0.9 <<<"$lengths")"
done
